//! What is made of all that a board tells: its state, and what was lost on the way.

use super::fault::Fault;
use super::received::ReceivedMessage;
use super::telemetry_row::TelemetryRow;
use link::message::Message;
use link::telemetry::Telemetry;

/// What was heard so far.
#[derive(Debug, Default)]
pub struct Monitor {
    /// Frames that came in.
    pub frames: u64,
    /// Frames that did not, by the gaps in their numbers; where these went round meanwhile, by the control steps as well.
    pub missing: u64,
    /// Frames that came whole and say what this program does not know.
    pub unknown: u64,
    /// How often the board's clock went back without a start.
    pub clock_backs: u32,
    /// Starts of the board while it was heard.
    pub restarts: u32,
    /// The newest control step.
    pub newest: Option<Telemetry>,
    /// The board's clock at that step \[s\].
    pub t: f64,
    time_us: u64,
    counted: Counted,
}

/// How far frames are counted.
#[derive(Debug, Default)]
struct Counted {
    /// The number of the frame up to which they are.
    sequence: Option<u16>,
    /// Frames that came in since.
    since: u16,
    /// Control steps that went by, and frames that were sent in them, as far as is known.
    steps: u64,
    frames: u64,
}

impl Counted {
    /// From a frame of this number on.
    fn from(sequence: u16) -> Self {
        Self { sequence: Some(sequence), ..Self::default() }
    }

    /// Frames lost before that of number `sequence`, so many control steps after the last one that was counted.
    ///
    /// The numbers tell it but for whole rounds; how many of these, the steps tell, at the rate of frames until then. Numbers
    /// that go back are no gap.
    fn lost(&mut self, sequence: u16, steps: u32) -> u64 {
        let reception = u64::from(std::mem::take(&mut self.since)) + 1;
        let Some(last) = self.sequence.replace(sequence) else { return 0 };
        let sent = i64::from(sequence.wrapping_sub(last));
        let expected = f64::from(steps) * self.frames as f64 / self.steps.max(1) as f64;
        let rounds = ((expected - sent as f64) / ROUND as f64).round() as i64;
        let sent = u64::try_from(sent + rounds * ROUND).unwrap_or(0).max(reception);
        (self.steps, self.frames) = (self.steps + u64::from(steps), self.frames + sent);
        sent - reception
    }
}

/// Frames after which their numbers begin anew.
const ROUND: i64 = 1 << 16;

/// Fewer control steps than are done in 2147 s, half of what the board's clock counts, at the lowest rate of 100 Hz.
const HALF_ROUND_STEPS: u32 = 100_000;

/// Something that was told.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// A control step.
    Step(Box<TelemetryRow>),
    /// A fault.
    Fault(Box<Fault>),
    /// Words.
    Log(String),
    /// Something that this program does not know.
    Unknown,
}

impl Monitor {
    /// Takes what came in next.
    pub fn take(&mut self, received: &ReceivedMessage) -> News {
        self.frames += 1;
        let news = match received.message() {
            Ok(Message::Telemetry(step)) => return self.step(received.sequence, step),
            Ok(Message::Fault(record)) => News::Fault(Box::new(record.into())),
            Ok(Message::Log(words)) => News::Log(words.into()),
            Ok(_) | Err(_) => {
                self.unknown += 1;
                News::Unknown
            }
        };
        match self.counted.sequence {
            Some(_) => self.counted.since = self.counted.since.wrapping_add(1),
            None => self.counted = Counted::from(received.sequence),
        }
        news
    }

    fn step(&mut self, sequence: u16, step: Telemetry) -> News {
        let now_us = step.frame.now_us;
        match self.newest {
            // A board that starts anew numbers its frames anew.
            Some(before) if (step.steps.wrapping_sub(before.steps) as i32) < 0 => {
                self.restarts += 1;
                (self.counted, self.time_us) = (Counted::from(sequence), now_us.into());
            }
            Some(before) => {
                let steps = step.steps.wrapping_sub(before.steps);
                self.missing += self.counted.lost(sequence, steps);
                let ahead = now_us.wrapping_sub(before.frame.now_us);
                // Half of the clock's round ahead takes more control steps than that at any rate.
                if (ahead as i32) < 0 && steps < HALF_ROUND_STEPS {
                    self.clock_backs += 1;
                    self.time_us = self.time_us.saturating_sub(ahead.wrapping_neg().into());
                } else {
                    self.time_us += u64::from(ahead);
                }
            }
            None => {
                self.missing += self.counted.lost(sequence, 0);
                self.time_us = now_us.into();
            }
        }
        self.t = self.time_us as f64 / 1e6;
        self.newest = Some(step);
        News::Step(Box::new(TelemetryRow::new(self.t, &step)))
    }
}
