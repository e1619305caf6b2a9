//! Checks that the frame yaws and rolls as expected from speed and steer angle.
//!
//! * **Yaw**: a bicycle of wheelbase `w` that rolls without slip yaws at `Y = v tan(steer) / w`. The slope of the
//!   measured over the expected rate is 1; a negative slope is a wrong sign of gyro or steer sensor.
//! * **Roll**: steering to one side accelerates the roll to the other. For a mass at the height `h`, `b` before the
//!   rear contact, `roll'' - g roll / h = -(v Y + b Y') / h`. Both sides correlate; a negative correlation is a wrong
//!   sign of the gyro's x axis or of the steer sensor. An accelerometer would show less of it in a fall: at its
//!   position, fall and lean almost cancel.
//! * **A standing wheel**: below [`STANDING_M_S`] the expected yaw rate is computed at [`MOVING_M_S`]; the slope is
//!   then the true speed divided by [`MOVING_M_S`].

use crate::estimate::Place;
use crate::fault::{Cause, Causes};
use crate::maths::G;
use crate::sensors::regression::{BLOCK_S, BlockMean, Slope, SlopeConfig, SlopePlan};
use core::hint::cold_path;

/// Yaw rate \[rad/s\]. The high-pass of one second removes a steer sensor's zero error and a gyro bias.
const YAW: SlopeConfig =
    SlopeConfig { highpass_s: 1.0, forget_s: 1.0, max_measured: 5.0, min_excitation: 0.002, settle_s: 0.0 };
/// Roll acceleration \[rad/s^2\]. The correlation of a single block is always 1 or -1; four blocks give a meaningful
/// one.
const ROLL: SlopeConfig =
    SlopeConfig { highpass_s: 1.0, forget_s: 0.5, max_measured: 20.0, min_excitation: 0.005, settle_s: 0.2 };
/// Slope below which the gyro or the steer sensor has the wrong sign. On recorded rides of two bicycles it stays above
/// 0 where both are right, even with a steer sensor scale error of 1.6.
pub const YAW_WRONG: f32 = -0.4;
/// Correlation below which the gyro's x axis or the steer sensor has the wrong sign. Where both are right it stays
/// above -0.51 on recorded rides of two bicycles, above 0.7 inside the basins of `h`.
pub const ROLL_WRONG: f32 = -0.7;
/// Impact threshold: a change of the roll acceleration between blocks larger than this \[rad/s^2\] plus `IMPACT_RATIO`
/// times the expected change restarts the correlation. Steering in response to an impact follows its direction instead
/// of opposing it.
const IMPACT_RAD_S2: f32 = 3.0;
const IMPACT_RATIO: f32 = 3.0;
/// Speed, computed from yaw rate and steer angle, above which a standing wheel sensor is faulty \[m/s\].
pub const MOVING_M_S: f32 = 1.5;
/// Speed above which a bicycle is ridden, neither led nor turned by hand \[m/s\].
pub const RIDING_M_S: f32 = 1.0;
/// Speed below which a wheel counts as standing \[m/s\].
const STANDING_M_S: f32 = 0.3;

/// State of motion by the wheel speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
enum WheelState {
    /// Ridden.
    Riding,
    /// Standing.
    Standing,
    /// Possibly led or turned by hand: no check.
    #[default]
    Ambiguous,
}

impl WheelState {
    fn at(speed_m_s: f32) -> Self {
        if speed_m_s > RIDING_M_S {
            Self::Riding
        } else if speed_m_s.abs() < STANDING_M_S {
            Self::Standing
        } else {
            Self::Ambiguous
        }
    }
}

/// Length of a block \[s\]: six motor blocks of `sign_check`, so that a gyro's noise causes little acceleration.
const LENGTH_S: f32 = 6.0 * BLOCK_S;
/// Control period of a block in which the block ends. `sign_check` updates no slope in it, so the work is spread over
/// the periods.
pub(super) const END_TICK: u16 = 2;
/// Control period of a block in which the roll is checked, a different one for the same reason.
pub(super) const ROLL_TICK: u16 = 10;

/// Constants derived from the parameters and the call rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SteeringPlan {
    checks_yaw: bool,
    checks_roll: bool,
    /// Control periods of a block.
    pub(super) block_ticks: u16,
    per_height: f32,
    forward_m: f32,
    yaw: SlopePlan,
    roll: SlopePlan,
}

impl SteeringPlan {
    pub(super) fn new(checks_yaw: bool, checks_roll: bool, mass: &Place, rate_hz: f32) -> Self {
        // At most 480 at the highest rate, and even, so that two checks of `repeats` fit in.
        let block_ticks = ((LENGTH_S * rate_hz) as u16 & !1).max(14);
        let dt_s = f32::from(block_ticks) / rate_hz;
        Self {
            checks_yaw,
            checks_roll,
            block_ticks,
            // Height limited to at least 0.1 m.
            per_height: 1.0 / if mass.up_m > 0.1 { mass.up_m } else { 0.1 },
            forward_m: mass.forward_m,
            yaw: SlopePlan::new(YAW, dt_s),
            roll: SlopePlan::new(ROLL, dt_s),
        }
    }
}

