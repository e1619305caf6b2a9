//! A gyro of your own, from its data sheet, in front of the flashed code: `cargo run --release -p sim-host --example own_sensor`.

use sim_host::plant::sensor_file::{SensorFile, SensorNumbers};
use sim_host::ride::{Start, traced};
use sim_host::scenario::{Content, PlantChoice, Preset, Scenario, SensorChange};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let gyro = SensorNumbers {
        period_s: Some(0.005),
        delay_s: Some(0.004),
        white_density: vec![1.3e-4; 3],
        bias_spread: vec![0.01; 3],
        quantum: vec![1.06e-3; 3],
        ..SensorNumbers::default()
    };
    let file = SensorFile { source: "data sheet".into(), gyro: Some(gyro), ..SensorFile::default() };
    let exact = Scenario { preset: Preset::Product, ..Scenario::default() };
    let change = SensorChange { model: Some(Content::Given(Box::new(file))), ..SensorChange::default() };
    let plant = PlantChoice { sensors: vec![change], seed: 1, ..PlantChoice::default() };
    let real = Scenario { plant, ..exact.clone() };
    let start = Start { speed_m_s: 4.0, steer_rate_rad_s: 3.0, ..Start::default() };
    for (name, scenario) in [("exact", exact), ("data sheet", real)] {
        let (ride, _) = traced(&scenario.resolve()?.conditions, start);
        let effort = ride.effort;
        println!(
            "{name}: {}, torque {:.2} N m rms, slew {:.0} N m/s",
            ride.outcome.name(),
            effort.rms_torque_nm,
            effort.peak_slew_nm_s
        );
    }
    Ok(())
}
