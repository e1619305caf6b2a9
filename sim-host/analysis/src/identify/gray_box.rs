//! The gray box: a linear bicycle at constant speed under a lateral force and a steer torque disturbance, closed by a
//! delayed rider whose feedback gains are unknown (Kuipers 2020, figure 2.4).

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};
use physics::bicycle::linear::Linear;
use physics::rider::{KEYS, Neuromuscular};

/// The number of gains that are identified: the first of [`KEYS`], on roll (p, i, d, dd), then on steer. Gains on
/// heading and lateral deviation need a measured path and are not part of the thesis's rider.
pub const GAINS: usize = 8;

/// A value for each gain, in the order of [`KEYS`].
pub type PerGain = [f64; GAINS];

/// Symbols of the gains.
pub fn symbols() -> &'static [&'static str] {
    &KEYS[..GAINS]
}

/// Number of states: roll, steer, their rates, their integrals, the rider's torque and its rate.
pub(super) const STATES: usize = 8;
/// Number of disturbances: lateral force \[N\], steer torque \[N m\].
pub(super) const INPUTS: usize = 2;

pub(super) type StateMatrix = SMatrix<f64, STATES, STATES>;
pub(super) type InputMatrix = SMatrix<f64, STATES, INPUTS>;

/// Bicycle, speed, delay and neuromuscular dynamics: everything of the closed loop but the gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrayBox {
    /// The linear bicycle.
    pub bicycle: Linear,
    /// Generalised forces on roll and steer per unit of lateral force \[m\].
    pub force_input: Vector2<f64>,
    /// The rider's neuromuscular dynamics.
    pub neuromuscular: Neuromuscular,
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
    /// Effective neural delay \[s\].
    pub delay_s: f64,
}

/// `x' = a x + alpha * neural signal + input * disturbance`; the feedback signals are `c x + d * disturbance`.
pub(super) struct OpenLoop {
    pub(super) a: StateMatrix,
    pub(super) alpha: SVector<f64, STATES>,
    pub(super) input: InputMatrix,
    pub(super) c: SMatrix<f64, GAINS, STATES>,
    pub(super) d: SMatrix<f64, GAINS, INPUTS>,
}

impl GrayBox {
    /// Stiffness of roll and steer at the speed \[N m/rad\].
    pub(super) fn stiffness(&self) -> Matrix2<f64> {
        self.bicycle.k0 * self.bicycle.g + self.bicycle.k2 * self.speed_m_s.powi(2)
    }

    /// The loop opened at the neural signal.
    pub(super) fn open_loop(&self) -> OpenLoop {
        let of_steer_torque = self.bicycle.steer_torque_response();
        let of_force = self.bicycle.acceleration(self.force_input);
        let (w, zeta) = (self.neuromuscular.omega_rad_s, self.neuromuscular.zeta);
        let mut a = StateMatrix::zeros();
        a.fixed_view_mut::<4, 4>(0, 0).copy_from(&self.bicycle.state_matrix(self.speed_m_s, 0.0));
        a.fixed_view_mut::<2, 1>(2, 6).copy_from(&of_steer_torque);
        (a[(4, 0)], a[(5, 1)], a[(6, 7)]) = (1.0, 1.0, 1.0);
        (a[(7, 6)], a[(7, 7)]) = (-w * w, -2.0 * zeta * w);
        let mut alpha = SVector::zeros();
        alpha[7] = w * w;
        let mut input = InputMatrix::zeros();
        input.fixed_view_mut::<2, 1>(2, 0).copy_from(&of_force);
        input.fixed_view_mut::<2, 1>(2, 1).copy_from(&of_steer_torque);
        let mut c = SMatrix::<f64, GAINS, STATES>::zeros();
        let mut d = SMatrix::<f64, GAINS, INPUTS>::zeros();
        for (angle, first) in [(0, 0), (1, 4)] {
            c[(first, angle)] = 1.0;
            c[(first + 1, 4 + angle)] = 1.0;
            c[(first + 2, 2 + angle)] = 1.0;
            c.set_row(first + 3, &a.row(2 + angle));
            d.set_row(first + 3, &input.row(2 + angle));
        }
        OpenLoop { a, alpha, input, c, d }
    }
}
