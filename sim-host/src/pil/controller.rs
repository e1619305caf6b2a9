//! The controller of a ride: a board in lockstep, reached over a link that can have faults.

use super::link_fault::LinkChannel;
use super::{BoardError, Direction, LinkFault, Lockstep};
use crate::num::RandomStream;
use crate::ride::{Remote, RemoteError, Start, Stepped};
use control::wire::encode_config;
use control::{Plan, SensorFrame};
use link::frame::MAX_FRAME;
use link::lockstep::{COMMAND_TIMEOUT_MS, ToBoard};
use link::message::NoMessage;
use link::{Decoder, Message, Received};

/// Bytes of the configuration in one message.
const PIECE: usize = 300;
/// The only control rate of an emulated board \[Hz\].
const RATE_HZ: f32 = 1000.0;
/// The link's faults use their own random streams, separate from those of the sensors and their faults.
const RANDOM_STREAM: u64 = 1 << 32;

/// Counts over all rides of a controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Control steps.
    pub steps: u64,
    /// Control steps affected by a link fault.
    pub affected: u64,
    /// Control steps without the board: its time advanced by more than one period.
    pub missed: u64,
    /// Restarts of the chip during a ride.
    pub restarts: u64,
}

/// A controller on a board: takes sensor frames, returns motor commands.
#[derive(Debug)]
pub struct Controller<B> {
    /// The board.
    pub board: B,
    faults: Vec<LinkFault>,
    seed: u64,
    ride: RideState,
    tally: Tally,
}

/// State of the current ride.
#[derive(Debug)]
struct RideState {
    /// Sequence number of its reset.
    number: u16,
    /// Messages with configuration and reset, until they are sent.
    opening: Vec<u8>,
    /// Control steps since the reset.
    step: u32,
    /// The control step at which the board's step count was 0.
    step_zero: u32,
    /// Control steps from t = 0; `None` before.
    tick: Option<u32>,
    sensors: LinkChannel,
    motor: LinkChannel,
    decoder: Decoder,
    /// The newest command, and for how many control steps it was held.
    held: (Stepped, u32),
    /// Control steps by which the board's time is ahead, and the command received at their end.
    ahead: Option<(u32, Option<Stepped>)>,
    /// Whether the chip restarted and no longer counts the ride's steps.
    restarted: bool,
}

impl RideState {
    fn new(number: u16, faults: &[LinkFault], seed: u64, start: &Start) -> Self {
        let passage = |direction: Direction| {
            LinkChannel::new(
                faults,
                direction,
                RandomStream::new(seed, start.key(), RANDOM_STREAM + direction as u64),
            )
        };
        Self {
            number,
            opening: Vec::new(),
            step: 0,
            step_zero: 0,
            tick: None,
            sensors: passage(Direction::Sensors),
            motor: passage(Direction::Motor),
            decoder: Decoder::default(),
            held: (Stepped::OFF, 0),
            ahead: None,
            restarted: false,
        }
    }

    /// Sequence number of this control step's sensor frame.
    fn sequence(&self) -> u16 {
        self.step.wrapping_sub(self.step_zero) as u16
    }

    /// What the motor does in a control step: the new command, or the previous one while it may be held.
    fn motor(&mut self, newest: Option<Stepped>) -> Stepped {
        self.held = match (newest, self.held) {
            (Some(newest), _) => (newest, 0),
            (None, (held, periods)) if periods < COMMAND_TIMEOUT_MS => (held, periods + 1),
            (None, _) => (Stepped::OFF, COMMAND_TIMEOUT_MS),
        };
        self.held.0
    }

    fn violation(&self, what: impl Into<String>) -> BoardError {
        BoardError::Lockstep { step: self.step, what: what.into() }
    }
}

impl<B: Lockstep> Controller<B> {
    /// A controller on this board over a link with these faults; `seed` is for their random numbers.
    pub fn new(board: B, faults: &[LinkFault], seed: u64) -> Self {
        let ride = RideState::new(0, faults, seed, &Start::default());
        Self { board, faults: faults.into(), seed, ride, tally: Tally::default() }
    }

    /// The counts so far.
    pub fn tally(&self) -> Tally {
        self.tally
    }

