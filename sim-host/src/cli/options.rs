//! Options of the command line from the settings of a scenario, and the scenario that the given options mean.

use super::Failure;
use super::conditions::warn_of_idle_rider;
use super::outputs::complain_once;
use super::scenario_error::named;
use crate::ride::FallCriterion;
use crate::scenario::setting::{
    ADAPTIVE, BICYCLES, CONDITIONS, FALL, Given, PLANE, RIDERS, SEARCH, START, Setting, UNCERTAIN,
};
use crate::scenario::{LoadedRider, RiderChoice, Scenario, cut_warnings};
use clap::builder::{PossibleValue, PossibleValuesParser, ValueParser};
use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Args, Command, FromArgMatches, Parser};
use std::marker::PhantomData;
use std::path::PathBuf;

/// The settings that a command has as options.
pub(super) trait Settings {
    const LISTS: &'static [&'static [Setting]];
    /// Whether values are checked when they are given. Otherwise they can contain a sweep's names in braces.
    const CHECKED: bool = true;
    /// Whether the command also takes a scenario's file.
    const FILE: bool = true;
    /// Whether settings that a ride cannot do without must be given.
    const REQUIRES: bool = true;
}

/// Conditions of a ride.
pub(super) struct Conditions;
/// Conditions and initial state of a ride.
pub(super) struct Ride;
/// Conditions and initial state of a ride, for an FMU, which has a speed of its own.
#[cfg(feature = "fmu")]
pub(super) struct Fmu;
/// Conditions and search of a basin.
pub(super) struct Basin;
/// Conditions and search of a basin, adaptive speeds, and drawn bicycles or riders.
pub(super) struct UncertainBasin;
/// The bicycle alone.
pub(super) struct Bicycle;
/// Conditions and search of a plane.
pub(super) struct Plane;
/// The search alone.
pub(super) struct Search;
/// The rider alone.
pub(super) struct Rider;
/// The bicycle and the rider.
pub(super) struct Ridden;
/// The fall criterion alone.
pub(super) struct Fall;
/// Conditions of a sweep's cells and their search, with names in braces.
pub(super) struct Cells;

impl Settings for Conditions {
    const LISTS: &'static [&'static [Setting]] = &[CONDITIONS];
}
impl Settings for Ride {
    const LISTS: &'static [&'static [Setting]] = &[CONDITIONS, START];
}
#[cfg(feature = "fmu")]
impl Settings for Fmu {
    const LISTS: &'static [&'static [Setting]] = &[CONDITIONS, START];
    const REQUIRES: bool = false;
}
impl Settings for Basin {
    const LISTS: &'static [&'static [Setting]] = &[CONDITIONS, SEARCH];
}
impl Settings for UncertainBasin {
    const LISTS: &'static [&'static [Setting]] = &[CONDITIONS, SEARCH, ADAPTIVE, UNCERTAIN];
}
impl Settings for Bicycle {
    const LISTS: &'static [&'static [Setting]] = &[BICYCLES];
    const FILE: bool = false;
}
impl Settings for Plane {
    const LISTS: &'static [&'static [Setting]] = &[CONDITIONS, PLANE];
}
impl Settings for Search {
    const LISTS: &'static [&'static [Setting]] = &[SEARCH];
    const FILE: bool = false;
}
impl Settings for Rider {
    const LISTS: &'static [&'static [Setting]] = &[RIDERS];
    const FILE: bool = false;
}
impl Settings for Ridden {
    const LISTS: &'static [&'static [Setting]] = &[BICYCLES, RIDERS];
    const FILE: bool = false;
}
impl Settings for Fall {
    const LISTS: &'static [&'static [Setting]] = &[&[FALL]];
    const FILE: bool = false;
}
impl Settings for Cells {
    const LISTS: &'static [&'static [Setting]] = &[CONDITIONS];
    const CHECKED: bool = false;
}

/// The given options of a command, in the order of the settings.
pub(super) struct Options<S> {
    pub(super) given: Vec<Given>,
    of: PhantomData<S>,
}

fn all<S: Settings>() -> impl Iterator<Item = &'static Setting> {
    S::LISTS.iter().flat_map(|list| list.iter())
}

