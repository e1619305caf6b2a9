//! The gate driver: enabled once the rotor is slow, configured, read back; its status is read when it opened the bridge.

use super::pins::{GATE_ENABLE, Pin, fixed};
use super::soft_spi::SoftSpi;
use core::cell::Cell;
use core::fmt::Write;
use core::sync::atomic::{AtomicBool, Ordering};
use devices::as5047::{ASK_ANGLE, Line};
use devices::drv8301::{Register, Status, data, is_present, read, write};
use devices::slow::Slow;
use devices::vesc6::{ENABLE_V, GATE_DRIVER, MOTOR};
use embassy_stm32::gpio::Level;
use embassy_stm32::pac::GPIOB;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_time::{Duration, Instant, block_for};

/// From enabling to ready; its data sheet says 5 to 10 ms.
const WAKE: Duration = Duration::from_millis(20);

/// How long the start waits for a slow rotor. A handlebar that is faster than the limit, 5.6 rad/s, goes from end to
/// end in this time; the watchdog's patience in a start is more than twice that.
const WAIT: Duration = Duration::from_millis(500);

/// Whether it was started well.
static STARTED: AtomicBool = AtomicBool::new(false);

/// The driver's bus, once that was tried; its pins are never let go beside a switching bridge.
static BUS: Mutex<CriticalSectionRawMutex, Cell<Option<SoftSpi>>> = Mutex::new(Cell::new(None));

/// Enables it and gives it its settings; whether it took them and nothing is wrong. It stays enabled only then. All its
/// inputs must be low meanwhile. A rotor that never is slow leaves it off.
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

/// Whether it was started well.
pub(super) fn is_started() -> bool {
    STARTED.load(Ordering::Relaxed)
}

/// Whether the rotor is slow, or becomes so in time: turned by hand, its terminals must not reach [`ENABLE_V`].
fn is_slow(encoder: &mut SoftSpi) -> bool {
    let most_turns_s = MOTOR.motor.turns_s_at(ENABLE_V);
    let (mut line, mut slow) = (Line::default(), Slow::default());
    let end = Instant::now() + WAIT;
    while Instant::now() < end {
        if slow.step(line.step(encoder.word(ASK_ANGLE)), most_turns_s) {
            return true;
        }
        block_for(Duration::from_millis(1));
    }
    match slow.turns_s {
        Some(turns_s) => defmt::error!(
            "gate driver: left off, the motor turned at {=f32} turns/s, of {=f32} allowed",
            turns_s,
            most_turns_s
        ),
        None => defmt::error!("gate driver: left off, no speed of the motor: its encoder is silent"),
    }
    false
}

/// Enables it, writes the settings and reads them back.
fn configure(bus: &mut SoftSpi) -> bool {
    GPIOB.bsrr().write(|w| w.set_bs(GATE_ENABLE, true));
    block_for(WAKE);
    // The first word may be lost, and the first reading takes away what waking up left behind.
    ask(bus, Register::Status1);
    let (control1, control2) = (GATE_DRIVER.control1(), GATE_DRIVER.control2());
    bus.word(write(Register::Control1, control1));
    bus.word(write(Register::Control2, control2));
    let told = [Register::Status2, Register::Status1, Register::Control1, Register::Control2]
        .map(|register| ask(bus, register));
    let good = match told {
        [Some(kind), Some(status), Some(one), Some(two)] => {
            is_present(kind) && status == 0 && (one, two) == (control1, control2)
        }
        _ => false,
    };
    defmt::info!("gate driver: good={=bool} kind, status, controls: {}", good, told);
    if let [Some(kind), Some(status), ..] = told {
        Status(status, kind).names().for_each(|name| defmt::warn!("gate driver: {=str}", name));
    }
    good
}

/// Its status in words. It must still be enabled: disabling clears the status. Takes 0.3 ms, too long for the motor's
/// interrupt.
pub(super) fn describe(words: &mut impl Write) -> core::fmt::Result {
    let Some(mut bus) = BUS.lock(Cell::take) else { return Ok(()) };
    let answers = [Register::Status1, Register::Status2].map(|register| ask(&mut bus, register));
    BUS.lock(|cell| cell.set(Some(bus)));
    let [Some(one), Some(two)] = answers else { return write!(words, "no answer") };
    Status(one, two).names().try_for_each(|name| write!(words, "{name}, "))?;
    write!(words, "status {one:03x} {two:03x}")
}

/// A register's data.
fn ask(bus: &mut SoftSpi, register: Register) -> Option<u16> {
    bus.word(read(register));
    data(register, bus.word(read(register)))
}
