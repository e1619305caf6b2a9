//! The polarity check: a sign error steers out of the fall, so nobody engages before this was passed.
//!
//! With the motor off, somebody beside the bicycle leans it to the right, turns the handlebar to the right and
//! pushes the bicycle forward, in this order; the first two count only while it stands. What each sensor says of it must have the right sign, and the
//! torque the law would ask for while it leans must be to the right.

use crate::sensors::validation::{Measurements, ValidationConfig};

/// What is to be done next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum PolarityStep {
    /// Lean the bicycle to the right, by a quarter of a radian or more.
    #[default]
    Lean = 0,
    /// Turn the handlebar to the right, by a third of a radian or more.
    Steer = 1,
    /// Push the bicycle forward, at a slow walk.
    Push = 2,
    /// Nothing: the check was passed.
    Passed = 3,
    /// Nothing: a sign is wrong. The calibration must be mended; the check begins anew at the next start.
    Wrong = 4,
}

/// Lean to the right that counts \[rad\].
const LEAN_RAD: f32 = 0.25;
/// Specific force to the left that so much lean makes at least \[m/s^2\]: less than a half of gravity's part.
const FORCE_M_S2: f32 = 1.0;
/// Turn of the handlebar that counts \[rad\].
const STEER_RAD: f32 = 0.3;
/// Speed that counts as pushed; below it the bicycle stands \[m/s\].
const PUSH_M_S: f32 = 0.3;
/// Torque of the hand on the handlebar that counts \[N m\].
const HAND_NM: f32 = 0.2;
/// Time constant by which summed rates forget \[s\]: no bias sums up to a move.
const FORGET_S: f32 = 2.0;
/// Speed whose gain is asked for; the published laws balance there \[m/s\].
pub const GAIN_SPEED_M_S: f32 = 4.0;

/// What the check remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolarityState {
    /// What is to be done next.
    pub next: PolarityStep,
    /// Sum of the rate of the move \[rad\].
    summed_rad: f32,
    /// Steer angle at the start of the move \[rad\].
    from_rad: Option<f32>,
}

/// What one sensor says of a move.
#[derive(Clone, Copy, PartialEq)]
enum SignAgreement {
    Nothing,
    Right,
    Wrong,
}

impl SignAgreement {
    /// By a value that must become `enough` or more, and nowhere as much the other way.
    fn of(value: f32, enough: f32) -> Self {
        if value >= enough {
            SignAgreement::Right
        } else if value <= -enough {
            SignAgreement::Wrong
        } else {
            SignAgreement::Nothing
        }
    }

    /// By a sensor: one that is not fitted agrees to all, one that is not believed says nothing.
    fn fitted(fitted: bool, value: Option<f32>, enough: f32) -> Self {
        match value {
            Some(value) => SignAgreement::of(value, enough),
            None if fitted => SignAgreement::Nothing,
            None => SignAgreement::Right,
        }
    }
}

/// One control period without torque, from calibrated sensors. `gain_nm_s_rad` is the law's at
/// [`GAIN_SPEED_M_S`]. Returns the torque shown: what the law would ask for, in the bicycle's sign \[N m\].
pub fn step(
    input: &ValidationConfig,
    period_s: f32,
    state: &mut PolarityState,
    measurements: &Measurements,
    gain_nm_s_rad: f32,
) -> f32 {
    let roll_rate = measurements.gyro_rad_s().map(|[x, ..]| x);
    let hand_torque_nm = gain_nm_s_rad * roll_rate.unwrap_or(0.0);
    let wheels = [measurements.front_wheel_m_s(), measurements.rear_wheel_m_s()];
    let stands = wheels.iter().any(Option::is_some)
        && wheels.iter().flatten().all(|speed| speed.newest.abs() < PUSH_M_S);
    if !stands && matches!(state.next, PolarityStep::Lean | PolarityStep::Steer) {
        // A ride is no check, and a fall to the right none at all.
        *state = PolarityState { next: state.next, ..PolarityState::default() };
        return hand_torque_nm;
    }
    let rate = match state.next {
        PolarityStep::Lean => roll_rate,
        PolarityStep::Steer => measurements.steer_rate_rad_s(),
        _ => None,
    };
    state.summed_rad += period_s * (rate.unwrap_or(0.0) - state.summed_rad / FORGET_S);
    let summed = state.summed_rad;
    let said = match state.next {
        PolarityStep::Lean => {
            let force = measurements.accel_m_s2().map(|[_, y, _]| -y);
            let leans = SignAgreement::of(summed, LEAN_RAD);
            let law = if gain_nm_s_rad < 0.0 { SignAgreement::Wrong } else { SignAgreement::Right };
            // The force tells the lean only as far as there is one.
            match leans {
                SignAgreement::Nothing => [leans, leans, leans],
                _ => [leans, SignAgreement::fitted(input.accel.fitted, force, FORCE_M_S2), law],
            }
        }
        PolarityStep::Steer => {
            let turned = measurements.steer_rad().map(|now| now - *state.from_rad.get_or_insert(now));
            let rate = measurements.steer_rate_rad_s().map(|_| summed);
            [
                SignAgreement::fitted(input.steer.fitted, turned, STEER_RAD),
                SignAgreement::fitted(input.steer_rate.fitted, rate, STEER_RAD),
                SignAgreement::fitted(input.rider_torque.fitted, measurements.rider_torque_nm(), HAND_NM),
            ]
        }
        PolarityStep::Push => {
            let speed = |bounds: Option<crate::sensors::validation::SpeedInterval>| bounds.map(|b| b.newest);
            [
                SignAgreement::fitted(
                    input.front_wheel.fitted,
                    speed(measurements.front_wheel_m_s()),
                    PUSH_M_S,
                ),
                SignAgreement::fitted(
                    input.rear_wheel.fitted,
                    speed(measurements.rear_wheel_m_s()),
                    PUSH_M_S,
                ),
                SignAgreement::Right,
            ]
        }
        PolarityStep::Passed | PolarityStep::Wrong => return hand_torque_nm,
    };
    let next = if said.contains(&SignAgreement::Wrong) {
        PolarityStep::Wrong
    } else if said.iter().all(|s| *s == SignAgreement::Right) {
        match state.next {
            PolarityStep::Lean => PolarityStep::Steer,
            PolarityStep::Steer => PolarityStep::Push,
            _ => PolarityStep::Passed,
        }
    } else {
        return hand_torque_nm;
    };
    *state = PolarityState { next, ..PolarityState::default() };
    hand_torque_nm
}
