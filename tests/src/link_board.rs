//! A board made of the `link` crate alone, and a transport to it that can lose, change and delay bytes.

use control::{ActiveLimits, CAUSES, Causes, Command, Config, Mode, SensorFrame, Triple};
use link::frame::{CRC, Frame, MAX_FRAME, MAX_PAYLOAD};
use link::message::Message;
use link::page::PAGE_BYTES;
use link::rejection::{RejectReason, Rejection};
use link::report::{FaultKind, FaultRecord, Hello, ResetCause, StoredFault, config_hash};
use link::requests::{answer, request};
use link::telemetry::Telemetry;
use link::{Decoder, Received};
use sim_host::board::{Transport, TransportError};
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A board without hardware.
pub struct LinkBoard {
    /// The configuration in force.
    pub config: Config,
    /// Configuration in its flash.
    pub stored: Option<Config>,
    /// Whether torque may flow.
    pub engaged: bool,
    /// Its stored faults, newest first.
    pub faults: Vec<FaultRecord<'static>>,
    /// Its protocol version; with another than this crate's it answers only with its version.
    pub version: u8,
    /// Number of complete requests received.
    pub requests: u32,
    /// Decoder of the received bytes.
    pub decoder: Decoder,
    /// Sequence number of its next unsolicited message.
    pub sequence: u16,
}

impl Default for LinkBoard {
    fn default() -> Self {
        Self {
            config: Config::product(),
            stored: None,
            engaged: false,
            faults: Vec::new(),
            version: link::frame::VERSION,
            requests: 0,
            decoder: Decoder::default(),
            sequence: 0,
        }
    }
}

impl LinkBoard {
    /// Processes received bytes; returns the answers.
    pub fn take(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        for byte in bytes {
            let Some(received) = self.decoder.feed(*byte) else { continue };
            // The answer borrows the received bytes, and `reply` needs the whole board.
            let complete = match &received {
                Received::Frame(frame) => (frame.kind, frame.sequence, frame.payload.to_vec()),
                Received::WrongVersion { .. } => continue,
            };
            self.requests += 1;
            out.extend(self.reply(complete.0, complete.1, &complete.2));
        }
        out
    }

    fn reply(&mut self, kind: u8, sequence: u16, payload: &[u8]) -> Vec<u8> {
        if self.version != link::frame::VERSION {
            return other_version(self.version);
        }
        let (sequence, message) = match request(&Received::Frame(Frame { kind, sequence, payload })) {
            Ok(request) => request,
            Err(wrong) => {
                let (sequence, answer) = wrong.answer();
                return encoded(&answer, sequence);
            }
        };
        let (image, version, commit) = ("fake", "0.1.0", "0123456789ab");
        let mut room = [0; PAGE_BYTES];
        let defaults = Config::product();
        if let Some(answer) = answer(&defaults, &mut self.config, self.engaged, &message, &mut room) {
            return encoded(&answer, sequence);
        }
        let answer = match message {
            Message::AskHello => {
                Message::Hello(Hello { image, version, commit, config_hash: config_hash(&self.config) })
            }
            Message::Store => {
                self.stored = Some(self.config.clone());
                Message::Done
            }
            Message::ListFaults { from } => Message::StoredFault(StoredFault {
                place: from,
                total: self.faults.len() as u16,
                record: self.faults.get(usize::from(from)).copied(),
            }),
            Message::ClearFaults => {
                self.faults.clear();
                Message::Done
            }
            _ => Message::Rejected(Rejection::of(RejectReason::NotHere)),
        };
        encoded(&answer, sequence)
    }

    /// An unsolicited message, under the next number.
    pub fn unsolicited(&mut self, message: &Message<'_>) -> Vec<u8> {
        let bytes = encoded(message, self.sequence);
        self.sequence = self.sequence.wrapping_add(1);
        bytes
    }
}

/// A message on the line.
pub fn encoded(message: &Message<'_>, sequence: u16) -> Vec<u8> {
    let mut bytes = [0; MAX_FRAME];
    let used = message.encode(sequence, &mut bytes).expect("room");
    bytes[..used].to_vec()
}

/// A complete frame of another version.
fn other_version(version: u8) -> Vec<u8> {
    let mut plain = vec![version, 0x87, 0, 0, link::frame::VERSION];
    plain.extend(CRC.checksum(&plain).to_le_bytes());
    let mut stuffed = [0; MAX_PAYLOAD];
    let used = cobs::encode(&plain, &mut stuffed);
    [&[0], &stuffed[..used], &[0]].concat()
}

