//! Gate driver: enabled while the rotor is slow, configured, and read back; its status is read when it opened the
//! bridge.

use super::pins::{GATE_ENABLE, Pin, fixed};
use super::soft_spi::SoftSpi;
use core::cell::Cell;
use core::fmt::Write;
use core::sync::atomic::{AtomicBool, Ordering};
use devices::as5047::{Line, READ_ANGLE};
use devices::drv8301::{Register, Status, data, is_present, read, write};
use devices::rotor_speed::RotorSpeedCheck;
use devices::vesc6::{ENABLE_V, GATE_DRIVER, MOTOR};
use embassy_stm32::gpio::Level;
use embassy_stm32::pac::GPIOB;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_time::{Duration, Instant, block_for};

/// Time from enabling to ready; the data sheet says 5 to 10 ms.
const WAKE: Duration = Duration::from_millis(20);

/// Longest wait for a slow rotor. A handlebar at more than the limit, 5.6 rad/s, crosses its whole range in this
/// time; the watchdog's timeout during the start is more than twice that.
const WAIT: Duration = Duration::from_millis(500);

/// Whether the start succeeded.
static STARTED: AtomicBool = AtomicBool::new(false);

/// SPI bus of the driver, after the start; its pins stay driven, as they are next to a switching bridge.
static BUS: Mutex<CriticalSectionRawMutex, Cell<Option<SoftSpi>>> = Mutex::new(Cell::new(None));

/// Enables and configures the driver; returns whether the settings were accepted without a fault. Otherwise it is
/// disabled again. All its inputs must be low meanwhile. If the rotor does not become slow, the driver stays off.
pub(super) fn start(enable: Pin, mut bus: SoftSpi, encoder: &mut SoftSpi) -> bool {
    fixed(enable, Level::Low);
    let good = is_slow(encoder) && configure(&mut bus);
    if !good {
        super::outputs_off();
    }
    BUS.lock(|cell| cell.set(Some(bus)));
    STARTED.store(good, Ordering::Relaxed);
    good
}

/// Whether the start succeeded.
pub(super) fn is_started() -> bool {
    STARTED.load(Ordering::Relaxed)
}

/// Whether the rotor is slow, or becomes so in time: if turned by hand, its terminals must stay below [`ENABLE_V`].
fn is_slow(encoder: &mut SoftSpi) -> bool {
    let most_turns_s = MOTOR.motor.turns_s_at(ENABLE_V);
    let (mut line, mut check) = (Line::default(), RotorSpeedCheck::default());
    let end = Instant::now() + WAIT;
    while Instant::now() < end {
        if check.step(line.step(encoder.word(READ_ANGLE)), most_turns_s) {
            return true;
        }
        block_for(Duration::from_millis(1));
    }
    match check.turns_s {
        Some(turns_s) => defmt::error!(
            "gate driver: left off, the motor turned at {=f32} turns/s, of {=f32} allowed",
            turns_s,
            most_turns_s
        ),
        None => defmt::error!("gate driver: left off, no speed of the motor: its encoder is silent"),
    }
    false
}

/// Enables the driver, writes the settings and reads them back.
fn configure(bus: &mut SoftSpi) -> bool {
    GPIOB.bsrr().write(|w| w.set_bs(GATE_ENABLE, true));
    block_for(WAKE);
    // The first word can be lost, and the first read clears the status of power-up.
    read_register(bus, Register::Status1);
    let (control1, control2) = (GATE_DRIVER.control1(), GATE_DRIVER.control2());
    bus.word(write(Register::Control1, control1));
    bus.word(write(Register::Control2, control2));
    let registers = [Register::Status2, Register::Status1, Register::Control1, Register::Control2]
        .map(|register| read_register(bus, register));
    let good = match registers {
        [Some(kind), Some(status), Some(one), Some(two)] => {
            is_present(kind) && status == 0 && (one, two) == (control1, control2)
        }
        _ => false,
    };
    defmt::info!("gate driver: good={=bool} kind, status, controls: {}", good, registers);
    if let [Some(kind), Some(status), ..] = registers {
        Status(status, kind).names().for_each(|name| defmt::warn!("gate driver: {=str}", name));
    }
    good
}

/// Names of the present faults. The driver must still be enabled: disabling clears the status. Takes 0.3 ms, too long
/// for the motor interrupt.
pub(super) fn describe(text: &mut impl Write) -> core::fmt::Result {
    let Some(mut bus) = BUS.lock(Cell::take) else { return Ok(()) };
    let answers = [Register::Status1, Register::Status2].map(|register| read_register(&mut bus, register));
    BUS.lock(|cell| cell.set(Some(bus)));
    let [Some(one), Some(two)] = answers else { return write!(text, "no answer") };
    Status(one, two).names().try_for_each(|name| write!(text, "{name}, "))?;
    write!(text, "status {one:03x} {two:03x}")
}

/// Data of a register.
fn read_register(bus: &mut SoftSpi, register: Register) -> Option<u16> {
    bus.word(read(register));
    data(register, bus.word(read(register)))
}
