//! Faults of the loop's link, as text: `DIRECTION:FAULT[=TIME][@FROM[..TO]]`, for example `sensors:late=3ms@1.5s..2s`.

use crate::num::RandomStream;
use crate::range::{TimeError, span, time};
use std::collections::VecDeque;
use std::fmt;
use std::str::FromStr;

/// Largest delay of bytes \[s\].
const LATEST_S: f64 = 1.0;
/// A control period \[s\].
const PERIOD_S: f64 = 1e-3;

/// Direction of the bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the board.
    Sensors,
    /// From the board.
    Motor,
}

impl Direction {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Sensors, Self::Motor];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sensors => "sensors",
            Self::Motor => "motor",
        }
    }
}

/// What happens to the bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkFaultKind {
    /// They are lost.
    Drop,
    /// They arrive this many control periods later. Bytes overtaken by those of a newer period are lost.
    Late(u32),
    /// One byte of each period is changed.
    Corrupt,
}

/// A fault of the link. Its text form parses back to the same fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkFault {
    /// The direction.
    pub direction: Direction,
    /// What happens.
    pub kind: LinkFaultKind,
    /// Start of the fault in the ride \[s\].
    pub from_s: f64,
    /// End of the fault in the ride \[s\]; can be infinite.
    pub to_s: f64,
}

impl LinkFault {
    fn acts(&self, tick: u32) -> bool {
        let passed = |at_s: f64| f64::from(tick) >= (at_s / PERIOD_S).round();
        passed(self.from_s) && !passed(self.to_s)
    }
}

impl fmt::Display for LinkFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.direction.name())?;
        match self.kind {
            LinkFaultKind::Drop => write!(f, "drop")?,
            LinkFaultKind::Late(ticks) => write!(f, "late={ticks}ms")?,
            LinkFaultKind::Corrupt => write!(f, "corrupt")?,
        }
        if self.from_s != 0.0 || self.to_s.is_finite() {
            write!(f, "@{}s", self.from_s)?;
        }
        if self.to_s.is_finite() {
            write!(f, "..{}s", self.to_s)?;
        }
        Ok(())
    }
}

impl FromStr for LinkFault {
    type Err = LinkFaultTextError;

    fn from_str(text: &str) -> Result<Self, LinkFaultTextError> {
        parsed(text).map_err(|error| LinkFaultTextError { text: text.into(), error })
    }
}

/// A text that is no fault of the link.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{text}`: {error}")]
pub struct LinkFaultTextError {
    /// The text.
    pub text: String,
    /// The error.
    pub error: LinkFaultFormError,
}

/// Why a text is no fault of the link.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinkFaultFormError {
    /// No direction and fault.
    #[error("expected DIRECTION:FAULT[=TIME][@FROM[..TO]], for example sensors:late=3ms@1.5s..2s")]
    Form,
    /// A direction that does not exist.
    #[error("unknown direction `{0}`; expected {known}", known = Direction::ALL.map(Direction::name).join(" or "))]
    Direction(String),
    /// A fault that does not exist.
    #[error("unknown link fault `{0}`; expected drop, late=TIME or corrupt")]
    Fault(String),
    /// `late` without its time.
    #[error("late needs a value: late=TIME")]
    NoTime,
    /// A value of a fault without one.
    #[error("{0}: it takes no value")]
    Value(String),
    /// A time or an interval.
    #[error(transparent)]
    Time(#[from] TimeError),
    /// A delay that is no number of control periods.
    #[error("late={0} is not a whole number of control periods of 1 ms, 1 ms to {LATEST_S} s")]
    Periods(String),
}

fn parsed(text: &str) -> Result<LinkFault, LinkFaultFormError> {
    let (direction, what) = text.split_once(':').ok_or(LinkFaultFormError::Form)?;
    let known = Direction::ALL.into_iter().find(|known| known.name() == direction);
    let direction = known.ok_or_else(|| LinkFaultFormError::Direction(direction.into()))?;
    let (what, when) = what.split_once('@').map_or((what, None), |(what, when)| (what, Some(when)));
    let kind = match what.split_once('=').map_or((what, None), |(name, value)| (name, Some(value))) {
        ("drop", None) => LinkFaultKind::Drop,
        ("corrupt", None) => LinkFaultKind::Corrupt,
        ("late", Some(by)) => LinkFaultKind::Late(periods(by)?),
        ("late", None) => return Err(LinkFaultFormError::NoTime),
        ("drop" | "corrupt", Some(_)) => return Err(LinkFaultFormError::Value(what.into())),
        _ => return Err(LinkFaultFormError::Fault(what.into())),
    };
    let (from_s, to_s) = when.map_or(Ok((0.0, f64::INFINITY)), span)?;
    Ok(LinkFault { direction, kind, from_s, to_s })
}

fn periods(text: &str) -> Result<u32, LinkFaultFormError> {
    let periods = time(text, LATEST_S)? / PERIOD_S;
    if periods >= 0.5 && (periods - periods.round()).abs() < 1e-6 {
        return Ok(periods.round() as u32);
    }
    Err(LinkFaultFormError::Periods(text.into()))
}

/// One direction of the link in one ride.
#[derive(Debug)]
pub(super) struct LinkChannel {
    faults: Vec<LinkFault>,
    random: RandomStream,
    /// Delayed bytes, with the period in which they arrive.
    late: VecDeque<(u32, Vec<u8>)>,
    /// Periods in which a fault acted.
    pub(super) affected: u32,
}

impl LinkChannel {
    /// A channel with the faults of its direction.
    pub(super) fn new(faults: &[LinkFault], direction: Direction, random: RandomStream) -> Self {
        let faults = faults.iter().filter(|fault| fault.direction == direction).copied().collect();
        Self { faults, random, late: VecDeque::new(), affected: 0 }
    }

    /// Whether it has no fault.
    pub(super) fn safe(&self) -> bool {
        self.faults.is_empty()
    }

    /// Replaces `bytes` of the period `tick` (from t = 0) by what arrives in that period, including earlier, delayed
    /// bytes.
    pub(super) fn pass(&mut self, tick: u32, bytes: &mut Vec<u8>) {
        let (mut lost, mut late) = (false, 0);
        let acting = self.faults.iter().filter(|fault| fault.acts(tick));
        for fault in acting.clone() {
            match fault.kind {
                LinkFaultKind::Drop => lost = true,
                LinkFaultKind::Late(ticks) => late += ticks,
                LinkFaultKind::Corrupt if bytes.is_empty() => {}
                LinkFaultKind::Corrupt => {
                    let place = self.random.below(bytes.len());
                    bytes[place] ^= 1 << self.random.below(8);
                }
            }
        }
        self.affected += u32::from(acting.count() > 0);
        if !lost && late == 0 {
            self.late.clear();
            return;
        }
        if !lost {
            self.late.push_back((tick + late, bytes.clone()));
        }
        bytes.clear();
        while self.late.front().is_some_and(|(due, _)| *due <= tick) {
            self.late.pop_front().into_iter().for_each(|(_, arrived)| *bytes = arrived);
        }
    }
}
