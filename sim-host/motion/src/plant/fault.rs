//! Fault injection in sensors, motor command, switch and clock. Text form: `gyro.x:bias=0.1@1.5s..3s`.

use super::Sensor;
use crate::num::RandomStream;
use std::collections::VecDeque;

/// Signal in which a fault is injected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// All samples of a sensor.
    Sensor(Sensor),
    /// The torque command to the motor \[N m\].
    Motor,
    /// The rider's switch: 1 is on.
    Engage,
    /// The controller's clock \[s\].
    Clock,
}

/// Type of the fault. Amounts are in the channel's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// The last value before the fault is held.
    Stuck,
    /// No samples.
    Missing,
    /// Samples are delayed by this time \[s\].
    Late(f64),
    /// White Gaussian noise of this standard deviation.
    Noise(f64),
    /// This amount is added.
    Bias(f64),
    /// This amount per second is added, from the start of the fault.
    Drift(f64),
    /// The value is multiplied by this factor.
    Scale(f64),
    /// The sign is inverted (for the switch: on becomes off).
    Flip,
    /// A permanent step by this amount.
    Jump(f64),
    /// This amount is added to one sample.
    Spike(f64),
    /// Not a number.
    Nan,
    /// The value is replaced by this one.
    Value(f64),
    /// Every sample is lost with this probability.
    Dropout(f64),
    /// No torque.
    Dead,
    /// A first-order lag with this time constant \[s\].
    Slow(f64),
}

/// One fault. Its text form parses to the same fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// Where it is injected.
    pub channel: Channel,
    /// Index of the axis in [`Sensor::axes`]; all axes if none.
    pub axis: Option<u8>,
    /// Type of the fault.
    pub kind: Kind,
    /// Start, in the time of the ride \[s\].
    pub from_s: f64,
    /// End, in the time of the ride \[s\]; can be infinite.
    pub to_s: f64,
}

/// State of a fault in one ride.
#[derive(Debug)]
pub struct FaultState {
    /// First tick of the fault, and first tick after it.
    from: i64,
    to: i64,
    period_s: f64,
    /// Last value before the fault, or output of the lag.
    last: [f64; 3],
    /// Delayed samples.
    late: VecDeque<Option<[f64; 3]>>,
    /// Delay in ticks.
    late_ticks: usize,
    /// Whether the fault has acted, so that a spike acts once.
    spent: bool,
    /// Decay of the lag's difference per period.
    decay: f64,
    random: RandomStream,
}

/// First tick at or after a time; exact for times that are whole numbers of periods.
pub(super) fn tick_of(time_s: f64, period_s: f64) -> i64 {
    // The conversion saturates at infinity.
    (time_s / period_s - 1e-6).ceil() as i64
}

impl FaultState {
    /// State before the ride; until the fault begins, the value is `steady`.
    pub fn new(fault: &Fault, period_s: f64, steady: [f64; 3], random: RandomStream) -> Self {
        let (late_ticks, decay) = match fault.kind {
            Kind::Late(late_s) => ((late_s / period_s).round() as usize, 0.0),
            Kind::Slow(constant_s) => (0, libm::exp(-period_s / constant_s)),
            _ => (0, 0.0),
        };
        Self {
            from: tick_of(fault.from_s, period_s),
            to: tick_of(fault.to_s, period_s),
            period_s,
            last: steady,
            late: VecDeque::new(),
            late_ticks,
            spent: false,
            decay,
            random,
        }
    }

    /// The sample at `tick` with the fault, from the `sample` without; `None` is no sample.
    pub fn apply(&mut self, fault: &Fault, tick: i64, sample: Option<[f64; 3]>) -> Option<[f64; 3]> {
        if tick < self.from || tick >= self.to {
            self.last = sample.unwrap_or(self.last);
            return sample;
        }
        match fault.kind {
            Kind::Missing => return None,
            Kind::Late(_) => {
                self.late.push_back(sample);
                return if self.late.len() > self.late_ticks { self.late.pop_front()? } else { None };
            }
            Kind::Dropout(p) => return sample.filter(|_| !self.random.chance(p)),
            _ => {}
        }
        let mut sample = sample?;
        let first = !std::mem::replace(&mut self.spent, true);
        let since_s = (tick - self.from) as f64 * self.period_s;
        for (axis, x) in sample.iter_mut().enumerate() {
            if fault.axis.is_some_and(|only| usize::from(only) != axis) {
                continue;
            }
            *x = match fault.kind {
                Kind::Stuck => self.last[axis],
                Kind::Noise(deviation) => *x + deviation * self.random.normal(),
                Kind::Bias(by) | Kind::Jump(by) => *x + by,
                Kind::Drift(by_s) => *x + by_s * since_s,
                // The clock continues from its present time, at another rate.
                Kind::Scale(factor) if fault.channel == Channel::Clock => *x + since_s * (factor - 1.0),
                Kind::Scale(factor) => *x * factor,
                Kind::Flip if fault.channel == Channel::Engage => 1.0 - *x,
                Kind::Flip => -*x,
                Kind::Spike(by) if first => *x + by,
                Kind::Nan => f64::NAN,
                Kind::Value(value) => value,
                Kind::Dead => 0.0,
                Kind::Slow(_) => *x + (self.last[axis] - *x) * self.decay,
                Kind::Spike(_) | Kind::Missing | Kind::Late(_) | Kind::Dropout(_) => *x,
            };
        }
        if let Kind::Slow(_) = fault.kind {
            self.last = sample;
        }
        Some(sample)
    }
}
