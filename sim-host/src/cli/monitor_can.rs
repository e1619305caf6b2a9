//! `sim-host monitor --can`: a board by its frames on a CAN bus, as they arrive or from a recording.

use super::monitor::{Args, SILENCE};
use super::monitor_files::{Files, both, failed, open};
use super::monitor_text::{cause_lines, cause_names, limit_names};
use super::monitor_view::{Seen, View};
use super::outputs::complain;
use super::{Ended, Failure, UsageError, interrupt};
use crate::board::broadcast::{Broadcast, BroadcastMonitor, BroadcastRow};
use crate::board::socketcan::{ArrivedFrame, Bus};
use crate::counted::counted;
use crate::recording::frames::{Frames, Id};
use crate::recording::{Remark, frames};
use control::{Causes, Mode};
use link::can::{CAUSES, STATE};
use serde_json::json;
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

/// State of a session.
struct Session {
    monitor: BroadcastMonitor,
    /// Error and remote frames.
    errors: u64,
    remote: u64,
    view: View,
    /// The newest known mode and causes.
    seen: Seen,
    files: Files,
}

pub(super) fn run(args: &Args, source: &str, quiet: bool) -> Result<Ended, Failure> {
    let path = Path::new(source);
    if path.exists() && !path.is_file() {
        return Err(format!("{source} is neither a file nor a CAN interface").into());
    }
    if !path.is_file() {
        let bus = Bus::open(source)?;
        let mut session = Session::new(args, source, None, quiet)?;
        let followed = session.follow(args, source, &bus);
        return both(followed, session.end(&[])).map(|((), ended)| ended);
    }
    let idle = [("--record", args.record.is_some()), ("--for", args.length.is_some())];
    if let Some((option, _)) = idle.into_iter().find(|(_, given)| *given) {
        let what = format!("{option} is for a CAN interface; {source} is a recording");
        return Err(UsageError(what).into());
    }
    let frames = frames(path)?;
    // One board: the first bus with its frames.
    let board = |id: Id| eleven_bits(id).is_some_and(|id| (STATE..=CAUSES).contains(&id));
    let Some(first) = frames.iter().find(|frame| board(frame.id)) else {
        let (count, from, to) = (counted(frames.len() as u64, "frame", "frames"), STATE, CAUSES);
        return Err(format!("{source}: {count}, none of a board (identifiers {from:#x} to {to:#x})").into());
    };
    let mut session = Session::new(args, source, Some(first.time_s), quiet)?;
    let read = session.read(&frames, first.bus);
    both(read, session.end(&frames.remarks)).map(|((), ended)| ended)
}

/// The number of an identifier of 11 bits.
fn eleven_bits(id: Id) -> Option<u16> {
    u16::try_from(id.number).ok().filter(|_| !id.extended)
}

impl Session {
    fn new(args: &Args, source: &str, start_s: Option<f64>, quiet: bool) -> Result<Self, Failure> {
        let config = json!({"can": {"source": source, "start_s": start_s}});
        let (csv, mcap, live) = (args.csv.as_deref(), args.mcap.as_deref(), start_s.is_none());
        let files = Files::create::<BroadcastRow>(csv, mcap, "/can", &config, live)?;
        let view = if quiet { View::None } else { View::new(format!("CAN: {source}"))? };
        let seen = Seen { mode: Mode::Off, causes: Causes::NONE, driven: false, late: 0 };
        Ok(Self { monitor: BroadcastMonitor::default(), errors: 0, remote: 0, view, seen, files })
    }

    /// Receives frames until the end.
    fn follow(&mut self, args: &Args, interface: &str, bus: &Bus) -> Result<(), Failure> {
        let mut record =
            args.record.as_deref().map(|path| Ok::<_, Failure>((path, open(path)?))).transpose()?;
        let length = args.length.map(Duration::from_secs_f64);
        let (begin, mut last_received, mut silence_shown) = (Instant::now(), Instant::now(), false);
        loop {
            if interrupt::stopped() || length.is_some_and(|length| begin.elapsed() >= length) {
                return Ok(());
            }
            match bus.receive(Duration::from_millis(50))? {
                Some(arrived) => {
                    (last_received, silence_shown) = (Instant::now(), false);
                    match arrived.frame {
                        ArrivedFrame::Data(id, data) => {
                            if let Some((path, to)) = &mut record {
                                let line = candump(arrived.time_s, interface, id, &data);
                                let written = to.write_all(line.as_bytes());
                                written.map_err(|error| failed(path, error))?;
                            }
                            self.take(arrived.time_s, eleven_bits(id), &data)?;
                        }
                        ArrivedFrame::Remote => self.remote += 1,
                        ArrivedFrame::Error => self.errors += 1,
                    }
                }
                None if last_received.elapsed() > SILENCE && !std::mem::replace(&mut silence_shown, true) => {
                    self.view.say(&format!("no data for {} s", SILENCE.as_secs()))?;
                }
                None => {}
            }
            self.files.flush()?;
            self.draw()?;
        }
    }

    /// Processes a recording; frames of other buses count as others.
    fn read(&mut self, frames: &Frames, bus: u32) -> Result<(), Failure> {
        (self.errors, self.remote) = (frames.errors, frames.remote);
        for frame in frames.iter() {
            if interrupt::stopped() {
                break;
            }
            self.take(frame.time_s, eleven_bits(frame.id).filter(|_| frame.bus == bus), frame.data)?;
        }
        self.draw()
    }

    fn take(&mut self, time_s: f64, identifier: Option<u16>, data: &[u8]) -> Result<(), Failure> {
        self.monitor.take(time_s, identifier, data).iter().try_for_each(|broadcast| self.show(broadcast))
    }

