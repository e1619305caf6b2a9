//! The same bytes on every link: little-endian, fixed length, any bit pattern allowed.

use crate::controller::{Command, Status};
use crate::frame::{Sample, SensorFrame};
use crate::input::Reject;

/// Bytes of a [`SensorFrame`]: roll rate and wheel speed, each f32 value and u16 age.
pub const FRAME_BYTES: usize = 12;
/// Bytes of a [`Command`]: torque and gain as f32, limits, status.
pub const COMMAND_BYTES: usize = 10;

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
    let status = match command.status {
        Status::Active => 0,
        Status::Filling => 1,
        Status::Rejected(reason) => 16 + reason as u8,
    };
    [t0, t1, t2, t3, g0, g1, g2, g3, command.limits.0, status]
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
