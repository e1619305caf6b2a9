//! NetCDF file of `ride`.

use super::active::{ACTIVE, active_causes, active_limits, cause_names, limit_names, mode_names};
use super::variable::outcome_flags;
use super::{File, Values, Variable, fall_flags, switch_flags};
use crate::report::tool::Tool;
use crate::ride::{FallCause, Ride, TracePoint};

/// A number of a point in time: its name, unit, meaning and value.
type Number = (&'static str, &'static str, &'static str, fn(&TracePoint) -> f64);

const NUMBERS: [Number; 15] = [
    ("t", "s", "time since the disturbance", |p| p.t),
    ("roll", "rad", "roll of the rear frame to the right", |p| p.roll),
    ("steer", "rad", "steer angle to the right", |p| p.steer),
    ("pitch", "rad", "pitch of the rear frame", |p| p.pitch),
    ("roll_rate", "rad s-1", "rate of roll", |p| p.roll_rate),
    ("steer_rate", "rad s-1", "rate of steer", |p| p.steer_rate),
    ("yaw_rate", "rad s-1", "rate of yaw to the right", |p| p.yaw_rate),
    ("rear_wheel_rate", "rad s-1", "rate of the rear wheel about its axle, negative forward", |p| {
        p.rear_wheel_rate
    }),
    ("rear_speed", "m s-1", "forward speed of the rear wheel", |p| p.rear_speed),
    ("front_speed", "m s-1", "forward speed of the front wheel", |p| p.front_speed),
    ("measured_roll_rate", "rad s-1", "rate of roll as received by the controller", |p| p.measured_roll_rate),
    ("measured_speed", "m s-1", "speed as received by the controller", |p| p.measured_speed),
    ("torque", "N m", "steer torque commanded by the assist, positive to the right", |p| p.torque),
    ("rider_torque", "N m", "steer torque of the rider", |p| p.rider_torque),
    ("motor_torque", "N m", "steer torque of the motor in the middle of the period", |p| p.motor_torque),
];

/// The file of a ride: the columns of its table over `t`, limits and causes as a flag each, and the outcome.
pub fn ride(title: &str, attributes: Vec<(&'static str, String)>, ride: &Ride, trace: &[TracePoint]) -> File {
    let number = |&(name, units, long_name, of): &Number| {
        Variable::numbers((name, units, long_name), &["t"], trace.iter().map(of).collect())
    };
    let mut variables: Vec<Variable> = NUMBERS.iter().map(number).collect();
    let (causes, numbers) = cause_names().into_iter().map(|(name, number)| (name, f64::from(number))).unzip();
    variables.extend([
        Variable::new(
            ("mode", "mode of the controller"),
            &["t"],
            Values::Flags(mode_names(), trace.iter().map(|p| p.mode).collect()),
        ),
        Variable::new(("limit", "limits of the torque"), &["limit"], Values::Texts(limit_names())),
        Variable::new(
            ("limit_active", "whether a limit changed the torque"),
            &["t", "limit"],
            switch_flags(ACTIVE, trace.iter().flat_map(|p| active_limits(p.limits))),
        ),
        Variable::new(("cause", "causes that prevent or reduce torque"), &["cause"], Values::Texts(causes)),
        Variable::numbers(("cause_number", "1", "number of the cause"), &["cause"], numbers),
        Variable::new(
            ("cause_active", "whether a cause prevented or reduced torque"),
            &["t", "cause"],
            switch_flags(ACTIVE, trace.iter().flat_map(|p| active_causes(p.causes))),
        ),
        Variable::new(("outcome", "outcome of the ride"), NONE, outcome_flags([ride.outcome])),
        Variable::new(
            ("fall", "reason for which the ride counts as fallen"),
            NONE,
            fall_flags([ride.outcome.fall().map(FallCause::name)]),
        ),
        Variable::numbers(
            ("time_to_fall", "s", "time of the fall since the disturbance"),
            NONE,
            vec![ride.outcome.time_to_fall_s().unwrap_or(f64::NAN)],
        ),
    ]);
    File { title: title.into(), tool: Tool::this(), attributes, variables }
}

/// The dimensions of a single value.
const NONE: &[&str] = &[];
