//! Output of a control step.

use crate::fault::Causes;
use crate::safety::engagement::Mode;
use crate::safety::limits::ActiveLimits;

/// Requested motor torque and the reasons for it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct Command {
    /// Steer torque in the motor's sign ([`crate::Calibration::motor_reversed`]) \[N m\]. Always finite.
    pub torque_nm: f32,
    /// Gain of the law \[N m s/rad\]; 0 while the authority is 0, or speed or roll rate is unknown or
    /// not yet aligned.
    pub gain_nm_s_rad: f32,
    /// Limits that changed the torque.
    pub limits: ActiveLimits,
    /// Mode of the controller.
    pub mode: Mode,
    /// All causes present: those that forbid or reduce torque, and those that are only reported.
    pub causes: Causes,
}
