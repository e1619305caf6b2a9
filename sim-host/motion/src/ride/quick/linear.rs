//! The linear motion near upright riding: derivatives of the nonlinear equations, and its steps.

use crate::bicycle::{Accelerations, Geometry, Motion, State, Torques};
use crate::num::{Dual, Scalar};
use crate::rider::{Instant, Rider, RiderState, SignalHistory};

/// A square matrix by rows.
pub(super) type Matrix<const N: usize> = [[f64; N]; N];
/// Roll, steer, roll rate and steer rate.
pub(super) const BICYCLE: usize = 4;
/// The same, then the entries of [`RiderState`] in their order.
pub(super) const RIDDEN: usize = 10;
/// The same, then the arriving neural signal and its slope over time.
const DELAYED: usize = 12;
/// Bicycle and rider, without the path from the neural signal to the one that arrives.
pub(super) struct Ridden {
    matrix: Matrix<RIDDEN>,
    /// Time derivative of the torque rate by the arriving signal \[1/s^2\].
    arriving: f64,
    /// The neural signal before its delay by the state.
    signal: [f64; RIDDEN],
}

impl Ridden {
    /// A bicycle at a forward speed \[m/s\], and a rider at the speed that schedules the gains; `sensed` is the bicycle of
    /// the rider's signals.
    pub(super) fn new(
        (b, speed): (&Geometry, f64),
        (rider, scheduled): (&Rider, f64),
        bicycle: &BicycleMatrix,
        sensed: &BicycleMatrix,
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
                roll: dual(of_row(sensed, 2)),
                steer: dual(of_row(sensed, 3)),
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
    pub(super) fn closed(&self) -> Matrix<RIDDEN> {
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
pub(super) struct Delayed<'a> {
    ridden: &'a Ridden,
    transition: Matrix<DELAYED>,
    step_s: f64,
    /// The signals of one delay at whole steps, in a ring: the next is the one that arrives now.
    arriving: Vec<f64>,
    next: usize,
}

impl<'a> Delayed<'a> {
    /// From the state `x` at the time `t`, and the signals before.
    pub(super) fn new(
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
    pub(super) fn step(&mut self, x: &[f64; RIDDEN]) -> [f64; RIDDEN] {
        let now = self.arriving[self.next];
        self.arriving[self.next] = dot(&self.ridden.signal, x);
        self.next = (self.next + 1) % self.arriving.len();
        let slope = (self.arriving[self.next] - now) / self.step_s;
        let mut z = [0.0; DELAYED];
        z[..RIDDEN].copy_from_slice(x);
        (z[RIDDEN], z[RIDDEN + 1]) = (now, slope);
        let mut after = *x;
        after.iter_mut().zip(&self.transition).for_each(|(x, row)| *x = dot(row, &z));
        after
    }
}

fn dot<const N: usize>(a: &[f64; N], x: &[f64; N]) -> f64 {
    let mut sum = 0.0;
    for k in 0..N {
        sum += a[k] * x[k];
    }
    sum
}

pub(super) fn times<const N: usize>(a: &Matrix<N>, x: &[f64; N]) -> [f64; N] {
    let mut product = *x;
    product.iter_mut().zip(a).for_each(|(y, row)| *y = dot(row, x));
    product
}

/// Time derivatives of roll, steer and their rates by these four, and by a torque on the steer axis.
pub(super) type BicycleMatrix = [[f64; BICYCLE + 1]; BICYCLE];

/// The linearised accelerations of roll and steer of upright riding, by the entries of [`BicycleMatrix`].
type Derivatives = [[f64; 2]; BICYCLE + 1];

/// These at every forward speed: those by the angles are a constant and a part proportional to the square of the speed (gravity and
/// centrifugal effects), those by the rates proportional to the speed (gyroscopic effects), those by the torque constant
/// (Meijaard 2007, eq. 5.3).
#[derive(Clone, Debug)]
pub(super) struct Upright {
    at_rest: Derivatives,
    at_one_m_s: Derivatives,
}

impl Upright {
    /// From the nonlinear equations at rest and at 1 m/s.
    pub(super) fn new(b: &Geometry) -> Self {
        Self { at_rest: derivatives(b, 0.0), at_one_m_s: derivatives(b, 1.0) }
    }

    /// The derivatives at a forward speed \[m/s\].
    fn at(&self, speed: f64) -> Derivatives {
        let grows = [speed * speed, speed * speed, speed, speed, 0.0];
        std::array::from_fn(|j| {
            let (rest, one) = (self.at_rest[j], self.at_one_m_s[j]);
            [0, 1].map(|i| rest[i] + (one[i] - rest[i]) * grows[j])
        })
    }

    /// At a forward speed \[m/s\] under the steer torque `gain` times the roll rate, delayed by `delay_s` to first order; `None`
    /// if not finite.
    pub(super) fn under(&self, speed: f64, gain: f64, delay_s: f64) -> Option<BicycleMatrix> {
        let derivatives = self.at(speed);
        let torque = derivatives[BICYCLE];
        let mut a = [[0.0; BICYCLE + 1]; BICYCLE];
        (a[0][2], a[1][3]) = (1.0, 1.0);
        // T = gain (p - delay dp/dt), and dp/dt contains torque[0] T.
        let share = 1.0 + gain * delay_s * torque[0];
        for (j, column) in derivatives.iter().enumerate() {
            let rate = f64::from(u8::from(j == 2));
            let steer_nm = gain * (rate - delay_s * column[0]) / share;
            a[2][j] = column[0] + torque[0] * steer_nm;
            a[3][j] = column[1] + torque[1] * steer_nm;
        }
        a.iter().flatten().all(|x| x.is_finite()).then_some(a)
    }
}

/// The derivatives of the nonlinear equations at a forward speed \[m/s\].
fn derivatives(b: &Geometry, speed: f64) -> Derivatives {
    let upright = State::upright(b, Dual::constant(speed));
    let variable = Dual { re: 0.0, eps: 1.0 };
    let zero = Dual::constant(0.0);
    let derivative = |state: &State<Dual>, steer: Dual| {
        let motion = Motion::new(b, state);
        let acc = motion.accelerations(b, &Torques { roll: zero, steer });
        [acc.roll.eps, acc.steer.eps]
    };
    [
        derivative(&State { roll: variable, ..upright }, zero),
        derivative(&State { steer: variable, ..upright }, zero),
        derivative(&State { roll_rate: variable, ..upright }, zero),
        derivative(&State { steer_rate: variable, ..upright }, zero),
        derivative(&upright, variable),
    ]
}

/// The matrix exponential of `a h`, by its series: `h` times the largest eigenvalue is below one.
pub(super) fn exponential<const N: usize>(a: &Matrix<N>, h: f64) -> Matrix<N> {
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

#[cfg(test)]
mod tests {
    use super::{Upright, derivatives};
    use crate::bicycle::{Geometry, Parameters};

    /// Riding at any speed: the derivatives of the nonlinear equations there are the polynomials through those at two speeds.
    #[test]
    fn two_speeds_give_the_derivatives_at_every_speed() {
        let shipped = physics::bicycle::catalogue::load("rigid_jason").unwrap().parameters.to_values();
        let b = Geometry::new(&Parameters::from_values(&shipped));
        let upright = Upright::new(&b);
        for i in 0..=60 {
            let speed = 0.25 * f64::from(i);
            for (of_two, exact) in
                upright.at(speed).iter().flatten().zip(derivatives(&b, speed).iter().flatten())
            {
                assert!(
                    (of_two - exact).abs() < 1e-9 * (1.0 + exact.abs()),
                    "at {speed} m/s: {of_two} for {exact}"
                );
            }
        }
    }
}
