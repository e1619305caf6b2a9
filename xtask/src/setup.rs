//! Installs what the images need beyond stable Rust: the chip's target, QEMU and the size tool.

use crate::Result;
use crate::paths::{TARGET, root, target_dir};
use crate::process::must;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Source of the target's `core`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetSource {
    /// rustup, or Debian if that fails.
    Auto,
    /// `rustup target add`.
    Rustup,
    /// Compiled from Debian's source package of the standard library.
    Debian,
}

/// Programs, each with its package.
const TOOLS: [(&str, &str); 2] =
    [("qemu-system-arm", "qemu-system-arm"), ("arm-none-eabi-size", "binutils-arm-none-eabi")];

/// Counts the instructions on the host; a test is skipped without it.
const COUNTER: (&str, &str) = ("valgrind", "valgrind");

/// Lists what is missing, each with the way to install it.
pub fn missing() -> Vec<String> {
    let target = (!has_target())
        .then(|| format!("the Rust target {TARGET}: cargo xtask setup, or rustup target add {TARGET}"));
    let tools = missing_tools().into_iter().map(|(program, package)| {
        format!("{program}: cargo xtask setup as root, or install your system's package (Debian: apt-get install {package})")
    });
    target.into_iter().chain(tools).collect()
}

/// Installs everything that is missing.
///
/// # Errors
/// The parts that could not be installed, and how to install them.
pub fn setup(source: TargetSource) -> Result<()> {
    let target = if has_target() { Ok(()) } else { add_target(source) };
    let tools = add_tools();
    for failure in [target, tools].into_iter().filter_map(Result::err) {
        eprintln!("{failure}");
    }
    match missing() {
        list if list.is_empty() => Ok(()),
        list => Err(format!("still missing:\n  {}", list.join("\n  "))),
    }
}

fn add_target(source: TargetSource) -> Result<()> {
    let rustup = || {
        let mut rustup = Command::new("rustup");
        // Without retries, since there is another source.
        must(rustup.args(["target", "add", TARGET]).env("RUSTUP_MAX_RETRIES", "0"), Duration::from_secs(120))
    };
    let debian = || {
        let script = root().join("xtask/setup-targets.sh");
        must(Command::new("bash").arg(script).arg(TARGET), Duration::from_secs(2 * 3600))
    };
    // Cargo does not detect another `core` of the same release, so everything built with an earlier one is removed, if
    // there is any.
    let _ = std::fs::remove_dir_all(target_dir());
    match source {
        TargetSource::Rustup => rustup(),
        TargetSource::Debian => debian(),
        TargetSource::Auto => rustup().or_else(|error| {
            eprintln!("{error}; building the target from Debian's source instead");
            debian()
        }),
    }
}

fn add_tools() -> Result<()> {
    let packages: Vec<_> = missing_tools().into_iter().map(|(_, package)| package).collect();
    let counter = (!runs(COUNTER.0)).then_some(COUNTER.1);
    if packages.is_empty() && counter.is_none() {
        return Ok(());
    }
    let apt = |arguments: &[&str]| {
        let mut apt = Command::new("apt-get");
        apt.env("DEBIAN_FRONTEND", "noninteractive").args(arguments);
        must(&mut apt, Duration::from_secs(3600))
    };
    let install =
        |packages: &[&str]| apt(&[&["install", "-y", "-qq", "--no-install-recommends"], packages].concat());
    let updated = apt(&["update", "-qq"]);
    if let Some(Err(error)) = counter.map(|package| install(&[package])) {
        eprintln!("{error}; the instructions on the host are not counted");
    }
    if packages.is_empty() { Ok(()) } else { updated.and_then(|()| install(&packages)) }
}

fn missing_tools() -> Vec<(&'static str, &'static str)> {
    TOOLS.into_iter().filter(|(program, _)| !runs(program)).collect()
}

pub(crate) fn runs(program: &str) -> bool {
    let quiet = |c: &mut Command| c.stdout(Stdio::null()).stderr(Stdio::null()).status();
    quiet(Command::new(program).arg("--version")).is_ok_and(|status| status.success())
}

fn has_target() -> bool {
    let rustc = std::env::var_os("RUSTC").unwrap_or("rustc".into());
    let Ok(output) = Command::new(rustc).args(["--print", "sysroot"]).output() else { return false };
    let sysroot = PathBuf::from(String::from_utf8_lossy(&output.stdout).trim());
    let Ok(files) = sysroot.join("lib/rustlib").join(TARGET).join("lib").read_dir() else { return false };
    files.flatten().any(|file| file.file_name().to_string_lossy().starts_with("libcore-"))
}
