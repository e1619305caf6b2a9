//! Driver of the board's IMU.

use super::soft_spi::SoftSpi;
use devices::bmi160::{BURST, CHIP, CHIP_ID, FIRST, Imu, SET_UP, STATUS, read, sample};
use embassy_time::{Duration, block_for};

/// Configures the IMU; returns whether it answers. Takes a fifth of a second.
pub(super) fn start(bus: &mut SoftSpi) -> bool {
    register(bus, CHIP);
    for step in SET_UP {
        bus.bytes(&mut [step.register, step.value]);
        block_for(Duration::from_millis(step.then_ms.into()));
        // A reset clears the IMU's bus selection.
        register(bus, CHIP);
    }
    let chip = register(bus, CHIP);
    defmt::info!("imu: chip={=u8:#x}, wanted {=u8:#x}", chip, CHIP_ID);
    chip == CHIP_ID
}

/// Reads the newest sample.
pub(super) fn newest(bus: &mut SoftSpi) -> Imu {
    let status = register(bus, STATUS);
    let mut bytes = [0; 1 + BURST];
    bytes[0] = read(FIRST);
    bus.bytes(&mut bytes);
    let [_, burst @ ..] = bytes;
    sample(status, &burst)
}

fn register(bus: &mut SoftSpi, register: u8) -> u8 {
    let mut bytes = [read(register), 0];
    bus.bytes(&mut bytes);
    bytes[1]
}
