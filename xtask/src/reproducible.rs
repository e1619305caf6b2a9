//! Checks that an image's bytes depend on source and compiler only, by comparing builds in three folders.

use crate::image::{IMAGES, loaded};
use crate::paths::{self, root};
use crate::process::{capture, must};
use crate::{Result, progress};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Names of different length. Each clone has its own `CARGO_HOME`, so that the crates' paths differ, too.
const FOLDERS: [&str; 3] =
    ["a", "another-folder", "a-folder-whose-name-is-much-longer-than-those-of-the-others"];

const GIT: Duration = Duration::from_secs(120);

/// Clones the commit of the work tree three times, adds a commit to two of the clones, builds all images in each, and
/// compares the flashed bytes without the commit's hash.
///
/// # Errors
/// A build failed, or two clones differ: the images and the number of differing bytes.
pub fn reproducible() -> Result<()> {
    let place = std::env::temp_dir().join(format!("steer-assist-{}", std::process::id()));
    let outcome = compare(&place);
    // Removed whatever the outcome.
    let _ = std::fs::remove_dir_all(&place);
    outcome
}

fn compare(place: &Path) -> Result<()> {
    let clones = FOLDERS.map(|name| clone(&place.join(name), name));
    let [first, rest @ ..] = clones;
    let (first, mut apart) = (first?, Vec::new());
    for other in rest {
        for ((image, one), other) in IMAGES.iter().zip(&first).zip(&other?) {
            let differing =
                one.iter().zip(other).filter(|(a, b)| a != b).count() + one.len().abs_diff(other.len());
            println!("{}: {} bytes, {differing} differ", image.name, one.len());
            if differing > 0 {
                apart.push(image.name);
            }
        }
    }
    if apart.is_empty() {
        Ok(())
    } else {
        Err(format!("images differ between folders: {}", apart.join(", ")))
    }
}

/// The images' bytes in a new clone, without the commit's hash.
fn clone(folder: &Path, name: &str) -> Result<Vec<Vec<u8>>> {
    let git = |arguments: &[&str]| {
        let mut git = Command::new("git");
        git.arg("-C").arg(folder).args(["-c", "user.name=xtask", "-c", "user.email=xtask"]).args(arguments);
        capture(&mut git, GIT)
    };
    must(Command::new("git").args(["clone", "--quiet"]).arg(root()).arg(folder), GIT)?;
    git(&["commit", "--quiet", "--allow-empty", "--message", name])?;
    let commit = git(&["rev-parse", "--short=12", "HEAD"])?.stdout;
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(folder).args(["xtask", "firmware"]).env("CARGO_HOME", cargo_home(folder)?);
    progress::must_whenever(&mut cargo)?;
    IMAGES
        .iter()
        .map(|image| Ok(without(&loaded(&paths::path_in(folder, image.name))?, commit.trim())))
        .collect()
}

/// A `CARGO_HOME` beside the clone that shares the downloads of the real one.
fn cargo_home(folder: &Path) -> Result<PathBuf> {
    let home = folder.with_extension("cargo-home");
    let make = || {
        std::fs::create_dir_all(&home)?;
        let real = paths::cargo_home().unwrap_or_default();
        std::os::unix::fs::symlink(real.join("registry"), home.join("registry"))
    };
    make().map_err(|error| format!("{}: {error}", home.display()))?;
    Ok(home)
}

/// The bytes with zeros in place of `word`.
fn without(bytes: &[u8], word: &str) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let places = bytes.windows(word.len()).enumerate().filter(|(_, w)| *w == word.as_bytes());
    let places: Vec<usize> = places.map(|(at, _)| at).collect();
    for at in places {
        bytes[at..at + word.len()].fill(0);
    }
    bytes
}
