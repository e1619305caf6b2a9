//! Counts the instructions of the simulator's work on the host by callgrind, and compares them with the recorded ones.
//!
//! Callgrind executes the program on a simulated processor with AVX2 and without AVX-512, in one thread, so that the
//! counts do not depend on which x86-64 with AVX2 executes it.

use crate::instructions::field;
use crate::paths::root;
use crate::process::{capture, must};
use crate::{Result, setup};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Largest relative difference from the recorded count, up or down, with the recorded compiler.
pub const TOLERANCE: f64 = 0.03;
/// The same with another compiler.
pub const OTHER_COMPILER: f64 = 0.15;

const LIMIT: Duration = Duration::from_secs(3600);

/// The pieces of work: their names in `sim-host/motion/benches/counts.rs`, and what one unit is.
const WORK: [(&str, &str); 6] = [
    ("right-hand-side", "right-hand side of eight rides"),
    ("ride-step", "step of eight rides, law h by the control crate"),
    ("control-step-thesis", "control step of the thesis preset"),
    ("control-step-product", "control step of the product preset, every sensor"),
    ("ride", "one ride of 6 s, alone, with its trace"),
    ("basin", "small basin: seven speeds, fast search"),
];

/// Counts, and what they depend on.
#[derive(Clone, Debug, PartialEq)]
pub struct Counts {
    /// The compiler, as `rustc --version` prints it.
    pub rustc: String,
    /// The compiler's target.
    pub target: String,
    /// Instructions of one unit of each piece of work.
    pub instructions: Vec<(String, u64)>,
}

/// Path of the recorded counts.
pub fn path() -> PathBuf {
    root().join("tests/data/instructions.toml")
}

/// Why nothing can be counted on this machine, if so.
pub fn impossible() -> Option<String> {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        Some("instructions are counted on Linux on x86-64 only".into())
    } else if !has_avx2() {
        Some("instructions are counted on a processor with AVX2 only".into())
    } else if !setup::runs("valgrind") {
        Some("valgrind is missing: cargo xtask setup as root, or apt-get install valgrind".into())
    } else {
        None
    }
}

fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    return false;
}

/// Builds the program and counts.
///
/// # Errors
/// The build, valgrind or the program failed.
pub fn measured() -> Result<Counts> {
    must(cargo().args(["--no-run", "--quiet"]), LIMIT)?;
    let mut rustc = Command::new(std::env::var_os("RUSTC").unwrap_or("rustc".into()));
    let compiler = capture(rustc.arg("-vV"), LIMIT)?.stdout;
    let of = |start: &str| compiler.lines().find_map(|line| line.strip_prefix(start)).unwrap_or_default();
    let target = of("host: ");
    let directory = root().join("target/counts");
    std::fs::create_dir_all(&directory).map_err(|e| format!("{}: {e}", directory.display()))?;
    let counted = |(name, _): (&str, &str)| {
        Ok((name.to_owned(), counted(name, target, &directory.join(format!("{name}.callgrind")))?))
    };
    Ok(Counts {
        rustc: of("rustc ").into(),
        target: target.into(),
        instructions: WORK.into_iter().map(counted).collect::<Result<_>>()?,
    })
}

/// Instructions of one unit of a piece of work; callgrind's own output goes into `profile`.
fn counted(name: &str, target: &str, profile: &Path) -> Result<u64> {
    let into = format!("--callgrind-out-file={}", profile.display());
    let valgrind = ["valgrind", "--tool=callgrind", "--toggle-collect=counts::counted", &into];
    // A list, unlike the environment variable of a runner, may contain paths with spaces.
    let runner = format!("target.{target}.runner = {valgrind:?}");
    let mut run = cargo();
    let outcome = capture(run.args(["--quiet", "--config", &runner, "--", name]), LIMIT)?;
    let text = std::fs::read_to_string(profile).map_err(|e| format!("{}: {e}", profile.display()));
    let all: Option<u64> =
        text?.lines().find_map(|line| line.strip_prefix("summary: ")).and_then(|sum| sum.trim().parse().ok());
    match (outcome.status, all, field::<u64>(&outcome.stdout, "units")) {
        (Some(0), Some(all), Some(units)) if all > 0 => Ok(all / units.max(1)),
        _ => Err(format!("{name} is not counted: {outcome:?}")),
    }
}

