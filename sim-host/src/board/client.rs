//! Requests to a board and their answers, over a line that can lose or damage anything.

use super::received::ReceivedMessage;
use super::transport::{Transport, TransportError};
use link::frame::{MAX_FRAME, VERSION};
use link::message::{Message, NoMessage};
use link::rejection::RejectReason;
use link::{Decoder, Received};
use std::collections::VecDeque;
use std::time::{Duration, Instant, SystemTime};

/// Number of unsolicited messages stored for [`Client::listen`]; the newest are kept.
const UNSOLICITED_MAX: usize = 4096;
/// Longest time after which a board has stored or restarted: its supervision waits 8 s for a store, its watchdog then 2 s.
const STORING: Duration = Duration::from_secs(11);

/// Timeout and number of attempts of a request.
#[derive(Clone, Copy, Debug)]
pub struct RetryPolicy {
    /// Real time for one answer. The largest answer behind the largest telemetry takes 40 ms at 115200 baud.
    pub answer: Duration,
    /// Attempts before giving up.
    pub tries: u32,
}

impl Default for RetryPolicy {
    fn default() -> Self {
        Self { answer: Duration::from_millis(400), tries: 5 }
    }
}

/// Why a request to a board failed.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The line failed.
    #[error(transparent)]
    Transport(#[from] TransportError),
    /// The board uses another version of the link.
    #[error(
        "the board uses version {theirs} of the link, this program version {VERSION}: flash the firmware of this program's release, or use the sim-host of the board's"
    )]
    Version {
        /// The board's version.
        theirs: u8,
    },
    /// The board does not answer.
    #[error("no answer to `{requested}`, sent {tries} times, {} s each", wait.as_secs_f64())]
    Silent {
        /// The request.
        requested: String,
        /// Number of attempts.
        tries: u32,
        /// Timeout of each attempt.
        wait: Duration,
    },
    /// The board rejects the request.
    #[error("the board rejects `{requested}`: {text}")]
    Refused {
        /// The request.
        requested: String,
        /// The reason.
        reason: RejectReason,
        /// The reason as text, with parameter and range.
        text: String,
    },
    /// The answer belongs to another request.
    #[error("the board's answer does not match `{requested}`")]
    Mismatch {
        /// The request.
        requested: String,
    },
}

impl ClientError {
    /// Whether the board may have carried out the request nevertheless.
    pub fn leaves_doubt(&self) -> bool {
        matches!(self, ClientError::Transport(_) | ClientError::Silent { .. })
    }
}

/// The connection to a board.
pub struct Client {
    line: Box<dyn Transport>,
    retry: RetryPolicy,
    decoder: Decoder,
    sequence: u16,
    received: VecDeque<ReceivedMessage>,
    whole: u64,
}

impl Client {
    /// A connection over `line`; sends nothing yet.
    pub fn new(line: Box<dyn Transport>, retry: RetryPolicy) -> Self {
        // Answers to an earlier program can still arrive; their sequence numbers differ.
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let sequence = now.subsec_micros() as u16;
        Self { line, retry, decoder: Decoder::default(), sequence, received: VecDeque::new(), whole: 0 }
    }

    /// Sends a request, repeatedly if need be, until its answer arrives or the tries are used up. `fits` decodes the
    /// answer; `requested` names the request in errors.
    ///
    /// The board may carry out the request more than once, since an answer can be lost.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn ask<T>(
        &mut self,
        request: &Message<'_>,
        requested: &str,
        fits: impl Fn(&Message<'_>) -> Option<T>,
    ) -> Result<T, ClientError> {
        let mut bytes = [0; MAX_FRAME];
        self.sequence = self.sequence.wrapping_add(1);
        let mismatch = || ClientError::Mismatch { requested: requested.into() };
        let used = request.encode(self.sequence, &mut bytes).ok_or_else(mismatch)?;
        let wait = if *request == Message::Store { STORING } else { self.retry.answer };
        for _ in 0..self.retry.tries {
            self.line.send(&bytes[..used])?;
            let Some(answer) = self.answer(wait)? else { continue };
            return match answer.message() {
                Ok(Message::Rejected(rejection)) => {
                    let (requested, text) = (requested.into(), rejection.to_string());
                    Err(ClientError::Refused { requested, reason: rejection.reason, text })
                }
                Ok(message) => fits(&message).ok_or_else(mismatch),
                Err(NoMessage::UnknownKind(_) | NoMessage::Malformed(_)) => Err(mismatch()),
            };
        }
        Err(ClientError::Silent { requested: requested.into(), tries: self.retry.tries, wait })
    }

    /// The unsolicited messages since the last call, after waiting up to `timeout` for the first one.
    ///
    /// # Errors
    /// The line failed, or the board uses another version.
    pub fn listen(&mut self, timeout: Duration) -> Result<Vec<ReceivedMessage>, ClientError> {
        if self.received.is_empty() {
            let bytes = self.line.receive(timeout)?;
            self.take(&bytes, None)?;
        }
        Ok(self.received.drain(..).collect())
    }

    /// Reopens a lost line; `None` for a line that cannot be reopened. The board may then be another one: request its
    /// identity.
    pub fn reopen(&mut self) -> Option<Result<(), TransportError>> {
        self.line.reopen()
    }

    /// Frames received damaged since the start, wrapping.
    pub fn damaged(&self) -> u32 {
        let dropped = self.decoder.dropped();
        dropped.garbled.wrapping_add(dropped.too_long).wrapping_add(dropped.bad_crc)
    }

    /// Frames received whole since the start.
    pub fn whole(&self) -> u64 {
        self.whole
    }

    /// Waits for the answer to the newest request; `None` on timeout.
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

    /// Decodes received bytes: returns the answer with this sequence number, stores unsolicited messages, drops late
    /// answers.
    fn take(&mut self, bytes: &[u8], sequence: Option<u16>) -> Result<Option<ReceivedMessage>, ClientError> {
        let mut answer = None;
        for byte in bytes {
            let received = self.decoder.feed(*byte);
            self.whole += u64::from(matches!(received, Some(Received::Frame(_))));
            match received {
                Some(Received::WrongVersion { theirs }) => return Err(ClientError::Version { theirs }),
                Some(Received::Frame(frame)) if ReceivedMessage::is_unsolicited(&frame) => {
                    if self.received.len() == UNSOLICITED_MAX {
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
