//! From which steer rates does the published law recover, and what does a limit of the torque cost?
//! `cargo run --release -p sim-host --example basin`

use sim_host::basin::{Basin, basin};
use sim_host::scenario::{OrNone, Scenario, SearchChoice, Speeds};

fn searched(scenario: &Scenario) -> Result<Basin, Box<dyn std::error::Error>> {
    let search = scenario.search.resolve(scenario.is_ridden())?;
    Ok(basin(&scenario.resolve()?.conditions, &search, |_| (), || false)?)
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let search = SearchChoice {
        speeds: Some(Speeds::Range("2:7:1".into())),
        tolerance: 0.05,
        ..SearchChoice::default()
    };
    let free = Scenario { law: Some("h".into()), search, ..Scenario::default() };
    let limited = Scenario { torque_limit_nm: Some(OrNone::At(3.0)), ..free.clone() };
    let (free, limited) = (searched(&free)?, searched(&limited)?);
    for (a, b) in free.columns.iter().zip(&limited.columns) {
        println!("{} m/s: {:5.2} rad/s, with 3 N m {:5.2} rad/s", a.speed, a.upper, b.upper);
    }
    println!("area {:.2} and {:.2} rad m/s^2", free.area(), limited.area());
    assert!(limited.area() < free.area());
    Ok(())
}
