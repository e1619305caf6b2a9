//! Does the frame yaw and roll as speed and steer angle make it?
//!
//! * **Yaw**: a bicycle of wheelbase `w` that rolls without slip yaws at `Y = v tan(steer) / w`. The slope of the measured
//!   rate over this one is 1; a negative one is a wrong sign of gyro or steer sensor.
//! * **Roll**: who steers to one side is pushed to the other. For a mass at the height `h`, `b` before the rear contact,
//!   `roll'' - g roll / h = -(v Y + b Y') / h`. Both sides of it correlate; a negative correlation is a wrong sign of the
//!   gyro's x axis or of the steer sensor. An accelerometer shows less of that in a fall: where it sits, falling and
//!   leaning almost cancel.
//! * **A wheel that stands**: below [`STANDING_M_S`] the slope over the yaw rate at
//!   [`MOVES_M_S`] is the true speed in parts of that one.

use crate::estimate::Place;
use crate::fault::{Cause, Causes};
use crate::maths::G;
use crate::sensors::regression::{STRETCH_S, Slope, SlopeConfig, SlopePlan, Stretch};
use core::hint::cold_path;

/// The yaw rate \[rad/s\]. What is slower than a second is left out: a steer sensor's zero, a bias of the gyro.
const YAW: SlopeConfig =
    SlopeConfig { highpass_s: 1.0, forget_s: 1.0, max_measured: 5.0, min_excitation: 0.002, settle_s: 0.0 };
/// The roll acceleration \[rad/s^2\]. Of a single stretch the correlation is 1 or -1, of four it means something.
const ROLL: SlopeConfig =
    SlopeConfig { highpass_s: 1.0, forget_s: 0.5, max_measured: 20.0, min_excitation: 0.005, settle_s: 0.2 };
/// Below this slope the gyro or the steer sensor has the wrong sign. On recorded rides of two bicycles it stays above 0
/// where both are right, also with a steer sensor whose scale is wrong by 1.6.
pub const YAW_WRONG: f32 = -0.4;
/// Below this correlation the gyro's x axis or the steer sensor has the wrong sign. On recorded rides of two bicycles it
/// stays above -0.51 where both are right, inside the basins of `h` above 0.7.
pub const ROLL_WRONG: f32 = -0.7;
/// A change of the roll acceleration from one stretch to the next by more than this \[rad/s^2\] and so many times what steering
/// explains is a blow, after which all begins anew: the steering that answers a blow goes with it, not against it.
const BLOW_RAD_S2: f32 = 3.0;
const BLOW_TIMES: f32 = 3.0;
/// Above this speed by yaw rate and steer angle a wheel that stands is wrong \[m/s\].
pub const MOVES_M_S: f32 = 1.5;
/// Speed above which a bicycle is ridden, and neither led nor turned by hand \[m/s\].
pub const RIDING_M_S: f32 = 1.0;
/// Speed below which a wheel stands \[m/s\].
const STANDING_M_S: f32 = 0.3;

/// What a wheel says of the bicycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Wheel {
    /// It is ridden.
    Rides,
    /// It stands.
    Stands,
    /// It may be led or turned by hand: nothing is judged.
    #[default]
    Creeps,
}

impl Wheel {
    fn at(speed_m_s: f32) -> Self {
        if speed_m_s > RIDING_M_S {
            Self::Rides
        } else if speed_m_s.abs() < STANDING_M_S {
            Self::Stands
        } else {
            Self::Creeps
        }
    }
}

/// Length of a stretch \[s\]: six of the motor's response, so that the noise of a gyro makes little acceleration.
const LENGTH_S: f32 = 6.0 * STRETCH_S;
/// At which control period of a stretch it ends: none of those in which a slope of `response` is told, so that no
/// period has to do both.
pub(super) const END_TICK: u16 = 2;
/// And in which the roll is judged, for the same reason another one.
pub(super) const ROLL_TICK: u16 = 10;

/// What follows from the parameters and the rate of calls alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SteeringPlan {
    checks_yaw: bool,
    checks_roll: bool,
    /// Control periods of a stretch.
    pub(super) stretch_ticks: u16,
    per_height: f32,
    forward_m: f32,
    yaw: SlopePlan,
    roll: SlopePlan,
}

impl SteeringPlan {
    pub(super) fn new(checks_yaw: bool, checks_roll: bool, mass: &Place, rate_hz: f32) -> Self {
        // At most 480 at the fastest rate there is, and an even number: two looks of `same` fit in.
        let stretch_ticks = ((LENGTH_S * rate_hz) as u16 & !1).max(14);
        let dt_s = f32::from(stretch_ticks) / rate_hz;
        Self {
            checks_yaw,
            checks_roll,
            stretch_ticks,
            // As if no mass were lower than 0.1 m.
            per_height: 1.0 / if mass.up_m > 0.1 { mass.up_m } else { 0.1 },
            forward_m: mass.forward_m,
            yaw: SlopePlan::new(YAW, dt_s),
            roll: SlopePlan::new(ROLL, dt_s),
        }
    }
}

