//! Sensors against each other: what no single sensor can know to be wrong.
//!
//! The relations are the kinematics of a bicycle that rolls without slip, pitch and the contacts'
//! wandering left out. Inside the basins of `h`, alone and with riders, that leaves up to 0.28 m/s
//! between the wheels and 0.80 rad/s of yaw unexplained (`data/motion.toml`); the tolerances must lie above.

use crate::fault::{Cause, Causes};
use crate::input::Believed;
use crate::maths::{at_least, at_most, per_root, sin_cos};
use crate::param::{Leaf, Visit};

/// The tolerances. Each check is off by default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossConfig {
    /// Wheelbase \[m\].
    pub wheelbase_m: f32,
    /// Steer axis tilt \[rad\].
    pub tilt_rad: f32,
    /// Largest difference of front wheel speed times the cosine of the steer angle on the ground from
    /// the rear wheel's speed \[m/s\].
    pub wheels_m_s: Option<f32>,
    /// Largest difference of the yaw rate from the one that speed and steer angle make \[rad/s\].
    pub yaw_rad_s: Option<f32>,
    /// Largest difference of the turned steer angle from the summed steer rate \[rad\].
    pub steer_rad: Option<f32>,
    /// Largest difference of the drive's torque from what it was asked for in the last periods \[N m\].
    pub motor_nm: Option<f32>,
    /// How long a difference must last \[control periods\].
    pub persist_ticks: u16,
}

impl Default for CrossConfig {
    /// All off; the geometry of a city bicycle.
    fn default() -> Self {
        Self {
            wheelbase_m: 1.06,
            tilt_rad: 0.32,
            wheels_m_s: None,
            yaw_rad_s: None,
            steer_rad: None,
            motor_nm: None,
            persist_ticks: 0,
        }
    }
}

impl CrossConfig {
    /// Shows every parameter.
    pub fn leaves<V: Visit>(&mut self, to: &mut V) {
        let g = "cross";
        to.number(&Leaf::new(g, "wheelbase_m", 0.5, 3.0), &mut self.wheelbase_m);
        to.number(&Leaf::new(g, "tilt_rad", -0.5, 1.0), &mut self.tilt_rad);
        to.limit(&Leaf::new(g, "wheels_m_s", 0.01, 10.0), &mut self.wheels_m_s);
        to.limit(&Leaf::new(g, "yaw_rad_s", 0.01, 20.0), &mut self.yaw_rad_s);
        to.limit(&Leaf::new(g, "steer_rad", 0.001, 3.0), &mut self.steer_rad);
        to.limit(&Leaf::new(g, "motor_nm", 0.01, 50.0), &mut self.motor_nm);
        to.count(&Leaf::new(g, "persist_ticks", 0.0, 1000.0), &mut self.persist_ticks);
    }
}

/// What follows from the parameters and the rate of calls alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossPlan {
    period_s: f32,
    per_wheelbase: f32,
    tilt_sin_cos: (f32, f32),
    /// The tolerances, infinite where a check is off \[m/s, rad/s, rad, N m\].
    wheels_m_s: f32,
    yaw_rad_s: f32,
    steer_rad: f32,
    motor_nm: f32,
}

impl CrossPlan {
    /// For `rate_hz` calls a second.
    pub fn new(config: &CrossConfig, rate_hz: f32) -> Self {
        Self {
            period_s: 1.0 / rate_hz,
            per_wheelbase: 1.0 / config.wheelbase_m,
            tilt_sin_cos: sin_cos(config.tilt_rad),
            wheels_m_s: config.wheels_m_s.unwrap_or(f32::INFINITY),
            yaw_rad_s: config.yaw_rad_s.unwrap_or(f32::INFINITY),
            steer_rad: config.steer_rad.unwrap_or(f32::INFINITY),
            motor_nm: config.motor_nm.unwrap_or(f32::INFINITY),
        }
    }
}

/// What the checks remember.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrossState {
    wheels: Lasting,
    yaw: Lasting,
    steer: Lasting,
    motor: Lasting,
    /// Steer angle less the summed steer rate, drifting slowly to the present one \[rad\].
    offset_rad: Option<f32>,
    /// Least and largest torque asked for in the last periods \[N m\].
    asked_nm: (f32, f32),
}

/// Counts how long something lasts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Lasting(u16);

