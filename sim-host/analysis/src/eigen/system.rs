//! Bicycle, assist and rider as one linear system with one delay.

use super::actuator::{ActuatorError, LinearActuator};
use super::feedback::{Feedback, StaticFeedback};
use super::qr::spectrum;
use control::Law;
use nalgebra::{Complex, ComplexField, DMatrix, DVector, RowDVector};
use physics::bicycle::{Parameters, linear::Linear};
use physics::rider::{Gains, Rider};

/// `x' = a x + b z(t - delay)`, `z = k x`; in the usual form `A0 = a`, `A1 = b k`. Only the signal `z` is
/// delayed.
#[derive(Clone, Debug, PartialEq)]
pub struct DelaySystem {
    /// Matrix of the undelayed feedback.
    pub a: DMatrix<f64>,
    /// Input vector of the delayed signal.
    pub b: DVector<f64>,
    /// Row vector that forms the signal.
    pub k: RowDVector<f64>,
    /// The delay \[s\]; 0 gives an ordinary system.
    pub delay_s: f64,
}

impl DelaySystem {
    /// The characteristic matrix `s I - a - b k exp(-s delay)`, singular at a root `s` \[1/s\].
    pub fn characteristic(&self, s: Complex<f64>) -> DMatrix<Complex<f64>> {
        let late = ComplexField::exp(-s * self.delay_s);
        DMatrix::from_fn(self.a.nrows(), self.a.ncols(), |i, j| {
            let diagonal = if i == j { s } else { Complex::ZERO };
            diagonal - self.a[(i, j)] - late * (self.b[i] * self.k[j])
        })
    }

    /// The system matrix without the delay.
    pub fn undelayed(&self) -> DMatrix<f64> {
        &self.a + &self.b * &self.k
    }

    /// The eigenvalues of `a`, in no order: those of a system without a delayed signal. `None` as [`spectrum`].
    pub fn spectrum(&self) -> Option<Vec<Complex<f64>>> {
        spectrum(&self.a)
    }

    /// Whether the delay has no effect.
    pub(super) fn is_ordinary(&self) -> bool {
        self.delay_s == 0.0 || self.b.amax() == 0.0 || self.k.amax() == 0.0
    }
}

/// A bicycle with an assist and optionally a rider, at any speed.
///
/// The states are, in this order: roll, steer, roll rate, steer rate; with a rider, those of integral of
/// roll, integral of steer, heading and lateral deviation of the front contact that a gain needs, then
/// neuromuscular torque and its rate; with an actuator that has a lag, its torque.
#[derive(Clone, Debug)]
pub struct Model {
    linear: Linear,
    /// Wheelbase \[m\], trail times the cosine of the steer axis tilt \[m\], that cosine.
    path: (f64, f64, f64),
    feedback: Feedback,
    actuator: LinearActuator,
    rider: Option<Rider>,
    /// Whether integral of roll, integral of steer, heading, lateral deviation are states.
    integrals: [bool; 4],
}

/// Indices in [`physics::rider::KEYS`] of the gains of [`Model::integrals`].
const INTEGRAL_KEYS: [usize; 4] = [1, 5, 8, 9];

impl Model {
    /// The linear model of a bicycle, an assist and a rider.
    pub fn new(p: &Parameters, feedback: Feedback, rider: Option<Rider>) -> Self {
        let used = |key: usize| {
            rider.iter().any(|r| r.schedule.points().iter().any(|(_, gains)| gains.0[key] != 0.0))
        };
        let mut integrals = INTEGRAL_KEYS.map(used);
        // The lateral deviation needs the heading.
        integrals[2] |= integrals[3];
        let cos = libm::cos(p.lam);
        let path = (p.w, p.c * cos, cos);
        Self { linear: Linear::new(p), path, feedback, actuator: LinearActuator::default(), rider, integrals }
    }

    /// The same with an actuator. Its inertia becomes part of the bicycle.
    ///
    /// # Errors
    /// A value out of its range, or an actuator delay together with a rider: the analysis allows one delayed
    /// signal.
    pub fn with_actuator(mut self, actuator: LinearActuator) -> Result<Self, ActuatorError> {
        actuator.check()?;
        if actuator.delay_s > 0.0 && self.rider.is_some() {
            return Err(ActuatorError::TwoDelays);
        }
        self.linear.m[(1, 1)] += actuator.inertia_kg_m2;
        self.actuator = actuator;
        Ok(self)
    }

    /// The bicycle.
    pub fn linear(&self) -> &Linear {
        &self.linear
    }

