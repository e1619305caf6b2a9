//! The same bytes on every link: little-endian, fixed length, any bit pattern allowed.

use crate::controller::{Command, Config, Status};
use crate::frame::{Sample, SensorFrame, Wheel};
use crate::history::Latency;
use crate::input::{InputConfig, Reject};
use crate::law::{Law, LawTable, TABLE_POINTS};
use crate::limits::{Limits, Taper};
use crate::param::{Leaf, ParamError, check};
use heapless::Vec;

/// Bytes of a [`SensorFrame`]: roll rate and wheel speed, each f32 value and u16 age.
pub const FRAME_BYTES: usize = 12;
/// Bytes of a [`Command`]: torque and gain as f32, limits as u16, status.
pub const COMMAND_BYTES: usize = 11;
/// Bytes of a [`Config`]: every field in the order of the types, room for a whole gain table.
pub const CONFIG_BYTES: usize = 46 + 8 * TABLE_POINTS;

/// A sensor frame as bytes.
pub fn encode_frame(frame: &SensorFrame) -> [u8; FRAME_BYTES] {
    let (a, b) = (sample(&frame.roll_rate_rad_s), sample(&frame.wheel_speed_m_s));
    let [a0, a1, a2, a3, a4, a5] = a;
    let [b0, b1, b2, b3, b4, b5] = b;
    [a0, a1, a2, a3, a4, a5, b0, b1, b2, b3, b4, b5]
}

/// A sensor frame from bytes. Every bit pattern is a frame.
pub fn decode_frame(bytes: &[u8; FRAME_BYTES]) -> SensorFrame {
    let [a0, a1, a2, a3, a4, a5, b0, b1, b2, b3, b4, b5] = *bytes;
    SensorFrame {
        roll_rate_rad_s: unsample([a0, a1, a2, a3, a4, a5]),
        wheel_speed_m_s: unsample([b0, b1, b2, b3, b4, b5]),
    }
}

/// A command as bytes: status 0 is active, 1 filling, 16 + [`Reject`] rejected.
pub fn encode_command(command: &Command) -> [u8; COMMAND_BYTES] {
    let [t0, t1, t2, t3] = command.torque_nm.to_le_bytes();
    let [g0, g1, g2, g3] = command.gain_nm_s_rad.to_le_bytes();
    let [l0, l1] = command.limits.0.to_le_bytes();
    let status = match command.status {
        Status::Active => 0,
        Status::Filling => 1,
        Status::Rejected(reason) => 16 + reason as u8,
    };
    [t0, t1, t2, t3, g0, g1, g2, g3, l0, l1, status]
}

/// A command's status byte read back; `None` for a byte that no status has.
pub fn decode_status(byte: u8) -> Option<Status> {
    match byte {
        0 => Some(Status::Active),
        1 => Some(Status::Filling),
        17 => Some(Status::Rejected(Reject::RollRateStale)),
        18 => Some(Status::Rejected(Reject::RollRateRange)),
        19 => Some(Status::Rejected(Reject::SpeedStale)),
        20 => Some(Status::Rejected(Reject::SpeedRange)),
        _ => None,
    }
}

fn sample(s: &Sample) -> [u8; 6] {
    let [v0, v1, v2, v3] = s.value.to_le_bytes();
    let [a0, a1] = s.age_ticks.to_le_bytes();
    [v0, v1, v2, v3, a0, a1]
}

fn unsample(b: [u8; 6]) -> Sample {
    let [v0, v1, v2, v3, a0, a1] = b;
    Sample { value: f32::from_le_bytes([v0, v1, v2, v3]), age_ticks: u16::from_le_bytes([a0, a1]) }
}

/// A configuration as bytes. What a law or an unset limit does not use is zero.
pub fn encode_config(config: &Config) -> [u8; CONFIG_BYTES] {
    let mut bytes = [0; CONFIG_BYTES];
    let mut to = Writer(bytes.iter_mut());
    to.f32(config.rate_hz);
    let (law, k, table) = match &config.law {
        Law::None => (0, 0.0, None),
        Law::H { cut: false } => (1, 0.0, None),
        Law::H { cut: true } => (2, 0.0, None),
        Law::F => (3, 0.0, None),
        Law::G => (4, 0.0, None),
        Law::Cl1 => (5, 0.0, None),
        Law::Cl2 { k } => (6, *k, None),
        Law::Table(table) => (7, 0.0, Some(table)),
    };
    let points = table.map_or(&[][..], LawTable::points);
    to.u8(law);
    to.f32(k);
    to.u8(points.len() as u8);
    for i in 0..TABLE_POINTS {
        let (speed, gain) = points.get(i).copied().unwrap_or((0.0, 0.0));
        to.f32(speed);
        to.f32(gain);
    }
    to.u8(match config.input.wheel {
        Wheel::Front => 0,
        Wheel::Rear => 1,
    });
    to.f32(config.input.roll_rate_max_rad_s);
    to.f32(config.input.speed_max_m_s);
    to.u16(config.input.roll_rate_max_age_ticks);
    to.u16(config.input.speed_max_age_ticks);
    to.u16(config.latency.roll_rate_ticks);
    to.u16(config.latency.speed_ticks);
    to.limit(config.shape.max_torque_nm);
    to.limit(config.shape.rise_nm_s);
    to.limit(config.shape.taper.map(|t| t.zero_m_s));
    to.f32(config.shape.taper.map_or(0.0, |t| t.full_m_s));
    bytes
}

