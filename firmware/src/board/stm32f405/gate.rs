//! The gate driver: switched on, told its settings, asked whether it took them.

use super::pins::{Pin, fixed};
use super::soft_spi::SoftSpi;
use embassy_stm32::gpio::Level;
use embassy_time::{Duration, block_for};
use parts::drv8301::{Register, Status, data, is_present, read, write};
use parts::vesc6::GATE_DRIVER;

/// From enabling to ready; its data sheet says 5 to 10 ms.
const WAKE: Duration = Duration::from_millis(20);

/// Enables it and gives it its settings; whether it took them and nothing is wrong. It stays enabled only then. All its
/// inputs must be low meanwhile.
pub(super) fn start(enable: Pin, bus: &mut SoftSpi) -> bool {
    fixed(enable, Level::High);
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
    if let [_, Some(status), ..] = told {
        Status(status).names().for_each(|name| defmt::warn!("gate driver: {=str}", name));
    }
    if !good {
        super::outputs_off();
    }
    good
}

/// A register's data.
fn ask(bus: &mut SoftSpi, register: Register) -> Option<u16> {
    bus.word(read(register));
    data(register, bus.word(read(register)))
}
