//! Options of `sim-host study`, and the files of its pages.

use super::outputs::print;
use super::threads::ThreadArgs;
use super::{Ended, Failure};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  sim-host study limits --out limits --pages docs       the page in docs/studies, made again
  sim-host study prototype --quick --out look           coarser, elsewhere
  sim-host study my-study.toml --out mine               sweeps of your own";

/// Options of `study`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// A built-in study (see `studies`), or FILE
    #[arg(value_name = "NAME|FILE")]
    pub(super) study: String,
    /// Folder of the results; interrupted sweeps of the same study in it are continued
    #[arg(long, default_value = "study", value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Folder of the page, studies/NAME.md, and its figures [default: that of --out]
    #[arg(long, value_name = "DIR")]
    pages: Option<PathBuf>,
    /// Coarser speeds; for `prototype` only
    #[arg(long)]
    pub(super) quick: bool,
    #[command(flatten)]
    pub(super) threads: ThreadArgs,
    /// No text or progress bar
    #[arg(long, short)]
    pub(super) quiet: bool,
}

impl Args {
    /// Folder of pages and figures.
    pub(super) fn pages(&self) -> &Path {
        self.pages.as_deref().unwrap_or(&self.out)
    }
}

/// Path of a study's page.
pub(super) fn page_path(args: &Args, name: &str) -> PathBuf {
    args.pages().join("studies").join(format!("{name}.md"))
}

/// Prints the page's path.
pub(super) fn print_path(args: &Args, page: &Path) -> Result<Ended, Failure> {
    if !args.quiet {
        print(&format!("{}\n", page.display()))?;
    }
    Ok(Ended::Done)
}

/// A folder below `pages`, created if missing.
pub(super) fn made(pages: &Path, folder: &str) -> Result<PathBuf, Failure> {
    let folder = pages.join(folder);
    std::fs::create_dir_all(&folder).map_err(|e| format!("can't make {}: {e}", folder.display()))?;
    Ok(folder)
}
