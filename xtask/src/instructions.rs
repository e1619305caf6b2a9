//! Instructions and stack of one control step, counted in QEMU.

use crate::{Result, qemu, rides};
use control::{Config, SensorFrame};
use std::str::FromStr;

/// The most instructions a step may take, of the 168,000 clock cycles of a period.
pub const BUDGET: u32 = 3000;
/// The most that a call of the motor's loop may take: half of the clock cycles of a PWM period at 40 kHz, the fastest.
pub const MOTOR_BUDGET: u32 = 2100;
/// The part of a budget that must stay free, in percent: the same source and compiler give code that differs by about one
/// percent from machine to machine, and a budget that is kept here must be kept there.
pub const MARGIN_PERCENT: u32 = 10;
/// The same for a configuration with everything on, which nobody flashes as it is: what was seen to differ.
pub const EVERYTHING_MARGIN_PERCENT: u32 = 1;
/// How the names of these configurations begin.
const EVERYTHING: &str = "everything on";
/// The most stack a step or call may take \[bytes\].
pub const STACK_BUDGET: u32 = 1024;

/// How many periods sensors hold their samples in the rides with slow ones; the gyro is lost after ten.
const HELD: [u16; 3] = [2, 5, 8];

/// The steps of one configuration over the border ride, or over the rides with every sensor; or the calls of the motor's loop.
#[derive(Clone, Copy, Debug)]
pub struct Count {
    /// The configuration's name, and what is ridden.
    pub name: &'static str,
    /// Mean instructions of a step, rounded down; the largest of several rides.
    pub mean: u32,
    /// Largest number of instructions of a step.
    pub max: u32,
    /// The most there may be.
    pub budget: u32,
    /// The deepest the stack went \[bytes\].
    pub stack: u32,
}

impl Count {
    /// The most instructions that leave the margin.
    pub fn most(&self) -> u32 {
        with_margin(self.budget, self.margin_percent())
    }

    /// The part of the budget that must stay free, in percent.
    pub fn margin_percent(&self) -> u32 {
        if self.name.starts_with(EVERYTHING) { EVERYTHING_MARGIN_PERCENT } else { MARGIN_PERCENT }
    }
}

/// A budget less its margin.
pub const fn with_margin(budget: u32, percent: u32) -> u32 {
    budget - budget * percent / 100
}

/// What the image counts after the rides: a motor that turns, and one that breaks in one way after the other.
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

/// A function of one number, and its instructions without the call: the mean of a thousand arguments.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// What it computes, and by what.
    pub name: String,
    /// Its instructions.
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

/// Rides of one name as one: the largest mean and the largest of all steps.
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

/// The number in `name=number` of a program's line.
pub fn field<T: FromStr>(line: &str, name: &str) -> Option<T> {
    line.split_whitespace().find_map(|word| word.strip_prefix(name)?.strip_prefix('=')?.parse().ok())
}
