//! Rides on which board and simulator are compared.

use crate::power;
use control::safety::engagement::EngagementConfig;
use control::{Config, Law};
use sim_host::bicycle::{Geometry, catalogue, onboard};
use sim_host::plant::{self, Plant};
use sim_host::ride::{Assist, Conditions, Imu};
use sim_host::rider::{self, Fit, Outside};

/// The control period \[s\].
pub const PERIOD_S: f64 = 1e-3;
/// Time step of the loop with the board \[s\].
pub const BOARD_STEP_S: f64 = 0.5e-3;

/// Configuration of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// The published law h alone, on the gyro's roll rate and the front wheel's speed: no limits; no checks but those
    /// of the sensors and the self-test.
    H,
    /// The flashed configuration.
    Product,
}

impl Preset {
    /// Name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::H => "h",
            Self::Product => "product",
        }
    }

    /// The configuration, with `polarity_checked` set.
    pub fn config(self) -> Config {
        let mut config = Config::product();
        if self == Self::H {
            // Without a self-test it would engage before the wheels' first pulses.
            let permit = EngagementConfig {
                self_test_ticks: config.permit.self_test_ticks,
                ..EngagementConfig::default()
            };
            config = Config { input: config.input, permit, ..Config::thesis(Law::H { cut: false }) };
        }
        config.calibration.polarity_checked = true;
        config
    }
}

/// Error text of preparing a ride.
pub type Reason = Box<dyn std::error::Error + Send + Sync>;

/// The bicycle `rigid_jason` with the gyro on its frame, exact sensors and an exact motor.
///
/// # Errors
/// An unknown rider.
pub fn simulated(preset: Preset, rider: Option<&str>, time_limit_s: f64) -> Result<Conditions, Reason> {
    let bicycle = Geometry::new(&catalogue::load("rigid_jason")?.parameters);
    let mut config = preset.config();
    let plant = Plant::default();
    onboard::fit(&mut config, &bicycle, plant.sensors.imu.point_m);
    let plan = config.plan().map_err(|e| e.to_string())?;
    let rider = match rider {
        Some(name) => Some(rider::catalogue::load(name)?.rider(Fit::default(), Outside::default(), None)?),
        None => None,
    };
    Ok(Conditions {
        rider,
        imu: Imu::Body,
        time_limit_s,
        step_s: PERIOD_S,
        ..Conditions::thesis(bicycle, Assist::Firmware(Box::new(plan)))
    })
}

/// As [`simulated`], with the motor's rotor and the friction of the Davis bicycle on the steer, as the board rides;
/// sensors, bridge and motor are the board's.
///
/// # Errors
/// As of [`simulated`].
pub fn on_board(preset: Preset, rider: Option<&str>, time_limit_s: f64) -> Result<Conditions, Reason> {
    let mut conditions = simulated(preset, rider, time_limit_s)?;
    conditions.bicycle.rotor_kg_m2 = power::ROTOR_KG_M2;
    conditions.plant.actuator.friction = plant::catalogue::load("davis")?.friction;
    conditions.step_s = BOARD_STEP_S;
    Ok(conditions)
}