    fn show(&mut self, broadcast: &Broadcast) -> Result<(), Failure> {
        let row = broadcast.row();
        self.files.write(self.monitor.start_s.unwrap_or_default() + row.t, &row)?;
        if let Some(state) = broadcast.state {
            (self.seen.mode, self.seen.driven) = (state.mode, state.driven);
        }
        if let Some(jump_s) = broadcast.clock_jump_s {
            let t = broadcast.t - jump_s;
            self.view.say(&format!(
                "the receiver's clock jumped ahead by {jump_s:.3} s at {t:.3} s; by the count of control steps nothing is missing"
            ))?;
        }
        self.seen.causes = broadcast.causes.unwrap_or(self.seen.causes);
        self.view.step(row.t, self.seen, || line(broadcast, self.monitor.counts.missing))
    }

    fn draw(&mut self) -> Result<(), Failure> {
        let (newest, causes, counts) = (self.monitor.newest, self.seen.causes, self.counts());
        self.view.draw(|| newest.iter().flat_map(panel).chain(cause_lines(causes)).chain([counts]).collect())
    }

    /// Completes the files and shows the summary; with data that was not decoded, says which.
    fn end(&mut self, remarks: &[Remark]) -> Result<Ended, Failure> {
        let shown = self.monitor.end().iter().try_for_each(|broadcast| self.show(broadcast));
        both(shown, self.files.finish())?;
        let t = self.monitor.newest.map_or(0.0, |newest| newest.t);
        let summary = format!("{}; {t:.3} s", self.counts());
        self.view.say(&summary)?;
        let counts = self.monitor.counts;
        let unread: Vec<String> = [
            (counts.wrong_length, ["frame of a wrong length", "frames of a wrong length"]),
            (counts.unknown, ["frame not understood", "frames not understood"]),
        ]
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, [one, several])| counted(count, one, several))
        .chain(remarks.iter().map(ToString::to_string))
        .collect();
        if !unread.is_empty() {
            complain(&format!("warning: part of the data was not decoded: {}", unread.join(", ")));
        }
        let skipped = [(self.errors, "error frames"), (self.remote, "remote frames, which have no data")];
        for (count, what) in skipped.into_iter().filter(|(count, _)| *count > 0) {
            complain(&format!("warning: {what}: {count}; left out"));
        }
        let ended = if unread.is_empty() { Ended::Done } else { Ended::Partly };
        Ok(if interrupt::stopped() { Ended::Interrupted } else { ended })
    }

    /// Counts of received frames.
    fn counts(&self) -> String {
        let counts = self.monitor.counts;
        let further = [
            (counts.wrong_length, ["of a wrong length"; 2]),
            (counts.unknown, ["not understood"; 2]),
            (counts.other, ["of others"; 2]),
            (self.errors, ["error frame", "error frames"]),
            (self.remote, ["remote frame", "remote frames"]),
            (counts.stopped, ["broadcast with control stopped", "broadcasts with control stopped"]),
            (counts.time_backs, ["time back", "times back"]),
            (counts.clock_jumps, ["jump of the clock ahead", "jumps of the clock ahead"]),
        ];
        let further = further.into_iter().filter(|(count, _)| *count > 0);
        let further: String =
            further.map(|(count, [one, several])| format!(", {}", counted(count, one, several))).collect();
        format!("{}, {} missing{further}", counted(counts.frames, "frame", "frames"), counts.missing)
    }
}

fn number(value: Option<f32>) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.2}"))
}

/// A broadcast in a line; values that are not known as -.
fn line(broadcast: &Broadcast, missing: u64) -> String {
    let row = broadcast.row();
    let state = match broadcast.state {
        Some(state) => format!("{}{}", state.mode.name(), if state.driven { "" } else { " (motor off)" }),
        None => "state missing".to_owned(),
    };
    format!(
        "{:.3} s {state}, torque {} N m, roll rate {} rad/s, steer {} rad, speed rear {} m/s, authority {}, limits {}, causes {}, missing {missing}",
        row.t,
        number(row.torque),
        number(row.measured_roll_rate),
        number(row.measured_steer),
        number(row.measured_rear_speed),
        number(row.authority),
        broadcast.state.map_or("-".to_owned(), |state| limit_names(state.limits)),
        broadcast.causes.map_or("-".to_owned(), cause_names),
    )
}

/// A broadcast in several lines, without its causes.
fn panel(broadcast: &Broadcast) -> Vec<String> {
    let row = broadcast.row();
    let switch = |on: Option<bool>| on.map_or("-", |on| if on { "on" } else { "off" });
    vec![
        format!("{:10.3} s", row.t),
        format!(
            "mode       {}, motor {}, switch {}",
            broadcast.state.map_or("-", |state| state.mode.name()),
            switch(row.driven),
            switch(row.engage)
        ),
        format!(
            "torque     {:>8} N m     motor {:>8} N m     authority {:>5}",
            number(row.torque),
            number(row.measured_motor_torque),
            number(row.authority)
        ),
        format!(
            "roll rate  {:>8} rad/s   steer {:>8} rad",
            number(row.measured_roll_rate),
            number(row.measured_steer)
        ),
        format!("speed      {:>8} rear, m/s", number(row.measured_rear_speed)),
        format!("limits     {}", broadcast.state.map_or("-".to_owned(), |state| limit_names(state.limits))),
    ]
}

/// A frame as a line of `candump -L`.
fn candump(time_s: f64, interface: &str, id: Id, data: &[u8]) -> String {
    let digits = if id.extended { 8 } else { 3 };
    let bytes: String = data.iter().map(|byte| format!("{byte:02X}")).collect();
    format!("({time_s:.6}) {interface} {:0digits$X}#{bytes}\n", id.number)
}
