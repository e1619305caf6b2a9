//! Text form of a fault: `CHANNEL[.AXIS]:KIND[=VALUE][@FROM[..TO]]`.

use super::Sensor;
use super::fault::{Channel, Fault, Kind};
use crate::range::{RangeError, TimeError, span, time, within};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// Largest magnitude of a fault's amount.
const LARGEST: f64 = 1e6;
/// Longest delay or time constant \[s\].
const LONGEST_S: f64 = 10.0;

impl Channel {
    /// All channels.
    pub fn all() -> impl Iterator<Item = Self> {
        Sensor::ALL.into_iter().map(Self::Sensor).chain([Self::Motor, Self::Engage, Self::Clock])
    }

    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sensor(sensor) => sensor.name(),
            Self::Motor => "motor",
            Self::Engage => "engage",
            Self::Clock => "clock",
        }
    }

    /// Names of the axes; none for a channel with one axis.
    const fn axes(self) -> &'static [&'static str] {
        match self {
            Self::Sensor(sensor) => sensor.axes(),
            _ => &[],
        }
    }

    /// Kinds of fault of the channel, in text form.
    const fn kinds(self) -> &'static [&'static str] {
        match self {
            Self::Sensor(_) => &[
                "stuck",
                "missing",
                "late=TIME",
                "noise=X",
                "bias=X",
                "drift=X/s",
                "scale=X",
                "flip",
                "jump=X",
                "spike=X",
                "nan",
                "value=X",
                "dropout=P",
                "slow=TIME",
            ],
            Self::Motor => &[
                "dead",
                "stuck",
                "late=TIME",
                "noise=X",
                "bias=X",
                "drift=X/s",
                "scale=X",
                "flip",
                "value=X",
                "slow=TIME",
            ],
            Self::Engage => &["stuck", "flip", "value=X", "missing"],
            Self::Clock => &["stuck", "scale=X", "jump=X"],
        }
    }
}

