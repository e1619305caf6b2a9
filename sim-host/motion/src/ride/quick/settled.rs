//! Exact rides of which only the outcome is wanted: once the motion has settled, quick rides continue those that do not fall.
//!
//! What decides between a fall and none is the violent motion after the disturbance; afterwards an error of the steps no longer
//! grows, under a law that is smooth. A ride that does not remain settled, or whose end quick rides do not decide, is ridden to its end
//! by exact steps.

use super::riders::RiderStart;
use super::{Begin, Quick};
use crate::bicycle::State;
use crate::ride::batch::equal;
use crate::ride::instructions::Instructions;
use crate::ride::lanes::Needed;
use crate::ride::{Conditions, FallCriterion, Outcome, Ride, Start};

/// Largest angles of a motion that has settled, as parts of the angles of a fall, and up to which quick rides continue it.
const SETTLED: f64 = 0.5;
const REMAINS: f64 = 0.75;
/// Largest rates of roll and steer of a motion that has settled \[rad/s\].
const ROLL_RATE_RAD_S: f64 = 1.5;
const STEER_RATE_RAD_S: f64 = 3.0;
/// Time between two instants at which a motion may have settled \[s\].
const INTERVAL_S: f64 = 0.1;
/// Shortest rest of a ride that quick rides continue \[s\]: its last second, and as much again.
const REST_S: f64 = 2.0;

/// Factor between late amplitudes and the limit that decides. Continued in fine steps after a second, late amplitudes near the limit
/// differ from the exact ride's by 0.003 % in the median, and by 0.07 % at most (cl2:4), with a rider by 0.03 %.
const CLEAR_SETTLED: f64 = 1.002;

/// An exact ride up to the time at which its motion settled.
pub(in crate::ride) struct Settled {
    /// The ride; its outcome is open.
    pub(in crate::ride) ride: Ride,
    pub(in crate::ride) state: State<f64>,
    pub(in crate::ride) rider: Option<RiderStart>,
}

/// Control periods between two instants at which a motion may have settled.
pub(in crate::ride) fn interval(conditions: &Conditions) -> u32 {
    (INTERVAL_S / conditions.step_s).round().max(1.0) as u32
}

/// Whether the motion at `t_s` seconds has settled, long enough before the time limit, and after the rider's first delayed signals.
pub(in crate::ride) fn has_settled(conditions: &Conditions, t_s: f64, state: &State<f64>) -> bool {
    let delay_s = conditions.rider.as_ref().map_or(0.0, |rider| rider.delay_s);
    within(&conditions.fall, state, SETTLED)
        && state.roll_rate.abs() < ROLL_RATE_RAD_S
        && state.steer_rate.abs() < STEER_RATE_RAD_S
        && t_s > 2.0 * delay_s
        && t_s + REST_S <= conditions.time_limit_s
}

/// Whether the motion remains settled.
pub(super) fn remains_settled(conditions: &Conditions, state: &State<f64>) -> bool {
    within(&conditions.fall, state, REMAINS)
}

fn within(fall: &FallCriterion, state: &State<f64>, part: f64) -> bool {
    let roll_rad = fall.flat.map_or(fall.roll_rad, |flat| flat.roll_rad.min(fall.roll_rad));
    state.roll.abs() < part * roll_rad && state.steer.abs() < part * fall.steer_rad
}

/// A ride whose outcome is wanted, and what quick rides say of it.
#[derive(Clone, Copy, Debug)]
pub struct Foreseen {
    /// Initial state.
    pub start: Start,
    /// Expected time of its fall, or the time limit \[s\].
    pub lasts_s: f64,
    /// Time for which it must be exact at least \[s\]; infinite if it must be to its end.
    pub exact_s: f64,
}

impl Quick<'_> {
    /// Rides whose outcomes are those of exact rides, in the order of `foreseen`. A ride that does not fall may end early after the time for
    /// which it must be exact; its effort and final state are those up to then. Under a controller whose step is executed, an own law, and a
    /// law with a dead band, limits or a delay every ride is exact to its end.
    pub fn decided(&self, foreseen: &[Foreseen]) -> Vec<Ride> {
        let starts: Vec<Start> = foreseen.iter().map(|ride| ride.start).collect();
        let continues = self.source.sampled().is_none() && !self.source.limited() && !self.source.jumps();
        let exact_s = foreseen.iter().map(|ride| if continues { ride.exact_s } else { f64::INFINITY });
        let exact_s: Vec<f64> = exact_s.collect();
        let lasts_s = foreseen.iter().zip(&exact_s).map(|(ride, exact_s)| ride.lasts_s.min(*exact_s));
        let instructions = Instructions::of_this_processor();
        let mut settled: Vec<Option<Box<Settled>>> = starts.iter().map(|_| None).collect();
        let needed = Needed::Outcome(&exact_s, &mut settled);
        let mut done = instructions.rides(self.conditions, &starts, needed, lasts_s);
        let mut open = Vec::new();
        let continued: Vec<usize> = (0..settled.len()).filter(|&i| settled[i].is_some()).collect();
        let begin: Vec<Begin> = settled.into_iter().flatten().map(Begin::Settled).collect();
        let fine = Self { clear: CLEAR_SETTLED, ..self.fine() };
        for (i, ride) in continued.into_iter().zip(instructions.quick_rides(&fine, begin)) {
            done[i].steps += ride.steps;
            match ride.outcome {
                Some(outcome @ (Outcome::Recovered | Outcome::Undecided)) => done[i].outcome = outcome,
                _ => open.push(i),
            }
        }
        let again: Vec<Start> = open.iter().map(|&i| starts[i]).collect();
        let again = instructions.rides(self.conditions, &again, Needed::Effort, equal(again.len()));
        for (i, ride) in open.into_iter().zip(again) {
            done[i] = Ride { steps: done[i].steps + ride.steps, ..ride };
        }
        done
    }
}