/// A control step: riding at 4 m/s, engaged, with two causes and a limit, `steps` milliseconds after the start.
pub fn telemetry(steps: u32) -> Telemetry {
    let frame = SensorFrame {
        now_us: steps.wrapping_mul(1000),
        gyro_rad_s: Triple::fresh([0.25, -0.5, 0.125]),
        front_wheel_m_s: control::Sample::fresh(4.0),
        engage: true,
        ..SensorFrame::missing()
    };
    let command = Command {
        torque_nm: 1.5,
        gain_nm_s_rad: 6.0,
        limits: ActiveLimits::RATE,
        mode: Mode::Engaged,
        causes: Causes::all(&[CAUSES[16], CAUSES[45]]),
    };
    Telemetry {
        steps,
        late: 2,
        driven: true,
        frame,
        command,
        slopes: [None, Some(0.5)],
        polarity: 3,
        polarity_torque_nm: 0.0,
    }
}

/// A fault of each kind, the newest first.
pub fn faults() -> Vec<FaultRecord<'static>> {
    let of = |kind, boot, text| FaultRecord {
        kind,
        boot,
        reset: ResetCause::Software,
        mode: Mode::Engaged,
        steps: 1234,
        frame_us: 1_234_000,
        causes: Causes::NONE,
        exception: 0,
        registers: [0; 6],
        text,
    };
    vec![
        FaultRecord { causes: Causes::all(&[CAUSES[0], CAUSES[56]]), ..of(FaultKind::Controller, 5, "") },
        of(FaultKind::BrownOut, 4, ""),
        FaultRecord { reset: ResetCause::Watchdog, ..of(FaultKind::Watchdog, 3, "") },
        FaultRecord {
            exception: 5,
            // PRECISERR and BFARVALID; FORCED.
            registers: [0x8200, 0x4000_0000, 0xdead_beef, 0x2000_1000, 0x0800_1234, 0x0800_4321],
            ..of(FaultKind::Exception, 2, "")
        },
        of(FaultKind::Panic, 1, "panicked at src/tasks/control.rs:12:5:\nattempt to divide by zero"),
        of(FaultKind::Drive, 1, "gate driver: over-current low a, fault, status 410 001"),
    ]
}

/// A board with several owners.
pub type Shared = Arc<Mutex<LinkBoard>>;

/// A shared board.
pub fn shared(board: LinkBoard) -> Shared {
    Arc::new(Mutex::new(board))
}

/// The board, also after another thread has panicked.
pub fn lock(board: &Shared) -> MutexGuard<'_, LinkBoard> {
    board.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Effect of the channel on some bytes.
pub type Fate = Box<dyn FnMut(Vec<u8>) -> LinkChannel + Send>;

/// Result of a transfer.
pub enum LinkChannel {
    /// They arrive, possibly changed.
    Arrives(Vec<u8>),
    /// They arrive after the next ones were sent.
    Late(Vec<u8>),
    /// The connection is lost from now on.
    Lost,
}

/// A connection in this process.
pub struct Wire {
    board: Shared,
    to_board: Fate,
    from_board: Fate,
    waiting: Vec<u8>,
    late: Vec<u8>,
    lost: bool,
}

impl Wire {
    /// To `board`, with the channel's effects in both directions.
    pub fn new(board: &Shared, to_board: Fate, from_board: Fate) -> Self {
        Self {
            board: board.clone(),
            to_board,
            from_board,
            waiting: Vec::new(),
            late: Vec::new(),
            lost: false,
        }
    }

    /// A connection on which everything arrives.
    pub fn good(board: &Shared) -> Self {
        Self::new(board, Box::new(LinkChannel::Arrives), Box::new(LinkChannel::Arrives))
    }

    fn check(&self) -> Result<(), TransportError> {
        let error = || io::ErrorKind::BrokenPipe.into();
        if self.lost { Err(TransportError::Lost { line: "wire".into(), error: error() }) } else { Ok(()) }
    }
}

impl Transport for Wire {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        self.check()?;
        self.waiting.append(&mut self.late);
        let there = match (self.to_board)(bytes.to_vec()) {
            LinkChannel::Arrives(bytes) | LinkChannel::Late(bytes) => bytes,
            LinkChannel::Lost => {
                self.lost = true;
                return self.check();
            }
        };
        let answer = lock(&self.board).take(&there);
        match (self.from_board)(answer) {
            LinkChannel::Arrives(mut bytes) => self.waiting.append(&mut bytes),
            LinkChannel::Late(mut bytes) => self.late.append(&mut bytes),
            LinkChannel::Lost => self.lost = true,
        }
        Ok(())
    }

    fn receive(&mut self, timeout: Duration) -> Result<Vec<u8>, TransportError> {
        let bytes = std::mem::take(&mut self.waiting);
        if bytes.is_empty() {
            self.check()?;
            // Nothing arrives before something is sent.
            std::thread::sleep(timeout);
        }
        Ok(bytes)
    }
}
