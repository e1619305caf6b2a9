//! Compares the rates of the rides with the machine's peak, and the time of a delayed rider's ride and basin in sim-host with
//! that of Python programs for the same ride.

use crate::instructions::field;
use crate::paths::root;
use crate::process::{capture, must};
use crate::{Result, peak, process};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

/// Largest difference between the rides' final states in each entry: roll, steer \[rad\], their rates, rear wheel rate
/// \[rad/s\].
const AGREED: f64 = 1e-6;

const LIMIT: Duration = Duration::from_secs(1200);

/// Measurements of a program.
#[derive(Clone, Debug)]
struct Timing {
    name: String,
    /// Median and minimum of several runs \[s\].
    median_s: f64,
    least_s: f64,
    rides: f64,
    right_hand_sides: f64,
    /// Final state of the ride; empty for the basin.
    end: Vec<f64>,
}

/// Measures and prints the table.
///
/// # Errors
/// The Python programs or their packages are unavailable (the rest is then printed nevertheless), or the final states
/// differ.
pub fn bench() -> Result<()> {
    // Builds and downloads come before the measurements.
    let python = environment();
    must(cargo().arg("--no-run"), LIMIT)?;
    let reference = python.and_then(|python| {
        let mut ride = Command::new(python);
        timings(ride.arg(reference("ride.py")))
    });
    let ours = timings(&mut cargo())?;
    println!("{}", peak::table()?);
    let all: Vec<Timing> = reference.iter().flatten().cloned().chain(ours).collect();
    print!("{}", table(&all));
    let apart = apart(&all);
    println!("\nthe final states differ by at most {apart:.1e} (rad, rad/s)");
    match reference {
        Err(error) => Err(format!("without the Python programs: {error}")),
        Ok(_) if apart < AGREED => Ok(()),
        Ok(_) => Err(format!("the final states differ by more than {AGREED:e}")),
    }
}

fn cargo() -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(root()).args(["bench", "--quiet", "--package", "sim-host", "--bench", "riders"]);
    cargo
}

fn reference(file: &str) -> PathBuf {
    root().join("sim-host/benches/reference").join(file)
}

/// A Python environment with the packages of `requirements.txt`; created at the first call.
fn environment() -> Result<PathBuf> {
    let place = root().join("target/bench-python");
    let python = place.join("bin/python");
    let mut make = Command::new("python3");
    must(make.args(["-m", "venv"]).arg(&place), LIMIT).map_err(|e| {
        format!("{e}\nneeded: Python 3.11 or later with venv (Debian: apt-get install python3-venv)")
    })?;
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"]);
    must(pip.arg(reference("requirements.txt")), LIMIT)
        .map_err(|e| format!("{e}\nneeded: the packages of sim-host/benches/reference/requirements.txt"))?;
    Ok(python)
}

/// Runs a program that prints timings.
fn timings(program: &mut Command) -> Result<Vec<Timing>> {
    let process::Outcome { status, stdout, stderr } = capture(program, LIMIT)?;
    let read: Vec<Timing> = stdout.lines().filter_map(timing).collect();
    if status == Some(0) && !read.is_empty() {
        Ok(read)
    } else {
        Err(format!("{program:?} failed:\n{stdout}{stderr}"))
    }
}

fn timing(line: &str) -> Option<Timing> {
    let end: String = field(line, "end")?;
    Some(Timing {
        name: field(line, "name")?,
        median_s: field(line, "median_s")?,
        least_s: field(line, "least_s")?,
        rides: field(line, "rides")?,
        right_hand_sides: field(line, "right_hand_sides")?,
        end: end.split(',').filter_map(|x| x.parse().ok()).collect(),
    })
}

fn table(all: &[Timing]) -> String {
    let mut text = String::from(
        "| median of several runs (least) | per right-hand side | per ride | in all |\n| --- | ---: | ---: | ---: |\n",
    );
    for t in all {
        let both = |scale: f64, digits: usize| {
            format!("{:.digits$} ({:.digits$})", t.median_s * scale, t.least_s * scale)
        };
        let _ = writeln!(
            text,
            "| {} | {} ns | {} ms | {} s |",
            t.name,
            both(1e9 / t.right_hand_sides, 0),
            both(1e3 / t.rides, 2),
            both(1.0, 3)
        );
    }
    text
}

/// The largest difference between the final states of two rides.
fn apart(all: &[Timing]) -> f64 {
    let ends: Vec<&Vec<f64>> = all.iter().map(|t| &t.end).filter(|end| !end.is_empty()).collect();
    // NaN differs from everything.
    let apart = |x: f64, y: f64| if (x - y).is_nan() { f64::INFINITY } else { (x - y).abs() };
    let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| apart(*x, *y)).fold(0.0, f64::max);
    ends.iter().flat_map(|a| ends.iter().map(|b| difference(a, b))).fold(0.0, f64::max)
}
