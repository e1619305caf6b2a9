//! One ride with the flashed control code after a knock on the handlebar: `cargo run --release -p sim-host --example ride`.

use sim_host::ride::{Outcome, Start, traced};
use sim_host::scenario::{Preset, Scenario};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario =
        Scenario { preset: Preset::Product, rider: "smart".to_owned().into(), ..Scenario::default() };
    let resolved = scenario.resolve()?;
    let start = Start { speed_m_s: 4.0, steer_rate_rad_s: 3.0, ..Start::default() };
    let (ride, trace) = traced(&resolved.conditions, start);
    for point in trace.iter().step_by(500) {
        println!(
            "{:.1} s  roll {:6.3} rad  steer {:6.3} rad  torque {:6.2} N m",
            point.t, point.roll, point.steer, point.torque
        );
    }
    println!("{}, largest torque {:.2} N m", ride.outcome.name(), ride.effort.peak_torque_nm);
    assert_eq!(ride.outcome, Outcome::Recovered);
    Ok(())
}
