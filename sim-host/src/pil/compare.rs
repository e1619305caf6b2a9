//! Compares rides and basins on a board with the same computed on the host, bit for bit.

use crate::basin::{Basin, Column};
use crate::ride::{
    Assist, Conditions, Remote, RemoteError, Ride, Start, Stepped, TracePoint, frames, traced,
};
use control::wire::{encode_command, encode_frame};
use control::{Plan, SensorFrame, State};
use std::fmt::Debug;

/// The first difference, as text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct Difference(pub String);

/// Records every control step of a controller.
pub struct Recorder<'a> {
    remote: &'a mut dyn Remote,
    /// The frames and their answers, from the controller's boot.
    pub steps: Vec<(SensorFrame, Stepped)>,
}

impl<'a> Recorder<'a> {
    /// A recorder around this controller.
    pub fn new(remote: &'a mut dyn Remote) -> Self {
        Self { remote, steps: Vec::new() }
    }
}

impl Remote for Recorder<'_> {
    fn begin(&mut self, plan: &Plan, start: &Start) -> Result<(), RemoteError> {
        self.steps.clear();
        self.remote.begin(plan, start)
    }

    fn disturb(&mut self) {
        self.remote.disturb();
    }

    fn step(&mut self, frame: &SensorFrame) -> Result<Stepped, RemoteError> {
        let stepped = self.remote.step(frame)?;
        self.steps.push((*frame, stepped));
        Ok(stepped)
    }
}

/// Compares a ride on a board with the same ride on the host: every frame, command and authority from the controller's
/// boot, every instant of the trace, and the outcome.
///
/// # Errors
/// The first difference.
pub fn same_ride(
    conditions: &Conditions,
    steps: &[(SensorFrame, Stepped)],
    ride: &Ride,
    trace: &[TracePoint],
) -> Result<(), Difference> {
    let (ride_here, trace_here) = traced(conditions, ride.start);
    let steps_here = stepped_here(conditions, &frames(conditions, ride.start, &trace_here));
    for (step, (here, there)) in steps_here.iter().zip(steps).enumerate() {
        let at = |what: &str| format!("{what} of control step {step}");
        same_by(&at("the frame"), &here.0, &there.0, &encode_frame(&here.0), &encode_frame(&there.0))?;
        let (a, b) = (&here.1.command, &there.1.command);
        same_by(&at("the command"), a, b, &encode_command(a), &encode_command(b))?;
        let (a, b) = (here.1.authority, there.1.authority);
        same_by(&at("the authority"), &a, &b, &a.to_bits(), &b.to_bits())?;
    }
    same("the number of control steps", &steps_here.len(), &steps.len())?;
    for (here, there) in trace_here.iter().zip(trace) {
        same(&format!("the motion at {} s", here.t), here, there)?;
    }
    same("the number of instants", &trace_here.len(), &trace.len())?;
    same("the ride's end", &ride_here, ride)
}

/// The host controller's answers to the frames.
fn stepped_here(conditions: &Conditions, frames: &[SensorFrame]) -> Vec<(SensorFrame, Stepped)> {
    let Assist::Firmware(plan) = &conditions.assist else { return Vec::new() };
    let mut state = State::default();
    let mut step = |frame: &SensorFrame| {
        let command = control::step(plan, &mut state, frame);
        (*frame, Stepped { command, authority: state.authority() })
    };
    frames.iter().map(&mut step).collect()
}

/// Compares a basin ridden on boards with the same on the host; `there` may have fewer speeds.
///
/// # Errors
/// The first difference.
pub fn same_basin(here: &Basin, there: &Basin) -> Result<(), Difference> {
    for column in &there.columns {
        let here = here.columns.iter().find(|c| c.speed.to_bits() == column.speed.to_bits());
        let none = || Difference(format!("there is no speed {} m/s here", column.speed));
        same_column(here.ok_or_else(none)?, column)?;
    }
    Ok(())
}

fn same_column(here: &Column, there: &Column) -> Result<(), Difference> {
    let Column { speed, upper, capped, islands, scan, outcome, border, beyond, work } = here;
    let at = |what: &str| format!("{what} at {speed} m/s");
    same(&at("the upper border"), upper, &there.upper)?;
    same(&at("whether nothing falls"), capped, &there.capped)?;
    same(&at("the islands"), islands, &there.islands)?;
    for (a, b) in scan.iter().zip(&there.scan) {
        same(&at(&format!("the ride from {} rad/s", a.rate)), a, b)?;
    }
    same(&at("the number of rides"), &scan.len(), &there.scan.len())?;
    same(&at("the outcome at the border"), outcome, &there.outcome)?;
    same(&at("the ride at the border"), border, &there.border)?;
    same(&at("the fall beyond it"), beyond, &there.beyond)?;
    same(&at("the work"), work, &there.work)
}

/// Compares by debug text, which differs for any two numbers, including 0 and -0.
fn same<T: Debug>(what: &str, here: &T, there: &T) -> Result<(), Difference> {
    same_by(what, here, there, &format!("{here:?}"), &format!("{there:?}"))
}

/// Compares by bits.
fn same_by<T: Debug, B: PartialEq>(
    what: &str,
    here: &T,
    there: &T,
    bits_here: &B,
    bits_there: &B,
) -> Result<(), Difference> {
    if bits_here == bits_there {
        return Ok(());
    }
    Err(Difference(format!("{what}: here {here:?}, on the board {there:?}")))
}
