//! Binary encoding of frames, commands and configurations, the same on every link: little-endian, fixed length, any bit
//! pattern accepted.

use crate::command::Command;
use crate::config::Config;
use crate::fault::Causes;
use crate::law::gain_schedule::{GainSchedule, TABLE_POINTS};
use crate::law::{LAW_NAMES, Law};
use crate::param::{ParamError, ParamSpec, ParamVisitor};
use crate::sensors::frame::{Sample, SensorFrame, Triple};
use heapless::Vec;

/// Bytes of a [`SensorFrame`]: its fields in their order, a sample as f32 values and a u16 age.
pub const FRAME_BYTES: usize = 81;
/// Bytes of a [`Command`]: torque and gain as f32, limits, mode, causes.
pub const COMMAND_BYTES: usize = 11 + CAUSE_BYTES;
/// Bytes of a set of causes, bit *n* for code *n*: more than today's codes need, so that sensors can be added without
/// another encoding.
pub const CAUSE_BYTES: usize = 16;
/// Bytes of a [`Config`]: the law with room for a full table, then every parameter in order.
pub const CONFIG_BYTES: usize = 1006;

/// Encodes a sensor frame.
pub fn encode_frame(frame: &SensorFrame) -> [u8; FRAME_BYTES] {
    let mut bytes = [0; FRAME_BYTES];
    let mut to = Writer(bytes.iter_mut());
    to.u32(frame.now_us);
    for triple in [&frame.gyro_rad_s, &frame.accel_m_s2] {
        triple.value.into_iter().for_each(|value| to.f32(value));
        to.u16(triple.age_ticks);
    }
    for sample in [
        &frame.steer_rad,
        &frame.steer_rate_rad_s,
        &frame.front_wheel_m_s,
        &frame.rear_wheel_m_s,
        &frame.rider_torque_nm,
        &frame.motor_torque_nm,
        &frame.heading_error_rad,
        &frame.lateral_error_m,
    ] {
        to.f32(sample.value);
        to.u16(sample.age_ticks);
    }
    to.u8(u8::from(frame.engage));
    bytes
}

/// Decodes a sensor frame. Every bit pattern is a frame; the switch is on only for 1.
pub fn decode_frame(bytes: &[u8; FRAME_BYTES]) -> SensorFrame {
    let mut from = Reader(bytes.iter());
    SensorFrame {
        now_us: from.u32(),
        gyro_rad_s: from.triple(),
        accel_m_s2: from.triple(),
        steer_rad: from.sample(),
        steer_rate_rad_s: from.sample(),
        front_wheel_m_s: from.sample(),
        rear_wheel_m_s: from.sample(),
        rider_torque_nm: from.sample(),
        motor_torque_nm: from.sample(),
        heading_error_rad: from.sample(),
        lateral_error_m: from.sample(),
        engage: from.u8() == 1,
    }
}

/// Encodes a command.
pub fn encode_command(command: &Command) -> [u8; COMMAND_BYTES] {
    let mut bytes = [0; COMMAND_BYTES];
    let mut to = Writer(bytes.iter_mut());
    to.f32(command.torque_nm);
    to.f32(command.gain_nm_s_rad);
    to.u16(command.limits.0);
    to.u8(command.mode as u8);
    to.bytes(encode_causes(command.causes));
    bytes
}

/// Encodes a set of causes.
pub fn encode_causes(causes: Causes) -> [u8; CAUSE_BYTES] {
    u128::from(causes.0).to_le_bytes()
}

/// Decodes a set of causes. Codes from 64 on, which this version does not have, are left out.
pub fn decode_causes(bytes: &[u8; CAUSE_BYTES]) -> Causes {
    Causes(u128::from_le_bytes(*bytes) as u64)
}

/// Encodes a configuration. Bytes that the law or an unset limit does not use are zero.
pub fn encode_config(config: &Config) -> [u8; CONFIG_BYTES] {
    let mut bytes = [0; CONFIG_BYTES];
    let mut to = Writer(bytes.iter_mut());
    let points = match &config.law {
        Law::Table(table) => table.points(),
        _ => &[],
    };
    to.u8(config.law.number());
    to.f32(config.law.slope());
    to.u8(points.len() as u8);
    for i in 0..TABLE_POINTS {
        let (speed, gain) = points.get(i).copied().unwrap_or((0.0, 0.0));
        to.f32(speed);
        to.f32(gain);
    }
    config.clone().visit_params(&mut to);
    bytes
}

/// Decodes a configuration without validating it; [`Config::plan`] does that. Never panics.
///
/// # Errors
/// An unknown law, a switch other than 0 or 1, or a table that [`GainSchedule::new`] rejects.
pub fn decode_config(bytes: &[u8; CONFIG_BYTES]) -> Result<Config, ParamError> {
    let mut from = Reader(bytes.iter());
    let (law, k, used) = (from.u8(), from.f32(), from.u8());
    let mut points: Vec<(f32, f32), TABLE_POINTS> = Vec::new();
    for _ in 0..TABLE_POINTS {
        // The vector has room for all points; those beyond `used` are dropped below.
        let _ = points.push((from.f32(), from.f32()));
    }
    ParamSpec::new("wire", "table.points", 0.0, TABLE_POINTS as f32).check(f32::from(used))?;
    points.truncate(usize::from(used));
    let table = if used > 0 { GainSchedule::new(&points)? } else { GainSchedule::default() };
    let last = (LAW_NAMES.len() - 1) as f32;
    let unknown = ParamSpec::new("wire", "law", 0.0, last).error(f32::from(law));
    let law = Law::numbered(law, k, table).ok_or(unknown)?;
    let mut config = Config::thesis(law);
    let mut decoder = Decoder { from, error: None };
    config.visit_params(&mut decoder);
    decoder.error.map_or(Ok(config), Err)
}

