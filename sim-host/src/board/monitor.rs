//! State of a board from its unsolicited messages, with the count of lost frames.

use super::fault::Fault;
use super::received::ReceivedMessage;
use super::telemetry_row::TelemetryRow;
use link::message::Message;
use link::telemetry::Telemetry;

/// State from the messages so far.
#[derive(Debug, Default)]
pub struct Monitor {
    /// Frames received.
    pub frames: u64,
    /// Frames lost, from the gaps in their sequence numbers; where these wrapped meanwhile, from the control steps as
    /// well.
    pub missing: u64,
    /// Frames received whole whose content this program does not know.
    pub unknown: u64,
    /// Times the board's clock went back without a restart.
    pub clock_backs: u32,
    /// Restarts of the board while it was monitored.
    pub restarts: u32,
    /// The newest control step.
    pub newest: Option<Telemetry>,
    /// The board's clock at that step \[s\].
    pub t: f64,
    time_us: u64,
    counted: Counted,
}

/// Position up to which frames are counted.
#[derive(Debug, Default)]
struct Counted {
    /// Sequence number of the last counted frame.
    sequence: Option<u16>,
    /// Frames received since.
    since: u16,
    /// Control steps passed, and frames sent in them, as far as known.
    steps: u64,
    frames: u64,
}

impl Counted {
    /// Starts counting at this sequence number.
    fn from(sequence: u16) -> Self {
        Self { sequence: Some(sequence), ..Self::default() }
    }

    /// Frames lost before the frame `sequence`, which is `steps` control steps after the last counted one.
    ///
    /// The sequence numbers give the count modulo their range; the steps and the frame rate so far give the number of
    /// wraps. Numbers that go back are no gap.
    fn lost(&mut self, sequence: u16, steps: u32) -> u64 {
        let arrived = u64::from(std::mem::take(&mut self.since)) + 1;
        let Some(last) = self.sequence.replace(sequence) else { return 0 };
        let sent = i64::from(sequence.wrapping_sub(last));
        let expected = f64::from(steps) * self.frames as f64 / self.steps.max(1) as f64;
        let rounds = ((expected - sent as f64) / ROUND as f64).round() as i64;
        let sent = u64::try_from(sent + rounds * ROUND).unwrap_or(0).max(arrived);
        (self.steps, self.frames) = (self.steps + u64::from(steps), self.frames + sent);
        sent - arrived
    }
}

/// Number of frames after which the sequence numbers wrap.
const ROUND: i64 = 1 << 16;

/// Fewer control steps than 2147 s take at the lowest rate of 100 Hz; 2147 s is half the range of the board's clock.
const HALF_ROUND_STEPS: u32 = 100_000;

/// Content of an unsolicited message.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// A control step.
    Step(Box<TelemetryRow>),
    /// A fault.
    Fault(Box<Fault>),
    /// Log text.
    Log(String),
    /// Content that this program does not know.
    Unknown,
}

impl Monitor {
    /// Processes the next message.
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
            // A restarted board restarts its sequence numbers.
            Some(before) if (step.steps.wrapping_sub(before.steps) as i32) < 0 => {
                self.restarts += 1;
                (self.counted, self.time_us) = (Counted::from(sequence), now_us.into());
            }
            Some(before) => {
                let steps = step.steps.wrapping_sub(before.steps);
                self.missing += self.counted.lost(sequence, steps);
                let ahead = now_us.wrapping_sub(before.frame.now_us);
                // A jump ahead by half the clock's range takes more control steps than this at any rate.
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
