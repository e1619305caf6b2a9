//! The basins with which the flashed limits and checks are evaluated: h without a rider and with two riders, in the
//! thesis conditions, up to the speed at which h changes sign.

use crate::basins::{H, assisted, configured};
use crate::fault_reactions::{product, rider};
use control::{Config, Limits, Sensor};
use rayon::prelude::*;
use sim_host::basin::{Axis, Method, Search, border};
use sim_host::plant::Plant;
use sim_host::ride::{Conditions, Imu, Start};
use std::sync::OnceLock;

/// Riders with h: none, and two riders.
pub const RIDERS: [Option<&str>; 3] = [None, Some("young"), Some("smart")];

/// The disturbances.
pub const AXES: [Axis; 2] = [Axis::SteerRate, Axis::RollRate];

/// The speeds \[m/s\].
pub const SPEEDS: [f64; 12] = [2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0, 7.5];

/// The height of a basin at a speed.
#[derive(Clone, Copy, Debug)]
pub struct Border {
    /// The rider.
    pub rider: Option<&'static str>,
    /// The disturbed rate.
    pub axis: Axis,
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
    /// Largest disturbance that does not end in a fall \[rad/s\].
    pub height_rad_s: f64,
}

impl Border {
    /// The ride from this fraction of the height.
    pub fn start(&self, part: f64) -> Start {
        self.axis.start(self.speed_m_s, part * self.height_rad_s)
    }
}

/// These conditions with one of [`RIDERS`].
pub fn with(name: Option<&str>, conditions: Conditions) -> Conditions {
    Conditions { rider: name.map(rider), ..conditions }
}

/// Every border of [`RIDERS`], [`AXES`] and [`SPEEDS`], in this order, computed once in a program.
pub fn borders() -> &'static [Border] {
    static BORDERS: OnceLock<Vec<Border>> = OnceLock::new();
    BORDERS.get_or_init(|| {
        let mut conditions = Vec::new();
        for rider in RIDERS {
            for axis in AXES {
                conditions.extend(SPEEDS.map(|speed_m_s| Border {
                    rider,
                    axis,
                    speed_m_s,
                    height_rad_s: 0.0,
                }));
            }
        }
        conditions.into_par_iter().map(found).collect()
    })
}

fn found(conditions: Border) -> Border {
    let (max_rate, scan_step) = match conditions.axis {
        Axis::SteerRate => (24.0, 0.5),
        Axis::RollRate => (6.0, 0.125),
    };
    let speed = conditions.speed_m_s;
    let search = Search {
        speeds: vec![speed],
        axis: conditions.axis,
        max_rate,
        scan_step,
        tolerance: 0.02 * scan_step,
        method: Method::Fast,
        efforts: false,
    };
    let column = border(&with(conditions.rider, assisted(H)), &search, speed);
    assert!(!column.capped, "{conditions:?} ends beyond {max_rate} rad/s");
    Border { height_rad_s: column.upper, ..conditions }
}

/// The product under h as published, without limits and checks; boot, self-test and ramps unchanged.
pub fn unchecked() -> Config {
    let mut config = Config { law: H, limits: Limits::default(), ..product() };
    let input = &mut config.input;
    input.max_gap_ms = None;
    for sensor in [
        &mut input.gyro,
        &mut input.accel,
        &mut input.steer,
        &mut input.steer_rate,
        &mut input.front_wheel,
        &mut input.rear_wheel,
        &mut input.motor,
    ] {
        *sensor = Sensor { max: 1e6, slope_per_s: None, stuck_ticks: 0, ..*sensor };
    }
    let cross = &mut config.cross;
    (cross.wheels_m_s, cross.yaw_rad_s, cross.steer_rad, cross.motor_nm) = (None, None, None, None);
    let permit = &mut config.permit;
    (permit.fallen_rad, permit.parked_m_s, permit.backwards_m_s, permit.lifted_m_s2) =
        (None, None, None, None);
    config
}

/// Rides under this configuration, the gyro on the frame.
pub fn sensed(config: Config, plant: Plant) -> Conditions {
    Conditions { imu: Imu::Body, plant, ..configured(config) }
}
