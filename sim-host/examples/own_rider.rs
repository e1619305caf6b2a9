//! A rider of your own: measured gains as a table in code, assisted and alone: `cargo run --release -p sim-host --example own_rider`.

use sim_host::ride::{Start, traced};
use sim_host::rider::RiderTable;
use sim_host::scenario::{Content, RiderChoice, Scenario};
use std::path::Path;

/// Gains at two speeds (K_phi_p: roll angle, K_phi_d: roll rate, K_delta_d: steer rate), identified with a delay of 40 ms.
const TABLE: &str = "\
schema = 1
delay_ms = 40
columns = ['speed_m_s', 'group', 'K_phi_p', 'K_phi_d', 'K_delta_d']
rows = [[3.0, 1, 30, 22, -1.5], [6.0, 2, 20, 12, -2.5]]
";

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let table = RiderTable::from_text("mine", TABLE, Path::new("mine.toml"))?;
    let rider = RiderChoice { table: Some(Content::Given(Box::new(table))), ..RiderChoice::default() };
    let start = Start { speed_m_s: 4.0, steer_rate_rad_s: 1.0, ..Start::default() };
    for law in ["none", "h"] {
        let scenario = Scenario { rider: rider.clone(), law: Some(law.into()), ..Scenario::default() };
        let (ride, _) = traced(&scenario.resolve()?.conditions, start);
        let roll_deg = ride.effort.peak_roll_rad.to_degrees();
        println!(
            "law {law}: {}, largest roll {roll_deg:.1} deg, rider {:.2} N m",
            ride.outcome.name(),
            ride.effort.rider_peak_torque_nm
        );
    }
    Ok(())
}
