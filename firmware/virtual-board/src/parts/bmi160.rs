//! Model of the IMU BMI160 (BST-BMI160-DS000): register map, 1600 filtered samples per second, sensor time.
//!
//! The data sheet gives the filters' bandwidths, not their order: second order is assumed.

use super::low_pass::LowPass;
use super::shift::{Event, Lines, Take};
use devices::bmi160::{CHIP_ID, M_S2_PER_COUNT, RAD_S_PER_COUNT};

/// One count of the sensor time \[ns\].
const TIME_COUNT_NS: u64 = 39_062;
/// Counts between two samples at 1600 Hz.
const SAMPLE_COUNTS: u64 = 16;
/// Time between two samples \[ns\].
const SAMPLE_NS: u64 = SAMPLE_COUNTS * TIME_COUNT_NS;
/// Sampling rate \[Hz\].
const RATE_HZ: f64 = 1600.0;
/// Bandwidths by the two oversampling bits of the set-up: fourfold, twofold, none \[Hz\].
const GYRO_HZ: [f64; 3] = [136.6, 254.6, 523.9];
const ACCEL_HZ: [f64; 3] = [162.0, 324.0, 684.0];

const CHIP: u8 = 0x00;
const DATA: u8 = 0x0c;
const TIME: u8 = 0x18;
const STATUS: u8 = 0x1b;
const ACCEL_SET_UP: u8 = 0x40;
const GYRO_SET_UP: u8 = 0x42;
const COMMAND: u8 = 0x7e;
const SOFT_RESET: u8 = 0xb6;
const ACCEL_NORMAL: u8 = 0x11;
const GYRO_NORMAL: u8 = 0x15;

/// The IMU.
#[derive(Clone, Debug)]
pub struct Bmi160 {
    lines: Lines,
    registers: [u8; 128],
    bits: u32,
    received: u8,
    register: u8,
    reads: bool,
    shifting: u8,
    now_ns: u64,
    /// Number of the newest sample read.
    last_read: u64,
    /// Sample in the data registers, and its number.
    sample: (u64, [u8; 12]),
    /// Number of the newest sample taken, and the filters of gyro and accelerometer.
    taken: u64,
    filters: [LowPass; 2],
    filtered: [[f64; 3]; 2],
    gyro_on: bool,
    accel_on: bool,
    motion: Motion,
    /// Whether it does not answer.
    pub silent: bool,
}

/// Standard deviation of a sample before the filters: the data sheet's density (0.007 degrees/s and 180 ug per root
/// of a Hz) over half the sampling rate \[rad/s, m/s^2\]. Without noise, samples of three axes would repeat exactly,
/// unlike those of a real chip.
const GYRO_NOISE_RAD_S: f64 = 0.0035;
const ACCEL_NOISE_M_S2: f64 = 0.05;

/// Pseudo-random value of mean 0 and standard deviation 1, approximately normal (sum of four uniform values), as a
/// function of its number.
fn normal(number: u64) -> f64 {
    // Mixing function of SplitMix64 (Steele, Lea and Flood).
    let mut bits = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    let parts = [0, 16, 32, 48].map(|shift| f64::from((bits >> shift) as u16) / 65_535.0);
    (parts.iter().sum::<f64>() - 2.0) * 3.0_f64.sqrt()
}

/// Motion of the chip from a time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Time after power-on \[ns\].
    pub at_ns: u64,
    /// Angular velocity \[rad/s\] and specific force \[m/s^2\] at that time, in the chip's axes.
    pub values: [[f64; 3]; 2],
    /// Time derivatives of both \[1/s\].
    pub slopes: [[f64; 3]; 2],
}

impl Motion {
    /// Level and at rest.
    pub const REST: Self = Self { at_ns: 0, values: [[0.0; 3], [0.0, 0.0, 9.806_65]], slopes: [[0.0; 3]; 2] };

    fn at(&self, at_ns: u64) -> [[f64; 3]; 2] {
        let seconds = (at_ns as f64 - self.at_ns as f64) * 1e-9;
        [0, 1].map(|of: usize| {
            [0, 1, 2].map(|axis: usize| self.values[of][axis] + seconds * self.slopes[of][axis])
        })
    }
}

impl Bmi160 {
    /// State after power-on, level and at rest.
    pub fn new() -> Self {
        Self {
            lines: Lines::new(),
            registers: [0; 128],
            bits: 0,
            received: 0,
            register: 0,
            reads: false,
            shifting: 0xff,
            now_ns: 0,
            last_read: 0,
            sample: (0, [0; 12]),
            gyro_on: false,
            accel_on: false,
            taken: 0,
            filters: [GYRO_HZ, ACCEL_HZ].map(|bandwidths| LowPass::new(bandwidths[2], RATE_HZ)),
            filtered: Motion::REST.values,
            motion: Motion::REST,
            silent: false,
        }
    }

    /// Data output; `None` while not selected or silent.
    pub fn output(&self) -> Option<bool> {
        (self.lines.is_selected() && !self.silent).then_some(self.shifting & 0x80 != 0)
    }

