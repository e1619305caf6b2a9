//! `sim-host monitor`: live values of a board as a panel, lines, a table or a recording.

use super::faults::no_recording;
use super::monitor_files::{Files, both, open};
use super::monitor_text::{line as text_line, panel, summary};
use super::monitor_view::{Seen, View};
use super::outputs::complain;
use super::port_args::{PortArgs, board};
use super::{Ended, Failure, interrupt, monitor_can};
use crate::board::monitor::{Monitor, News};
use crate::board::printable::printable;
use crate::board::received::ReceivedMessage;
use crate::board::reception::Reception;
use crate::board::recorded::{Recorder, Recording};
use crate::board::telemetry_row::TelemetryRow;
use crate::board::{BoardName, Client, ClientError, RetryPolicy, Transport, TransportError};
use crate::range::{TimeError, time};
use crate::report::output::Output;
use link::telemetry::Telemetry;
use serde_json::json;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};

const EXAMPLES: &str = "\
Ends with Ctrl-C, after --for, at the end of a recording, or when the line is lost; written files remain. \
A lost serial port is reopened when it is back within the time of --reopen. \
If standard output is no terminal, it prints a line per second and one for every change of mode, causes, drive \
or missed deadlines.

Examples:
  sim-host monitor --port /dev/ttyACM0
  sim-host monitor --port /dev/ttyACM0 --record ride.link --csv ride.csv
  sim-host monitor --file ride.link --csv ride.csv
  sim-host monitor --can can0 --mcap ride.mcap
  sim-host monitor --can ride.blf --csv ride.csv";

/// Silence after which a message is shown.
pub(super) const SILENCE: Duration = Duration::from_secs(2);

/// Time between two attempts to reopen a lost line.
const RETRY_INTERVAL: Duration = Duration::from_millis(200);

/// Options of `monitor`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES, group = board().arg("file").arg("can"))]
pub(super) struct Args {
    #[command(flatten)]
    port: PortArgs,
    /// A recording of --record, read as fast as possible
    #[arg(long, value_name = "FILE", conflicts_with = "baud")]
    file: Option<PathBuf>,
    /// The board's frames on CAN instead of its link: an interface of Linux, for example can0, or a recording (candump, ASC, BLF,
    /// MDF 4), read as fast as possible
    #[arg(long, value_name = "INTERFACE|FILE", conflicts_with = "baud")]
    pub(super) can: Option<String>,
    /// Write every control step of the telemetry, with --can every broadcast, as a CSV table, at once; - is standard output
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// Write the rows of --csv as MCAP, for Foxglove and PlotJuggler
    #[arg(long, value_name = "FILE")]
    pub(super) mcap: Option<PathBuf>,
    /// Write the received raw bytes for --file, with --can the frames as a log of candump, at once; - is standard output
    #[arg(long, value_name = "FILE", conflicts_with = "file")]
    pub(super) record: Option<PathBuf>,
    /// End after this time, for example 10s [default: never]
    #[arg(long = "for", value_name = "TIME", value_parser = duration, conflicts_with = "file")]
    pub(super) length: Option<f64>,
    /// Longest wait for the lost serial port of --port; 0s ends at once
    #[arg(long, value_name = "TIME", value_parser = duration, default_value = "60s", conflicts_with_all = ["file", "can", "qemu", "virtual_board"])]
    reopen: f64,
}

fn duration(text: &str) -> Result<f64, TimeError> {
    time(text, 1e6)
}

/// State of a monitor session.
struct Session {
    client: Client,
    monitor: Monitor,
    view: View,
    files: Files,
    /// Damaged frames before the first whole one: reception begins in the middle of a frame.
    damaged_before: u32,
    begin: Instant,
    /// Time after which to end.
    length: Option<Duration>,
    /// Longest wait for a lost line.
    reopen: Duration,
    /// Bytes of an incomplete last frame of a recording.
    rest: usize,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let quiet = places(args)?;
    interrupt::install_saying("ending");
    if let Some(source) = &args.can {
        return monitor_can::run(args, source, quiet);
    }
    let mut client = Client::new(line(args)?, RetryPolicy::default());
    let board = if args.file.is_some() { None } else { Some(client.hello()?) };
    let title = board.as_ref().map_or("a recording".to_owned(), BoardName::label);
    let config = json!({"board": board});
    let (csv, mcap, live) = (args.csv.as_deref(), args.mcap.as_deref(), args.file.is_none());
    let files = Files::create::<TelemetryRow>(csv, mcap, "/board", &config, live)?;
    let view = if quiet { View::None } else { View::new(title)? };
    let damaged_before = client.damaged();
    let mut session = Session {
        client,
        monitor: Monitor::default(),
        view,
        files,
        damaged_before,
        begin: Instant::now(),
        length: args.length.map(Duration::from_secs_f64),
        reopen: Duration::from_secs_f64(args.reopen),
        rest: 0,
    };
    let received = session.receive();
    let (ended, ()) = both(received, session.end())?;
    let reception = session.reception();
    match (&args.file, reception.unread()) {
        (Some(file), _) if reception.frames == 0 => Err(no_recording(file)),
        (_, Some(unread)) => {
            complain(&format!("warning: part of the data was not decoded: {unread}"));
            Ok(if matches!(ended, Ended::Done) { Ended::Partly } else { ended })
        }
        _ => Ok(ended),
    }
}