    /// Source of the roots beyond the bicycle's four.
    pub(super) fn adds(&self) -> &'static str {
        if self.rider.is_some() { "rider" } else { "actuator" }
    }

    /// The law, if there is no other feedback.
    pub(super) fn law_alone(&self) -> Option<&Law> {
        let exact = LinearActuator { inertia_kg_m2: self.actuator.inertia_kg_m2, ..Default::default() };
        match (&self.feedback, &self.rider) {
            (Feedback::Law(law), None) if self.actuator == exact => Some(law),
            _ => None,
        }
    }

    /// The system at speed `v` \[m/s\].
    pub fn at(&self, v: f64) -> DelaySystem {
        self.scaled(v, 1.0)
    }

    /// The system at speed `v` \[m/s\] with all feedback, of assist and rider, multiplied by `strength`.
    pub(super) fn scaled(&self, v: f64, strength: f64) -> DelaySystem {
        let extra = self.integrals.iter().filter(|used| **used).count();
        let late = usize::from(self.actuator.time_constant_s > 0.0);
        let with_rider = 4 + if self.rider.is_some() { extra + 2 } else { 0 };
        let n = with_rider + late;
        let of_torque = self.linear.steer_torque_response();
        let StaticFeedback { roll, roll_rate } = self.feedback.at(v);
        let scale = self.actuator.scale * strength;
        let (roll, roll_rate) = (roll * scale, roll_rate * scale);
        let (mut a, mut b, mut k) = (DMatrix::zeros(n, n), DVector::zeros(n), RowDVector::zeros(n));
        let at_once = late == 0 && self.actuator.delay_s == 0.0;
        let mut bicycle = self.linear.state_matrix(v, if at_once { roll_rate } else { 0.0 });
        for row in 0..2 {
            if at_once {
                bicycle[(2 + row, 0)] += of_torque[row] * roll;
            }
            bicycle[(2 + row, 3)] -= of_torque[row] * self.actuator.viscous_nm_s_rad * strength;
        }
        a.view_mut((0, 0), (4, 4)).copy_from(&bicycle);
        if !at_once {
            self.add_actuator(&mut a, &mut b, &mut k, (roll, roll_rate));
        }
        let Some(rider) = &self.rider else { return DelaySystem { a, b, k, delay_s: self.actuator.delay_s } };

        let torque = with_rider - 2;
        a[(2, torque)] = of_torque[0];
        a[(3, torque)] = of_torque[1];
        let neuromuscular = rider.neuromuscular;
        a[(torque, torque + 1)] = 1.0;
        a[(torque + 1, torque)] = -neuromuscular.omega_rad_s.powi(2);
        a[(torque + 1, torque + 1)] = -2.0 * neuromuscular.zeta * neuromuscular.omega_rad_s;
        b[torque + 1] = neuromuscular.omega_rad_s.powi(2);
        let places = self.add_integrals(&mut a, v);

        let Gains(gains) = rider.schedule.at(v);
        // Roll and steer, their rates, and their accelerations from the bicycle's equations.
        for (key, state) in [(0, 0), (4, 1), (2, 2), (6, 3)] {
            k[state] += gains[key];
        }
        k += a.row(2) * gains[3] + a.row(3) * gains[7];
        for (key, place) in INTEGRAL_KEYS.into_iter().zip(places) {
            if let Some(state) = place {
                k[state] += gains[key];
            }
        }
        k *= strength;
        DelaySystem { a, b, k, delay_s: rider.delay_s }
    }

    /// Writes the actuator's response to the torque requested by `gains` of roll and roll rate.
    fn add_actuator(
        &self,
        a: &mut DMatrix<f64>,
        b: &mut DVector<f64>,
        k: &mut RowDVector<f64>,
        gains: (f64, f64),
    ) {
        let of_torque = self.linear.steer_torque_response();
        let LinearActuator { delay_s, time_constant_s, .. } = self.actuator;
        let (mut enters, mut requested) = (b.clone(), k.clone());
        (requested[0], requested[2]) = gains;
        if time_constant_s > 0.0 {
            let torque = a.nrows() - 1;
            a[(2, torque)] = of_torque[0];
            a[(3, torque)] = of_torque[1];
            a[(torque, torque)] = -1.0 / time_constant_s;
            enters[torque] = 1.0 / time_constant_s;
        } else {
            (enters[2], enters[3]) = (of_torque[0], of_torque[1]);
        }
        if delay_s > 0.0 {
            (*b, *k) = (enters, requested);
        } else {
            *a += enters * requested;
        }
    }

    /// Writes the rows of the integrals in use; returns their indices in the state.
    fn add_integrals(&self, a: &mut DMatrix<f64>, v: f64) -> [Option<usize>; 4] {
        let (w, trail, cos) = self.path;
        let mut next = 4..;
        let places = self.integrals.map(|used| if used { next.next() } else { None });
        for (state, place) in places[..2].iter().enumerate() {
            if let Some(row) = place {
                a[(*row, state)] = 1.0;
            }
        }
        if let Some(heading) = places[2] {
            a[(heading, 1)] = v * cos / w;
            a[(heading, 3)] = trail / w;
            if let Some(lateral) = places[3] {
                // The rear contact's v psi plus the front contact's motion about it: the terms of the trail
                // cancel.
                a[(lateral, heading)] = v;
                a[(lateral, 1)] = v * cos;
            }
        }
        places
    }
}
