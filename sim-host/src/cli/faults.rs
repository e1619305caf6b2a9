//! `sim-host faults`: fault records of a board or a recording.

use super::outputs::{complain, print, write_json};
use super::port_args::{PortArgs, board};
use super::{Ended, Failure};
use crate::board::fault::Fault;
use crate::board::reception::Reception;
use crate::board::recorded::Recording;
use crate::board::{Client, ClientError, RetryPolicy, TransportError};
use crate::report::board::FaultsDocument;
use crate::report::output::Output;
use crate::report::tool::{SCHEMA, Tool};
use link::message::Message;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  sim-host faults --port /dev/ttyACM0
  sim-host faults --port /dev/ttyACM0 --clear
  sim-host faults --file ride.link";

/// Options of `faults`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES, group = board().arg("file"))]
pub(super) struct Args {
    #[command(flatten)]
    port: PortArgs,
    /// Show the fault records in a recording of `monitor --record`
    #[arg(long, value_name = "FILE", conflicts_with = "baud")]
    file: Option<PathBuf>,
    /// Erase the fault records on the board after showing them
    #[arg(long, conflicts_with = "file")]
    clear: bool,
    /// Write JSON to FILE, or to standard output (also -)
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let json = args.json.as_deref().map(Output::create).transpose()?;
    let (client, board, faults, recording) = match &args.file {
        Some(file) => {
            let (faults, reception) = recorded(file)?;
            (None, None, faults, Some(reception))
        }
        None => {
            let (mut client, board) = args.port.connect()?;
            let faults = client.faults()?;
            (Some(client), Some(board), faults, None)
        }
    };
    match json {
        Some(output) => {
            let tool = Tool::this();
            write_json(&output, &FaultsDocument { schema: SCHEMA, tool, board, faults, recording })?
        }
        None if faults.is_empty() => match recording {
            Some(reception) => print(&format!("no faults in {} frames\n", reception.frames))?,
            None => print("no faults\n")?,
        },
        None => print(&faults.iter().map(Fault::to_string).collect::<Vec<_>>().join("\n"))?,
    }
    if let Some(mut client) = client.filter(|_| args.clear) {
        client.clear_faults()?;
    }
    match (&args.file, recording.and_then(|reception| reception.unread())) {
        (Some(file), Some(unread)) => {
            complain(&format!("warning: {}: {unread}; faults in them are not shown", file.display()));
            Ok(Ended::Partly)
        }
        _ => Ok(Ended::Done),
    }
}

/// The fault records of a recording, in its order, and counts of its frames.
fn recorded(file: &Path) -> Result<(Vec<Fault>, Reception), Failure> {
    let mut client = Client::new(Box::new(Recording::open(file)?), RetryPolicy::default());
    let (mut faults, mut unknown) = (Vec::new(), 0);
    let rest = loop {
        let received = match client.listen(RetryPolicy::default().answer) {
            Ok(received) => received,
            Err(ClientError::Transport(TransportError::Ended { rest, .. })) => break rest,
            Err(error) => return Err(error.into()),
        };
        for one in received {
            match one.message() {
                Ok(Message::Fault(record)) => faults.push(record.into()),
                Ok(Message::Telemetry(_) | Message::Log(_)) => {}
                Ok(_) | Err(_) => unknown += 1,
            }
        }
    };
    let reception = Reception { frames: client.whole(), damaged: client.damaged(), unknown, rest };
    if reception.frames == 0 {
        return Err(no_recording(file));
    }
    Ok((faults, reception))
}

/// The error for a file without any whole frame.
pub(super) fn no_recording(file: &Path) -> Failure {
    format!(
        "{}: no whole frame of the link in it; expected a recording of `monitor --record`",
        file.display()
    )
    .into()
}
