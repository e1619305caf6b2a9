//! A rider that a caller advances with samples of the bicycle's motion, one time step after the other: the rider of another
//! simulator.
//!
//! The rider's torque in a step depends on earlier samples only, as long as the neural delay is not shorter than the step.

use super::{DelayLine, Rider, Signals};
use crate::integrate::{STAGES, Stages};
use crate::num::Moves;
use serde::{Deserialize, Serialize};

/// The bicycle's motion at the start of a step. Right positive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RiderSample {
    /// Angle, rate and acceleration of roll \[rad, rad/s, rad/s^2\].
    pub roll: [f64; 3],
    /// Angle, rate and acceleration of steer.
    pub steer: [f64; 3],
    /// Heading of the rear frame relative to the start \[rad\].
    pub heading_rad: f64,
    /// Lateral deviation of the front contact \[m\].
    pub front_lateral_m: f64,
    /// Speed that schedules the gains \[m/s\].
    pub speed_m_s: f64,
}

/// The torque on the handlebar \[N m\] and its rate \[N m/s\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Muscle {
    torque: f64,
    rate: f64,
}

impl Moves for Muscle {
    fn moved(&self, h: f64, by: &Self) -> Self {
        Self { torque: self.torque + by.torque * h, rate: self.rate + by.rate * h }
    }
}

/// State of the rider. All zero at the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SteppedRider {
    muscle: Muscle,
    /// Integrals of roll and steer up to the last sample \[rad s\].
    integrals: [f64; 2],
    last: Option<RiderSample>,
    /// `None` without delay.
    delay_line: Option<DelayLine>,
}

impl SteppedRider {
    /// A rider at the start, advanced in steps of `step_s` seconds.
    pub fn new(rider: &Rider, step_s: f64) -> Self {
        let delay = rider.delay_steps(step_s);
        Self {
            muscle: Muscle::default(),
            integrals: [0.0; 2],
            last: None,
            delay_line: (delay > 0).then(|| DelayLine::new(delay)),
        }
    }

    /// The torque on the handlebar \[N m\], right positive, and its rate \[N m/s\].
    pub fn torque(&self) -> [f64; 2] {
        [self.muscle.torque, self.muscle.rate]
    }

    /// One time step of `step_s` seconds from the sample at its start.
    ///
    /// The integrals of roll and steer are those of the cubic through both samples' values and rates. Without a delay the
    /// neural signal is held over the step.
    pub fn step(&mut self, rider: &Rider, step_s: f64, now: &RiderSample) {
        if let Some(last) = self.last.replace(*now) {
            let pairs = [(last.roll, now.roll), (last.steer, now.steer)];
            for (integral, ([a, a_rate, _], [b, b_rate, _])) in self.integrals.iter_mut().zip(pairs) {
                *integral += mean([a, a_rate], [b, b_rate], step_s) * step_s;
            }
        }
        let ([roll, roll_rate, roll_acc], [steer, steer_rate, steer_acc]) = (now.roll, now.steer);
        let [roll_integral, steer_integral] = self.integrals;
        let signals = Signals([
            roll,
            roll_integral,
            roll_rate,
            roll_acc,
            steer,
            steer_integral,
            steer_rate,
            steer_acc,
            now.heading_rad,
            now.front_lateral_m,
        ]);
        let signal = rider.schedule.at(now.speed_m_s).signal(&signals);
        let arriving = match &mut self.delay_line {
            Some(delay_line) => {
                delay_line.push(signal);
                delay_line.arriving()
            }
            None => [signal; 3],
        };
        let mut stages = Stages::new(self.muscle);
        for (stage, part) in STAGES.into_iter().enumerate() {
            let Muscle { torque, rate } = stages.at;
            let alpha = arriving[(2.0 * part) as usize];
            let k = Muscle { torque: rate, rate: rider.neuromuscular.acceleration(alpha, torque, rate) };
            stages.next(stage, step_s, &k);
        }
        self.muscle = stages.end;
    }
}

/// Mean over `h` seconds of the cubic through the values and rates at both ends.
fn mean([a, a_rate]: [f64; 2], [b, b_rate]: [f64; 2], h: f64) -> f64 {
    0.5 * (a + b) + h / 12.0 * (a_rate - b_rate)
}