/// A configuration from bytes, not yet checked: [`Config::plan`] does that. Never panics.
///
/// # Errors
/// A law, wheel or limit mark that does not exist, or a table that [`LawTable::new`] refuses.
pub fn decode_config(bytes: &[u8; CONFIG_BYTES]) -> Result<Config, ParamError> {
    let mut from = Reader(bytes.iter());
    let rate_hz = from.f32();
    let (law, k, used) = (from.u8(), from.f32(), from.u8());
    let mut points: Vec<(f32, f32), TABLE_POINTS> = Vec::new();
    for _ in 0..TABLE_POINTS {
        // There is room for all of them; those beyond `used` are dropped below.
        let _ = points.push((from.f32(), from.f32()));
    }
    check("wire.table.points", f32::from(used), 0.0, TABLE_POINTS as f32)?;
    points.truncate(usize::from(used));
    let law = match law {
        0 => Law::None,
        1 => Law::H { cut: false },
        2 => Law::H { cut: true },
        3 => Law::F,
        4 => Law::G,
        5 => Law::Cl1,
        6 => Law::Cl2 { k },
        7 => Law::Table(LawTable::new(&points)?),
        other => return Err(Leaf::new("wire", "law", 0.0, 7.0).error(f32::from(other))),
    };
    let input = InputConfig {
        wheel: if from.mark("wire.wheel")? { Wheel::Rear } else { Wheel::Front },
        roll_rate_max_rad_s: from.f32(),
        speed_max_m_s: from.f32(),
        roll_rate_max_age_ticks: from.u16(),
        speed_max_age_ticks: from.u16(),
    };
    let latency = Latency { roll_rate_ticks: from.u16(), speed_ticks: from.u16() };
    let max_torque_nm = from.limit("wire.max_torque")?;
    let max_rate_nm_s = from.limit("wire.max_rate")?;
    let (zero, full_m_s) = (from.limit("wire.taper")?, from.f32());
    let taper = zero.map(|zero_m_s| Taper { zero_m_s, full_m_s });
    let (rise_nm_s, fall_nm_s) = (max_rate_nm_s, max_rate_nm_s);
    let shape = Limits { max_torque_nm, rise_nm_s, fall_nm_s, taper, ..Limits::default() };
    Ok(Config { rate_hz, law, input, latency, shape })
}

/// Fills bytes in order; what does not fit is dropped, which [`CONFIG_BYTES`] rules out.
struct Writer<'a>(core::slice::IterMut<'a, u8>);

impl Writer<'_> {
    fn u8(&mut self, value: u8) {
        if let Some(byte) = self.0.next() {
            *byte = value;
        }
    }
    fn u16(&mut self, value: u16) {
        value.to_le_bytes().into_iter().for_each(|b| self.u8(b));
    }
    fn f32(&mut self, value: f32) {
        value.to_le_bytes().into_iter().for_each(|b| self.u8(b));
    }
    fn limit(&mut self, value: Option<f32>) {
        self.u8(u8::from(value.is_some()));
        self.f32(value.unwrap_or(0.0));
    }
}

/// Takes bytes in order; past the end there are zeros, which [`CONFIG_BYTES`] rules out.
struct Reader<'a>(core::slice::Iter<'a, u8>);

impl Reader<'_> {
    fn u8(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }
    fn u16(&mut self) -> u16 {
        u16::from_le_bytes([self.u8(), self.u8()])
    }
    fn f32(&mut self) -> f32 {
        f32::from_le_bytes([self.u8(), self.u8(), self.u8(), self.u8()])
    }
    fn mark(&mut self, name: &'static str) -> Result<bool, ParamError> {
        match self.u8() {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(Leaf::switch("", name).error(f32::from(other))),
        }
    }
    fn limit(&mut self, name: &'static str) -> Result<Option<f32>, ParamError> {
        let (set, value) = (self.mark(name)?, self.f32());
        Ok(set.then_some(value))
    }
}
