//! The IMU BMI160: its registers as bytes, its samples as SI units.
//!
//! Bytes, the highest bit first, clock low at rest, data taken at its rising edge; the first byte is the register, with
//! bit 7 for a read. Source: its data sheet, BST-BMI160-DS000.

/// Register of the chip's number; reading it once after power-on also chooses this bus.
pub const CHIP: u8 = 0x00;
/// The chip's number.
pub const CHIP_ID: u8 = 0xd1;
/// Register that tells which values were not read yet. It forgets as soon as one of them is read, so it comes first.
pub const STATUS: u8 = 0x1b;
/// First of the [`BURST`] registers.
pub const FIRST: u8 = 0x0c;
/// Bytes of gyro, accelerometer and time, from [`FIRST`].
pub const BURST: usize = 15;

/// The byte that reads from a register on.
pub const fn read(register: u8) -> u8 {
    register | 0x80
}

/// One step of the set-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Write {
    /// The register.
    pub register: u8,
    /// Its value.
    pub value: u8,
    /// Time until the next step \[ms\].
    pub then_ms: u8,
}

/// Set-up: reset; both sensors on; 1600 samples a second with twofold oversampling (the gyro's bandwidth 255 Hz, the
/// accelerometer's 324), 16 g, 2000 degrees a second.
///
/// Read 1000 times a second, what is above 745 Hz folds into that bandwidth. Without oversampling it is 524 Hz, and
/// what folds below it begins at 476 Hz: hardly filtered. Fourfold is 136 Hz. Taken for filters of the second order the
/// three lag by 0.4, 0.9 and 1.7 ms, and 5 ms cost 5 % of the basin at 2.5 m/s (docs/delay.md).
pub const SET_UP: [Write; 7] = [
    Write { register: 0x7e, value: 0xb6, then_ms: 100 },
    Write { register: 0x7e, value: 0x11, then_ms: 10 },
    Write { register: 0x7e, value: 0x15, then_ms: 100 },
    Write { register: 0x40, value: 0x1c, then_ms: 1 },
    Write { register: 0x41, value: 0x0c, then_ms: 1 },
    Write { register: 0x42, value: 0x1c, then_ms: 1 },
    Write { register: 0x43, value: 0x00, then_ms: 1 },
];

/// One count of the gyro \[rad/s\]: 16.4 counts to a degree a second.
pub const RAD_S_PER_COUNT: f32 = core::f32::consts::PI / 180.0 / 16.4;
/// One count of the accelerometer \[m/s^2\]: 2048 counts to standard gravity.
pub const M_S2_PER_COUNT: f32 = 9.806_65 / 2048.0;

/// One sample, in the chip's own axes. What is at the end of the scale is infinite, so that nobody takes it for a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imu {
    /// Angular velocity \[rad/s\].
    pub gyro_rad_s: [f32; 3],
    /// Specific force \[m/s^2\].
    pub accel_m_s2: [f32; 3],
    /// The chip's clock \[39.0625 us\], 24 bits.
    pub time: u32,
    /// Whether the gyro's values were not read before.
    pub gyro_new: bool,
    /// Whether the accelerometer's values were not read before.
    pub accel_new: bool,
}

/// The sample in the bytes from [`FIRST`] on, after the value of [`STATUS`] just before.
pub fn sample(status: u8, bytes: &[u8; BURST]) -> Imu {
    let [gx, gxh, gy, gyh, gz, gzh, ax, axh, ay, ayh, az, azh, t0, t1, t2] = *bytes;
    let gyro = [[gx, gxh], [gy, gyh], [gz, gzh]];
    let accel = [[ax, axh], [ay, ayh], [az, azh]];
    Imu {
        gyro_rad_s: gyro.map(|count| scaled(i16::from_le_bytes(count), RAD_S_PER_COUNT)),
        accel_m_s2: accel.map(|count| scaled(i16::from_le_bytes(count), M_S2_PER_COUNT)),
        time: u32::from_le_bytes([t0, t1, t2, 0]),
        gyro_new: status & 0x40 != 0,
        accel_new: status & 0x80 != 0,
    }
}

fn scaled(count: i16, unit: f32) -> f32 {
    match count {
        i16::MIN => f32::NEG_INFINITY,
        i16::MAX => f32::INFINITY,
        count => f32::from(count) * unit,
    }
}
