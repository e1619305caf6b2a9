//! Decides a ride early: the rest of a small motion by the linear model at the present speed.
//!
//! Within [`LARGEST_RAD`] and [`LARGEST_RAD_S`] the nonlinear terms change a motion by about 1 %; the outcome is
//! decided only if the late amplitudes differ from the limit by the factor [`CLEAR`].

use super::controller::Linear;
use super::linear::{BICYCLE, Delayed, Matrix, Ridden, Upright, exponential, times};
use super::source::Source;
use crate::bicycle::{Geometry, State};
use crate::ride::assist::IdealLaw;
use crate::ride::{Conditions, Imu, Outcome, ScheduleSpeed};
use crate::rider::{Rider, RiderState, SignalHistory};
use control::Law;

/// Largest roll and steer \[rad\].
const LARGEST_RAD: f64 = 0.1;
/// Largest rates of roll and steer \[rad/s\].
const LARGEST_RAD_S: f64 = 0.8;
/// Largest heading \[rad\], of which the lateral path is a sine.
const LARGEST_HEADING_RAD: f64 = 0.2;
/// Factor between a late amplitude and the limit that decides.
const CLEAR: f64 = 1.25;
/// Time step of the linear motion \[s\].
const STEP_S: f64 = 0.02;
/// The same with a rider, at most \[s\]: the delayed signal is interpolated linearly within a step.
const RIDER_STEP_S: f64 = 0.015;
/// Relative change of the gain within 1 % of the speed up to which the law counts as linear.
const GAIN_CHANGE: f64 = 0.1;

/// The linear model of the rides under some conditions.
#[derive(Clone, Debug)]
pub(super) struct Forecast {
    bicycle: Geometry,
    upright: Upright,
    assist: Linear,
    schedule_speed: ScheduleSpeed,
    rider: Option<Rider>,
    /// Whether the rider has a gain on the lateral path.
    follows_path: bool,
}

/// The motion of a ride at the time of a forecast.
pub(super) struct Now<'a> {
    /// Time since the disturbance \[s\].
    pub(super) t_s: f64,
    pub(super) state: &'a State<f64>,
    /// Whether the assist has full authority.
    pub(super) engaged: bool,
    /// The rider's state, and its signals if it has a delay.
    pub(super) rider: Option<(RiderState<f64>, Option<&'a SignalHistory>)>,
    /// Speed at t = 0 \[m/s\].
    pub(super) initial_m_s: f64,
}

/// Largest roll and steer in the last second, and in all of a ride \[rad\].
type Amplitudes = ([f64; 2], [f64; 2]);

impl Forecast {
    /// Time between two forecasts of a ride \[s\].
    pub(super) const INTERVAL_S: f64 = 0.25;

    /// The model under an assist; `None` if it is not linear near upright riding.
    pub(super) fn new(conditions: &Conditions, source: &Source) -> Option<Self> {
        let assist = match source {
            Source::None => Linear::unlimited(IdealLaw::from(Law::None), 0.0),
            Source::Law(law) => Linear::of_law(law)?,
            Source::Sampled(plan) => Linear::of(conditions, plan)?,
            Source::Own(_) => return None,
        };
        // The roll rate in the frame differs from the roll angle's derivative by pitch and yaw.
        let linear = conditions.imu == Imu::Euler && assist.law.dead_band.roll_rate_rad_s == 0.0;
        let (bicycle, schedule_speed) = (conditions.bicycle, conditions.schedule_speed);
        let rider = conditions.rider.clone();
        let sets = rider.iter().flat_map(|rider| rider.schedule.points());
        let follows_path = sets.map(|(_, gains)| gains.get("K_y")).any(|gain| gain != Some(0.0));
        let upright = Upright::new(&bicycle);
        linear.then_some(Self { bicycle, upright, assist, schedule_speed, rider, follows_path })
    }

    /// Whether a motion is small enough. A rider's signals must all come from it, too.
    pub(super) fn covers(&self, now: &Now) -> bool {
        let state = now.state;
        let heading =
            now.rider.as_ref().filter(|_| self.follows_path).map_or(0.0, |(rider, _)| rider.heading);
        let kink_s = self.rider.as_ref().map_or(0.0, |rider| 2.0 * rider.delay_s);
        state.roll.abs().max(state.steer.abs()) < LARGEST_RAD
            && state.roll_rate.abs().max(state.steer_rate.abs()) < LARGEST_RAD_S
            && now.engaged
            && heading.abs() < LARGEST_HEADING_RAD
            && now.t_s >= kink_s
    }

