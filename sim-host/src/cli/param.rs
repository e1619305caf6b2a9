//! `sim-host param`: list, get, set, store, reset, export, import.

use super::outputs::{complain, print, write_json};
use super::parameter_file;
use super::port_args::{PortArgs, board};
use super::{Ended, Failure};
use crate::board::BoardName;
use crate::board::client::Client;
use crate::board::parameter::{Parameter, law_points};
use crate::board::settings::{Setting, Settings};
use crate::board::tune::{Tuned, tune};
use crate::report::board::ParametersDocument;
use crate::report::output::Output;
use crate::report::tool::Tool;
use crate::scenario::{ParameterFile, law};
use std::fmt::Write;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  sim-host param list limits --port /dev/ttyACM0
  sim-host param set limits.max_torque_nm 5 --port /dev/ttyACM0
  sim-host param store --port /dev/ttyACM0
  sim-host param export board.toml --port /dev/ttyACM0
  sim-host ride --speed 4 --steer-rate 3 --parameters board.toml";

const LIST_HELP: &str = "\
Examples:
  sim-host param list --port /dev/ttyACM0
  sim-host param list taper --port /dev/ttyACM0 --json
  sim-host param list limits --defaults";

const GET_HELP: &str = "\
Examples:
  sim-host param get rate_hz --port /dev/ttyACM0
  sim-host param get law --port /dev/ttyACM0";

const SET_HELP: &str = "\
VALUE is a number, none, on, off or a name, as `param list` shows; for the law one of --law: a name, \
or a TOML file with speed_m_s and gain_nm_s_rad. It is lost at power-off unless stored by `param store`.

Examples:
  sim-host param set limits.max_torque_nm 5 --port /dev/ttyACM0
  sim-host param set limits.end_stop on --port /dev/ttyACM0
  sim-host param set law cl2:3 --port /dev/ttyACM0";

const IMPORT_HELP: &str = "\
All keys and values are checked before anything is set. If the board then rejects one, what was set \
before is restored. A passed polarity check is never imported.

Example:
  sim-host param import board.toml --port /dev/ttyACM0";

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// The board's parameters: value, unit, allowed values, and the default if it differs
    #[command(group = board().arg("defaults"), after_help = LIST_HELP)]
    List {
        /// Only parameters with this text in their name
        #[arg(default_value = "")]
        filter: String,
        /// Write JSON to FILE, or to standard output (also -)
        #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
        json: Option<PathBuf>,
        /// The parameters of the flashed configuration, without a board
        #[arg(long, conflicts_with = "baud")]
        defaults: bool,
        #[command(flatten)]
        port: PortArgs,
    },
    /// One parameter's value
    #[command(group = board(), after_help = GET_HELP)]
    Get {
        /// Its name
        key: String,
        #[command(flatten)]
        port: PortArgs,
    },
    /// Sets one parameter, or the law
    #[command(group = board(), after_help = SET_HELP)]
    Set {
        /// Its name
        key: String,
        /// Its value
        #[arg(allow_hyphen_values = true)]
        value: String,
        #[command(flatten)]
        port: PortArgs,
    },
    /// Stores all parameters in the board's flash
    #[command(group = board(), after_help = "Example:\n  sim-host param store --port /dev/ttyACM0")]
    Store {
        #[command(flatten)]
        port: PortArgs,
    },
    /// Sets all parameters to their defaults, without storing them
    #[command(group = board(), after_help = "Example:\n  sim-host param reset --port /dev/ttyACM0")]
    Reset {
        #[command(flatten)]
        port: PortArgs,
    },
    /// Exports all parameters to a file for `param import` and --parameters
    #[command(group = board(), after_help = "Example:\n  sim-host param export board.toml --port /dev/ttyACM0")]
    Export {
        /// Output file; - is standard output
        #[arg(default_value = "-")]
        file: PathBuf,
        #[command(flatten)]
        port: PortArgs,
    },
    /// Sets all parameters of a file, or none, and reads them back
    #[command(group = board(), before_help = parameter_file::HELP, after_help = IMPORT_HELP)]
    Import {
        /// A file written by `param export`
        file: PathBuf,
        #[command(flatten)]
        port: PortArgs,
    },
}

pub(super) fn run(command: &Command) -> Result<Ended, Failure> {
    match command {
        Command::List { filter, json, defaults, port } => {
            list(filter, json.as_ref(), (!defaults).then_some(port))?;
        }
        Command::Get { key, port } => get(key, port)?,
        Command::Set { key, value, port } => set(key, value, port)?,
        Command::Store { port } => {
            port.connect()?.0.store()?;
            print("stored\n")?;
        }
        Command::Reset { port } => {
            port.connect()?.0.reset()?;
            print("all parameters have their defaults; not stored: `sim-host param store` stores them\n")?;
        }
        Command::Export { file, port } => export(file, port)?,
        Command::Import { file, port } => import(file, port)?,
    }
    Ok(Ended::Done)
}