/// State of the steering checks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub(super) struct Steering {
    /// Block means of expected yaw rate, measured yaw rate and roll rate.
    block: BlockMean<3>,
    /// State of motion, the same throughout this block and the previous one.
    wheel: WheelState,
    yaw: Slope,
    roll: Slope,
    /// Expected and measured roll acceleration of the previous block \[rad/s^2\].
    roll_before: Option<[f32; 2]>,
    /// Changes of expected and measured roll acceleration, until [`Steering::check_roll`] uses them \[rad/s^2\].
    roll_change: Option<[f32; 2]>,
    roll_wrong: bool,
    causes: Causes,
}

impl Steering {
    /// Adds a sample: speed \[m/s\], expected yaw rate per speed \[rad/m\], and the rates measured about the vertical
    /// and about the frame's x axis \[rad/s\].
    #[inline]
    pub(super) fn add(&mut self, speed_m_s: f32, yaw_rad_m: f32, yaw_rad_s: f32, roll_rad_s: f32) {
        let wheel = WheelState::at(speed_m_s);
        if wheel != self.wheel {
            cold_path();
            *self = Self { wheel, ..Self::default() };
        }
        let riding = wheel == WheelState::Riding;
        if wheel != WheelState::Ambiguous {
            let speed_m_s = if riding { speed_m_s } else { MOVING_M_S };
            self.block.add([speed_m_s * yaw_rad_m, yaw_rad_s, roll_rad_s]);
        }
    }

    /// Whether the bicycle is ridden, neither led nor turned by hand.
    #[inline]
    pub(super) fn is_riding(&self) -> bool {
        self.wheel == WheelState::Riding
    }

    /// Ends a block at this speed \[m/s\] and repeats the yaw check. `rear` is true for the rear wheel's speed; it
    /// selects the wheel that is reported as stuck.
    pub(super) fn end(&mut self, plan: &SteeringPlan, speed_m_s: f32, rear: bool) {
        let Some((now, before)) = self.block.end() else { return };
        let ([expected, measured, rate], [expected_before, measured_before, rate_before]) = (now, before);
        let (expected_change, rate_change) = (expected - expected_before, rate - rate_before);
        self.causes = Causes::NONE;
        if plan.checks_yaw {
            let slope = self.yaw.step(&plan.yaw, expected_change, measured - measured_before);
            if self.wheel == WheelState::Riding {
                self.causes.note(Cause::YawDisagrees, slope.is_some_and(|slope| slope < YAW_WRONG));
            } else if slope.is_some_and(|slope| slope > 1.0) {
                cold_path();
                self.causes.note(if rear { Cause::RearWheelStuck } else { Cause::FrontWheelStuck }, true);
            }
        }
        if plan.checks_roll && self.wheel == WheelState::Riding {
            let per_s = 1.0 / plan.roll.dt_s;
            let centripetal = 0.5 * speed_m_s * (expected + expected_before);
            let expected_accel = -plan.per_height * (centripetal + plan.forward_m * expected_change * per_s);
            let measured_accel = rate_change * per_s;
            let gravity_change = G * plan.per_height * plan.roll.dt_s * rate_before;
            let last = self.roll_before.replace([expected_accel, measured_accel]);
            self.roll_change = last.map(|[expected_accel_before, measured_accel_before]| {
                [
                    expected_accel - expected_accel_before,
                    measured_accel - measured_accel_before - gravity_change,
                ]
            });
        }
    }

    /// Repeats the roll check, some periods after the end of a block.
    pub(super) fn check_roll(&mut self, plan: &SteeringPlan) {
        let Some([expected, measured]) = self.roll_change.take() else { return };
        if measured.abs() > IMPACT_RAD_S2 + IMPACT_RATIO * expected.abs() {
            cold_path();
            self.roll = Slope::default();
        } else {
            let _ = self.roll.step(&plan.roll, expected, measured);
        }
        self.roll_wrong = self.roll_correlation().is_some_and(|correlation| correlation < ROLL_WRONG);
    }

    /// Causes of the latest yaw and roll checks.
    pub(super) fn causes(&self) -> Causes {
        let mut causes = self.causes;
        causes.note(Cause::GyroDisagrees, self.roll_wrong);
        causes
    }

    /// Slope of the yaw rate, while the bicycle is ridden.
    pub(super) fn yaw_slope(&self) -> Option<f32> {
        self.yaw.value(&YAW).filter(|_| self.wheel == WheelState::Riding)
    }

    /// Correlation of the roll acceleration.
    pub(super) fn roll_correlation(&self) -> Option<f32> {
        self.roll.correlation(&ROLL)
    }
}
