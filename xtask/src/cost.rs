//! Computing time over the size of the work: `docs/img/cost.svg` and the table of `docs/performance.md`.

use crate::document::with_table;
use crate::paths::root;
use crate::process::capture;
use crate::{Result, process};
use std::process::Command;
use std::time::Duration;

const LIMIT: Duration = Duration::from_secs(3600);

/// Measures, draws the figure and writes the table.
///
/// # Errors
/// The program does not build or fails, or a file cannot be written.
pub fn cost() -> Result<()> {
    let (figure, page) = (root().join("docs/img/cost.svg"), root().join("docs/performance.md"));
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(root()).args(["bench", "--quiet", "--package", "sim-host", "--bench", "cost", "--"]);
    let process::Outcome { status, stdout, stderr } = capture(cargo.arg(&figure), LIMIT)?;
    if status != Some(0) {
        return Err(format!("{stdout}{stderr}"));
    }
    let text = std::fs::read_to_string(&page).map_err(|e| format!("{}: {e}", page.display()))?;
    let text = with_table(&text, "cost", &stdout)?;
    std::fs::write(&page, text).map_err(|e| format!("{}: {e}", page.display()))?;
    print!("{stdout}");
    Ok(())
}