/// Lists the parameters of the board on `port`, or of the flashed configuration.
fn list(filter: &str, json: Option<&PathBuf>, port: Option<&PortArgs>) -> Result<(), Failure> {
    let json = json.map(|path| Output::create(path)).transpose()?;
    let (board, settings) = match port {
        Some(port) => {
            let (mut client, board) = port.connect()?;
            (Some(board), Settings::read(&mut client)?)
        }
        None => (None, Settings::flashed()),
    };
    let listed: Vec<&Parameter> = settings.parameters.iter().filter(|one| one.key.contains(filter)).collect();
    if listed.is_empty() {
        return Err(format!("no parameter has `{filter}` in its name").into());
    }
    if let Some(output) = json {
        return write_json(&output, &ParametersDocument::new(board, &settings, &listed));
    }
    let label = board.as_ref().map_or("flashed configuration".into(), BoardName::label);
    let mut text = format!("# {label}\n");
    for one in listed {
        text += &line(&settings, one);
    }
    print(&text)
}

/// A parameter as a line, followed by the points of a law that is a table.
fn line(settings: &Settings, one: &Parameter) -> String {
    let default =
        if one.has(one.default) { String::new() } else { format!("; default {}", one.text(one.default)) };
    let mut text =
        format!("{:42} {:>12} {:15} {}{default}\n", one.key, one.text(one.value), one.unit, one.allowed());
    if one.key == "law" {
        for (speed_m_s, gain_nm_s_rad) in law_points(&settings.law).unwrap_or_default() {
            let _ = writeln!(text, "  {speed_m_s} m/s: {gain_nm_s_rad} N m s/rad");
        }
    }
    text
}

fn known<'a>(settings: &'a Settings, key: &str) -> Result<&'a Parameter, Failure> {
    settings
        .find(key)
        .ok_or_else(|| format!("the board has no parameter {key}; `sim-host param list` shows all").into())
}

fn get(key: &str, port: &PortArgs) -> Result<(), Failure> {
    let settings = Settings::read(&mut port.connect()?.0)?;
    print(&line(&settings, known(&settings, key)?))
}

fn set(key: &str, words: &str, port: &PortArgs) -> Result<(), Failure> {
    let law = if key == "law" { Some(law::parse(words)?) } else { None };
    let (mut client, _) = port.connect()?;
    let before = Settings::read(&mut client)?;
    let setting = match law {
        Some(law) => Setting::Law(law.into()),
        None => Setting::Value { key: key.into(), value: known(&before, key)?.parse(words)? },
    };
    apply(&mut client, &before, &[setting], &[key])
}

fn export(file: &std::path::Path, port: &PortArgs) -> Result<(), Failure> {
    let output = Output::create(file)?;
    let (mut client, board) = port.connect()?;
    let settings = Settings::read(&mut client)?;
    let Tool { name, version, commit } = Tool::this();
    let remark = format!("{name} {version} commit {commit}: {}", board.label());
    Ok(output.finish(parameter_file::text(&settings, &remark)?.as_bytes())?)
}

fn import(path: &std::path::Path, port: &PortArgs) -> Result<(), Failure> {
    let file = ParameterFile::read(path)?;
    let (mut client, _) = port.connect()?;
    let before = Settings::read(&mut client)?;
    let wanted = before
        .understand(file.law.as_ref(), &file.values)
        .map_err(|error| format!("{}: {error}; nothing is set", path.display()))?;
    apply(&mut client, &before, &wanted, &[])?;
    let (there, all) = (file.values.len(), before.but_law().count());
    let law = if file.law.is_some() { "the law" } else { "no law" };
    if there < all || file.law.is_none() {
        print(&format!(
            "{there} of the board's {all} parameters and {law} are in {}; the others stay\n",
            path.display()
        ))?;
    }
    Ok(())
}

/// Sets the wanted settings and prints the result; the settings in `always` are printed even if unchanged.
fn apply(client: &mut Client, before: &Settings, wanted: &[Setting], always: &[&str]) -> Result<(), Failure> {
    let Tuned { now, set, differing } = tune(client, before, wanted)?;
    let mut text = String::new();
    for key in set
        .iter()
        .map(String::as_str)
        .chain(always.iter().copied().filter(|key| !set.iter().any(|s| s == key)))
    {
        let _ = writeln!(text, "{key} = {} (was {})", now.words(key), before.words(key));
    }
    let _ = match set.len() {
        0 => writeln!(text, "nothing to set: the board has it already"),
        n => writeln!(text, "{n} set; not stored: `sim-host param store` stores them"),
    };
    print(&text)?;
    for key in &differing {
        complain(&format!(
            "note: {key} is {}, not as requested: only the polarity check itself sets it",
            now.words(key)
        ));
    }
    Ok(())
}