/// `cargo bench` of the program. Flags of this machine do not apply.
fn cargo() -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(root()).args(["bench", "--package", "motion", "--bench", "counts"]);
    cargo.env_remove("RUSTFLAGS").env("CARGO_ENCODED_RUSTFLAGS", "");
    let profile =
        std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("CARGO_PROFILE_"));
    profile.for_each(|(name, _)| _ = cargo.env_remove(name));
    cargo
}

/// The recorded counts.
///
/// # Errors
/// The file is missing or is not of this format.
pub fn recorded() -> Result<Counts> {
    let text = std::fs::read_to_string(path()).map_err(|e| format!("{}: {e}", path().display()))?;
    parsed(&text).ok_or_else(|| format!("{}: not the format of `cargo xtask counts`", path().display()))
}

fn parsed(text: &str) -> Option<Counts> {
    let table: toml::Table = text.parse().ok()?;
    let word = |key: &str| Some(table.get(key)?.as_str()?.to_owned());
    let count = |(name, value): (&String, &toml::Value)| {
        Some((name.clone(), u64::try_from(value.as_integer()?).ok()?))
    };
    let instructions = table.get("instructions")?.as_table()?.iter().map(count).collect::<Option<_>>()?;
    Some(Counts { rustc: word("rustc")?, target: word("target")?, instructions })
}

impl Counts {
    /// The count of a piece of work.
    pub fn of(&self, name: &str) -> Option<u64> {
        self.instructions.iter().find(|(other, _)| other == name).map(|(_, count)| *count)
    }

    /// As the text of the file.
    pub fn toml(&self) -> String {
        let mut text = format!(
            "# Instructions on the host, counted by callgrind. Written by `cargo xtask counts --update`; see docs/testing.md.\n\
             rustc = {:?}\ntarget = {:?}\n\n[instructions]\n",
            self.rustc, self.target
        );
        for (name, count) in &self.instructions {
            let _ = writeln!(text, "{name} = {count}");
        }
        text
    }

    /// As a table beside the recorded counts.
    pub fn table(&self, recorded: &Counts) -> String {
        let mut text =
            String::from("| instructions | recorded | now | change |\n| --- | ---: | ---: | ---: |\n");
        for (name, unit) in WORK {
            let (Some(before), Some(now)) = (recorded.of(name), self.of(name)) else { continue };
            let percent = 100.0 * (now as f64 / before as f64 - 1.0);
            let _ = writeln!(text, "| {unit} | {before} | {now} | {percent:+.2} % |");
        }
        text
    }

    /// The pieces of work whose count differs from the recorded one by more than the tolerance, or that only one of them has.
    pub fn changed(&self, recorded: &Counts) -> Vec<String> {
        let tolerance = if self.rustc == recorded.rustc { TOLERANCE } else { OTHER_COMPILER };
        let close = |now: u64, before: u64| (now as f64 / before as f64 - 1.0).abs() <= tolerance;
        let both = self.instructions.iter().chain(&recorded.instructions).map(|(name, _)| name);
        let names: BTreeSet<&String> = both.collect();
        let line = |name: &String| match (recorded.of(name), self.of(name)) {
            (Some(before), Some(now)) if close(now, before) => None,
            (before, now) => Some(format!("{name}: recorded {before:?}, now {now:?} instructions")),
        };
        names.into_iter().filter_map(line).collect()
    }
}

/// Counts and prints a table; with `update` writes the file.
///
/// # Errors
/// Nothing can be counted here, a run failed, the file cannot be read or written, or, without `update`, a count changed.
pub fn counts(update: bool) -> Result<()> {
    if let Some(reason) = impossible() {
        return Err(reason);
    }
    let now = measured()?;
    let before = if update { recorded().unwrap_or_else(|_| now.clone()) } else { recorded()? };
    print!("{}", now.table(&before));
    if update {
        return std::fs::write(path(), now.toml()).map_err(|e| format!("{}: {e}", path().display()));
    }
    let changed = now.changed(&before);
    if changed.is_empty() { Ok(()) } else { Err(changed.join("\n  ")) }
}
