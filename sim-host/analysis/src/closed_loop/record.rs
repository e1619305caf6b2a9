//! The samples of a recording in which a controller closed the loop.

use super::checked::GAP;

/// A measured or estimated signal that a steering law may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Signal {
    /// Roll rate \[rad/s\].
    RollRate,
    /// Steer angle \[rad\].
    Steer,
    /// The recording's own roll angle \[rad\].
    Roll,
    /// Steer rate \[rad/s\].
    SteerRate,
    /// Torque of the rider \[N m\].
    RiderTorque,
    /// Yaw rate \[rad/s\].
    YawRate,
}

impl Signal {
    /// All signals, the ones a steering law more often uses first: where two are collinear, the earlier is kept.
    pub const ALL: [Self; 6] =
        [Self::RollRate, Self::Steer, Self::Roll, Self::SteerRate, Self::RiderTorque, Self::YawRate];

    /// The name, as in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::RollRate => "roll-rate",
            Self::Steer => "steer",
            Self::Roll => "roll",
            Self::SteerRate => "steer-rate",
            Self::RiderTorque => "rider-torque",
            Self::YawRate => "yaw-rate",
        }
    }

    /// Unit of a gain from this signal to the torque.
    pub const fn gain_unit(self) -> &'static str {
        match self {
            Self::RollRate | Self::SteerRate | Self::YawRate => "N m s/rad",
            Self::Steer | Self::Roll => "N m/rad",
            Self::RiderTorque => "1",
        }
    }
}

/// The values of one signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The signal.
    pub signal: Signal,
    /// Its values in SI units, one for each time; NaN without a value.
    pub values: Vec<f64>,
}

/// A recording, sampled at the times of the torque. All vectors have the same length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Times \[s\], increasing.
    pub times_s: Vec<f64>,
    /// Steer torque of the controller \[N m\]; NaN without a value.
    pub torque_nm: Vec<f64>,
    /// Forward speed \[m/s\]; NaN without a value.
    pub speed_m_s: Vec<f64>,
    /// Distance counted by a wheel sensor \[m\], if recorded: where the speed is a mean over seconds, as the controller
    /// used it, the distance has the true one.
    pub distance_m: Option<Vec<f64>>,
    /// The recorded signals.
    pub channels: Vec<Channel>,
}

impl Record {
    /// The values of a signal, if recorded.
    pub fn channel(&self, signal: Signal) -> Option<&[f64]> {
        self.channels.iter().find(|channel| channel.signal == signal).map(|channel| &channel.values[..])
    }

    /// The first index after each gap, from 0 to the number of samples.
    pub(super) fn breaks(&self, period_s: f64) -> Vec<usize> {
        let gaps = self.times_s.windows(2).enumerate();
        let gaps = gaps.filter(|(_, two)| (two[1] - two[0] - period_s).abs() > GAP * period_s);
        let inner = gaps.map(|(i, _)| i + 1);
        std::iter::once(0).chain(inner).chain([self.times_s.len()]).collect()
    }
}
