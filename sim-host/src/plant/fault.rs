//! Faults: what goes wrong, from when to when. Written as `gyro.x:bias=0.1@1.5s..3s`.

use super::{RandomStream, Sensor};
use std::collections::VecDeque;

/// What a fault is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// A sensor: every sample it delivers.
    Sensor(Sensor),
    /// The torque command on its way to the motor \[N m\].
    Motor,
    /// The rider's switch: 1 is on.
    Engage,
    /// The controller's clock \[s\].
    Clock,
}

/// What goes wrong. Amounts are in the channel's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Says for ever what it said last.
    Stuck,
    /// Says nothing.
    Missing,
    /// Says everything later by this time \[s\].
    Late(f64),
    /// White Gaussian noise of this standard deviation.
    Noise(f64),
    /// This much is added.
    Bias(f64),
    /// This much per second is added, from the fault's beginning.
    Drift(f64),
    /// Times this.
    Scale(f64),
    /// The other sign (for the switch: on is off).
    Flip,
    /// A step by this much, for good.
    Jump(f64),
    /// This much is added to one sample.
    Spike(f64),
    /// Not a number.
    Nan,
    /// This value.
    Value(f64),
    /// Every sample is lost with this probability.
    Dropout(f64),
    /// No torque.
    Dead,
    /// A first-order lag with this time constant \[s\].
    Slow(f64),
}

/// One fault. Its text form parses back to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// What it is on.
    pub channel: Channel,
    /// Which axis by [`Sensor::axes`]; all of them if none.
    pub axis: Option<u8>,
    /// What goes wrong.
    pub kind: Kind,
    /// From this time of the ride \[s\], ...
    pub from_s: f64,
    /// ... up to this time, which may be infinite \[s\].
    pub to_s: f64,
}

/// A fault in one ride.
#[derive(Debug)]
pub struct FaultState {
    /// First tick it acts at, and first tick it does not any more.
    from: i64,
    to: i64,
    period_s: f64,
    /// What was said last before it.
    last: [f64; 3],
    /// What is said too late.
    late: VecDeque<Option<[f64; 3]>>,
    /// For how many ticks.
    late_ticks: usize,
    /// A spike was there.
    spent: bool,
    /// What a lag keeps of the difference in a period.
    keeps: f64,
    random: RandomStream,
}

/// The first tick not before a time, times that are a whole number of periods being exact.
fn tick_of(time_s: f64, period_s: f64) -> i64 {
    // The conversion saturates at infinity.
    (time_s / period_s - 1e-6).ceil() as i64
}

impl FaultState {
    /// Before the ride; until it begins, `steady` is said.
    pub fn new(fault: &Fault, period_s: f64, steady: [f64; 3], random: RandomStream) -> Self {
        let (late_ticks, keeps) = match fault.kind {
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
            keeps,
            random,
        }
    }

    /// What is said at `tick` where `said` would be; `None` is nothing.
    pub fn apply(&mut self, fault: &Fault, tick: i64, said: Option<[f64; 3]>) -> Option<[f64; 3]> {
        if tick < self.from || tick >= self.to {
            self.last = said.unwrap_or(self.last);
            return said;
        }
        match fault.kind {
            Kind::Missing => return None,
            Kind::Late(_) => {
                self.late.push_back(said);
                return if self.late.len() > self.late_ticks { self.late.pop_front()? } else { None };
            }
            Kind::Dropout(p) => return said.filter(|_| !self.random.chance(p)),
            _ => {}
        }
        let mut said = said?;
        let first = !std::mem::replace(&mut self.spent, true);
        let since_s = (tick - self.from) as f64 * self.period_s;
        for (axis, x) in said.iter_mut().enumerate() {
            if fault.axis.is_some_and(|only| usize::from(only) != axis) {
                continue;
            }
            *x = match fault.kind {
                Kind::Stuck => self.last[axis],
                Kind::Noise(deviation) => *x + deviation * self.random.normal(),
                Kind::Bias(by) | Kind::Jump(by) => *x + by,
                Kind::Drift(by_s) => *x + by_s * since_s,
                // A clock goes on from where it is.
                Kind::Scale(factor) if fault.channel == Channel::Clock => *x + since_s * (factor - 1.0),
                Kind::Scale(factor) => *x * factor,
                Kind::Flip if fault.channel == Channel::Engage => 1.0 - *x,
                Kind::Flip => -*x,
                Kind::Spike(by) if first => *x + by,
                Kind::Nan => f64::NAN,
                Kind::Value(value) => value,
                Kind::Dead => 0.0,
                Kind::Slow(_) => *x + (self.last[axis] - *x) * self.keeps,
                Kind::Spike(_) | Kind::Missing | Kind::Late(_) | Kind::Dropout(_) => *x,
            };
        }
        if let Kind::Slow(_) = fault.kind {
            self.last = said;
        }
        Some(said)
    }
}
