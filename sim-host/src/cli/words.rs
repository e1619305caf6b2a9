//! Options of `ride` and `basin` as command-line words: stored as given, parsed later.

use super::conditions::ConditionArgs;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches, Parser};
use std::marker::PhantomData;

/// The options of `T` as typed. Their values are not checked: they can contain names in braces, and combinations can be
/// checked only after these are replaced.
pub(super) struct Words<T> {
    words: Vec<String>,
    of: PhantomData<T>,
}

/// A command of conditions only, for parsing.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Alone {
    #[command(flatten)]
    conditions: ConditionArgs,
}

/// The conditions given by some words.
///
/// # Errors
/// The wrong option and its error, in one line.
pub(super) fn conditions(words: &[String]) -> Result<ConditionArgs, String> {
    Alone::try_parse_from(words).map(|alone| alone.conditions).map_err(|e| usage_error(&e))
}

/// A usage error in one line: its first paragraph.
pub(super) fn usage_error(error: &clap::Error) -> String {
    let text = error.to_string();
    let first: Vec<&str> = text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    format!("{} (see `sim-host basin --help`)", first.join(" ").trim_start_matches("error: "))
}

/// An option that words can set.
pub(super) struct Choice {
    arg: Arg,
}

/// The option with this name, or the names of all options.
pub(super) fn choice<T: Args>(name: &str) -> Result<Choice, Vec<String>> {
    let options = options::<T>();
    match options.iter().find(|arg| arg.get_long() == Some(name)) {
        Some(arg) => Ok(Choice { arg: arg.clone() }),
        None => Err(options.iter().filter_map(|arg| Some(arg.get_long()?.to_owned())).collect()),
    }
}

impl Choice {
    /// Whether it may be given more than once.
    pub(super) fn repeats(&self) -> bool {
        matches!(self.arg.get_action(), clap::ArgAction::Append)
    }

    /// The word that sets it to `value`; a switch is `on` or `off`.
    pub(super) fn word(&self, value: &str) -> Result<Option<String>, String> {
        let name = self.arg.get_long().unwrap_or_default();
        match value {
            _ if self.arg.get_action().takes_values() => Ok(Some(format!("--{name}={value}"))),
            "on" => Ok(Some(format!("--{name}"))),
            "off" => Ok(None),
            _ => Err(format!("--{name} is a switch: `{value}` is neither on nor off")),
        }
    }
}

fn options<T: Args>() -> Vec<Arg> {
    T::augment_args(Command::new("options")).get_arguments().cloned().collect()
}

/// The option, with any text allowed and nothing required.
fn loose(arg: &Arg) -> Arg {
    let name = arg.get_long().unwrap_or_default().to_owned();
    let mut loose = Arg::new(arg.get_id().clone()).long(name).action(arg.get_action().clone());
    if let Some(help) = arg.get_help() {
        loose = loose.help(help.clone());
    }
    if arg.get_action().takes_values() {
        loose = loose
            .value_parser(clap::builder::ValueParser::string())
            .default_values(arg.get_default_values().to_vec())
            .allow_hyphen_values(arg.is_allow_hyphen_values_set() || arg.is_allow_negative_numbers_set());
        loose = match (arg.get_value_names(), arg.get_num_args()) {
            (Some(names), _) => loose.value_names(names.to_vec()),
            (None, _) => loose,
        };
    }
    match arg.get_num_args() {
        Some(range) => loose.num_args(range),
        None => loose,
    }
}

impl<T: Args> Words<T> {
    /// The words, each `--option`, `--option=value` or a value of an option with several.
    pub(super) fn words(&self) -> &[String] {
        &self.words
    }
}

impl<T: Args> Args for Words<T> {
    fn augment_args(command: Command) -> Command {
        command.args(options::<T>().iter().map(loose))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<T: Args> FromArgMatches for Words<T> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut words = Vec::new();
        for arg in options::<T>() {
            let id = arg.get_id().as_str();
            if matches.value_source(id) != Some(clap::parser::ValueSource::CommandLine) {
                continue;
            }
            let option = format!("--{}", arg.get_long().unwrap_or_default());
            if !arg.get_action().takes_values() {
                words.push(option);
                continue;
            }
            for values in matches.get_raw_occurrences(id).into_iter().flatten() {
                let values: Vec<_> = values.map(|v| v.to_string_lossy().into_owned()).collect();
                match &values[..] {
                    [one] => words.push(format!("{option}={one}")),
                    _ => words.extend(std::iter::once(option.clone()).chain(values)),
                }
            }
        }
        Ok(Self { words, of: PhantomData })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