impl Kind {
    /// Name on the command line.
    const fn name(&self) -> &'static str {
        match self {
            Self::Stuck => "stuck",
            Self::Missing => "missing",
            Self::Late(_) => "late",
            Self::Noise(_) => "noise",
            Self::Bias(_) => "bias",
            Self::Drift(_) => "drift",
            Self::Scale(_) => "scale",
            Self::Flip => "flip",
            Self::Jump(_) => "jump",
            Self::Spike(_) => "spike",
            Self::Nan => "nan",
            Self::Value(_) => "value",
            Self::Dropout(_) => "dropout",
            Self::Dead => "dead",
            Self::Slow(_) => "slow",
        }
    }

    /// Whether the fault acts on whole samples, and so on all axes.
    const fn whole(&self) -> bool {
        matches!(self, Self::Missing | Self::Late(_) | Self::Dropout(_))
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.channel.name())?;
        let axis = self.axis.and_then(|axis| self.channel.axes().get(usize::from(axis)));
        if let Some(axis) = axis {
            write!(f, ".{axis}")?;
        }
        write!(f, ":{}", self.kind.name())?;
        match self.kind {
            Kind::Stuck | Kind::Missing | Kind::Flip | Kind::Nan | Kind::Dead => {}
            Kind::Late(x) | Kind::Slow(x) => write!(f, "={x}s")?,
            Kind::Drift(x) => write!(f, "={x}/s")?,
            Kind::Noise(x)
            | Kind::Bias(x)
            | Kind::Scale(x)
            | Kind::Jump(x)
            | Kind::Spike(x)
            | Kind::Value(x)
            | Kind::Dropout(x) => write!(f, "={x}")?,
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

impl Serialize for Fault {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Fault {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

/// A text that is no fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("fault `{text}`: {error}")]
pub struct FaultTextError {
    /// The text.
    pub text: String,
    /// The error.
    pub error: FaultFormError,
}

/// Why a text is no fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FaultFormError {
    /// No channel and kind.
    #[error(
        "expected CHANNEL[.AXIS]:KIND[=VALUE][@FROM[..TO]], for example gyro.x:bias=0.1@1.5s..3s; the channels are {}, and \
         a channel alone lists its kinds",
        channels()
    )]
    Form,
    /// A channel without a kind.
    #[error("{channel} needs a kind of fault; there are {known}")]
    NoKind {
        /// The channel.
        channel: &'static str,
        /// The channel's kinds.
        known: String,
    },
    /// An axis of a kind that acts on whole samples.
    #[error("{0} acts on whole samples; leave out the axis")]
    WholeSamples(&'static str),
    /// The end of a jump.
    #[error("a jump is permanent; leave out its end")]
    JumpEnds,
    /// A channel that does not exist.
    #[error("no channel `{name}`; there are {known}")]
    Channel {
        /// As given.
        name: String,
        /// The channels.
        known: String,
    },
    /// An axis of a channel with one axis.
    #[error("{channel} has one axis only; leave out `.{axis}`")]
    OneAxis {
        /// The channel.
        channel: &'static str,
        /// As given.
        axis: String,
    },
    /// An axis that the channel does not have.
    #[error("{channel} has no axis `{axis}`; it has {known}")]
    Axis {
        /// The channel.
        channel: &'static str,
        /// As given.
        axis: String,
        /// The channel's axes.
        known: String,
    },
    /// A kind that the channel does not have.
    #[error("no kind `{name}` of {channel}; there are {known}")]
    Kind {
        /// As given.
        name: String,
        /// The channel.
        channel: &'static str,
        /// The channel's kinds.
        known: String,
    },
    /// A kind without its value.
    #[error("{name} needs a value: {form}")]
    NoValue {
        /// The kind.
        name: String,
        /// The kind with its value.
        form: &'static str,
    },
    /// A value of a kind without one.
    #[error("{0} takes no value")]
    Value(String),
    /// A value that is no number.
    #[error("{name}: `{value}` is not a number")]
    Number {
        /// The kind.
        name: String,
        /// As given.
        value: String,
    },
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// A time or an interval.
    #[error(transparent)]
    Time(#[from] TimeError),
    /// A time constant of zero.
    #[error("slow: the time constant must be above 0 s")]
    NotSlow,
}

impl FromStr for Fault {
    type Err = FaultTextError;

    fn from_str(text: &str) -> Result<Self, FaultTextError> {
        parsed(text).map_err(|error| FaultTextError { text: text.into(), error })
    }
}

/// The names of all channels.
fn channels() -> String {
    Channel::all().map(Channel::name).collect::<Vec<_>>().join(", ")
}

fn parsed(text: &str) -> Result<Fault, FaultFormError> {
    let Some((place, what)) = text.split_once(':') else {
        let (channel, _) = placed(text).map_err(|_| FaultFormError::Form)?;
        return Err(FaultFormError::NoKind { channel: channel.name(), known: channel.kinds().join(", ") });
    };
    let (what, when) = what.split_once('@').map_or((what, None), |(what, when)| (what, Some(when)));
    let (channel, axis) = placed(place)?;
    let kind = kind(channel, what)?;
    if axis.is_some() && kind.whole() {
        return Err(FaultFormError::WholeSamples(kind.name()));
    }
    let (from_s, to_s) = when.map_or(Ok((0.0, f64::INFINITY)), span)?;
    if to_s.is_finite() && matches!(kind, Kind::Jump(_)) {
        return Err(FaultFormError::JumpEnds);
    }
    Ok(Fault { channel, axis, kind, from_s, to_s })
}

fn placed(text: &str) -> Result<(Channel, Option<u8>), FaultFormError> {
    let (name, axis) = text.split_once('.').map_or((text, None), |(name, axis)| (name, Some(axis)));
    let channel = Channel::all()
        .find(|channel| channel.name() == name)
        .ok_or_else(|| FaultFormError::Channel { name: name.into(), known: channels() })?;
    let Some(axis) = axis else { return Ok((channel, None)) };
    let axes = channel.axes();
    let index = axes.iter().position(|known| *known == axis).ok_or_else(|| match axes {
        [] => FaultFormError::OneAxis { channel: channel.name(), axis: axis.into() },
        _ => FaultFormError::Axis { channel: channel.name(), axis: axis.into(), known: axes.join(", ") },
    })?;
    Ok((channel, Some(index as u8)))
}

fn kind(channel: Channel, text: &str) -> Result<Kind, FaultFormError> {
    let (name, value) = text.split_once('=').map_or((text, None), |(name, value)| (name, Some(value)));
    let known =
        channel.kinds().iter().find(|kind| kind.split('=').next() == Some(name)).ok_or_else(|| {
            let known = channel.kinds().join(", ");
            FaultFormError::Kind { name: name.into(), channel: channel.name(), known }
        })?;
    let value = match (known.contains('='), value) {
        (true, None) => return Err(FaultFormError::NoValue { name: name.into(), form: known }),
        (false, Some(_)) => return Err(FaultFormError::Value(name.into())),
        (_, value) => value.unwrap_or_default(),
    };
    let number = |min: f64, max: f64| {
        let text = if name == "drift" { value.strip_suffix("/s").unwrap_or(value) } else { value };
        let x: f64 = text
            .trim()
            .parse()
            .map_err(|_| FaultFormError::Number { name: name.into(), value: value.into() })?;
        within(name, x, min, max)?;
        Ok::<f64, FaultFormError>(x)
    };
    let any = || number(-LARGEST, LARGEST);
    Ok(match name {
        "missing" => Kind::Missing,
        "late" => Kind::Late(time(value, LONGEST_S)?),
        "noise" => Kind::Noise(number(0.0, LARGEST)?),
        "bias" => Kind::Bias(any()?),
        "drift" => Kind::Drift(any()?),
        "scale" => Kind::Scale(any()?),
        "flip" => Kind::Flip,
        "jump" => Kind::Jump(any()?),
        "spike" => Kind::Spike(any()?),
        "nan" => Kind::Nan,
        "value" if channel == Channel::Engage => Kind::Value(number(0.0, 1.0)?),
        "value" => Kind::Value(any()?),
        "dropout" => Kind::Dropout(number(0.0, 1.0)?),
        "dead" => Kind::Dead,
        "slow" => Kind::Slow(positive(time(value, LONGEST_S)?)?),
        _ => Kind::Stuck,
    })
}

fn positive(time_s: f64) -> Result<f64, FaultFormError> {
    if time_s > 0.0 { Ok(time_s) } else { Err(FaultFormError::NotSlow) }
}
