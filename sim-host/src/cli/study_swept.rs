//! `sim-host study` for studies that are defined as sweeps in a TOML file.

use super::options::{Cells, Options, Search, usage_error};
use super::outputs::complain;
use super::progress::{print_wait, progress};
use super::study_args::{Args, made, page_path, print_path};
use super::sweep::{finish, resolved as sweep_of, to_do};
use super::{Ended, Failure, interrupt};
use crate::commands::sweep::SweepTask;
use crate::report::output::Output;
use crate::report::picture::{caption, svg_with_caption};
use crate::scenario::Scenario;
use crate::scenario::setting::{Given, SEARCH};
use crate::study::swept::{self, Part, Spent, Study, StudyOptions};
use crate::sweep::{self, Folder, Grid, Progress, Shard, Wait};
use clap::Parser;
use std::path::Path;
use std::time::Instant;

/// The options of a study's sweep.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct PartArgs {
    #[command(flatten)]
    search: Options<Search>,
    #[command(flatten)]
    conditions: Options<Cells>,
}

pub(super) fn run(args: &Args, study: &Study) -> Result<Ended, Failure> {
    let named = |part: &Part, e: Failure| format!("study {}, sweep {}: {e}", study.source, part.name);
    let sweeps: Vec<SweepTask> =
        study.parts.iter().map(|p| resolved(p).map_err(|e| named(p, e))).collect::<Result<_, _>>()?;
    interrupt::install();
    let folder = |(part, sweep): (&Part, &SweepTask)| Folder::open(&args.out.join(&part.name), &sweep.plan);
    let folders: Vec<Folder> = study.parts.iter().zip(&sweeps).map(folder).collect::<Result<_, _>>()?;
    made(args.pages(), "studies")?;
    let figures = made(args.pages(), "img/studies")?;
    let page = page_path(args, &study.name);
    let place = Output::create(&page)?;
    let pool = args.threads.pool()?;
    let (mut grids, mut afresh, begin) = (Vec::new(), true, Instant::now());
    for (sweep, folder) in sweeps.iter().zip(&folders) {
        let mine = Shard::WHOLE.of(&sweep.plan.cells);
        let cells = to_do(sweep, &mine, folder);
        afresh &= cells.len() == mine.len();
        let bar = progress(!args.quiet, &study.name, cells.len() * sweep.search.speeds.len(), "columns");
        let waits = |wait: &Wait| print_wait(!args.quiet, &bar, wait);
        let steps = Progress { advanced: &|| bar.inc(1), waits: &waits, stop: &interrupt::stopped };
        let done = pool.install(|| sweep::run(&cells, &sweep.search, folder, &steps));
        bar.finish_and_clear();
        let done = done?;
        afresh &= done.by_others == 0;
        if done.cells < cells.len() {
            complain("interrupted: the cells that are done are kept; the same command continues");
            return Ok(Ended::Interrupted);
        }
        let grid = Grid::gather(&sweep.plan, std::slice::from_ref(folder))?;
        finish(&grid, folder, None, true)?;
        grids.push(grid);
    }
    let seconds = afresh.then(|| begin.elapsed().as_secs_f64());
    let spent = Spent { seconds, threads: pool.current_num_threads() };
    write_figures(study, &grids, &figures)?;
    place.finish(swept::page(study, &grids, spent, "../img/studies").as_bytes())?;
    print_path(args, &page)
}

fn resolved(part: &Part) -> Result<SweepTask, Failure> {
    let mut base = Scenario::default();
    let given = match (part.options.settings()?, &part.options) {
        (Some(settings), _) => {
            let given = settings.into_iter().map(|(setting, text)| Given { setting, text });
            let (search, given): (Vec<_>, Vec<_>) =
                given.partition(|given| SEARCH.iter().any(|setting| setting.name == given.setting.name));
            search.iter().try_for_each(|given| given.apply(&mut base))?;
            given
        }
        (None, StudyOptions::Text(text)) => {
            let words = shlex::split(text).ok_or("a quotation mark is not closed")?;
            let args = PartArgs::try_parse_from(words).map_err(|e| usage_error(&e))?;
            args.search.apply(&mut base)?;
            args.conditions.given
        }
        (None, StudyOptions::Table(_)) => Vec::new(),
    };
    sweep_of(&part.axes()?, &base, given)
}

fn write_figures(study: &Study, grids: &[Grid], folder: &Path) -> Result<(), Failure> {
    for (part, grid) in study.parts.iter().zip(grids) {
        // The page has the command; the full configuration is in the sweep's folder.
        let about = caption(&serde_json::json!({"options": part.options.typed(), "over": part.over}));
        for (name, picture) in swept::figures(part, grid) {
            let path = folder.join(format!("{}-{name}.svg", study.name));
            Output::create(&path)?.finish(svg_with_caption(&picture.svg(), &about).as_bytes())?;
        }
    }
    Ok(())
}
