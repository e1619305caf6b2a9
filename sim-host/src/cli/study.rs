//! `sim-host study` and `sim-host studies`.

use super::basin::{ThreadArgs, progress};
use super::outputs::{complain, print};
use super::{Ended, Failure, interrupt, study_swept};
use crate::study::catalogue::{Study, load, shipped};
use crate::study::page::{Page, Places};
use crate::study::trial::TrialError;
use crate::study::{balance_assist, prototype};
use std::fmt::Write;
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
    study: String,
    /// Folder of the results; interrupted sweeps of the same study in it are continued
    #[arg(long, default_value = "study", value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Folder of the page, studies/NAME.md, and its figures [default: that of --out]
    #[arg(long, value_name = "DIR")]
    pages: Option<PathBuf>,
    /// Coarser speeds; for `prototype` only
    #[arg(long)]
    quick: bool,
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

pub(super) fn list() -> Result<Ended, Failure> {
    let mut text = String::new();
    for study in shipped()? {
        let _ = writeln!(text, "{:14} {}", study.name(), study.title());
        for line in study.question().lines() {
            let _ = writeln!(text, "    {line}");
        }
    }
    print(&text)?;
    Ok(Ended::Done)
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let study = load(&args.study)?;
    if args.quick && study != Study::Prototype {
        return Err(format!("--quick works with `prototype` only, not with study {}", study.name()).into());
    }
    match study {
        Study::BalanceAssist => one_page(args, balance_assist::NAME, || balance_assist::study().map(Some)),
        Study::Prototype => one_page(args, prototype::NAME, || prototype(args)),
        Study::Swept(study) => study_swept::run(args, &study),
    }
}

/// The prototype's page; `None` if interrupted.
fn prototype(args: &Args) -> Result<Option<Page>, TrialError> {
    interrupt::install();
    let search = prototype::search(if args.quick { 1.1 } else { 0.25 });
    let bar = progress(!args.quiet, "study", prototype::work(&search), "columns");
    let page = prototype::study(&search, &|| bar.inc(1), &interrupt::stopped);
    bar.finish_and_clear();
    page
}

/// A study with a single page and figure.
fn one_page<E: std::error::Error + Send + 'static>(
    args: &Args,
    name: &str,
    compute: impl FnOnce() -> Result<Option<Page>, E> + Send,
) -> Result<Ended, Failure> {
    let folder = made(args.pages(), "studies")?;
    let places = Places::create(&folder, name)?;
    let Some(page) = args.threads.pool()?.install(compute)? else {
        complain("interrupted: nothing is written");
        return Ok(Ended::Interrupted);
    };
    places.write(&page)?;
    print_path(args, &page_path(args, name))
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