    /// One exchange; returns the received command, if any, and the sequence number of its frame.
    fn exchange(&mut self, frame: &SensorFrame) -> Result<Option<(Stepped, u16)>, BoardError> {
        let ride = &mut self.ride;
        let mut sensors = Vec::with_capacity(MAX_FRAME);
        let sequence = ride.sequence();
        put(&Message::PilFrame(*frame), sequence, &mut sensors);
        if let Some(tick) = ride.tick {
            ride.sensors.pass(tick, &mut sensors);
        }
        let resets = !ride.opening.is_empty();
        if resets {
            ride.opening.append(&mut sensors);
            sensors = std::mem::take(&mut ride.opening);
        }
        self.board.exchange(&ToBoard { sensors: &sensors, line: &[] })?;
        let mut motor = self.board.last().motor.to_vec();
        if let Some(tick) = ride.tick {
            ride.motor.pass(tick, &mut motor);
        }
        let (mut command, mut reset) = (None, !resets);
        let mut bytes = &motor[..];
        while !bytes.is_empty() {
            let Some(Received::Frame(received)) = ride.decoder.take(&mut bytes) else { continue };
            match Message::decode(&received) {
                Ok(Message::PilCommand { command: newest, authority }) => {
                    command = Some((Stepped { command: newest, authority }, received.sequence));
                }
                Ok(Message::Done) => reset |= received.sequence == ride.number,
                Ok(Message::Rejected(rejection)) => return Err(BoardError::Refused(rejection.to_string())),
                Ok(_) => {}
                Err(NoMessage::UnknownKind(kind) | NoMessage::Malformed(kind)) => {
                    return Err(ride.violation(format!("a message of kind {kind:#04x} that can't be read")));
                }
            }
        }
        if !reset {
            return Err(ride.violation("the reset was not answered"));
        }
        Ok(command)
    }

    /// A control step in which the board takes part.
    fn stepped(&mut self, frame: &SensorFrame) -> Result<Stepped, BoardError> {
        let (before_ms, starts) = (self.board.last().time_ms, self.board.last().starts);
        let sequence = self.ride.sequence();
        let newest = self.exchange(frame)?;
        let (now_ms, started) = (self.board.last().time_ms, self.board.last().starts.wrapping_sub(starts));
        let ride = &mut self.ride;
        let gone_ms = now_ms.wrapping_sub(before_ms);
        if gone_ms == 0 || gone_ms > i32::MAX as u32 {
            return Err(ride.violation(format!("the board's time went from {before_ms} ms to {now_ms} ms")));
        }
        if started > 0 {
            // The board counts steps from its restart, after which it has done one.
            (ride.restarted, ride.step_zero) = (true, ride.step + gone_ms - 1);
            self.tally.restarts += u64::from(started);
        }
        let sure = ride.sensors.safe() && ride.motor.safe() && !ride.restarted;
        match newest {
            None if sure => return Err(ride.violation("the board gave no command")),
            Some((_, of)) if sure && of != sequence => {
                return Err(ride.violation(format!("a command of frame {of} in answer to frame {sequence}")));
            }
            _ => {}
        }
        let newest = newest.map(|(stepped, _)| stepped);
        if gone_ms == 1 {
            return Ok(ride.motor(newest));
        }
        ride.ahead = Some((gone_ms - 1, newest));
        self.tally.missed += 1;
        Ok(ride.motor(None))
    }
}

impl<B: Lockstep> Remote for Controller<B> {
    fn begin(&mut self, plan: &Plan, start: &Start) -> Result<(), RemoteError> {
        let config = plan.config();
        if config.rate_hz != RATE_HZ {
            return Err(BoardError::Rate(config.rate_hz).into());
        }
        let number = self.ride.number.wrapping_add(1);
        self.ride = RideState::new(number, &self.faults, self.seed, start);
        for (piece, bytes) in encode_config(config).chunks(PIECE).enumerate() {
            put(&Message::PilConfig { at: (piece * PIECE) as u16, bytes }, number, &mut self.ride.opening);
        }
        put(&Message::PilReset, number, &mut self.ride.opening);
        Ok(())
    }

    fn disturb(&mut self) {
        self.ride.tick = Some(0);
    }

    fn step(&mut self, frame: &SensorFrame) -> Result<Stepped, RemoteError> {
        let affected = self.ride.sensors.affected + self.ride.motor.affected;
        let stepped = match self.ride.ahead.take() {
            Some((1, newest)) => self.ride.motor(newest),
            Some((periods, newest)) => {
                self.ride.ahead = Some((periods - 1, newest));
                self.tally.missed += 1;
                self.ride.motor(None)
            }
            None => self.stepped(frame)?,
        };
        let ride = &mut self.ride;
        self.tally.affected += u64::from(ride.sensors.affected + ride.motor.affected - affected);
        self.tally.steps += 1;
        ride.step += 1;
        ride.tick = ride.tick.map(|tick| tick + 1);
        Ok(stepped)
    }
}

/// Appends a message to the bytes of the link.
fn put(message: &Message<'_>, sequence: u16, to: &mut Vec<u8>) {
    let mut room = [0; MAX_FRAME];
    // All messages of the loop fit.
    let used = message.encode(sequence, &mut room).unwrap_or(0);
    to.extend_from_slice(&room[..used]);
}
