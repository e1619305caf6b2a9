//! `sim-host thesis`: reproduces the thesis and writes the report.

use super::outputs::{complain, print};
use super::{Ended, Failure, interrupt};
use crate::counted::counted;
use crate::thesis::catalogue::{CATALOGUE, Entry, Made, selected};
use crate::thesis::document::{Compared, ThesisDocument};
use crate::thesis::run::{Progress, run as compute, work};
use crate::thesis::study::Study;
use crate::thesis::write::{PAGE, prepare, write};
use indicatif::{ProgressBar, ProgressStyle};
use std::fmt::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

const EXAMPLES: &str = "\
Examples:
  sim-host thesis                              the whole report, in thesis-report/report.html
  sim-host thesis --quick --out look           coarser, for a look
  sim-host thesis --only 3.13,figure-C.3,D     some items: numbers, names, chapters
  sim-host thesis --list                       the items and what they need";

/// Options of `thesis`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Folder of the report
    #[arg(long, default_value = "thesis-report", value_name = "DIR")]
    out: PathBuf,
    /// Items by name or number, chapters or appendices; separated by commas [default: all]
    #[arg(long, value_name = "ITEMS", value_delimiter = ',')]
    only: Vec<String>,
    /// Coarser speeds and borders, fewer experiments
    #[arg(long)]
    quick: bool,
    /// List the items and their requirements
    #[arg(long)]
    list: bool,
    /// Threads; the result does not depend on them [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// No text or progress bar
    #[arg(long, short)]
    quiet: bool,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let entries = selected(&args.only)?;
    if args.list {
        print(&list(&entries))?;
        return Ok(Ended::Done);
    }
    let study = Study::new(args.quick)?;
    prepare(&args.out)?;
    interrupt::install();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads.unwrap_or(0).into()).build()?;
    let bar = progress(!args.quiet, work(&study, &entries));
    let begin = Instant::now();
    let steps = Progress { advanced: &|n| bar.inc(n), stop: &interrupt::stopped };
    let outcomes = pool.install(|| compute(&study, &entries, &steps));
    let seconds = begin.elapsed().as_secs_f64();
    bar.finish_and_clear();
    let document = ThesisDocument::new(&outcomes, args.quick, study.resolution, seconds);
    if outcomes.iter().all(|o| o.item.is_none()) && !document.complete {
        complain("interrupted: no item is done, nothing is written");
        return Ok(Ended::Interrupted);
    }
    write(&args.out, &document, &outcomes)?;
    if !args.quiet {
        print(&(summary(&document) + &format!("{}\n", args.out.join(PAGE).display())))?;
    }
    if document.complete {
        return Ok(Ended::Done);
    }
    let done = outcomes.iter().filter(|o| o.item.is_some()).count();
    complain(&format!("interrupted: {done} of {} items are done and kept", outcomes.len()));
    Ok(Ended::Interrupted)
}

/// A progress bar with the remaining time, on standard error if it is a terminal.
fn progress(shown: bool, work: u64) -> ProgressBar {
    if !shown {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("thesis {bar:40} {percent}%, {elapsed} gone, {eta} left");
    let bar = ProgressBar::new(work).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}

fn list(entries: &[&Entry]) -> String {
    let width = CATALOGUE.iter().map(|e| e.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for entry in entries {
        let needs = match entry.made {
            Made::Computed { needs, .. } => format!("from {needs}"),
            Made::Unavailable(reason) => format!("not computed: {reason}"),
        };
        let _ = writeln!(text, "{:width$}  {} ({needs})", entry.name, entry.title);
    }
    text
}

/// The result as text.
fn summary(document: &ThesisDocument) -> String {
    let items = |status: &str| document.items.iter().filter(|i| i.status == status).count();
    let Compared { printed, close, explained, unexplained, missing } = Compared::of(&document.values);
    format!(
        "{} in {:.1} s, {} not computable; {}: {close} within 2 %, the rounding or the bound of the print, {explained} explained, \
         {unexplained} unexplained, {missing} without a computed counterpart\n",
        counted(items("computed"), "item", "items"),
        document.seconds,
        items("unavailable"),
        counted(printed, "printed number", "printed numbers"),
    )
}
