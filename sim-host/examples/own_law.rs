//! A law of your own as a function, beside the published one: `cargo run --release -p sim-host --example own_law`.
//!
//! A function is evaluated continuously, with exact sensors. To fly on a board a law is a gain table (docs/cli.md, "Laws") or a
//! variant of `control::Law` (CONTRIBUTING.md, "Add a law").

use sim_host::basin::{Axis, Method, Search, basin};
use sim_host::ride::{Assist, Conditions, OwnLaw};
use sim_host::scenario::{AssistKind, Scenario};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let published = Scenario { law: Some("h".into()), assist: AssistKind::Ideal, ..Scenario::default() }
        .resolve()?
        .conditions;
    // Positive steers into the fall; the torque saturates softly at 4 N m.
    let law = OwnLaw::new(|roll_rate_rad_s, speed_m_s| {
        let gain = if speed_m_s < 7.5 { 12.0 - 1.6 * speed_m_s } else { 0.0 };
        let torque_nm = gain * roll_rate_rad_s;
        torque_nm / (1.0 + torque_nm.abs() / 4.0)
    });
    let own = Conditions { assist: Assist::Own(law), ..published.clone() };
    let search = Search {
        speeds: vec![3.0, 4.5, 6.0],
        axis: Axis::SteerRate,
        max_rate: 20.0,
        scan_step: 0.5,
        tolerance: 0.05,
        method: Method::Fast,
        efforts: false,
    };
    let [published, own] = [published, own].map(|conditions| basin(&conditions, &search, |_| (), || false));
    let (published, own) = (published?, own?);
    for (a, b) in published.columns.iter().zip(&own.columns) {
        println!("{} m/s: h {:5.2} rad/s, own {:5.2} rad/s", a.speed, a.upper, b.upper);
    }
    assert!(own.columns.iter().all(|column| column.upper > 0.0));
    Ok(())
}
