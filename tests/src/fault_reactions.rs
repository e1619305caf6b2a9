//! The faults of the fault tests, and the flashed controller on which they act.

use crate::basins::{alone, configured};
use control::{Cause, Config, Mode};
use sim_host::bicycle::onboard::fit;
use sim_host::plant::{Fault, Plant};
use sim_host::ride::Conditions;
use sim_host::rider::{Fit, Outside, Rider, catalogue};

/// A fault, the cause that must be reported, the mode that must follow, and within how many milliseconds of its
/// beginning.
#[derive(Clone, Copy, Debug)]
pub struct FaultReaction(pub &'static str, pub Cause, pub Mode, pub u32);

/// Every fault that is ridden.
#[rustfmt::skip]
pub const FAULT_REACTIONS: &[FaultReaction] = &[
    FaultReaction("gyro:missing@300ms", Cause::GyroLost, Mode::Fault, 12),
    FaultReaction("gyro:nan@300ms", Cause::GyroRange, Mode::Fault, 12),
    FaultReaction("gyro.x:value=40@300ms", Cause::GyroRange, Mode::Fault, 12),
    FaultReaction("gyro.x:jump=5@300ms", Cause::GyroJump, Mode::Fault, 12),
    FaultReaction("gyro.z:jump=-5@300ms", Cause::GyroJump, Mode::Fault, 12),
    FaultReaction("gyro:late=50ms@300ms", Cause::GyroLost, Mode::Fault, 12),
    FaultReaction("gyro:stuck@50ms", Cause::GyroStuck, Mode::Fault, 600),
    FaultReaction("accel:missing@300ms", Cause::AccelLost, Mode::Limp, 22),
    FaultReaction("accel:nan@300ms", Cause::AccelRange, Mode::Limp, 22),
    FaultReaction("accel.y:value=200@300ms", Cause::AccelRange, Mode::Limp, 22),
    FaultReaction("steer:missing@300ms", Cause::SteerLost, Mode::Limp, 22),
    FaultReaction("steer:nan@300ms", Cause::SteerRange, Mode::Limp, 22),
    FaultReaction("steer:value=2@300ms", Cause::SteerRange, Mode::Limp, 22),
    FaultReaction("steer:jump=0.5@300ms", Cause::SteerJump, Mode::Limp, 22),
    FaultReaction("steer:stuck@50ms", Cause::SteerStuck, Mode::Limp, 300),
    FaultReaction("steer:flip@50ms", Cause::YawDisagrees, Mode::Fault, 600),
    FaultReaction("steer-rate:missing@300ms", Cause::SteerRateLost, Mode::Limp, 22),
    FaultReaction("steer-rate:nan@300ms", Cause::SteerRateRange, Mode::Limp, 22),
    FaultReaction("steer-rate:value=-50@300ms", Cause::SteerRateRange, Mode::Limp, 22),
    FaultReaction("steer-rate:flip@50ms", Cause::SteerDisagrees, Mode::Limp, 600),
    FaultReaction("front-wheel:missing@300ms", Cause::FrontWheelLost, Mode::Limp, 252),
    FaultReaction("front-wheel:nan@300ms", Cause::FrontWheelRange, Mode::Limp, 252),
    FaultReaction("front-wheel:value=0@300ms", Cause::FrontWheelJump, Mode::Limp, 252),
    FaultReaction("front-wheel:drift=-2/s@300ms", Cause::WheelsDisagree, Mode::Limp, 800),
    FaultReaction("rear-wheel:missing@300ms", Cause::RearWheelLost, Mode::Limp, 252),
    FaultReaction("rear-wheel:nan@300ms", Cause::RearWheelRange, Mode::Limp, 252),
    FaultReaction("rear-wheel:scale=0.5@300ms", Cause::RearWheelJump, Mode::Limp, 252),
    FaultReaction("rear-wheel:drift=2/s@300ms", Cause::WheelsDisagree, Mode::Limp, 800),
    FaultReaction("motor-report:missing@300ms", Cause::MotorLost, Mode::Fault, 22),
    FaultReaction("motor-report:nan@300ms", Cause::MotorRange, Mode::Fault, 22),
    FaultReaction("motor:dead@20ms", Cause::MotorStuck, Mode::Fault, 150),
    FaultReaction("motor:flip@20ms", Cause::MotorDisagrees, Mode::Fault, 150),
    FaultReaction("motor:stuck@20ms", Cause::MotorStuck, Mode::Fault, 150),
    FaultReaction("engage:value=0@300ms", Cause::SwitchOff, Mode::Standby, 1),
    FaultReaction("clock:jump=0.05@300ms", Cause::Timing, Mode::Fault, 1),
];

impl FaultReaction {
    /// The fault from `from_s` of the ride on \[s\], or from the test's own time.
    ///
    /// # Panics
    /// If the text is no fault.
    pub fn fault(&self, from_s: Option<f64>) -> Fault {
        let fault: Fault = self.0.parse().unwrap_or_else(|e| panic!("{e}"));
        Fault { from_s: from_s.unwrap_or(fault.from_s), ..fault }
    }
}

/// The flashed configuration fitted to its bicycle, its polarity checked.
pub fn product() -> Config {
    let mut config = Config::product();
    config.calibration.polarity_checked = true;
    fit(&mut config, &alone().bicycle, Plant::default().sensors.imu.point_m);
    config
}

/// A shipped rider between the means of their measured gains.
///
/// # Panics
/// If there is none of that name.
pub fn rider(name: &str) -> Rider {
    let table = catalogue::load(name).unwrap_or_else(|e| panic!("{e}"));
    table.rider(Fit::Mean, Outside::Extrapolate, None).unwrap_or_else(|e| panic!("{e}"))
}

/// The smart old rider assisted by `config`, through `plant`.
pub fn smart(config: Config, plant: Plant) -> Conditions {
    Conditions { rider: Some(rider("smart")), plant, ..configured(config) }
}
