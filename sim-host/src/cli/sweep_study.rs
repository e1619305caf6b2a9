//! `sim-host sweep study` and `sim-host sweep studies`.

use super::basin::{SearchArgs, progress};
use super::cells::{Resolved, resolve};
use super::conditions::ConditionArgs;
use super::outputs::{complain, print};
use super::sweep::{finish, to_do};
use super::words::{Words, why};
use super::{Ended, Failure, interrupt};
use crate::report::output::Output;
use crate::report::picture::{caption, svg_with_caption};
use crate::sweep::study::{Part, Spent, Study, figures, load, page, shipped};
use crate::sweep::{self, Folder, Grid, Progress, Shard};
use clap::Parser;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

const EXAMPLES: &str = "\
Examples:
  sim-host sweep study limits --out limits
  sim-host sweep study my-study.toml --pages my-docs";

/// Options of `sweep study`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// A shipped study (see `sweep studies`), or FILE
    #[arg(value_name = "NAME|FILE")]
    study: String,
    /// Folder of the sweeps; one of the same study is gone on with
    #[arg(long, default_value = "study", value_name = "DIR")]
    out: PathBuf,
    /// Folder of the page, studies/NAME.md, and its figures, img/studies/ [default: that of --out]
    #[arg(long, value_name = "DIR")]
    pages: Option<PathBuf>,
    #[command(flatten)]
    threads: super::basin::ThreadArgs,
    /// No text or progress bar
    #[arg(long, short)]
    quiet: bool,
}

/// The options of a study's sweep.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct PartArgs {
    #[command(flatten)]
    search: SearchArgs,
    #[command(flatten)]
    conditions: Words<ConditionArgs>,
}

pub(super) fn list() -> Result<Ended, Failure> {
    let mut text = String::new();
    for study in shipped() {
        let study = study?;
        let _ = writeln!(text, "{:10} {}", study.name, study.title);
    }
    print(&text)?;
    Ok(Ended::Done)
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let study = load(&args.study)?;
    let named = |part: &Part, e: Failure| format!("study {}, sweep {}: {e}", study.name, part.name);
    let sweeps: Vec<Resolved> =
        study.parts.iter().map(|p| resolved(p).map_err(|e| named(p, e))).collect::<Result<_, _>>()?;
    let folder = |(part, sweep): (&Part, &Resolved)| Folder::open(&args.out.join(&part.name), &sweep.plan);
    let folders: Vec<Folder> = study.parts.iter().zip(&sweeps).map(folder).collect::<Result<_, _>>()?;
    let pages = args.pages.as_deref().unwrap_or(&args.out);
    let page = page_place(pages, &study)?;
    interrupt::install();
    let pool = args.threads.pool()?;
    let (mut grids, mut afresh, begin) = (Vec::new(), true, Instant::now());
    for (sweep, folder) in sweeps.iter().zip(&folders) {
        let mine = Shard::WHOLE.of(&sweep.plan.cells);
        let cells = to_do(sweep, &mine, folder);
        afresh &= cells.len() == mine.len();
        let bar = progress(!args.quiet, &study.name, cells.len() * sweep.search.speeds.len(), "columns");
        let steps = Progress { advanced: &|| bar.inc(1), stop: &interrupt::stopped };
        let done = pool.install(|| sweep::run(&cells, &sweep.search, folder, &steps));
        bar.finish_and_clear();
        if done? < cells.len() {
            complain("interrupted: the cells that are done are kept; the same command goes on");
            return Ok(Ended::Interrupted);
        }
        let grid = Grid::gather(&sweep.plan, std::slice::from_ref(folder))?;
        finish(&grid, folder, None, true)?;
        grids.push(grid);
    }
    let seconds = afresh.then(|| begin.elapsed().as_secs_f64());
    write(&study, &grids, Spent { seconds, threads: pool.current_num_threads() }, pages, &page)?;
    if !args.quiet {
        print(&format!("{}\n", page_name(pages, &study).display()))?;
    }
    Ok(Ended::Done)
}

fn resolved(part: &Part) -> Result<Resolved, Failure> {
    let words = shlex::split(&part.options).ok_or("a quotation mark is not closed")?;
    let args = PartArgs::try_parse_from(words).map_err(|e| why(&e))?;
    resolve(&part.axes()?, args.conditions.words(), |ridden| args.search.search(ridden))
}

fn page_name(pages: &Path, study: &Study) -> PathBuf {
    pages.join("studies").join(format!("{}.md", study.name))
}

/// The page's place, tried before the work.
fn page_place(pages: &Path, study: &Study) -> Result<Output, Failure> {
    for folder in ["studies", "img/studies"] {
        let folder = pages.join(folder);
        std::fs::create_dir_all(&folder).map_err(|e| format!("can't make {}: {e}", folder.display()))?;
    }
    Ok(Output::create(&page_name(pages, study))?)
}

fn write(study: &Study, grids: &[Grid], spent: Spent, pages: &Path, place: &Output) -> Result<(), Failure> {
    for (part, grid) in study.parts.iter().zip(grids) {
        // The page has the command; the full configuration is with the sweep.
        let about = caption(&serde_json::json!({"options": part.options, "over": part.over}));
        for (name, picture) in figures(part, grid) {
            let path = pages.join("img/studies").join(format!("{}-{name}.svg", study.name));
            Output::create(&path)?.finish(svg_with_caption(&picture.svg(), &about).as_bytes())?;
        }
    }
    Ok(place.finish(page(study, grids, spent, "../img/studies").as_bytes())?)
}
