//! probe-rs, the runner of the boards' images.

use crate::Result;
use crate::paths::TARGET;
use crate::process::capture;
use std::process::Command;
use std::time::Duration;

/// Longer than it takes to print a version, even on a busy machine.
const LIMIT: Duration = Duration::from_secs(60);

/// Checks that the runner of `.cargo/config.toml` can be run; another one, chosen by cargo's environment variable, is taken as it
/// is.
///
/// # Errors
/// It cannot: how to install it.
pub fn ready() -> Result<()> {
    let chosen = format!("CARGO_TARGET_{}_RUNNER", TARGET.to_uppercase().replace('-', "_"));
    if std::env::var_os(chosen).is_some() {
        return Ok(());
    }
    let run = capture(Command::new("probe-rs").arg("--version"), LIMIT);
    run.map(drop).map_err(|error| {
        format!("probe-rs flashes the board, and {error}: cargo install probe-rs-tools --locked (docs/firmware.md)")
    })
}
