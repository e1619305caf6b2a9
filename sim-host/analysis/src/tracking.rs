//! Gains of `control::law::path_tracking`, from bicycle, speed, law gain and weights: the linear-quadratic
//! regulator of the linearised bicycle stabilised by the law.

use crate::exponential::exponential_of;
use nalgebra::{Matrix1, RowSVector, SMatrix, SVector};
use physics::bicycle::Parameters;
use physics::bicycle::linear::Linear;

const N: usize = 7;
type Square = SMatrix<f64, N, N>;

/// Weights of the quadratic cost: the integral of the weighted squares is minimised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Weight of a lateral deviation of 1 m.
    pub lateral: f64,
    /// Weight of its integral of 1 m s.
    pub integral: f64,
    /// Weight of a torque of 1 N m.
    pub torque: f64,
}

impl Default for Weights {
    /// 1 m weighs as much as 1 N m: a deviation of half a metre is corrected with a small part of the torque
    /// that balance may need. The integral has a fiftieth of the weight: it acts slowly compared with the
    /// return to the path.
    fn default() -> Self {
        Self { lateral: 1.0, integral: 0.02, torque: 1.0 }
    }
}

/// Control period of the design \[s\].
const PERIOD_S: f64 = 1e-3;

/// The linearised bicycle on a straight path: state matrix, and input vector of the steer torque \[N m\].
///
/// The state is roll, steer, their rates, heading error, lateral deviation of the rear contact, and its
/// integral. Yaw rate is `(v steer + c steer rate) cos(lam) / w` (Meijaard et al. 2007, eq. B7).
pub fn on_path(p: &Parameters, v: f64, law_gain: f64) -> (Square, SVector<f64, N>) {
    let linear = Linear::new(p);
    let mut a = Square::zeros();
    a.fixed_view_mut::<4, 4>(0, 0).copy_from(&linear.state_matrix(v, law_gain));
    let turn = libm::cos(p.lam) / p.w;
    a[(4, 1)] = v * turn;
    a[(4, 3)] = p.c * turn;
    a[(5, 4)] = v;
    a[(6, 5)] = 1.0;
    let mut b = SVector::<f64, N>::zeros();
    b.fixed_rows_mut::<2>(2).copy_from(&linear.steer_torque_response());
    (a, b)
}

/// Feedback gains at a speed \[m/s\]: the torque is minus their product with the state of [`on_path`].
///
/// Discretised at 1 kHz with zero-order hold. The Riccati equation is solved by structure-preserving doubling
/// (Chu, Fan, Lin and Wang 2004), which converges quadratically.
pub fn gains(p: &Parameters, v: f64, law_gain: f64, weights: &Weights) -> RowSVector<f64, N> {
    let (a, b) = on_path(p, v, law_gain);
    // Discretises a and b together: the exponential of [[a, b], [0, 0]].
    let mut both = SMatrix::<f64, 8, 8>::zeros();
    both.fixed_view_mut::<N, N>(0, 0).copy_from(&(a * PERIOD_S));
    both.fixed_view_mut::<N, 1>(0, N).copy_from(&(b * PERIOD_S));
    let sampled = exponential_of(&both);
    let a: Square = sampled.fixed_view::<N, N>(0, 0).into();
    let b: SVector<f64, N> = sampled.fixed_view::<N, 1>(0, N).into();
    let torque = weights.torque * PERIOD_S;

    let mut turn = a;
    let mut reach = b * b.transpose() / torque;
    let mut cost = Square::zeros();
    cost[(5, 5)] = weights.lateral * PERIOD_S;
    cost[(6, 6)] = weights.integral * PERIOD_S;
    for _ in 0..40 {
        let Some(w) = (Square::identity() + reach * cost).lu().try_inverse() else { break };
        let (next_reach, next_cost) =
            (reach + turn * w * reach * turn.transpose(), cost + turn.transpose() * cost * w * turn);
        turn = turn * w * turn;
        (reach, cost) = (next_reach, next_cost);
        if turn.amax() < 1e-14 {
            break;
        }
    }
    let weight = Matrix1::new(torque) + b.transpose() * cost * b;
    b.transpose() * cost * a / weight[(0, 0)]
}
