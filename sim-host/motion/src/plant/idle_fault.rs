//! Faults that change nothing.

use super::Sensor;
use super::fault::{Channel, Fault, tick_of};
use control::ValidationConfig;

impl Sensor {
    /// Its declaration among the controller's inputs.
    #[inline(always)]
    pub const fn declared(self, input: &ValidationConfig) -> &control::Sensor {
        match self {
            Self::Gyro => &input.gyro,
            Self::Accel => &input.accel,
            Self::Steer => &input.steer,
            Self::SteerRate => &input.steer_rate,
            Self::FrontWheel => &input.front_wheel,
            Self::RearWheel => &input.rear_wheel,
            Self::RiderTorque => &input.rider_torque,
            Self::MotorReport => &input.motor,
            Self::Path => &input.path,
        }
    }

    /// Why nothing about this sensor has an effect: the controller does not declare it.
    pub fn unfitted(self, input: &ValidationConfig) -> Option<String> {
        let key = self.key();
        (!self.declared(input).fitted)
            .then(|| format!("the controller has no such sensor (--set input.{key}.fitted=on)"))
    }
}

impl Fault {
    /// Why the fault has no effect on a controller with these inputs, at `instants` control instants from t = 0, each
    /// `period_s` \[s\] after the one before; `None` if it can have one.
    pub fn idle(&self, input: &ValidationConfig, instants: u64, period_s: f64) -> Option<String> {
        let unfitted = match self.channel {
            Channel::Sensor(sensor) => sensor.unfitted(input),
            Channel::Motor | Channel::Engage | Channel::Clock => None,
        };
        unfitted.or_else(|| self.never(instants, period_s))
    }

    /// Why none of the control instants is in the fault's time.
    fn never(&self, instants: u64, period_s: f64) -> Option<String> {
        let (from, to) = (tick_of(self.from_s, period_s), tick_of(self.to_s, period_s));
        let instants = i64::try_from(instants).unwrap_or(i64::MAX);
        if from >= instants {
            let end_s = instants as f64 * period_s;
            return Some(format!("it begins at {} s, and the end is at {end_s:.3} s", self.from_s));
        }
        (from >= to).then(|| "no control instant is in its time".into())
    }
}