    /// Sets the motion from a time on.
    pub fn moves(&mut self, motion: Motion) {
        self.take_samples(motion.at_ns);
        self.motion = motion;
    }

    /// Takes the samples up to a time \[ns\]; returns the newest one's number.
    fn take_samples(&mut self, now_ns: u64) -> u64 {
        let newest = now_ns / SAMPLE_NS;
        for number in self.taken + 1..=newest {
            let [gyro, accel] = self.motion.at(number * SAMPLE_NS);
            let noisy = |of: [f64; 3], deviation: f64, first: u64| {
                [0, 1, 2].map(|axis: usize| of[axis] + deviation * normal(6 * number + first + axis as u64))
            };
            let (gyro, accel) = (noisy(gyro, GYRO_NOISE_RAD_S, 0), noisy(accel, ACCEL_NOISE_M_S2, 3));
            self.filtered = [self.filters[0].step(gyro), self.filters[1].step(accel)];
        }
        self.taken = self.taken.max(newest);
        self.taken
    }

    /// A register as written.
    pub const fn written(&self, register: u8) -> u8 {
        self.registers[(register & 0x7f) as usize]
    }

    /// Updates the bus lines.
    pub fn lines(&mut self, select: bool, clock: bool, data: bool, now_ns: u64) {
        self.now_ns = now_ns;
        match self.lines.step(Take::Rising, select, clock, data) {
            Event::None | Event::Released => (),
            Event::Selected => (self.bits, self.received, self.shifting) = (0, 0, 0xff),
            Event::Bit(bit) => {
                self.received = self.received << 1 | u8::from(bit);
                self.bits += 1;
                if self.bits.is_multiple_of(8) {
                    self.byte();
                }
            }
            Event::Next if self.bits.is_multiple_of(8) => self.shifting = self.answer(),
            Event::Next => self.shifting <<= 1,
        }
    }

    /// The byte after the one just received.
    fn answer(&mut self) -> u8 {
        if !self.reads || self.bits == 0 {
            return 0xff;
        }
        let register = self.register;
        self.register = (self.register + 1) & 0x7f;
        self.value(register)
    }

    fn byte(&mut self) {
        if self.bits == 8 {
            (self.register, self.reads) = (self.received & 0x7f, self.received & 0x80 != 0);
        } else if !self.reads {
            let register = self.register;
            self.register = (self.register + 1) & 0x7f;
            self.write(register, self.received);
        }
    }

    fn write(&mut self, register: u8, value: u8) {
        match (register, value) {
            (COMMAND, SOFT_RESET) => {
                self.registers = [0; 128];
                (self.gyro_on, self.accel_on) = (false, false);
            }
            (COMMAND, ACCEL_NORMAL) => self.accel_on = true,
            (COMMAND, GYRO_NORMAL) => self.gyro_on = true,
            _ => {
                self.registers[usize::from(register & 0x7f)] = value;
                let oversampling = usize::from(value >> 4 & 0b111).min(2);
                match register {
                    GYRO_SET_UP => self.filters[0] = LowPass::new(GYRO_HZ[oversampling], RATE_HZ),
                    ACCEL_SET_UP => self.filters[1] = LowPass::new(ACCEL_HZ[oversampling], RATE_HZ),
                    _ => (),
                }
            }
        }
    }

    fn value(&mut self, register: u8) -> u8 {
        let counts = self.now_ns / TIME_COUNT_NS;
        let newest = self.take_samples(self.now_ns);
        match register {
            CHIP => CHIP_ID,
            STATUS => {
                let fresh = newest != self.last_read;
                u8::from(fresh && self.accel_on) << 7 | u8::from(fresh && self.gyro_on) << 6
            }
            DATA..TIME => {
                // A burst reads one sample even if the next comes meanwhile.
                if register == DATA || self.sample.0 == 0 {
                    self.sample = (newest, self.measure());
                    self.last_read = newest;
                }
                self.sample.1[usize::from(register - DATA)]
            }
            TIME..STATUS => (counts >> (8 * (register - TIME))) as u8,
            _ => self.registers[usize::from(register)],
        }
    }

    fn measure(&self) -> [u8; 12] {
        let [gyro, accel] = self.filtered;
        let counts = |values: [f64; 3], unit: f32, on: bool| {
            values.map(|value| {
                let counts = (value / f64::from(unit)).round().clamp(-32_768.0, 32_767.0);
                if on { counts as i16 } else { 0 }
            })
        };
        let [gx, gy, gz] = counts(gyro, RAD_S_PER_COUNT, self.gyro_on);
        let [ax, ay, az] = counts(accel, M_S2_PER_COUNT, self.accel_on);
        let mut bytes = [0; 12];
        for (pair, value) in bytes.chunks_exact_mut(2).zip([gx, gy, gz, ax, ay, az]) {
            pair.copy_from_slice(&value.to_le_bytes());
        }
        bytes
    }
}

impl Default for Bmi160 {
    fn default() -> Self {
        Self::new()
    }
}
