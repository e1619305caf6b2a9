//! What is made of all that a board tells: its state, and what was lost on the way.

use super::fault::Fault;
use super::row::Row;
use super::told::Told;
use link::message::Message;
use link::telemetry::Telemetry;

/// What was heard so far.
#[derive(Debug, Default)]
pub struct Monitor {
    /// Frames that came in.
    pub frames: u64,
    /// Frames that did not, by the gaps in their numbers.
    pub missing: u64,
    /// Starts of the board while it was heard.
    pub restarts: u32,
    /// The newest control step.
    pub newest: Option<Telemetry>,
    /// The board's clock at that step \[s\].
    pub t: f64,
    time_us: u64,
    sequence: Option<u16>,
}

/// Something that was told.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// A control step.
    Step(Box<Row>),
    /// A fault.
    Fault(Box<Fault>),
    /// Words.
    Log(String),
    /// Something that this program does not know.
    Unknown,
}

impl Monitor {
    /// Takes what came in next.
    pub fn take(&mut self, told: &Told) -> News {
        self.frames += 1;
        let news = match told.message() {
            Ok(Message::Telemetry(step)) => return self.step(told.sequence, step),
            Ok(Message::Fault(record)) => News::Fault(Box::new(record.into())),
            Ok(Message::Log(words)) => News::Log(words.into()),
            Ok(_) | Err(_) => News::Unknown,
        };
        self.count(told.sequence);
        news
    }

    fn step(&mut self, sequence: u16, step: Telemetry) -> News {
        let now_us = step.frame.now_us;
        match self.newest {
            // A board that starts anew numbers its frames anew.
            Some(before) if (step.steps.wrapping_sub(before.steps) as i32) < 0 => {
                self.restarts += 1;
                (self.sequence, self.time_us) = (Some(sequence), now_us.into());
            }
            Some(before) => {
                self.count(sequence);
                self.time_us += u64::from(now_us.wrapping_sub(before.frame.now_us));
            }
            None => {
                self.count(sequence);
                self.time_us = now_us.into();
            }
        }
        self.t = self.time_us as f64 / 1e6;
        self.newest = Some(step);
        News::Step(Box::new(Row::new(self.t, &step)))
    }

    /// Numbers that go back are those of a board that started anew, and no gap.
    fn count(&mut self, sequence: u16) {
        let gap = self.sequence.map_or(0, |last| sequence.wrapping_sub(last).wrapping_sub(1));
        self.missing += if gap > u16::MAX / 2 { 0 } else { u64::from(gap) };
        self.sequence = Some(sequence);
    }
}