impl Lasting {
    /// Whether a `difference` beyond the `limit` has lasted longer than allowed. What can't be
    /// compared breaks off the count.
    fn beyond(&mut self, limit: f32, difference: Option<f32>, persist_ticks: u16) -> bool {
        match difference {
            Some(difference) if difference.abs() > limit => {
                self.0 = self.0.saturating_add(1);
                self.0 > persist_ticks
            }
            _ => {
                self.0 = 0;
                false
            }
        }
    }
}

/// What the checks found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crossed {
    /// The disagreements that have lasted.
    pub causes: Causes,
    /// Of [`on_the_ground`], if the steer angle is known.
    pub ground: Option<(f32, f32)>,
}

/// How quickly the sums forget: the part of the difference that one period takes away.
const FORGET: f32 = 1.0 / 256.0;

/// One control period: the sensors, sine and cosine of the roll angle as estimated, and the torque asked for in
/// the period before, in the bicycle's sign \[N m\].
pub fn step(
    config: &CrossConfig,
    plan: &CrossPlan,
    state: &mut CrossState,
    believed: &Believed,
    roll_sin_cos: (f32, f32),
    torque_nm: f32,
) -> Crossed {
    let mut causes = Causes::NONE;
    let persist = config.persist_ticks;
    let front = believed.front_wheel_m_s().map(|v| v.newest);
    let rear = believed.rear_wheel_m_s().map(|v| v.newest);
    let ground = believed.steer_rad().map(|steer| on_the_ground(plan, roll_sin_cos, steer));

    let wheels = match (front, rear, ground) {
        (Some(front), Some(rear), Some((_, cos))) => Some(front * cos - rear),
        _ => None,
    };
    causes.note(Cause::WheelsDisagree, state.wheels.beyond(plan.wheels_m_s, wheels, persist));

    // The front wheel moves sideways by its speed times the sine; without it the rear one must do.
    let sideways = match (front, rear, ground) {
        (Some(front), _, Some((sin, _))) => Some(front * sin),
        (None, Some(rear), Some((sin, cos))) if cos > 0.2 => Some(rear * sin / cos),
        _ => None,
    };
    let yaw = match (sideways, believed.gyro_rad_s()) {
        (Some(sideways), Some([_, y, z])) => {
            let (sin, cos) = roll_sin_cos;
            Some(y * sin + z * cos - sideways * plan.per_wheelbase)
        }
        _ => None,
    };
    causes.note(Cause::YawDisagrees, state.yaw.beyond(plan.yaw_rad_s, yaw, persist));

    let steer = match (believed.steer_rad(), believed.steer_rate_rad_s()) {
        (Some(angle), Some(rate)) => {
            let expected = state.offset_rad.unwrap_or(angle) + rate * plan.period_s;
            let difference = angle - expected;
            state.offset_rad = Some(expected + FORGET * difference);
            Some(difference)
        }
        _ => {
            state.offset_rad = None;
            None
        }
    };
    causes.note(Cause::SteerDisagrees, state.steer.beyond(plan.steer_rad, steer, persist));

    let (low, high) = state.asked_nm;
    let motor = believed.motor_torque_nm().map(|given| {
        if given > high {
            given - high
        } else if given < low {
            given - low
        } else {
            0.0
        }
    });
    causes.note(Cause::MotorDisagrees, state.motor.beyond(plan.motor_nm, motor, persist));
    let closer = |bound: f32| bound + 4.0 * FORGET * (torque_nm - bound);
    state.asked_nm = (at_most(torque_nm, closer(low)), at_least(torque_nm, closer(high)));
    Crossed { causes, ground }
}

/// Sine and cosine of the angle between the front wheel's and the rear frame's tracks on the ground:
/// the steer angle turned about the tilted axis, leaned by an angle of which sine and cosine are given.
pub fn on_the_ground(plan: &CrossPlan, roll_sin_cos: (f32, f32), steer_rad: f32) -> (f32, f32) {
    let ((sin_tilt, cos_tilt), (sin_roll, cos_roll)) = (plan.tilt_sin_cos, roll_sin_cos);
    let (sin_steer, cos_steer) = sin_cos(steer_rad);
    let (across, along) = (cos_tilt * sin_steer, cos_steer * cos_roll - sin_tilt * sin_steer * sin_roll);
    let square = across * across + along * along;
    if square > 1e-6 {
        let per = per_root(square);
        (across * per, along * per)
    } else {
        (0.0, 1.0)
    }
}
