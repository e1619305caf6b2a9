//! Counts instructions and stack of one control step in QEMU.

use crate::{Result, qemu, rides};
use control::{Config, SensorFrame};
use std::str::FromStr;

/// Budget of a step's instructions, of the 168,000 clock cycles of a period.
pub const BUDGET: u32 = 3000;
/// Budget of a call of the motor's loop: half of the clock cycles of a PWM period at 40 kHz, the fastest.
pub const MOTOR_BUDGET: u32 = 2100;
/// Part of a budget that must stay free, in percent: code from the same source and compiler differs by about one
/// percent between machines, and the budget must hold on all of them.
pub const MARGIN_PERCENT: u32 = 10;
/// The same for the configuration with everything on, which is not flashed as it is: the observed difference.
pub const EVERYTHING_MARGIN_PERCENT: u32 = 1;
/// Prefix of these configurations' names.
const EVERYTHING: &str = "everything on";
/// Stack budget of a step or call \[bytes\].
pub const STACK_BUDGET: u32 = 1024;

/// Hold times of the samples in the rides with slow sensors, in periods; the gyro is lost after ten.
const HELD: [u16; 3] = [2, 5, 8];

/// Counts of the steps of one configuration over the border ride, or over the rides with every sensor; or of the calls
/// of the motor's loop.
#[derive(Clone, Copy, Debug)]
pub struct Count {
    /// Name of the configuration and the ride.
    pub name: &'static str,
    /// Mean instructions of a step, rounded down; the largest of several rides.
    pub mean: u32,
    /// Largest instruction count of a step.
    pub max: u32,
    /// The budget.
    pub budget: u32,
    /// Largest stack depth \[bytes\].
    pub stack: u32,
}

impl Count {
    /// The largest count that leaves the margin free.
    pub fn most(&self) -> u32 {
        with_margin(self.budget, self.margin_percent())
    }

    /// The part of the budget that must stay free, in percent.
    pub fn margin_percent(&self) -> u32 {
        if self.name.starts_with(EVERYTHING) { EVERYTHING_MARGIN_PERCENT } else { MARGIN_PERCENT }
    }
}

/// A budget without its margin.
pub const fn with_margin(budget: u32, percent: u32) -> u32 {
    budget - budget * percent / 100
}

/// Names of the image's counts after the rides: a turning motor, and one with each fault in turn.
const MOTOR: [&str; 2] = ["motor's loop, turning", "motor's loop, broken in turn"];

/// Counts for every configuration. The images must be built.
///
/// # Errors
/// QEMU or the image failed.
pub fn counts() -> Result<Vec<Count>> {
    let configurations = rides::configurations();
    let unchecked = Config::product();
    let (border, whole, broken) = (rides::border_ride(), rides::all_sensors_ride(), rides::broken_rides());
    let mut rides: Vec<(&str, &Config, &[SensorFrame])> =
        configurations.iter().map(|(name, config)| (*name, config, border.as_slice())).collect();
    let (product, everything) = (rides::product(), rides::everything());
    rides.push(("product, polarity unchecked", &unchecked, &whole));
    let slow = HELD.map(|periods| rides::held(&whole, periods));
    let slow_broken = broken.iter().flat_map(|ride| HELD.map(|periods| rides::held(ride, periods)));
    let slow_broken: Vec<_> = slow_broken.collect();
    for (config, [name, name_broken, name_slow, name_slow_broken]) in [
        (
            &product,
            [
                "product, every sensor",
                "product, each sensor broken in turn",
                "product, sensors slower than the control",
                "product, slower and each broken in turn",
            ],
        ),
        (
            &everything,
            [
                "everything on",
                "everything on, each sensor broken in turn",
                "everything on, sensors slower than the control",
                "everything on, slower and each broken in turn",
            ],
        ),
    ] {
        rides.push((name, config, &whole));
        rides.extend(broken.iter().map(|ride| (name_broken, config, ride.as_slice())));
        rides.extend(slow.iter().map(|ride| (name_slow, config, ride.as_slice())));
        rides.extend(slow_broken.iter().map(|ride| (name_slow_broken, config, ride.as_slice())));
    }
    let files: Vec<(&Config, &[SensorFrame])> =
        rides.iter().map(|(_, config, ride)| (*config, *ride)).collect();
    let directory = qemu::directory("instructions")?;
    std::fs::write(directory.join("rides.bin"), rides::encode(&files)).map_err(|e| e.to_string())?;
    let outcome = qemu::run("qemu-instructions", &[], &directory, qemu::COUNTED, qemu::LIMIT)?;
    let names = rides.iter().map(|(name, ..)| (*name, BUDGET));
    let names = names.chain(MOTOR.map(|name| (name, MOTOR_BUDGET)));
    let lines = outcome.stdout.lines().filter(|line| field::<u32>(line, "steps").is_some());
    let counts: Vec<Count> = lines
        .zip(names)
        .filter_map(|(line, (name, budget))| {
            let [mean, max, stack] = ["mean", "max", "stack"].map(|key| field(line, key));
            Some(Count { name, mean: mean?, max: max?, budget, stack: stack? })
        })
        .collect();
    if outcome.status == Some(0) && counts.len() == rides.len() + MOTOR.len() {
        Ok(joined(counts))
    } else {
        Err(format!("qemu-instructions: {outcome:?}"))
    }
}

/// A function of one number with its mean instruction count over a thousand arguments, without the call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// The function and its implementation.
    pub name: String,
    /// Mean instruction count.
    pub mean: u32,
}

/// Counts for the functions of docs/motor.md. The images must be built.
///
/// # Errors
/// QEMU or the image failed.
pub fn functions() -> Result<Vec<Function>> {
    let directory = qemu::directory("functions")?;
    // No rides.
    std::fs::write(directory.join("rides.bin"), []).map_err(|e| e.to_string())?;
    let outcome = qemu::run("qemu-instructions", &[], &directory, qemu::COUNTED, qemu::LIMIT)?;
    let function = |line: &str| {
        let (name, _) = line.strip_prefix("function ")?.rsplit_once(", ")?;
        Some(Function { name: name.into(), mean: field(line, "mean")? })
    };
    let functions: Vec<Function> = outcome.stdout.lines().filter_map(function).collect();
    if outcome.status == Some(0) && !functions.is_empty() {
        Ok(functions)
    } else {
        Err(format!("qemu-instructions: {outcome:?}"))
    }
}

/// Combines the rides of one name: the largest mean and the largest maximum.
fn joined(counts: Vec<Count>) -> Vec<Count> {
    let mut all: Vec<Count> = Vec::new();
    for count in counts {
        match all.iter_mut().find(|other| other.name == count.name) {
            Some(same) => {
                (same.mean, same.max) = (same.mean.max(count.mean), same.max.max(count.max));
                same.stack = same.stack.max(count.stack);
            }
            None => all.push(count),
        }
    }
    all
}

/// The number in `name=number` of a line of output.
pub fn field<T: FromStr>(line: &str, name: &str) -> Option<T> {
    line.split_whitespace().find_map(|word| word.strip_prefix(name)?.strip_prefix('=')?.parse().ok())
}
