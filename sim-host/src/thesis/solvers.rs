//! Other integrators for the uncontrolled bicycle: two Runge-Kutta methods with fixed steps, and adaptive solvers of a
//! library (appendix D).

use crate::bicycle::{Geometry, Motion, State, Torques};
use crate::integrate::rate;
use differential_equations::prelude::{BackwardDifferentiationFormula, ExplicitRungeKutta, IVP, ODE};
use std::f64::consts::FRAC_PI_2;

/// Roll, steer, their rates and the rear wheel's rate; and the pitch, which depends on the first two, as the initial
/// value of its own iteration.
pub type Entries = [f64; 6];

/// The uncontrolled bicycle as a first-order system.
#[derive(Debug)]
pub struct Free<'a>(pub &'a Geometry);

impl Free<'_> {
    /// The time derivative of every entry.
    pub fn rate(&self, y: &Entries) -> Entries {
        let state = state(y);
        let none = Torques { roll: 0.0, steer: 0.0 };
        let motion = Motion::new(self.0, &state);
        entries(&rate(&state, &motion, &motion.accelerations(self.0, &none)))
    }
}

impl ODE<f64, Entries> for Free<'_> {
    fn diff(&self, _: f64, y: &Entries, rate: &mut Entries) {
        *rate = self.rate(y);
    }
}

fn state(y: &Entries) -> State<f64> {
    let [roll, steer, roll_rate, steer_rate, rear_wheel_rate, pitch] = *y;
    State { roll, steer, roll_rate, steer_rate, rear_wheel_rate, pitch }
}

/// A state's entries.
pub fn entries(s: &State<f64>) -> Entries {
    [s.roll, s.steer, s.roll_rate, s.steer_rate, s.rear_wheel_rate, s.pitch]
}

/// Euclidean distance of two states, without the dependent pitch.
pub fn distance(a: &Entries, b: &Entries) -> f64 {
    a[..5].iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

/// Whether a state is impossible for a riding bicycle.
fn broken(y: &Entries) -> bool {
    !y.iter().all(|x| x.is_finite()) || y[0].abs() >= FRAC_PI_2 || y[1].abs() >= FRAC_PI_2
}

/// An explicit Runge-Kutta method: the stages' weights of earlier slopes, and those of the step.
#[derive(Debug)]
pub struct Tableau {
    /// Its name.
    pub name: &'static str,
    stages: &'static [&'static [f64]],
    weights: &'static [f64],
}

/// The classical method of fourth order (eqs D.1 to D.5).
pub const RK4: Tableau = Tableau {
    name: "RK4",
    stages: &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
    weights: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
};

/// The fifth-order solution of Fehlberg's method (eqs D.6 to D.12; D.11 is printed with 28 in place of 2).
pub const RKF45: Tableau = Tableau {
    name: "RKF45, fifth order",
    stages: &[
        &[],
        &[1.0 / 4.0],
        &[3.0 / 32.0, 9.0 / 32.0],
        &[1932.0 / 2197.0, -7200.0 / 2197.0, 7296.0 / 2197.0],
        &[439.0 / 216.0, -8.0, 3680.0 / 513.0, -845.0 / 4104.0],
        &[-8.0 / 27.0, 2.0, -3544.0 / 2565.0, 1859.0 / 4104.0, -11.0 / 40.0],
    ],
    weights: &[16.0 / 135.0, 0.0, 6656.0 / 12825.0, 28561.0 / 56430.0, -9.0 / 50.0, 2.0 / 55.0],
};

/// The state after `steps` equal steps over `seconds`; `None` if the bicycle fell before.
pub fn fixed(
    problem: &Free,
    method: &Tableau,
    start: &Entries,
    seconds: f64,
    steps: usize,
) -> Option<Entries> {
    let h = seconds / steps as f64;
    let mut y = *start;
    let mut slopes = [[0.0; 6]; 6];
    for _ in 0..steps {
        for (i, before) in method.stages.iter().enumerate() {
            slopes[i] = problem.rate(&moved(&y, h, before, &slopes));
        }
        y = moved(&y, h, method.weights, &slopes);
        if broken(&y) {
            return None;
        }
    }
    Some(y)
}

fn moved(y: &Entries, h: f64, weights: &[f64], slopes: &[Entries; 6]) -> Entries {
    let mut to = *y;
    for (w, slope) in weights.iter().zip(slopes) {
        to.iter_mut().zip(slope).for_each(|(x, k)| *x += h * w * k);
    }
    to
}

/// An adaptive solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adaptive {
    /// Dormand and Prince's fifth order: MATLAB's `ode45`.
    Dopri5,
    /// Dormand and Prince's eighth order.
    Dop853,
    /// Backward differentiation of orders 1 to 5: the family of MATLAB's `ode15s`.
    Bdf,
}

impl Adaptive {
    /// All of them.
    pub const ALL: [Self; 3] = [Adaptive::Dopri5, Adaptive::Bdf, Adaptive::Dop853];

    /// Its name in the report.
    pub fn name(self) -> &'static str {
        match self {
            Adaptive::Dopri5 => "Dormand-Prince 5 (as ode45)",
            Adaptive::Dop853 => "Dormand-Prince 8",
            Adaptive::Bdf => "BDF 1 to 5 (as ode15s)",
        }
    }
}

/// Step limit of an adaptive solution.
const MOST_STEPS: usize = 2_000_000;

/// The state after `seconds` with absolute and relative tolerance `tolerance` and steps up to `h_max`; `None` if the
/// solver gives up or the bicycle fell before.
pub fn adaptive(
    problem: &Free,
    solver: Adaptive,
    start: &Entries,
    seconds: f64,
    tolerance: f64,
    h_max: f64,
) -> Option<Entries> {
    let ivp = IVP::ode(problem, 0.0, seconds, *start);
    let solution = match solver {
        Adaptive::Dopri5 => {
            let method = ExplicitRungeKutta::dopri5().rtol(tolerance).atol(tolerance).h_max(h_max);
            ivp.method(method.max_steps(MOST_STEPS)).solve()
        }
        Adaptive::Dop853 => {
            let method = ExplicitRungeKutta::dop853().rtol(tolerance).atol(tolerance).h_max(h_max);
            ivp.method(method.max_steps(MOST_STEPS)).solve()
        }
        Adaptive::Bdf => {
            let method = BackwardDifferentiationFormula::adaptive().rtol(tolerance).atol(tolerance);
            ivp.method(method.h_max(h_max).max_steps(MOST_STEPS)).solve()
        }
    };
    let solution = solution.ok()?;
    // The library ends without an error if a step fails.
    let whole = solution.t.last().is_some_and(|t| (t - seconds).abs() < 1e-9);
    let fell = solution.y.iter().any(broken);
    solution.y.last().copied().filter(|_| whole && !fell)
}
