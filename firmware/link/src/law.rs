//! Encoding of the control law: number, slope and points of the gain schedule, as in `control::wire`, but only with the
//! points in use.

use crate::bytes::{Reader, Writer};
use control::law::LAW;
use control::law::gain_schedule::TABLE_POINTS;
use control::param::ParamError;
use control::{GainSchedule, Law};
use heapless::Vec;

/// Largest encoded law \[bytes\]: number, slope, count, and speed and gain of each point.
pub const LAW_BYTES: usize = 1 + 4 + 1 + 8 * TABLE_POINTS;

/// Error of decoding a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoLaw {
    /// Too few bytes, or too many points.
    Malformed,
    /// An unknown law, or a value outside its range.
    Rejected(ParamError),
}

/// Writes a law.
pub fn encode(law: &Law, to: &mut Writer<'_>) {
    let points = match law {
        Law::Table(table) => table.points(),
        _ => &[],
    };
    to.u8(law.number());
    to.f32(law.slope());
    to.u8(points.len() as u8);
    for (speed_m_s, gain_nm_s_rad) in points {
        to.f32(*speed_m_s);
        to.f32(*gain_nm_s_rad);
    }
}

/// Reads a law and checks it.
///
/// # Errors
/// As of [`NoLaw`].
pub fn decode(from: &mut Reader<'_>) -> Result<Law, NoLaw> {
    let (number, slope, points) = read(from).ok_or(NoLaw::Malformed)?;
    let table = match points.is_empty() {
        true => GainSchedule::default(),
        false => GainSchedule::new(&points).map_err(NoLaw::Rejected)?,
    };
    let law = Law::numbered(number, slope, table).ok_or(NoLaw::Rejected(LAW.error(f32::from(number))))?;
    law.validate().map_err(NoLaw::Rejected)?;
    Ok(law)
}

type Parts = (u8, f32, Vec<(f32, f32), TABLE_POINTS>);

fn read(from: &mut Reader<'_>) -> Option<Parts> {
    let (number, slope, count) = (from.u8()?, from.f32()?, from.u8()?);
    let mut points = Vec::new();
    for _ in 0..count {
        points.push((from.f32()?, from.f32()?)).ok()?;
    }
    Some((number, slope, points))
}
