//! IMU BMI160: register map, set-up, and conversion of its samples to SI units.
//!
//! SPI bytes, most significant bit first, clock idle low, data sampled on its rising edge; the first byte is the
//! register, with bit 7 set for a read. Source: data sheet BST-BMI160-DS000.

/// Register of the chip's identifier; reading it once after power-on also selects SPI.
pub const CHIP: u8 = 0x00;
/// Identifier of the chip.
pub const CHIP_ID: u8 = 0xd1;
/// Status register: which values are new. Reading a value clears its flag, so it is read first.
pub const STATUS: u8 = 0x1b;
/// First of the [`BURST`] registers.
pub const FIRST: u8 = 0x0c;
/// Length of gyro, accelerometer and time data from [`FIRST`] \[bytes\].
pub const BURST: usize = 15;

/// First byte of a read that begins at a register.
pub const fn read(register: u8) -> u8 {
    register | 0x80
}

/// One register write of the set-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Write {
    /// The register.
    pub register: u8,
    /// Value to write.
    pub value: u8,
    /// Delay until the next write \[ms\].
    pub then_ms: u8,
}

/// Set-up: reset; both sensors on; 1600 samples per second with twofold oversampling (bandwidth of the gyro 255 Hz,
/// of the accelerometer 324 Hz), ranges 16 g and 2000 degrees per second.
///
/// At a read rate of 1000 Hz, frequencies above 745 Hz alias into that bandwidth. Without oversampling the bandwidth is
/// 524 Hz, and aliasing begins at 476 Hz, where attenuation is small. Fourfold oversampling gives 136 Hz. Modelled as
/// second-order filters the three lag by 0.4, 0.9 and 1.7 ms, and 5 ms cost 5 % of the basin at 2.5 m/s
/// (docs/delay.md).
pub const SET_UP: [Write; 7] = [
    Write { register: 0x7e, value: 0xb6, then_ms: 100 },
    Write { register: 0x7e, value: 0x11, then_ms: 10 },
    Write { register: 0x7e, value: 0x15, then_ms: 100 },
    Write { register: 0x40, value: 0x1c, then_ms: 1 },
    Write { register: 0x41, value: 0x0c, then_ms: 1 },
    Write { register: 0x42, value: 0x1c, then_ms: 1 },
    Write { register: 0x43, value: 0x00, then_ms: 1 },
];

/// One count of the gyro \[rad/s\]: 16.4 counts per degree per second.
pub const RAD_S_PER_COUNT: f32 = core::f32::consts::PI / 180.0 / 16.4;
/// One count of the accelerometer \[m/s^2\]: 2048 counts per standard gravity.
pub const M_S2_PER_COUNT: f32 = 9.806_65 / 2048.0;

/// One sample in the chip's axes. A saturated value is infinite, so that validation rejects it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imu {
    /// Angular velocity \[rad/s\].
    pub gyro_rad_s: [f32; 3],
    /// Specific force \[m/s^2\].
    pub accel_m_s2: [f32; 3],
    /// Time of the chip's clock, in units of 39.0625 us, 24 bits.
    pub time: u32,
    /// Whether the gyro's values are new.
    pub gyro_new: bool,
    /// Whether the accelerometer's values are new.
    pub accel_new: bool,
}

/// Decodes the sample in the bytes from [`FIRST`], with the value of [`STATUS`] read just before.
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