/// Checks the places to write to; whether one of them is standard output.
fn places(args: &Args) -> Result<bool, Failure> {
    let options = [("--csv", &args.csv), ("--record", &args.record), ("--mcap", &args.mcap)];
    let mut places: Vec<(&str, Output)> = Vec::new();
    for (option, path) in options {
        let Some(path) = path else { continue };
        let place = Output::create(path)?;
        if let Some((other, _)) = places.iter().find(|(_, other)| other.collides(&place)) {
            return Err(format!("{other} and {option} have the same place to write to").into());
        }
        if option == "--mcap" && place.is_standard() {
            return Err("--mcap needs a file, not standard output".into());
        }
        if option == "--record" && path.extension().is_some_and(|extension| extension == "mcap") {
            return Err("--record writes what was received as it is; --mcap writes MCAP".into());
        }
        places.push((option, place));
    }
    Ok(places.iter().any(|(_, place)| place.is_standard()))
}

/// The line to monitor, recorded to a file if requested.
fn line(args: &Args) -> Result<Box<dyn Transport>, Failure> {
    let line: Box<dyn Transport> = match (&args.file, args.port.open()?) {
        (Some(file), _) => Box::new(Recording::open(file)?),
        (None, Some(line)) => line,
        (None, None) => return Err("no board is named; see --port, --qemu and --file".into()),
    };
    Ok(match &args.record {
        Some(path) => Box::new(Recorder::new(line, &path.display().to_string(), open(path)?)),
        None => line,
    })
}

impl Session {
    /// Receives and shows messages until the end.
    fn receive(&mut self) -> Result<Ended, Failure> {
        let (mut last_received, mut silence_shown) = (Instant::now(), false);
        loop {
            if let Some(ended) = self.ended() {
                return Ok(ended);
            }
            let received = match self.client.listen(Duration::from_millis(50)) {
                Ok(received) => received,
                Err(ClientError::Transport(TransportError::Ended { rest, .. })) => {
                    self.rest = rest;
                    return Ok(Ended::Done);
                }
                Err(ClientError::Transport(lost @ TransportError::Lost { .. })) => match self.wait(lost)? {
                    Some(ended) => return Ok(ended),
                    None => continue,
                },
                Err(error) => return Err(error.into()),
            };
            if !received.is_empty() {
                (last_received, silence_shown) = (Instant::now(), false);
            } else if last_received.elapsed() > SILENCE && !std::mem::replace(&mut silence_shown, true) {
                self.view.say(&format!("no data for {} s", SILENCE.as_secs()))?;
            }
            received.iter().try_for_each(|received| self.take(received))?;
            self.files.flush()?;
            let damaged = self.damaged();
            self.view.draw(|| panel(&self.monitor, damaged))?;
        }
    }

    /// Whether to end, and how.
    fn ended(&self) -> Option<Ended> {
        let over = self.length.is_some_and(|length| self.begin.elapsed() >= length);
        if interrupt::stopped() { Some(Ended::Interrupted) } else { over.then_some(Ended::Done) }
    }

    /// Waits for a lost line; `None` when a board answers on it again.
    fn wait(&mut self, lost: TransportError) -> Result<Option<Ended>, Failure> {
        let (since, seconds) = (Instant::now(), self.reopen.as_secs_f64());
        let mut announced = false;
        while since.elapsed() < self.reopen {
            let Some(opened) = self.client.reopen() else { return Err(lost.into()) };
            if !std::mem::replace(&mut announced, true) {
                self.view.say(&format!("{lost}; waiting up to {seconds} s for it"))?;
            }
            if opened.is_ok() {
                match self.client.hello() {
                    Ok(board) => {
                        self.view.say(&format!(
                            "back after {:.1} s: {}",
                            since.elapsed().as_secs_f64(),
                            board.label()
                        ))?;
                        return Ok(None);
                    }
                    Err(error @ ClientError::Version { .. }) => return Err(error.into()),
                    // The board may still be starting.
                    Err(_) => {}
                }
            }
            if let Some(ended) = self.ended() {
                return Ok(Some(ended));
            }
            sleep(RETRY_INTERVAL);
        }
        let waited = if announced { format!("; not back within {seconds} s") } else { String::new() };
        Err(format!("{lost}{waited}").into())
    }

    fn take(&mut self, received: &ReceivedMessage) -> Result<(), Failure> {
        match self.monitor.take(received) {
            News::Step(row) => {
                self.files.write(row.t, &row)?;
                let (damaged, Some(step)) = (self.damaged(), &self.monitor.newest) else { return Ok(()) };
                let Telemetry { command, driven, late, .. } = *step;
                let seen = Seen { mode: command.mode, causes: command.causes, driven, late };
                self.view.step(self.monitor.t, seen, || text_line(&self.monitor, step, damaged))
            }
            News::Fault(fault) => self.view.say(&format!("fault: {fault}")),
            News::Log(words) => self.view.say(&format!("log: {}", printable(&words))),
            News::Unknown => Ok(()),
        }
    }

    /// Shows the summary and completes the files.
    fn end(&mut self) -> Result<(), Failure> {
        self.files.finish()?;
        self.view.say(&summary(&self.monitor, self.damaged()))
    }

    fn reception(&self) -> Reception {
        let (frames, damaged) = (self.client.whole(), self.damaged());
        Reception { frames, damaged, unknown: self.monitor.unknown, rest: self.rest }
    }

    fn damaged(&self) -> u32 {
        self.client.damaged().wrapping_sub(self.damaged_before)
    }
}