/// Number of [`CONFIG_BYTES`] that are used; a test checks that all are.
pub fn config_bytes_used() -> usize {
    let mut counter = Counter(1 + 4 + 1 + 8 * TABLE_POINTS);
    Config::thesis(Law::None).visit_params(&mut counter);
    counter.0
}

/// Writes bytes in order; bytes beyond the end would be dropped, which the fixed lengths exclude.
struct Writer<'a>(core::slice::IterMut<'a, u8>);

impl Writer<'_> {
    fn u8(&mut self, value: u8) {
        if let Some(byte) = self.0.next() {
            *byte = value;
        }
    }
    fn bytes<const N: usize>(&mut self, bytes: [u8; N]) {
        bytes.into_iter().for_each(|b| self.u8(b));
    }
    fn u16(&mut self, value: u16) {
        self.bytes(value.to_le_bytes());
    }
    fn u32(&mut self, value: u32) {
        self.bytes(value.to_le_bytes());
    }
    fn f32(&mut self, value: f32) {
        self.bytes(value.to_le_bytes());
    }
}

impl ParamVisitor for Writer<'_> {
    fn number(&mut self, _: &ParamSpec, value: &mut f32) {
        self.f32(*value);
    }
    fn optional_number(&mut self, _: &ParamSpec, value: &mut Option<f32>) {
        self.u8(u8::from(value.is_some()));
        self.f32(value.unwrap_or(0.0));
    }
    fn count(&mut self, _: &ParamSpec, value: &mut u16) {
        self.u16(*value);
    }
    fn switch(&mut self, _: &ParamSpec, value: &mut bool) {
        self.u8(u8::from(*value));
    }
    fn choice(&mut self, _: &ParamSpec, _: &'static [&'static str], value: &mut u8) {
        self.u8(*value);
    }
}

/// Reads bytes in order; beyond the end it would read zeros, which the fixed lengths exclude.
struct Reader<'a>(core::slice::Iter<'a, u8>);

impl Reader<'_> {
    fn u8(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }
    fn u16(&mut self) -> u16 {
        u16::from_le_bytes([self.u8(), self.u8()])
    }
    fn u32(&mut self) -> u32 {
        u32::from_le_bytes([self.u8(), self.u8(), self.u8(), self.u8()])
    }
    fn f32(&mut self) -> f32 {
        f32::from_bits(self.u32())
    }
    fn sample(&mut self) -> Sample {
        Sample { value: self.f32(), age_ticks: self.u16() }
    }
    fn triple(&mut self) -> Triple {
        Triple { value: [self.f32(), self.f32(), self.f32()], age_ticks: self.u16() }
    }
}

/// Sets every parameter from bytes.
struct Decoder<'a> {
    from: Reader<'a>,
    error: Option<ParamError>,
}

impl Decoder<'_> {
    fn flag(&mut self, leaf: &ParamSpec) -> bool {
        let byte = self.from.u8();
        if byte > 1 && self.error.is_none() {
            self.error = Some(ParamSpec::switch(leaf.group, leaf.name).error(f32::from(byte)));
        }
        byte == 1
    }
}

impl ParamVisitor for Decoder<'_> {
    fn number(&mut self, _: &ParamSpec, value: &mut f32) {
        *value = self.from.f32();
    }
    fn optional_number(&mut self, leaf: &ParamSpec, value: &mut Option<f32>) {
        let (set, number) = (self.flag(leaf), self.from.f32());
        *value = set.then_some(number);
    }
    fn count(&mut self, _: &ParamSpec, value: &mut u16) {
        *value = self.from.u16();
    }
    fn switch(&mut self, leaf: &ParamSpec, value: &mut bool) {
        *value = self.flag(leaf);
    }
    fn choice(&mut self, leaf: &ParamSpec, names: &'static [&'static str], value: &mut u8) {
        *value = self.from.u8();
        if usize::from(*value) >= names.len() && self.error.is_none() {
            self.error = Some(leaf.error(f32::from(*value)));
        }
    }
}

/// Counts the bytes that [`Writer`] would write.
struct Counter(usize);

impl ParamVisitor for Counter {
    fn number(&mut self, _: &ParamSpec, _: &mut f32) {
        self.0 += 4;
    }
    fn optional_number(&mut self, _: &ParamSpec, _: &mut Option<f32>) {
        self.0 += 5;
    }
    fn count(&mut self, _: &ParamSpec, _: &mut u16) {
        self.0 += 2;
    }
    fn switch(&mut self, _: &ParamSpec, _: &mut bool) {
        self.0 += 1;
    }
    fn choice(&mut self, _: &ParamSpec, _: &'static [&'static str], _: &mut u8) {
        self.0 += 1;
    }
}
