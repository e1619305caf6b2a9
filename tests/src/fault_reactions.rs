//! The faults of the fault cards, and the flashed controller they strike.

use crate::basins::{alone, configured};
use control::{Cause, Config, Mode};
use sim_host::bicycle::onboard::fit;
use sim_host::plant::{Fault, Plant};
use sim_host::ride::Conditions;
use sim_host::rider::{Fit, Outside, Rider, catalogue};

/// A fault, the cause that must be told, the mode that must follow, and within how many milliseconds of its
/// beginning.
#[derive(Clone, Copy, Debug)]
pub struct Card(pub &'static str, pub Cause, pub Mode, pub u32);

/// Every fault that is ridden.
#[rustfmt::skip]
pub const CARDS: &[Card] = &[
    Card("gyro:missing@300ms", Cause::GyroLost, Mode::Fault, 12),
    Card("gyro:nan@300ms", Cause::GyroRange, Mode::Fault, 12),
    Card("gyro.x:value=40@300ms", Cause::GyroRange, Mode::Fault, 12),
    Card("gyro.x:jump=5@300ms", Cause::GyroJump, Mode::Fault, 12),
    Card("gyro.z:jump=-5@300ms", Cause::GyroJump, Mode::Fault, 12),
    Card("gyro:late=50ms@300ms", Cause::GyroLost, Mode::Fault, 12),
    Card("gyro:stuck@50ms", Cause::GyroStuck, Mode::Fault, 600),
    Card("accel:missing@300ms", Cause::AccelLost, Mode::Limp, 22),
    Card("accel:nan@300ms", Cause::AccelRange, Mode::Limp, 22),
    Card("accel.y:value=200@300ms", Cause::AccelRange, Mode::Limp, 22),
    Card("steer:missing@300ms", Cause::SteerLost, Mode::Limp, 22),
    Card("steer:nan@300ms", Cause::SteerRange, Mode::Limp, 22),
    Card("steer:value=2@300ms", Cause::SteerRange, Mode::Limp, 22),
    Card("steer:jump=0.5@300ms", Cause::SteerJump, Mode::Limp, 22),
    Card("steer:stuck@50ms", Cause::SteerStuck, Mode::Limp, 300),
    Card("steer:flip@50ms", Cause::YawDisagrees, Mode::Fault, 600),
    Card("steer-rate:missing@300ms", Cause::SteerRateLost, Mode::Limp, 22),
    Card("steer-rate:nan@300ms", Cause::SteerRateRange, Mode::Limp, 22),
    Card("steer-rate:value=-50@300ms", Cause::SteerRateRange, Mode::Limp, 22),
    Card("steer-rate:flip@50ms", Cause::SteerDisagrees, Mode::Limp, 600),
    Card("front-wheel:missing@300ms", Cause::FrontWheelLost, Mode::Limp, 252),
    Card("front-wheel:nan@300ms", Cause::FrontWheelRange, Mode::Limp, 252),
    Card("front-wheel:value=0@300ms", Cause::FrontWheelJump, Mode::Limp, 252),
    Card("front-wheel:drift=-2/s@300ms", Cause::WheelsDisagree, Mode::Limp, 800),
    Card("rear-wheel:missing@300ms", Cause::RearWheelLost, Mode::Limp, 252),
    Card("rear-wheel:nan@300ms", Cause::RearWheelRange, Mode::Limp, 252),
    Card("rear-wheel:scale=0.5@300ms", Cause::RearWheelJump, Mode::Limp, 252),
    Card("rear-wheel:drift=2/s@300ms", Cause::WheelsDisagree, Mode::Limp, 800),
    Card("motor-report:missing@300ms", Cause::MotorLost, Mode::Fault, 22),
    Card("motor-report:nan@300ms", Cause::MotorRange, Mode::Fault, 22),
    Card("motor:dead@20ms", Cause::MotorStuck, Mode::Fault, 150),
    Card("motor:flip@20ms", Cause::MotorDisagrees, Mode::Fault, 150),
    Card("motor:stuck@20ms", Cause::MotorStuck, Mode::Fault, 150),
    Card("engage:value=0@300ms", Cause::SwitchOff, Mode::Standby, 1),
    Card("clock:jump=0.05@300ms", Cause::Timing, Mode::Fault, 1),
];

impl Card {
    /// The fault from `from_s` of the ride on \[s\], or from when the card says.
    ///
    /// # Panics
    /// When the card's text is no fault.
    pub fn fault(&self, from_s: Option<f64>) -> Fault {
        let fault: Fault = self.0.parse().unwrap_or_else(|e| panic!("{e}"));
        Fault { from_s: from_s.unwrap_or(fault.from_s), ..fault }
    }
}

/// What is flashed, told which bicycle it is on, its polarity checked.
pub fn product() -> Config {
    let mut config = Config::product();
    config.calibration.polarity_checked = true;
    fit(&mut config, &alone().bicycle, Plant::default().sensors.imu.point_m);
    config
}

/// A shipped rider between the means of their measured gains.
///
/// # Panics
/// When none has that name.
pub fn rider(name: &str) -> Rider {
    let table = catalogue::load(name).unwrap_or_else(|e| panic!("{e}"));
    table.rider(Fit::Mean, Outside::Extrapolate, None).unwrap_or_else(|e| panic!("{e}"))
}

/// The smart old rider assisted by `config`, through `plant`.
pub fn smart(config: Config, plant: Plant) -> Conditions {
    Conditions { rider: Some(rider("smart")), plant, ..configured(config) }
}
