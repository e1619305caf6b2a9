//! A board that is asked and answers, over a line that may lose or damage anything.

use super::received::ReceivedMessage;
use super::transport::{Transport, TransportError};
use link::frame::{MAX_FRAME, VERSION};
use link::message::{Message, NoMessage};
use link::rejection::RejectReason;
use link::{Decoder, Received};
use std::collections::VecDeque;
use std::time::{Duration, Instant, SystemTime};

/// Most of what came unasked that is kept for whoever looks at it; of more the newest.
const KEPT: usize = 4096;
/// Longest time a board takes to erase and write its flash, with much to spare.
const STORING: Duration = Duration::from_secs(5);

/// How long to wait for an answer, and how often to ask.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// Real time for one answer. The largest answer behind the largest telemetry takes 40 ms at 115200 baud.
    pub answer: Duration,
    /// How often the same is asked before giving up.
    pub tries: u32,
}

impl Default for Patience {
    fn default() -> Self {
        Self { answer: Duration::from_millis(400), tries: 5 }
    }
}

/// Why a board does not do what it is asked for.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The line.
    #[error(transparent)]
    Transport(#[from] TransportError),
    /// It speaks another version of the link.
    #[error("the board speaks version {theirs} of the link, this program version {VERSION}")]
    Version {
        /// The board's.
        theirs: u8,
    },
    /// It does not answer.
    #[error("no answer to `{requested}`, asked {tries} times, {} s each", wait.as_secs_f64())]
    Silent {
        /// What was asked.
        requested: String,
        /// How often.
        tries: u32,
        /// How long was waited each time.
        wait: Duration,
    },
    /// It refuses.
    #[error("the board refuses `{requested}`: {text}")]
    Refused {
        /// What was asked.
        requested: String,
        /// Why.
        why: RejectReason,
        /// Why, in words, with parameter and range.
        text: String,
    },
    /// Its answer is to something else.
    #[error("the board's answer to `{requested}` does not fit")]
    Unfit {
        /// What was asked.
        requested: String,
    },
}

impl ClientError {
    /// Whether the board may have carried out what it was asked for nevertheless.
    pub fn leaves_doubt(&self) -> bool {
        matches!(self, ClientError::Transport(_) | ClientError::Silent { .. })
    }
}

/// A board at the other end of a line.
pub struct Client {
    line: Box<dyn Transport>,
    timeout: Patience,
    decoder: Decoder,
    sequence: u16,
    received: VecDeque<ReceivedMessage>,
    whole: u64,
}

impl Client {
    /// Over `line`. Nothing is asked yet.
    pub fn new(line: Box<dyn Transport>, timeout: Patience) -> Self {
        // Answers to a program that went away may still come; they have other numbers.
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let sequence = now.subsec_micros() as u16;
        Self { line, timeout, decoder: Decoder::default(), sequence, received: VecDeque::new(), whole: 0 }
    }

    /// Asks until the answer comes, which `fits` reads; `requested` says in words what for.
    ///
    /// The same may be carried out more than once: an answer can get lost on its way back.
    ///
    /// # Errors
    /// As of [`ClientError`].
    pub fn ask<T>(
        &mut self,
        request: &Message<'_>,
        requested: &str,
        fits: impl Fn(&Message<'_>) -> Option<T>,
    ) -> Result<T, ClientError> {
        let mut bytes = [0; MAX_FRAME];
        self.sequence = self.sequence.wrapping_add(1);
        let unfit = || ClientError::Unfit { requested: requested.into() };
        let used = request.encode(self.sequence, &mut bytes).ok_or_else(unfit)?;
        let wait = if *request == Message::Store { STORING } else { self.timeout.answer };
        for _ in 0..self.timeout.tries {
            self.line.send(&bytes[..used])?;
            let Some(answer) = self.answer(wait)? else { continue };
            return match answer.message() {
                Ok(Message::Refused(refusal)) => {
                    let (requested, text) = (requested.into(), refusal.to_string());
                    Err(ClientError::Refused { requested, why: refusal.why, text })
                }
                Ok(message) => fits(&message).ok_or_else(unfit),
                Err(NoMessage::UnknownKind(_) | NoMessage::Malformed(_)) => Err(unfit()),
            };
        }
        Err(ClientError::Silent { requested: requested.into(), tries: self.timeout.tries, wait })
    }

    /// What the board said unasked since the last call, after waiting for it up to `timeout`.
    ///
    /// # Errors
    /// The line, or another version.
    pub fn listen(&mut self, timeout: Duration) -> Result<Vec<ReceivedMessage>, ClientError> {
        if self.received.is_empty() {
            let bytes = self.line.receive(timeout)?;
            self.take(&bytes, None)?;
        }
        Ok(self.received.drain(..).collect())
    }

    /// Opens the line anew after it was lost; `None` for one that never comes back. Who is there now is to be asked.
    pub fn reopen(&mut self) -> Option<Result<(), TransportError>> {
        self.line.reopen()
    }

    /// Frames that came damaged, since the start, wrapping.
    pub fn damaged(&self) -> u32 {
        let dropped = self.decoder.dropped();
        dropped.garbled.wrapping_add(dropped.too_long).wrapping_add(dropped.bad_crc)
    }

    /// Frames that came whole, since the start.
    pub fn whole(&self) -> u64 {
        self.whole
    }

    /// Waits for the answer to the newest request; `None` when none came in time.
    fn answer(&mut self, wait: Duration) -> Result<Option<ReceivedMessage>, ClientError> {
        let begin = Instant::now();
        loop {
            let rest = wait.saturating_sub(begin.elapsed());
            if rest.is_zero() {
                return Ok(None);
            }
            let bytes = self.line.receive(rest)?;
            if let Some(answer) = self.take(&bytes, Some(self.sequence))? {
                return Ok(Some(answer));
            }
        }
    }

    /// Takes what came in: the answer of this number, if it is among it; what is unasked is kept, all else is old.
    fn take(&mut self, bytes: &[u8], sequence: Option<u16>) -> Result<Option<ReceivedMessage>, ClientError> {
        let mut answer = None;
        for byte in bytes {
            let received = self.decoder.feed(*byte);
            self.whole += u64::from(matches!(received, Some(Received::Frame(_))));
            match received {
                Some(Received::WrongVersion { theirs }) => return Err(ClientError::Version { theirs }),
                Some(Received::Frame(frame)) if ReceivedMessage::is_unasked(&frame) => {
                    if self.received.len() == KEPT {
                        self.received.pop_front();
                    }
                    self.received.push_back(ReceivedMessage::new(&frame));
                }
                Some(Received::Frame(frame)) if Some(frame.sequence) == sequence => {
                    answer = Some(ReceivedMessage::new(&frame));
                }
                Some(Received::Frame(_)) | None => {}
            }
        }
        Ok(answer)
    }
}
