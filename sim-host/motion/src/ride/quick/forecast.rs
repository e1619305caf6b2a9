//! Decides a ride early: the rest of a small motion by the linear model at the present speed.
//!
//! Within [`LARGEST_RAD`] and [`LARGEST_RAD_S`] the nonlinear terms change a motion by less than 1 %; the outcome is
//! decided only if the late amplitudes differ from the limit by the factor [`CLEAR`].

use super::source::Source;
use crate::bicycle::{Accelerations, Geometry, Motion, State, Torques};
use crate::num::{Dual, Scalar};
use crate::ride::assist::IdealLaw;
use crate::ride::{Conditions, Imu, Outcome, ScheduleSpeed};
use crate::rider::{Instant, Rider, RiderState, SignalHistory};
use control::Law;

/// Largest roll and steer \[rad\].
const LARGEST_RAD: f64 = 0.05;
/// Largest rates of roll and steer \[rad/s\].
const LARGEST_RAD_S: f64 = 0.4;
/// Largest heading \[rad\], of which the lateral path is a sine.
const LARGEST_HEADING_RAD: f64 = 0.2;
/// Factor between a late amplitude and the limit that decides.
const CLEAR: f64 = 1.25;
/// Time step of the linear motion \[s\].
const STEP_S: f64 = 0.02;
/// The same with a rider, at most \[s\]: the delayed signal is interpolated linearly within a step.
const RIDER_STEP_S: f64 = 0.01;
/// Relative change of the gain within 1 % of the speed up to which the law counts as linear.
const GAIN_CHANGE: f64 = 0.1;

/// The linear model of the rides under some conditions.
#[derive(Clone, Debug)]
pub(super) struct Forecast {
    bicycle: Geometry,
    law: Law,
    delay_s: f64,
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
    /// The rider's state, and its signals if it has a delay.
    pub(super) rider: Option<(RiderState<f64>, Option<&'a SignalHistory>)>,
    /// Speed at t = 0 \[m/s\].
    pub(super) initial_m_s: f64,
}

/// A square matrix by rows.
type Matrix<const N: usize> = [[f64; N]; N];
/// Roll, steer, roll rate and steer rate.
const BICYCLE: usize = 4;
/// The same, then the entries of [`RiderState`] in their order.
const RIDDEN: usize = 10;
/// The same, then the arriving neural signal and its slope over time.
const DELAYED: usize = 12;
/// Largest roll and steer in the last second, and in all of a ride \[rad\].
type Amplitudes = ([f64; 2], [f64; 2]);

impl Forecast {
    /// Time between two forecasts of a ride \[s\].
    pub(super) const INTERVAL_S: f64 = 0.25;

    /// The model under an assist; `None` if it is not linear near upright riding.
    pub(super) fn new(conditions: &Conditions, source: &Source) -> Option<Self> {
        let (law, delay_s) = match source {
            Source::None => (IdealLaw::from(Law::None), 0.0),
            Source::Ideal(law, delay_s) => ((**law).clone(), *delay_s),
            Source::Own(_) => return None,
        };
        // The roll rate in the frame differs from the roll angle's derivative by pitch and yaw.
        let linear = conditions.imu == Imu::Euler && law.dead_band.roll_rate_rad_s == 0.0;
        let (bicycle, schedule_speed) = (conditions.bicycle, conditions.schedule_speed);
        let rider = conditions.rider.clone();
        let sets = rider.iter().flat_map(|rider| rider.schedule.points());
        let follows_path = sets.map(|(_, gains)| gains.get("K_y")).any(|gain| gain != Some(0.0));
        linear.then_some(Self { bicycle, law: law.law, delay_s, schedule_speed, rider, follows_path })
    }

