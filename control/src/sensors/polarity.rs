//! Polarity check before riding. A sign error makes the assist steer out of the fall, so engagement requires a passed
//! check.
//!
//! With the motor off, a person beside the bicycle leans it to the right, turns the handlebar to the right and pushes
//! the bicycle forward, in this order. Leaning and turning count only while the bicycle stands. Every sensor must
//! respond with the right sign, and the torque that the law would request during the lean must be to the right.

use crate::sensors::measurements::{Measurements, SpeedInterval};
use crate::sensors::validation::ValidationConfig;

crate::numbered! {
    /// Next step of the polarity check.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    #[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
    pub enum PolarityStep {
        /// Lean the bicycle to the right, by a quarter of a radian or more.
        #[default]
        Lean = 0,
        /// Turn the handlebar to the right, by a third of a radian or more.
        Steer = 1,
        /// Push the bicycle forward, at a slow walk.
        Push = 2,
        /// None: the check was passed.
        Passed = 3,
        /// None: a sign is wrong. The calibration must be corrected; the check restarts at the next start-up.
        Wrong = 4,
    }
}

/// Minimum roll angle of a lean to the right \[rad\].
const LEAN_RAD: f32 = 0.25;
/// Minimum specific force to the left in such a lean \[m/s^2\]: less than half of gravity's component.
const FORCE_M_S2: f32 = 1.0;
/// Minimum turn of the handlebar \[rad\].
const STEER_RAD: f32 = 0.3;
/// Minimum speed of a push; below it the bicycle stands \[m/s\].
const PUSH_M_S: f32 = 0.3;
/// Minimum torque of the hand on the handlebar \[N m\].
const HAND_NM: f32 = 0.2;
/// Leak time constant of the integrated rates \[s\]: a bias does not add up to a movement.
const FORGET_S: f32 = 2.0;
/// Speed at which the law's gain is taken; the published laws balance there \[m/s\].
pub const GAIN_SPEED_M_S: f32 = 4.0;

/// State of the polarity check.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct PolarityState {
    /// Next step of the polarity check.
    pub next: PolarityStep,
    /// Integrated rate of the movement \[rad\].
    integrated_rad: f32,
    /// Steer angle at the start of the movement \[rad\].
    start_rad: Option<f32>,
}

/// Sign of one sensor's response to a movement.
#[derive(Clone, Copy, PartialEq)]
enum SignAgreement {
    Undecided,
    Right,
    Wrong,
}

impl SignAgreement {
    /// Compares a value with `threshold`: right from it upwards, wrong from its negative downwards.
    fn of(value: f32, threshold: f32) -> Self {
        if value >= threshold {
            SignAgreement::Right
        } else if value <= -threshold {
            SignAgreement::Wrong
        } else {
            SignAgreement::Undecided
        }
    }

    /// Compares a sensor's value; a sensor that is not fitted counts as right, an invalid one as undecided.
    fn fitted(fitted: bool, value: Option<f32>, threshold: f32) -> Self {
        match value {
            Some(value) => SignAgreement::of(value, threshold),
            None if fitted => SignAgreement::Undecided,
            None => SignAgreement::Right,
        }
    }
}

/// One control period without torque, from calibrated sensors. `gain_nm_s_rad` is the law's gain at [`GAIN_SPEED_M_S`].
pub fn step(
    input: &ValidationConfig,
    period_s: f32,
    state: &mut PolarityState,
    measurements: &Measurements,
    gain_nm_s_rad: f32,
) {
    let roll_rate = measurements.gyro_rad_s().map(|[x, ..]| x);
    let wheels = [measurements.front_wheel_m_s(), measurements.rear_wheel_m_s()];
    let stands = wheels.iter().any(Option::is_some)
        && wheels.iter().flatten().all(|speed| speed.newest.abs() < PUSH_M_S);
    if !stands && matches!(state.next, PolarityStep::Lean | PolarityStep::Steer) {
        // The check does not advance while riding, and a fall to the right must not pass it.
        *state = PolarityState { next: state.next, ..PolarityState::default() };
        return;
    }
    let rate = match state.next {
        PolarityStep::Lean => roll_rate,
        PolarityStep::Steer => measurements.steer_rate_rad_s(),
        _ => None,
    };
    state.integrated_rad += period_s * (rate.unwrap_or(0.0) - state.integrated_rad / FORGET_S);
    let integrated = state.integrated_rad;
    let agreement = match state.next {
        PolarityStep::Lean => {
            let force = measurements.accel_m_s2().map(|[_, y, _]| -y);
            let leans = SignAgreement::of(integrated, LEAN_RAD);
            let law = if gain_nm_s_rad < 0.0 { SignAgreement::Wrong } else { SignAgreement::Right };
            // The accelerometer is compared only once there is a lean.
            match leans {
                SignAgreement::Undecided => [leans, leans, leans],
                _ => [leans, SignAgreement::fitted(input.accel.fitted, force, FORCE_M_S2), law],
            }
        }
        PolarityStep::Steer => {
            let steered = measurements.steer_rad().map(|now| now - *state.start_rad.get_or_insert(now));
            let rate = measurements.steer_rate_rad_s().map(|_| integrated);
            [
                SignAgreement::fitted(input.steer.fitted, steered, STEER_RAD),
                SignAgreement::fitted(input.steer_rate.fitted, rate, STEER_RAD),
                SignAgreement::fitted(input.rider_torque.fitted, measurements.rider_torque_nm(), HAND_NM),
            ]
        }
        PolarityStep::Push => {
            let speed = |bounds: Option<SpeedInterval>| bounds.map(|b| b.newest);
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
        PolarityStep::Passed | PolarityStep::Wrong => return,
    };
    let next = if agreement.contains(&SignAgreement::Wrong) {
        PolarityStep::Wrong
    } else if agreement.iter().all(|s| *s == SignAgreement::Right) {
        match state.next {
            PolarityStep::Lean => PolarityStep::Steer,
            PolarityStep::Steer => PolarityStep::Push,
            _ => PolarityStep::Passed,
        }
    } else {
        return;
    };
    *state = PolarityState { next, ..PolarityState::default() };
}
