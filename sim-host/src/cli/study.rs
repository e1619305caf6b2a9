//! `sim-host study`.

use super::basin::{ThreadArgs, progress};
use super::outputs::complain;
use super::{Ended, Failure, interrupt};
use crate::study::page::{Page, Places};
use crate::study::{balance_assist, prototype};
use clap::ValueEnum;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  sim-host study balance-assist                the pages in docs/studies, made again
  sim-host study prototype --out look --quick  coarser, elsewhere";

/// Options of `study`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Which study
    study: Study,
    /// Folder that NAME.md and NAME.svg are written to
    #[arg(long, default_value = "docs/studies", value_name = "DIR")]
    out: PathBuf,
    /// Coarser speeds
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    threads: ThreadArgs,
    /// No text or progress bar
    #[arg(long, short)]
    quiet: bool,
}

/// A study.
#[derive(Clone, Copy, ValueEnum)]
enum Study {
    /// Stable speeds and measured weave of the balance-assist prototype beside the model's
    BalanceAssist,
    /// Basins of the prototype's law beside those of h, at 7 N m
    Prototype,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let name = match args.study {
        Study::BalanceAssist => balance_assist::NAME,
        Study::Prototype => prototype::NAME,
    };
    let places = Places::create(&args.out, name)?;
    let pool = args.threads.pool()?;
    let page = match args.study {
        Study::BalanceAssist => Some(pool.install(balance_assist::study)?),
        Study::Prototype => {
            interrupt::install();
            let search = prototype::search(if args.quick { 1.1 } else { 0.25 });
            let bar = progress(!args.quiet, "study", prototype::work(&search), "columns");
            let page = pool.install(|| prototype::study(&search, &|| bar.inc(1), &interrupt::stopped));
            bar.finish_and_clear();
            page?
        }
    };
    let Some(page) = page else {
        complain("interrupted: nothing is written");
        return Ok(Ended::Interrupted);
    };
    places.write(&page)?;
    if !args.quiet {
        let Page { text, .. } = page;
        super::outputs::print(&text)?;
    }
    Ok(Ended::Done)
}