    /// Whether a motion is small enough. A rider's signals must all come from it, too.
    pub(super) fn covers(&self, now: &Now) -> bool {
        let state = now.state;
        let heading =
            now.rider.as_ref().filter(|_| self.follows_path).map_or(0.0, |(rider, _)| rider.heading);
        let kink_s = self.rider.as_ref().map_or(0.0, |rider| 2.0 * rider.delay_s);
        state.roll.abs().max(state.steer.abs()) < LARGEST_RAD
            && state.roll_rate.abs().max(state.steer_rate.abs()) < LARGEST_RAD_S
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
        let gain = self.law.gain(scheduled);
        let smooth =
            |factor: f64| (self.law.gain(factor * scheduled) - gain).abs() <= GAIN_CHANGE * gain.abs();
        if !(smooth(0.99) && smooth(1.01)) {
            return None;
        }
        let upright = Upright::new(&self.bicycle, speed);
        let bicycle = upright.under(gain, self.delay_s)?;
        let x = [state.roll, state.steer, state.roll_rate, state.steer_rate];
        let (Some(rider), Some((rider_state, history))) = (&self.rider, &now.rider) else {
            let matrix = std::array::from_fn(|i| std::array::from_fn(|j| bicycle[i][j]));
            let steps = (left_s / STEP_S).ceil().max(1.0);
            let transition: Matrix<BICYCLE> = exponential(&matrix, left_s / steps);
            return largest(x, (steps as u32, left_s / steps), |x| times(&transition, x));
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
        let felt = if history.is_some() { upright.under(gain, 0.0)? } else { bicycle };
        let ridden = Ridden::new((&self.bicycle, speed), (rider, scheduled), &bicycle, &felt);
        match history {
            None => {
                let steps = (left_s / RIDER_STEP_S).ceil().max(1.0);
                let transition = exponential(&ridden.closed(), left_s / steps);
                largest(x, (steps as u32, left_s / steps), |x| times(&transition, x))
            }
            Some(history) => {
                let step_s = rider.delay_s / (rider.delay_s / RIDER_STEP_S).ceil();
                let mut delayed = Delayed::new(&ridden, (rider.delay_s, step_s), now.t_s, &x, history);
                let steps = (left_s / step_s).ceil().max(1.0) as u32;
                largest(x, (steps, step_s), |x| delayed.step(x))
            }
        }
    }

    /// The outcome, if it is clear.
    pub(super) fn outcome(&self, recovered_below: f64, late: [f64; 2], peak: [f64; 2]) -> Option<Outcome> {
        Outcome::of_amplitudes(recovered_below, late, peak, CLEAR)
    }
}

/// The largest angles of a linear motion over `steps` of `step_s` seconds; `None` if it does not remain small. The first
/// four entries of its state are those of the bicycle.
fn largest<const N: usize>(
    mut x: [f64; N],
    (steps, step_s): (u32, f64),
    mut next: impl FnMut(&[f64; N]) -> [f64; N],
) -> Option<Amplitudes> {
    let (mut late, mut peak) = ([0.0_f64; 2], [0.0_f64; 2]);
    for step in 1..=steps {
        x = next(&x);
        let small = x[0].abs().max(x[1].abs()) < LARGEST_RAD && x[2].abs().max(x[3].abs()) < LARGEST_RAD_S;
        if !small {
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

/// Bicycle and rider, without the path from the neural signal to the one that arrives.
struct Ridden {
    matrix: Matrix<RIDDEN>,
    /// Time derivative of the torque rate by the arriving signal \[1/s^2\].
    arriving: f64,
    /// The neural signal before its delay by the state.
    signal: [f64; RIDDEN],
}

impl Ridden {
    /// A bicycle at a forward speed \[m/s\], and a rider at the speed that schedules the gains; `felt` is the bicycle of
    /// the rider's signals.
    fn new(
        (b, speed): (&Geometry, f64),
        (rider, scheduled): (&Rider, f64),
        bicycle: &BicycleMatrix,
        felt: &BicycleMatrix,
    ) -> Self {
        let gains = rider.schedule.at(scheduled);
        let (mut matrix, mut signal) = ([[0.0; RIDDEN]; RIDDEN], [0.0; RIDDEN]);
        for j in 0..RIDDEN {
            let of = |i: usize| Dual { re: 0.0, eps: f64::from(u8::from(i == j)) };
            let state = State {
                roll: of(0),
                steer: of(1),
                roll_rate: of(2),
                steer_rate: of(3),
                ..State::upright(b, Dual::constant(speed))
            };
            let rider_state = RiderState {
                roll_integral: of(4),
                steer_integral: of(5),
                heading: of(6),
                rear_lateral: of(7),
                torque: of(TORQUE),
                torque_rate: of(9),
            };
            let by = match j {
                0..BICYCLE => Some(j),
                TORQUE => Some(BICYCLE),
                _ => None,
            };
            let of_row = |matrix: &BicycleMatrix, row: usize| by.map_or(0.0, |column| matrix[row][column]);
            let motion = Motion::new(b, &state);
            let dual = |eps: f64| Dual { re: 0.0, eps };
            let acc = Accelerations {
                roll: dual(of_row(felt, 2)),
                steer: dual(of_row(felt, 3)),
                rear_wheel: dual(0.0),
            };
            let now = Instant::new(&state, &motion, &acc);
            signal[j] = gains.signal(&rider_state.signals(&now)).eps;
            let r = rider_state.rate(b, &now, &rider.neuromuscular, dual(0.0));
            let rates = [0, 1, 2, 3].map(|row| of_row(bicycle, row));
            let rider_rates =
                [r.roll_integral, r.steer_integral, r.heading, r.rear_lateral, r.torque, r.torque_rate];
            for (row, rate) in matrix.iter_mut().zip(rates.into_iter().chain(rider_rates.map(|r| r.eps))) {
                row[j] = rate;
            }
        }
        let arriving = rider.neuromuscular.acceleration(1.0, 0.0, 0.0);
        Self { matrix, arriving, signal }
    }

    /// The closed loop without delay.
    fn closed(&self) -> Matrix<RIDDEN> {
        let mut closed = self.matrix;
        for (x, signal) in closed[RIDDEN - 1].iter_mut().zip(self.signal) {
            *x += self.arriving * signal;
        }
        closed
    }
}

/// The index of the rider's torque in the state.
const TORQUE: usize = 8;

/// The linear motion of bicycle and rider with a neural delay of a whole number of steps.
struct Delayed<'a> {
    ridden: &'a Ridden,
    transition: Matrix<DELAYED>,
    step_s: f64,
    /// The signals of one delay at whole steps, in a ring: the next is the one that arrives now.
    arriving: Vec<f64>,
    next: usize,
}

impl<'a> Delayed<'a> {
    /// From the state `x` at the time `t`, and the signals before.
    fn new(
        ridden: &'a Ridden,
        (delay_s, step_s): (f64, f64),
        t: f64,
        x: &[f64; RIDDEN],
        history: &SignalHistory,
    ) -> Self {
        let mut matrix = [[0.0; DELAYED]; DELAYED];
        for (row, from) in matrix.iter_mut().zip(&ridden.matrix) {
            row[..RIDDEN].copy_from_slice(from);
        }
        matrix[RIDDEN - 1][RIDDEN] = ridden.arriving;
        matrix[RIDDEN][RIDDEN + 1] = 1.0;
        let mut history = history.clone();
        history.push(t, dot(&ridden.signal, x));
        let steps = (delay_s / step_s).round() as usize;
        let arriving = (0..steps).map(|i| history.at(t - delay_s + i as f64 * step_s)).collect();
        Self { ridden, transition: exponential(&matrix, step_s), step_s, arriving, next: 0 }
    }

    /// The state one step after `x`.
    fn step(&mut self, x: &[f64; RIDDEN]) -> [f64; RIDDEN] {
        let now = self.arriving[self.next];
        self.arriving[self.next] = dot(&self.ridden.signal, x);
        self.next = (self.next + 1) % self.arriving.len();
        let slope = (self.arriving[self.next] - now) / self.step_s;
        let z: [f64; DELAYED] =
            std::array::from_fn(|i| x.get(i).copied().unwrap_or(if i == RIDDEN { now } else { slope }));
        std::array::from_fn(|i| dot(&self.transition[i], &z))
    }
}

fn dot<const N: usize>(a: &[f64; N], x: &[f64; N]) -> f64 {
    let mut sum = 0.0;
    for k in 0..N {
        sum += a[k] * x[k];
    }
    sum
}

fn times<const N: usize>(a: &Matrix<N>, x: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| dot(&a[i], x))
}

/// Time derivatives of roll, steer and their rates by these four, and by a torque on the steer axis.
type BicycleMatrix = [[f64; BICYCLE + 1]; BICYCLE];

/// The linearised accelerations of roll and steer of upright riding: derivatives of the nonlinear equations by the entries
/// of [`BicycleMatrix`].
struct Upright([[f64; 2]; BICYCLE + 1]);

impl Upright {
    /// At a forward speed \[m/s\].
    fn new(b: &Geometry, speed: f64) -> Self {
        let upright = State::upright(b, Dual::constant(speed));
        let variable = Dual { re: 0.0, eps: 1.0 };
        let zero = Dual::constant(0.0);
        let derivative = |state: &State<Dual>, steer: Dual| {
            let motion = Motion::new(b, state);
            let acc = motion.accelerations(b, &Torques { roll: zero, steer });
            [acc.roll.eps, acc.steer.eps]
        };
        Self([
            derivative(&State { roll: variable, ..upright }, zero),
            derivative(&State { steer: variable, ..upright }, zero),
            derivative(&State { roll_rate: variable, ..upright }, zero),
            derivative(&State { steer_rate: variable, ..upright }, zero),
            derivative(&upright, variable),
        ])
    }

    /// Under the steer torque `gain` times the roll rate, delayed by `delay_s` to first order; `None` if not finite.
    fn under(&self, gain: f64, delay_s: f64) -> Option<BicycleMatrix> {
        let torque = self.0[BICYCLE];
        let mut a = [[0.0; BICYCLE + 1]; BICYCLE];
        (a[0][2], a[1][3]) = (1.0, 1.0);
        // T = gain (p - delay dp/dt), and dp/dt contains torque[0] T.
        let share = 1.0 + gain * delay_s * torque[0];
        for (j, column) in self.0.iter().enumerate() {
            let rate = f64::from(u8::from(j == 2));
            let steer_nm = gain * (rate - delay_s * column[0]) / share;
            a[2][j] = column[0] + torque[0] * steer_nm;
            a[3][j] = column[1] + torque[1] * steer_nm;
        }
        a.iter().flatten().all(|x| x.is_finite()).then_some(a)
    }
}

/// The matrix exponential of `a h`, by its series: `h` times the largest eigenvalue is below one.
fn exponential<const N: usize>(a: &Matrix<N>, h: f64) -> Matrix<N> {
    const TERMS: u32 = 14;
    let mut sum = [[0.0; N]; N];
    (0..N).for_each(|i| sum[i][i] = 1.0);
    let mut term = sum;
    for n in 1..=TERMS {
        let scale = h / f64::from(n);
        let before = term;
        for (row, before) in term.iter_mut().zip(&before) {
            *row = [0.0; N];
            for (factor, a) in before.iter().zip(a) {
                for (x, a) in row.iter_mut().zip(a) {
                    *x += factor * scale * a;
                }
            }
        }
        for (row, add) in sum.iter_mut().zip(&term) {
            row.iter_mut().zip(add).for_each(|(x, y)| *x += y);
        }
    }
    sum
}
