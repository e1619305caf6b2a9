//! Rides for the tests with a board in the loop.

use crate::basins::{H, assisted, configured};
use control::wire::{encode_command, encode_frame};
use control::{Config, SensorFrame};
use sim_host::bicycle::onboard::fit;
use sim_host::pil::compare::Recorder;
use sim_host::pil::{Controller, LinkFault, Lockstep};
use sim_host::plant::{Plant, Sensor};
use sim_host::ride::{Conditions, RemoteError, Ride, Start, Stepped, TracePoint, traced_on};
use sim_host::rider::{Fit, Outside, catalogue};

/// A knock from which the assist recovers.
pub const KNOCK: Start = Start { speed_m_s: 4.0, steer_rate_rad_s: 5.0, roll_rate_rad_s: 0.0 };
/// One from which it does not.
pub const FALL: Start = Start { speed_m_s: 2.0, steer_rate_rad_s: 25.0, roll_rate_rad_s: 0.0 };

/// The flashed configuration on the thesis bicycle, every sensor fitted.
pub fn product() -> Conditions {
    let mut config = Config::product();
    config.calibration.polarity_checked = true;
    let bare = configured(config.clone());
    fit(&mut config, &bare.bicycle, bare.plant.sensors.imu.point_m);
    Conditions { time_limit_s: 2.0, ..configured(config) }
}

/// Rides that use all of the loop: the published law with exact sensors and a fall under it, the flashed
/// configuration with all of its sensors, noise and a fault, and a delayed rider beside it.
///
/// # Panics
/// If a shipped rider does not load.
pub fn varied() -> Vec<(&'static str, Conditions, Start)> {
    let law = Conditions { time_limit_s: 2.0, ..assisted(H) };
    let mut noisy = product();
    noisy.plant.sensors.model_mut(Sensor::Gyro).noise = 0.02;
    let faulty = Plant {
        faults: vec![
            "gyro:stuck@300ms".parse().expect("a fault"),
            "front-wheel:late=20ms@1s".parse().expect("one"),
        ],
        ..noisy.plant.clone()
    };
    let young = catalogue::load("young").expect("it ships");
    let young = young.rider(Fit::Regression, Outside::Extrapolate, None).expect("in range");
    vec![
        ("law h", law.clone(), KNOCK),
        ("law h, a fall", law, FALL),
        ("product", product(), KNOCK),
        ("product, noisy gyro", noisy, KNOCK),
        ("product, faults", Conditions { plant: faulty, ..product() }, KNOCK),
        ("product and a rider", Conditions { rider: Some(young), ..product() }, KNOCK),
    ]
}

/// Record of a ride on a board.
#[derive(Clone, Debug)]
pub struct Ridden {
    /// The ride.
    pub ride: Ride,
    /// Its instants.
    pub trace: Vec<TracePoint>,
    /// The frames from the controller's boot, and its answers.
    pub steps: Vec<(SensorFrame, Stepped)>,
}

impl Ridden {
    /// All bits of frames and answers.
    pub fn bits(&self) -> Vec<(Vec<u8>, Vec<u8>, u32)> {
        let bits = |(frame, stepped): &(SensorFrame, Stepped)| {
            let command = encode_command(&stepped.command).into();
            (encode_frame(frame).into(), command, stepped.authority.to_bits())
        };
        self.steps.iter().map(bits).collect()
    }
}

/// A ride on a board.
///
/// # Errors
/// The board's.
pub fn ridden<B: Lockstep>(
    conditions: &Conditions,
    start: Start,
    controller: &mut Controller<B>,
) -> Result<Ridden, RemoteError> {
    let mut recorder = Recorder::new(controller);
    let (ride, trace) = traced_on(conditions, start, &mut recorder)?;
    Ok(Ridden { ride, trace, steps: recorder.steps })
}

/// Faults of the link from their text.
///
/// # Panics
/// If one is not a fault.
pub fn link_faults(texts: &[&str]) -> Vec<LinkFault> {
    texts.iter().map(|text| text.parse().unwrap_or_else(|error| panic!("{error}"))).collect()
}
