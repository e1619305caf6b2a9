//! The firmware images: list, build and paths.

use crate::paths::target_dir;
pub use crate::paths::{TARGET, cargo_home, path, root};
use crate::process::{Outcome, capture, must};
use crate::{Result, probe, setup};
use std::ffi::{OsStr, OsString};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::Duration;

/// An image with its budgets.
pub struct Image {
    /// The binary's name.
    pub name: &'static str,
    /// The board's feature of the package `firmware`.
    pub board: &'static str,
    /// Flash budget \[bytes\].
    pub flash: u32,
    /// RAM budget, stack included \[bytes\].
    pub ram: u32,
}

/// Every image; those of a board are beside each other. A test compares them with the places that name them.
pub const IMAGES: [Image; 7] = [
    Image { name: "qemu-control", board: "board-qemu", flash: 112 << 10, ram: 48 << 10 },
    Image { name: "qemu-pil", board: "board-qemu", flash: 256 << 10, ram: 72 << 10 },
    Image { name: "qemu-replay", board: "board-qemu", flash: 128 << 10, ram: 64 << 10 },
    Image { name: "qemu-instructions", board: "board-qemu", flash: 144 << 10, ram: 64 << 10 },
    Image { name: "qemu-fault", board: "board-qemu", flash: 64 << 10, ram: 48 << 10 },
    Image { name: "board-vesc6", board: "board-vesc6", flash: 288 << 10, ram: 64 << 10 },
    Image { name: "board-vesc6-align", board: "board-vesc6", flash: 96 << 10, ram: 48 << 10 },
];

/// The boards' features, each once.
pub fn boards() -> Vec<&'static str> {
    let mut boards: Vec<&str> = IMAGES.iter().map(|image| image.board).collect();
    boards.dedup();
    boards
}

/// Builds the images of all boards.
///
/// # Errors
/// Cargo failed.
pub fn build_all() -> Result<()> {
    boards().into_iter().try_for_each(build)
}

/// Longer than any build takes, even on a busy machine.
const BUILD_LIMIT: Duration = Duration::from_secs(4 * 3600);

/// The bytes of an image that are flashed, without debug information.
///
/// # Errors
/// `objcopy` or the image is missing.
pub fn loaded(image: &Path) -> Result<Vec<u8>> {
    let bytes = image.with_extension("bin");
    let mut objcopy = Command::new("arm-none-eabi-objcopy");
    must(objcopy.args(["-O", "binary"]).arg(image).arg(&bytes), Duration::from_secs(600))?;
    std::fs::read(&bytes).map_err(|error| format!("{}: {error}", bytes.display()))
}

/// Builds the images of one board.
///
/// # Errors
/// Cargo failed.
pub fn build(board: &str) -> Result<()> {
    must(cargo_build("firmware", board).arg("--bins"), BUILD_LIMIT)
}

/// Builds the image that links only without a panic path; with `unwrap` it contains one on purpose.
///
/// # Errors
/// Cargo cannot be run, or exceeded the limit. A link failure is returned as an [`Outcome`].
pub fn link_no_panic(unwrap: bool) -> Result<Outcome> {
    capture(&mut cargo_build("no-panic", if unwrap { "unwrap" } else { "proof" }), BUILD_LIMIT)
}

/// For tests: whether the images of `board-qemu` can be run; builds them at the first call.
///
/// Without the target or QEMU it prints a notice and returns `false`; if `STEER_ASSIST_REQUIRE_QEMU` is set, as by
/// `cargo xtask test`, it panics.
///
/// # Panics
/// The images do not build, or are required and cannot be run.
pub fn ready() -> bool {
    static READY: OnceLock<bool> = OnceLock::new();
    *READY.get_or_init(|| {
        let missing = setup::missing();
        if missing.is_empty() {
            build("board-qemu").expect("the images build");
            return true;
        }
        let list = missing.join("\n  ");
        assert!(std::env::var_os("STEER_ASSIST_REQUIRE_QEMU").is_none(), "the firmware tests need\n  {list}");
        // Not `eprintln`, which the test harness captures.
        let _ = writeln!(std::io::stderr(), "\nSKIPPED, NOT PASSED: the firmware tests need\n  {list}\n");
        false
    })
}

/// Builds an image like [`build`] and runs it with the runner of `.cargo/config.toml`, which flashes it and shows its
/// log.
///
/// # Errors
/// The image does not exist, probe-rs is missing, or cargo or the runner failed.
pub fn flash(name: &str) -> Result<()> {
    let known = IMAGES.iter().find(|image| image.name == name && image.board != "board-qemu");
    let image = known.ok_or_else(|| format!("no image for a board is called {name:?}"))?;
    probe::ready()?;
    must(cargo("run", "firmware", image.board).args(["--bin", image.name]), Duration::MAX)
}

fn cargo_build(package: &str, feature: &str) -> Command {
    let mut build = cargo("build", package, feature);
    build.arg("--quiet");
    build
}

/// A cargo command with the settings common to all images, so that their bytes depend on source and compiler only.
fn cargo(command: &str, package: &str, feature: &str) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(root()).args([command, "--profile", "firmware", "--target", TARGET]);
    cargo.args(["--package", package, "--features", feature, "--target-dir"]).arg(target_dir());
    // Host settings, such as coverage, do not apply to the chip.
    for setting in ["RUSTFLAGS", "RUSTC_WRAPPER", "RUSTC_WORKSPACE_WRAPPER", "CARGO_INCREMENTAL"] {
        cargo.env_remove(setting);
    }
    let profile =
        std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("CARGO_PROFILE_"));
    profile.for_each(|(name, _)| _ = cargo.env_remove(name));
    // These flags also replace those of every configuration file.
    cargo.env("CARGO_ENCODED_RUSTFLAGS", encoded(&remaps()));
    cargo
}

/// The folders of this machine that a panic message could contain, each with its replacement in the image. If two
/// match, the later one applies.
fn remaps() -> Vec<(PathBuf, &'static str)> {
    let home = cargo_home();
    // The folder is named after the registry's address, which differs for a mirror.
    let registries = home.iter().flat_map(|home| home.join("registry/src").read_dir()).flatten().flatten();
    let registries = registries.map(|folder| (folder.path(), "/crates"));
    let fixed = [(home.clone(), "/cargo"), (Some(root().into()), "/steer-assist")];
    fixed.into_iter().filter_map(|(folder, name)| Some((folder?, name))).chain(registries).collect()
}

/// The compiler's flags for these replacements, in the format of `CARGO_ENCODED_RUSTFLAGS`.
fn encoded(remaps: &[(PathBuf, &str)]) -> OsString {
    let flags = remaps.iter().map(|(folder, name)| {
        let mut flag = OsString::from("--remap-path-prefix=");
        flag.push(folder);
        flag.push("=");
        flag.push(name);
        flag
    });
    flags.collect::<Vec<_>>().join(OsStr::new("\x1f"))
}
