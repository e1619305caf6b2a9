//! Decides a ride early: the rest of a small motion by the linear model at the present speed.
//!
//! Within [`LARGEST_RAD`] and [`LARGEST_RAD_S`] the nonlinear terms change a motion by less than 1 %; the outcome is
//! decided only if the late amplitudes differ from the limit by the factor [`CLEAR`].

use super::{Conditions, IdealLaw, Imu, Outcome, ScheduleSpeed};
use crate::bicycle::{Geometry, Motion, State, Torques};
use crate::num::{Dual, Scalar};
use control::Law;

/// Largest roll and steer \[rad\].
const LARGEST_RAD: f64 = 0.05;
/// Largest rates of roll and steer \[rad/s\].
const LARGEST_RAD_S: f64 = 0.4;
/// Factor between a late amplitude and the limit that decides.
const CLEAR: f64 = 1.25;
/// Time step of the linear motion \[s\].
const STEP_S: f64 = 0.02;
/// Relative change of the gain within 1 % of the speed up to which the law counts as linear.
const GAIN_CHANGE: f64 = 0.1;

/// The linear model of the rides under some conditions.
#[derive(Clone, Debug)]
pub(super) struct Forecast {
    bicycle: Geometry,
    law: Law,
    delay_s: f64,
    schedule_speed: ScheduleSpeed,
}

/// State matrix of roll, steer, roll rate and steer rate.
type Matrix = [[f64; 4]; 4];

impl Forecast {
    /// Time between two forecasts of a ride \[s\].
    pub(super) const INTERVAL_S: f64 = 0.25;

    /// The model under a law whose torque is delayed by `delay_s` to first order; `None` if the law is not linear near
    /// upright riding.
    pub(super) fn new(conditions: &Conditions, law: &IdealLaw, delay_s: f64) -> Option<Self> {
        // The roll rate in the frame differs from the roll angle's derivative by pitch and yaw.
        let linear = conditions.imu == Imu::Euler && law.dead_band.roll_rate_rad_s == 0.0;
        let (bicycle, schedule_speed) = (conditions.bicycle, conditions.schedule_speed);
        linear.then(|| Self { bicycle, law: law.law.clone(), delay_s, schedule_speed })
    }

    /// Whether a motion is small enough.
    pub(super) fn covers(state: &State<f64>) -> bool {
        state.roll.abs() < LARGEST_RAD
            && state.steer.abs() < LARGEST_RAD
            && state.roll_rate.abs() < LARGEST_RAD_S
            && state.steer_rate.abs() < LARGEST_RAD_S
    }

    /// Largest roll and steer in the last of the next `left_s` seconds, and in all of them \[rad\]. `None` if the motion
    /// does not remain small, or the law's gain is not smooth at this speed.
    pub(super) fn amplitudes(
        &self,
        state: &State<f64>,
        initial_m_s: f64,
        left_s: f64,
    ) -> Option<([f64; 2], [f64; 2])> {
        let speed = -self.bicycle.rR * state.rear_wheel_rate;
        let scheduled = match self.schedule_speed {
            ScheduleSpeed::Initial => initial_m_s,
            ScheduleSpeed::Front | ScheduleSpeed::Rear => speed,
        };
        let gain = self.law.gain(scheduled);
        let smooth =
            |factor: f64| (self.law.gain(factor * scheduled) - gain).abs() <= GAIN_CHANGE * gain.abs();
        if !(smooth(0.99) && smooth(1.01)) {
            return None;
        }
        let matrix = state_matrix(&self.bicycle, speed, gain, self.delay_s)?;
        let steps = (left_s / STEP_S).ceil().max(1.0);
        let transition = exponential(&matrix, left_s / steps);
        let mut x = [state.roll, state.steer, state.roll_rate, state.steer_rate];
        let (mut late, mut peak) = ([0.0_f64; 2], [0.0_f64; 2]);
        for step in 1..=steps as u32 {
            x = transition.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + row[3] * x[3]);
            let small =
                x[0].abs().max(x[1].abs()) < LARGEST_RAD && x[2].abs().max(x[3].abs()) < LARGEST_RAD_S;
            if !small {
                return None;
            }
            for i in 0..2 {
                peak[i] = peak[i].max(x[i].abs());
                if (steps - f64::from(step)) * left_s / steps < 1.0 {
                    late[i] = late[i].max(x[i].abs());
                }
            }
        }
        Some((late, peak))
    }

    /// The outcome, if it is clear.
    pub(super) fn outcome(&self, recovered_below: f64, late: [f64; 2], peak: [f64; 2]) -> Option<Outcome> {
        Outcome::of_amplitudes(recovered_below, late, peak, CLEAR)
    }
}

/// The linearised motion at a forward speed \[m/s\] under the steer torque `gain` times the roll rate, delayed by
/// `delay_s` to first order; derivatives of the nonlinear equations.
fn state_matrix(b: &Geometry, speed: f64, gain: f64, delay_s: f64) -> Option<Matrix> {
    let mut a = [[0.0; 4]; 4];
    (a[0][2], a[1][3]) = (1.0, 1.0);
    let upright = State::upright(b, Dual::constant(speed));
    let variable = Dual { re: 0.0, eps: 1.0 };
    let zero = Dual::constant(0.0);
    let derivative = |state: &State<Dual>, steer: Dual| {
        let motion = Motion::new(b, state);
        let acc = motion.accelerations(b, &Torques { roll: zero, steer });
        [acc.roll.eps, acc.steer.eps]
    };
    let columns = [
        derivative(&State { roll: variable, ..upright }, zero),
        derivative(&State { steer: variable, ..upright }, zero),
        derivative(&State { roll_rate: variable, ..upright }, zero),
        derivative(&State { steer_rate: variable, ..upright }, zero),
    ];
    let torque = derivative(&upright, variable);
    // T = gain (p - delay dp/dt), and dp/dt contains torque[0] T.
    let share = 1.0 + gain * delay_s * torque[0];
    for (j, column) in columns.iter().enumerate() {
        let rate = f64::from(u8::from(j == 2));
        let steer_nm = gain * (rate - delay_s * column[0]) / share;
        a[2][j] = column[0] + torque[0] * steer_nm;
        a[3][j] = column[1] + torque[1] * steer_nm;
    }
    a.iter().flatten().all(|x| x.is_finite()).then_some(a)
}

/// The matrix exponential of `a h`, by its series: `h` times the largest eigenvalue is below one.
fn exponential(a: &Matrix, h: f64) -> Matrix {
    const TERMS: u32 = 14;
    let mut sum: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let mut term = sum;
    for n in 1..=TERMS {
        let scale = h / f64::from(n);
        term = std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..4).map(|k| term[i][k] * a[k][j]).sum::<f64>() * scale)
        });
        for (row, add) in sum.iter_mut().zip(&term) {
            row.iter_mut().zip(add).for_each(|(x, y)| *x += y);
        }
    }
    sum
}
