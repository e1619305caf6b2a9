//! `sim-host faults`.

use super::outputs::{print, write_json};
use super::port_args::{PortArgs, board};
use super::{Ended, Failure};
use crate::board::fault::Fault;
use crate::board::recorded::Recording;
use crate::board::{Client, LineError, Patience};
use crate::report::board::FaultsDocument;
use crate::report::document::SCHEMA;
use crate::report::output::Output;
use crate::report::resolved::Tool;
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
    /// Those told in a recording of `monitor --record`
    #[arg(long, value_name = "FILE")]
    file: Option<PathBuf>,
    /// Make the board forget them, after they were shown
    #[arg(long, conflicts_with = "file")]
    clear: bool,
    /// Write JSON to FILE, or to standard output (also -)
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let json = args.json.as_deref().map(Output::create).transpose()?;
    let (client, board, faults) = match &args.file {
        Some(file) => (None, None, recorded(file)?),
        None => {
            let (mut client, board) = args.port.connect()?;
            let faults = client.faults()?;
            (Some(client), Some(board), faults)
        }
    };
    match json {
        Some(output) => {
            write_json(&output, &FaultsDocument { schema: SCHEMA, tool: Tool::this(), board, faults })?
        }
        None if faults.is_empty() => print("no faults\n")?,
        None => print(&faults.iter().map(Fault::to_string).collect::<Vec<_>>().join("\n"))?,
    }
    if let Some(mut client) = client.filter(|_| args.clear) {
        client.clear_faults()?;
    }
    Ok(Ended::Done)
}

/// The faults that a recording tells, in its order.
fn recorded(file: &Path) -> Result<Vec<Fault>, Failure> {
    let mut client = Client::new(Box::new(Recording::open(file)?), Patience::default());
    let mut faults = Vec::new();
    loop {
        let told = match client.listen(Patience::default().answer) {
            Ok(told) => told,
            Err(crate::board::ClientError::Line(LineError::Ended { .. })) => return Ok(faults),
            Err(error) => return Err(error.into()),
        };
        for one in told {
            if let Ok(Message::Fault(record)) = one.message() {
                faults.push(record.into());
            }
        }
    }
}
