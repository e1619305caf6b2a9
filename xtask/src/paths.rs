//! Paths in the workspace, and of the built images.

use std::path::{Path, PathBuf};

/// The target of every image: Cortex-M4 with hardware f32.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// The workspace's root.
pub fn root() -> &'static Path {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().unwrap_or(manifest)
}

/// Cargo's target directory of the images, separate from the host's.
pub fn target_dir() -> PathBuf {
    root().join("target/firmware")
}

/// Path of a built image.
pub fn path(name: &str) -> PathBuf {
    path_in(root(), name)
}

/// Path of an image built in the clone at `root`.
pub(crate) fn path_in(root: &Path, name: &str) -> PathBuf {
    root.join("target/firmware").join(TARGET).join("firmware").join(name)
}

/// Cargo's home directory, with its downloads.
pub fn cargo_home() -> Option<PathBuf> {
    let set = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    set.or_else(|| Some(std::env::home_dir()?.join(".cargo")))
}