    /// Largest roll and steer in the last of the next `left_s` seconds, and in all of them. `None` if the motion
    /// does not remain small, or the law's gain is not smooth at this speed.
    pub(super) fn amplitudes(&self, now: &Now, left_s: f64) -> Option<Amplitudes> {
        let state = now.state;
        let speed = -self.bicycle.rR * state.rear_wheel_rate;
        let scheduled = match self.schedule_speed {
            ScheduleSpeed::Initial => now.initial_m_s,
            ScheduleSpeed::Front | ScheduleSpeed::Rear => speed,
        };
        let Linear { law: IdealLaw { law, .. }, delay_s, largest_nm, largest_nm_s, slowest_m_s } =
            &self.assist;
        let gain = law.gain(scheduled);
        let smooth = |factor: f64| (law.gain(factor * scheduled) - gain).abs() <= GAIN_CHANGE * gain.abs();
        if !(smooth(0.99) && smooth(1.01))
            || gain.abs() * LARGEST_RAD_S > *largest_nm
            || scheduled < *slowest_m_s
        {
            return None;
        }
        let most_rad_s2 = largest_nm_s / gain.abs();
        let bicycle = self.upright.under(speed, gain, *delay_s)?;
        let x = [state.roll, state.steer, state.roll_rate, state.steer_rate];
        let (Some(rider), Some((rider_state, history))) = (&self.rider, &now.rider) else {
            let matrix = std::array::from_fn(|i| std::array::from_fn(|j| bicycle[i][j]));
            let steps = (left_s / STEP_S).ceil().max(1.0);
            let transition: Matrix<BICYCLE> = exponential(&matrix, left_s / steps);
            return largest(x, (steps as u32, left_s / steps), most_rad_s2, |x| times(&transition, x));
        };
        let ([roll, steer, roll_rate, steer_rate], r) = (x, rider_state);
        let x = [
            roll,
            steer,
            roll_rate,
            steer_rate,
            r.roll_integral,
            r.steer_integral,
            r.heading,
            r.rear_lateral,
            r.torque,
            r.torque_rate,
        ];
        // With a neural delay the signals are sampled, together with the torque of the same sample.
        let sensed = if history.is_some() { self.upright.under(speed, gain, 0.0)? } else { bicycle };
        let ridden = Ridden::new((&self.bicycle, speed), (rider, scheduled), &bicycle, &sensed);
        match history {
            None => {
                let steps = (left_s / RIDER_STEP_S).ceil().max(1.0);
                let transition = exponential(&ridden.closed(), left_s / steps);
                largest(x, (steps as u32, left_s / steps), most_rad_s2, |x| times(&transition, x))
            }
            Some(history) => {
                let step_s = rider.delay_s / (rider.delay_s / RIDER_STEP_S).ceil();
                let mut delayed = Delayed::new(&ridden, (rider.delay_s, step_s), now.t_s, &x, history);
                let steps = (left_s / step_s).ceil().max(1.0) as u32;
                largest(x, (steps, step_s), most_rad_s2, |x| delayed.step(x))
            }
        }
    }

    /// The outcome, if it is clear.
    pub(super) fn outcome(&self, recovered_below: f64, late: [f64; 2], peak: [f64; 2]) -> Option<Outcome> {
        Outcome::of_amplitudes(recovered_below, late, peak, CLEAR)
    }
}

/// The largest angles of a linear motion over `steps` of `step_s` seconds; `None` if it does not remain small, or if the roll rate
/// changes faster than `most_rad_s2`. The first four entries of its state are those of the bicycle.
fn largest<const N: usize>(
    mut x: [f64; N],
    (steps, step_s): (u32, f64),
    most_rad_s2: f64,
    mut next: impl FnMut(&[f64; N]) -> [f64; N],
) -> Option<Amplitudes> {
    let (mut late, mut peak) = ([0.0_f64; 2], [0.0_f64; 2]);
    for step in 1..=steps {
        let before_rad_s = x[2];
        x = next(&x);
        let small = x[0].abs().max(x[1].abs()) < LARGEST_RAD && x[2].abs().max(x[3].abs()) < LARGEST_RAD_S;
        if !small || (x[2] - before_rad_s).abs() > most_rad_s2 * step_s {
            return None;
        }
        for i in 0..2 {
            peak[i] = peak[i].max(x[i].abs());
            if f64::from(steps - step) * step_s < 1.0 {
                late[i] = late[i].max(x[i].abs());
            }
        }
    }
    Some((late, peak))
}
