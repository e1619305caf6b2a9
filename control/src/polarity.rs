//! The polarity check: a sign error steers out of the fall, so nobody engages before this was passed.
//!
//! With the motor off, somebody beside the bicycle leans it to the right, turns the handlebar to the right and
//! pushes the bicycle forward, in this order; the first two count only while it stands. What each sensor says of it must have the right sign, and the
//! torque the law would ask for while it leans must be to the right.

use crate::input::{Believed, InputConfig};

/// What is to be done next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Move {
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
pub const SHOWN_AT_M_S: f32 = 4.0;

/// What the check remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolarityState {
    /// What is to be done next.
    pub next: Move,
    /// Sum of the rate of the move \[rad\].
    summed_rad: f32,
    /// Steer angle at the start of the move \[rad\].
    from_rad: Option<f32>,
}

/// What one sensor says of a move.
#[derive(Clone, Copy, PartialEq)]
enum Says {
    Nothing,
    Right,
    Wrong,
}

impl Says {
    /// By a value that must become `enough` or more, and nowhere as much the other way.
    fn of(value: f32, enough: f32) -> Self {
        if value >= enough {
            Says::Right
        } else if value <= -enough {
            Says::Wrong
        } else {
            Says::Nothing
        }
    }

    /// By a sensor: one that is not fitted agrees to all, one that is not believed says nothing.
    fn fitted(fitted: bool, value: Option<f32>, enough: f32) -> Self {
        match value {
            Some(value) => Says::of(value, enough),
            None if fitted => Says::Nothing,
            None => Says::Right,
        }
    }
}

/// One control period without torque, from calibrated sensors. `gain_nm_s_rad` is the law's at
/// [`SHOWN_AT_M_S`]. Returns the torque shown: what the law would ask for, in the bicycle's sign \[N m\].
pub fn step(
    input: &InputConfig,
    period_s: f32,
    state: &mut PolarityState,
    believed: &Believed,
    gain_nm_s_rad: f32,
) -> f32 {
    let roll_rate = believed.gyro_rad_s().map(|[x, ..]| x);
    let shown_nm = gain_nm_s_rad * roll_rate.unwrap_or(0.0);
    let wheels = [believed.front_wheel_m_s(), believed.rear_wheel_m_s()];
    let stands = wheels.iter().any(Option::is_some)
        && wheels.iter().flatten().all(|speed| speed.newest.abs() < PUSH_M_S);
    if !stands && matches!(state.next, Move::Lean | Move::Steer) {
        // A ride is no check, and a fall to the right none at all.
        *state = PolarityState { next: state.next, ..PolarityState::default() };
        return shown_nm;
    }
    let rate = match state.next {
        Move::Lean => roll_rate,
        Move::Steer => believed.steer_rate_rad_s(),
        _ => None,
    };
    state.summed_rad += period_s * (rate.unwrap_or(0.0) - state.summed_rad / FORGET_S);
    let summed = state.summed_rad;
    let said = match state.next {
        Move::Lean => {
            let force = believed.accel_m_s2().map(|[_, y, _]| -y);
            let leans = Says::of(summed, LEAN_RAD);
            let law = if gain_nm_s_rad < 0.0 { Says::Wrong } else { Says::Right };
            // The force tells the lean only as far as there is one.
            match leans {
                Says::Nothing => [leans, leans, leans],
                _ => [leans, Says::fitted(input.accel.fitted, force, FORCE_M_S2), law],
            }
        }
        Move::Steer => {
            let turned = believed.steer_rad().map(|now| now - *state.from_rad.get_or_insert(now));
            let rate = believed.steer_rate_rad_s().map(|_| summed);
            [
                Says::fitted(input.steer.fitted, turned, STEER_RAD),
                Says::fitted(input.steer_rate.fitted, rate, STEER_RAD),
                Says::fitted(input.rider_torque.fitted, believed.rider_torque_nm(), HAND_NM),
            ]
        }
        Move::Push => {
            let speed = |bounds: Option<crate::input::Bounds>| bounds.map(|b| b.newest);
            [
                Says::fitted(input.front_wheel.fitted, speed(believed.front_wheel_m_s()), PUSH_M_S),
                Says::fitted(input.rear_wheel.fitted, speed(believed.rear_wheel_m_s()), PUSH_M_S),
                Says::Right,
            ]
        }
        Move::Passed | Move::Wrong => return shown_nm,
    };
    let next = if said.contains(&Says::Wrong) {
        Move::Wrong
    } else if said.iter().all(|s| *s == Says::Right) {
        match state.next {
            Move::Lean => Move::Steer,
            Move::Steer => Move::Push,
            _ => Move::Passed,
        }
    } else {
        return shown_nm;
    };
    *state = PolarityState { next, ..PolarityState::default() };
    shown_nm
}