/// What is remembered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Steering {
    /// Expected and measured yaw rate, roll rate.
    stretch: Stretch<3>,
    /// In this stretch, and in the one before.
    wheel: Wheel,
    yaw: Slope,
    roll: Slope,
    /// Both sides of the roll's equation at the stretch before.
    roll_before: Option<[f32; 2]>,
    /// By how much they have changed, until that is judged.
    roll_change: Option<[f32; 2]>,
    roll_wrong: bool,
    causes: Causes,
}

impl Steering {
    /// A control period: the speed \[m/s\], the yaw rate that each m/s of it makes \[rad/m\], and those measured
    /// about the vertical and about the frame's x axis \[rad/s\].
    #[inline]
    pub(super) fn add(&mut self, speed_m_s: f32, per_speed: f32, yaw_rad_s: f32, x_rad_s: f32) {
        let wheel = Wheel::at(speed_m_s);
        if wheel != self.wheel {
            cold_path();
            *self = Self { wheel, ..Self::default() };
        }
        let rides = wheel == Wheel::Rides;
        if wheel != Wheel::Creeps {
            let speed_m_s = if rides { speed_m_s } else { MOVES_M_S };
            self.stretch.add([speed_m_s * per_speed, yaw_rad_s, x_rad_s]);
        }
    }

    /// Whether the bicycle is ridden, neither led nor turned by hand.
    #[inline]
    pub(super) fn rides(&self) -> bool {
        self.wheel == Wheel::Rides
    }

    /// The end of a stretch, at this speed \[m/s\]: all is judged anew. A wheel that stands is the rear one where that
    /// one is known.
    pub(super) fn end(&mut self, plan: &SteeringPlan, speed_m_s: f32, rear: bool) {
        let Some((now, before)) = self.stretch.end() else { return };
        let ([expected, measured, rate], [expected_before, measured_before, rate_before]) = (now, before);
        let (turned, more) = (expected - expected_before, rate - rate_before);
        self.causes = Causes::NONE;
        if plan.checks_yaw {
            let slope = self.yaw.step(&plan.yaw, turned, measured - measured_before);
            if self.wheel == Wheel::Rides {
                self.causes.note(Cause::YawDisagrees, slope.is_some_and(|slope| slope < YAW_WRONG));
            } else if slope.is_some_and(|slope| slope > 1.0) {
                cold_path();
                self.causes.note(if rear { Cause::RearWheelStuck } else { Cause::FrontWheelStuck }, true);
            }
        }
        if plan.checks_roll && self.wheel == Wheel::Rides {
            let per_s = 1.0 / plan.roll.dt_s;
            let middle = 0.5 * speed_m_s * (expected + expected_before);
            let expected_accel = -plan.per_height * (middle + plan.forward_m * turned * per_s);
            let accelerated = more * per_s;
            let leaned = G * plan.per_height * plan.roll.dt_s * rate_before;
            let last = self.roll_before.replace([expected_accel, accelerated]);
            self.roll_change = last.map(|[expected_accel_before, accelerated_before]| {
                [expected_accel - expected_accel_before, accelerated - accelerated_before - leaned]
            });
        }
    }

    /// Some periods after the end of a stretch: the roll is judged anew.
    pub(super) fn check_roll(&mut self, plan: &SteeringPlan) {
        let Some([expected, measured]) = self.roll_change.take() else { return };
        if measured.abs() > BLOW_RAD_S2 + BLOW_TIMES * expected.abs() {
            cold_path();
            self.roll = Slope::default();
        } else {
            let _ = self.roll.step(&plan.roll, expected, measured);
        }
        self.roll_wrong = self.roll_correlation().is_some_and(|correlation| correlation < ROLL_WRONG);
    }

    /// What was found when each was judged last.
    pub(super) fn causes(&self) -> Causes {
        let mut causes = self.causes;
        causes.note(Cause::GyroDisagrees, self.roll_wrong);
        causes
    }

    /// The slope of the yaw rate while the bicycle is ridden.
    pub(super) fn yaw_slope(&self) -> Option<f32> {
        self.yaw.value(&YAW).filter(|_| self.wheel == Wheel::Rides)
    }

    /// The correlation of the roll.
    pub(super) fn roll_correlation(&self) -> Option<f32> {
        self.roll.correlation(&ROLL)
    }
}