fn arg<S: Settings>(setting: &'static Setting) -> Arg {
    let arg = Arg::new(setting.name)
        .long(setting.name)
        .value_name(setting.value)
        .help(setting.help)
        .action(if setting.repeats { ArgAction::Append } else { ArgAction::Set })
        .allow_hyphen_values(setting.hyphen);
    let arg = match setting.default {
        Some(default) => arg.default_value(default),
        None => arg,
    };
    let arg = match setting.alone {
        Some(alone) => arg.num_args(0..=1).default_missing_value(alone),
        None => arg,
    };
    let arg = if setting.required && S::REQUIRES { arg.required_unless_present("scenario") } else { arg };
    if !S::CHECKED {
        return arg.value_parser(ValueParser::string());
    }
    if setting.grammar {
        return arg.value_parser(ValueParser::string());
    }
    if setting.words.is_empty() {
        let set = setting.set;
        return arg
            .value_parser(move |text: &str| set(&mut Scenario::default(), text).map(|()| text.to_owned()));
    }
    let words = setting.words.iter().map(|(word, help)| PossibleValue::new(*word).help(*help));
    arg.value_parser(PossibleValuesParser::new(words))
}

impl<S: Settings> Args for Options<S> {
    fn augment_args(command: Command) -> Command {
        let command = command.args(all::<S>().map(arg::<S>));
        let gains = ["gains", "delay", "gains-outside"];
        if !S::CHECKED || !all::<S>().any(|setting| setting.name == gains[0]) {
            return command;
        }
        // A scenario's file can have the rider, too.
        let riders = ["rider", "scenario"].into_iter().take(if S::FILE { 2 } else { 1 });
        let group = ArgGroup::new("a rider").args(riders).multiple(true);
        gains
            .iter()
            .fold(command.group(group), |command, name| command.mut_arg(name, |arg| arg.requires("a rider")))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<S: Settings> FromArgMatches for Options<S> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let typed = |setting: &&Setting| {
            matches.value_source(setting.name) == Some(clap::parser::ValueSource::CommandLine)
        };
        let given = all::<S>().filter(typed).flat_map(|setting| {
            let texts = matches.get_many::<String>(setting.name).into_iter().flatten();
            texts.map(move |text| Given { setting, text: text.clone() })
        });
        Ok(Self { given: given.collect(), of: PhantomData })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl<S> Options<S> {
    /// Applies the options to a scenario.
    ///
    /// # Errors
    /// The option with its text, and what is expected.
    pub(super) fn apply(&self, scenario: &mut Scenario) -> Result<(), String> {
        // Another rider does not have this one's delay and gains.
        if self.given.iter().any(|given| given.setting.name == "rider") {
            scenario.rider = RiderChoice::default();
        }
        self.given.iter().try_for_each(|given| given.apply(scenario)).map_err(|error| error.to_string())
    }

    /// The options without those of a name.
    #[cfg(feature = "fmu")]
    fn without(&self, name: &str) -> Self {
        let given = self.given.iter().filter(|given| given.setting.name != name).cloned().collect();
        Self { given, of: PhantomData }
    }
}

impl Options<Bicycle> {
    /// The bicycle with the requested changes.
    ///
    /// # Errors
    /// The error with file, key or value.
    pub(super) fn bicycle(&self) -> Result<crate::bicycle::catalogue::Bicycle, Failure> {
        let mut scenario = Scenario::default();
        self.apply(&mut scenario)?;
        Ok(scenario.bicycle().map_err(|e| named(&scenario, &e))?)
    }
}

impl Options<Fall> {
    /// The requested fall criterion.
    ///
    /// # Errors
    /// The error with key, value and range.
    pub(super) fn fall(&self) -> Result<FallCriterion, Failure> {
        let mut scenario = Scenario::default();
        self.apply(&mut scenario)?;
        Ok(scenario.fall.into())
    }
}

impl Options<Rider> {
    /// The requested rider; `None` for a rigid one.
    ///
    /// # Errors
    /// The error with file, key or value.
    pub(super) fn rider(&self) -> Result<Option<LoadedRider>, Failure> {
        let mut scenario = Scenario::default();
        self.apply(&mut scenario)?;
        warn_of_idle_rider(&scenario);
        Ok(scenario.rider.load().map_err(|e| named(&scenario, &e))?)
    }
}

/// The scenario file that options change.
#[derive(clap::Args)]
pub(super) struct ScenarioFile {
    /// Scenario (TOML or JSON), or a result in JSON, which contains its scenario; options change it
    #[arg(long, value_name = "FILE")]
    pub(super) scenario: Option<PathBuf>,
}

impl ScenarioFile {
    /// The scenario of the file, or the default.
    ///
    /// # Errors
    /// The file is wrong.
    pub(super) fn read(&self) -> Result<Scenario, Failure> {
        let Some(path) = self.scenario.as_deref() else { return Ok(Scenario::default()) };
        // JSON that was cut cannot be parsed.
        let toml = path.extension().is_none_or(|ending| ending != "json");
        for warning in cut_warnings(path.to_str().into_iter().filter(|_| toml)) {
            complain_once(&format!("warning: {warning}"));
        }
        Ok(Scenario { file: Some(path.into()), ..Scenario::read(path)? })
    }
}

/// A scenario from a file and options.
#[derive(clap::Args)]
pub(super) struct Chosen<S: Settings> {
    #[command(flatten)]
    file: ScenarioFile,
    /// Print the scenario that the options mean, as TOML, and end
    #[arg(long)]
    pub(super) print_scenario: bool,
    #[command(flatten)]
    options: Options<S>,
}

impl<S: Settings> Chosen<S> {
    /// The scenario of the file, or the default, changed by the options.
    ///
    /// # Errors
    /// The file or an option is wrong.
    pub(super) fn scenario(&self) -> Result<Scenario, Failure> {
        let mut scenario = self.file.read()?;
        self.options.apply(&mut scenario)?;
        Ok(scenario)
    }

    /// The names of the given options that have no effect on what `made` makes of the scenario, in the order of the options; of
    /// those that `judged` names.
    ///
    /// # Errors
    /// The file or an option is wrong.
    #[cfg(feature = "fmu")]
    pub(super) fn idle<M: PartialEq>(
        &self,
        judged: impl Fn(&str) -> bool,
        made: impl Fn(&Scenario) -> Option<M>,
    ) -> Result<Vec<&'static str>, Failure> {
        let of = |options: &Options<S>| -> Result<Option<M>, Failure> {
            let mut scenario = self.file.read()?;
            Ok(options.apply(&mut scenario).ok().and_then(|()| made(&scenario)))
        };
        let mut kept = Options { given: self.options.given.clone(), of: PhantomData };
        let whole = of(&kept)?;
        let mut names: Vec<&'static str> = kept.given.iter().map(|given| given.setting.name).collect();
        names.dedup();
        let mut idle = Vec::new();
        // Backwards, as an option can need an earlier one: the rider's gains a rider.
        for name in names.into_iter().rev().filter(|name| judged(name)) {
            let fewer = kept.without(name);
            if of(&fewer)? == whole {
                kept = fewer;
                idle.insert(0, name);
            }
        }
        Ok(idle)
    }
}

/// A command of conditions only, for parsing.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Alone {
    #[command(flatten)]
    file: ScenarioFile,
    #[command(flatten)]
    options: Options<Conditions>,
}

/// The scenario of options in a text.
///
/// # Errors
/// The wrong option and its error, in one line.
pub(super) fn parsed(text: &str) -> Result<Scenario, Failure> {
    let words = shlex::split(text).ok_or("a quotation mark is not closed")?;
    let alone = Alone::try_parse_from(words).map_err(|e| usage_error(&e))?;
    let mut scenario = alone.file.read()?;
    alone.options.apply(&mut scenario)?;
    Ok(scenario)
}

/// A usage error in one line: its first paragraph.
pub(super) fn usage_error(error: &clap::Error) -> String {
    let text = error.to_string();
    let first: Vec<&str> = text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    format!("{} (see `sim-host basin --help`)", first.join(" ").trim_start_matches("error: "))
}
