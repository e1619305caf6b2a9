//! `sim-host study` and `sim-host studies`.

use super::outputs::{complain, print};
use super::progress::progress;
use super::study_args::{Args, made, page_path, print_path};
use super::{Ended, Failure, interrupt, study_swept};
use crate::study::catalogue::{Study, load, shipped};
use crate::study::equal_vaf::{self, EqualVafError, Extent};
use crate::study::page::{Page, Places};
use crate::study::trial::TrialError;
use crate::study::{balance_assist, prototype};
use std::fmt::Write;

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
        Study::EqualVaf => one_page(args, equal_vaf::NAME, || equal_vaf(args)),
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

/// The page of gains with equal VAF; `None` if interrupted.
fn equal_vaf(args: &Args) -> Result<Option<Page>, EqualVafError> {
    interrupt::install();
    let extent = Extent::page();
    let bar = progress(!args.quiet, "study", equal_vaf::work(&extent)?, "columns");
    let page = equal_vaf::study(&extent, &|| bar.inc(1), &interrupt::stopped);
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
