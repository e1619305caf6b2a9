//! The firmware images: what there is, how it is built, where it lies.

use crate::process::{Outcome, capture, must};
use crate::{Result, setup};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::Duration;

/// The target of every image: Cortex-M4 with hardware f32.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// An image and the most it may take.
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

/// Every image.
pub const IMAGES: [Image; 7] = [
    Image { name: "qemu-control", board: "board-qemu", flash: 96 << 10, ram: 48 << 10 },
    Image { name: "qemu-pil", board: "board-qemu", flash: 256 << 10, ram: 72 << 10 },
    Image { name: "qemu-replay", board: "board-qemu", flash: 128 << 10, ram: 64 << 10 },
    Image { name: "qemu-instructions", board: "board-qemu", flash: 144 << 10, ram: 64 << 10 },
    Image { name: "qemu-fault", board: "board-qemu", flash: 64 << 10, ram: 48 << 10 },
    Image { name: "board-stm32f405", board: "board-stm32f405", flash: 256 << 10, ram: 64 << 10 },
    Image { name: "board-stm32f405-align", board: "board-stm32f405", flash: 64 << 10, ram: 48 << 10 },
];

const BUILD_LIMIT: Duration = Duration::from_secs(1200);

/// The workspace's root.
pub fn root() -> &'static Path {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().unwrap_or(manifest)
}

/// Where cargo builds the images, apart from the host's programs.
pub fn target_dir() -> PathBuf {
    root().join("target/firmware")
}

/// Where a built image lies.
pub fn path(name: &str) -> PathBuf {
    target_dir().join(TARGET).join("firmware").join(name)
}

/// Builds the images of one board.
///
/// # Errors
/// Cargo's failure.
pub fn build(board: &str) -> Result<()> {
    must(cargo_build("firmware", board).arg("--bins"), BUILD_LIMIT)
}

/// Builds the image that links only without a panic path, `unwrap` with one on purpose.
///
/// # Errors
/// Cargo could not be run, or took too long. A failure to link is an [`Outcome`].
pub fn link_no_panic(unwrap: bool) -> Result<Outcome> {
    capture(&mut cargo_build("no-panic", if unwrap { "unwrap" } else { "proof" }), BUILD_LIMIT)
}

/// For tests: whether the images of `board-qemu` can be run; builds them at the first call.
///
/// Without the target or QEMU it says so, loudly, and is `false`; with `STEER_ASSIST_REQUIRE_QEMU`
/// set, as `cargo xtask test` does, that is a failure.
///
/// # Panics
/// When the images don't build, or are required and can't.
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
        // Not `eprintln`, which the test harness swallows.
        let _ = writeln!(std::io::stderr(), "\nSKIPPED, NOT PASSED: the firmware tests need\n  {list}\n");
        false
    })
}

fn cargo_build(package: &str, feature: &str) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(root()).args(["build", "--quiet", "--profile", "firmware", "--target", TARGET]);
    cargo.args(["--package", package, "--features", feature, "--target-dir"]).arg(target_dir());
    // Flags meant for the host, such as coverage, are not for the chip.
    for flags in ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "RUSTC_WRAPPER", "RUSTC_WORKSPACE_WRAPPER"] {
        cargo.env_remove(flags);
    }
    cargo
}
