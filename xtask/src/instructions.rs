//! Instructions of one control step, counted in QEMU.

use crate::{Result, qemu, rides};
use control::{Config, SensorFrame};
use std::str::FromStr;
use std::time::Duration;

/// The most instructions a step may take, of the 168,000 clock cycles of a period.
pub const BUDGET: u32 = 3000;

/// The steps of one configuration over the border ride.
#[derive(Clone, Copy, Debug)]
pub struct Count {
    /// The configuration's name.
    pub name: &'static str,
    /// Mean instructions of a step, rounded down.
    pub mean: u32,
    /// Largest number of instructions of a step.
    pub max: u32,
}

/// Counts for every configuration. The images must be built.
///
/// # Errors
/// QEMU or the image failed.
pub fn counts() -> Result<Vec<Count>> {
    let configurations = rides::configurations();
    let ride = rides::border_ride();
    let rides: Vec<(&Config, &[SensorFrame])> =
        configurations.iter().map(|(_, config)| (config, ride.as_slice())).collect();
    let directory = qemu::directory("instructions")?;
    std::fs::write(directory.join("rides.bin"), rides::encode(&rides)).map_err(|e| e.to_string())?;
    let outcome = qemu::run("qemu-instructions", &[], &directory, qemu::COUNTED, Duration::from_secs(300))?;
    let counts: Vec<Count> = outcome
        .stdout
        .lines()
        .filter(|line| line.starts_with("steps="))
        .zip(&configurations)
        .filter_map(|(line, (name, _))| {
            Some(Count { name, mean: field(line, "mean")?, max: field(line, "max")? })
        })
        .collect();
    if outcome.status == Some(0) && counts.len() == configurations.len() {
        Ok(counts)
    } else {
        Err(format!("qemu-instructions: {outcome:?}"))
    }
}

/// The number in `name=number` of a program's line.
pub fn field<T: FromStr>(line: &str, name: &str) -> Option<T> {
    line.split_whitespace().find_map(|word| word.strip_prefix(name)?.strip_prefix('=')?.parse().ok())
}
