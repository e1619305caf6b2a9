//! The image `qemu-pil` with a bicycle that rides steadily.

use control::{Command, Config, Mode, SensorFrame};
use link::frame::{Decoder, MAX_FRAME, Received};
use link::lockstep::ToBoard;
use link::message::Message;
use link::report::FaultKind;
use sim_host::pil::Lockstep;
use sim_host::pil::qemu::Qemu;
use tests::wait::LONG;
use xtask::{image, rides};

/// Contents of a fault record.
#[derive(Debug, PartialEq)]
pub(crate) struct FoundFault {
    pub(crate) kind: FaultKind,
    pub(crate) boot: u32,
    pub(crate) mode: Mode,
    pub(crate) steps: u32,
    pub(crate) text: String,
}

/// A board that rides steadily, upright.
pub(crate) struct SteadyBoard {
    pub(crate) board: Qemu,
    motor: Decoder,
    line: Decoder,
    /// Number of the next step since the last start of the loop.
    step: u16,
    now_us: u32,
    /// Sent with the next exchange.
    request: Vec<u8>,
    /// The board's requested fault records.
    pub(crate) faults: Vec<FoundFault>,
    pub(crate) logs: Vec<String>,
    pub(crate) done: u32,
    pub(crate) hash: Option<u32>,
    /// Values of the requested parameters.
    pub(crate) values: Vec<Option<f32>>,
    pub(crate) latest: Option<Command>,
    /// Sensor values, upright.
    pub(crate) steady: SensorFrame,
}

impl SteadyBoard {
    /// Started with these arguments; the product with every sensor rides; its configuration, the polarity check
    /// passed, is in flash.
    pub(crate) fn start(arguments: &[&str]) -> Self {
        let mut board = Self::with(arguments, &rides::product());
        board.request(&Message::Store);
        board.ride(20, false);
        assert_eq!(board.done, 1, "stored");
        board
    }

    /// Started with these arguments; this configuration rides.
    pub(crate) fn with(arguments: &[&str], config: &Config) -> Self {
        let board = Qemu::start(&image::path("qemu-pil"), arguments, LONG).expect("the image starts");
        let mut board = Self {
            board,
            motor: Decoder::default(),
            line: Decoder::default(),
            step: 0,
            now_us: 0,
            request: Vec::new(),
            faults: Vec::new(),
            logs: Vec::new(),
            done: 0,
            hash: None,
            values: Vec::new(),
            latest: None,
            steady: rides::all_sensors_ride()[200],
        };
        board.begin(config);
        board
    }

    fn begin(&mut self, config: &Config) {
        let bytes = control::wire::encode_config(config);
        let mut sensors = Vec::new();
        for (i, piece) in bytes.chunks(256).enumerate() {
            put(&Message::PilConfig { at: 256 * i as u16, bytes: piece }, 0, &mut sensors);
        }
        put(&Message::PilReset, 0, &mut sensors);
        put(&Message::PilFrame(self.steady), 0, &mut sensors);
        (self.step, self.now_us) = (1, self.steady.now_us.wrapping_add(1000));
        self.exchange(&sensors);
    }

    pub(crate) fn request(&mut self, message: &Message<'_>) {
        put(message, 9, &mut self.request);
    }

    /// This number of milliseconds with the switch in this position.
    pub(crate) fn ride(&mut self, ms: u32, engage: bool) {
        for _ in 0..ms {
            let steady = self.steady;
            let frame = SensorFrame { now_us: self.now_us, engage, ..steady };
            let mut sensors = Vec::new();
            put(&Message::PilFrame(frame), self.step, &mut sensors);
            (self.step, self.now_us) = (self.step.wrapping_add(1), self.now_us.wrapping_add(1000));
            self.exchange(&sensors);
        }
    }

    fn exchange(&mut self, sensors: &[u8]) {
        let line = std::mem::take(&mut self.request);
        let starts = self.starts();
        self.board.exchange(&ToBoard { sensors, line: &line }).expect("the board runs");
        if self.starts() != starts {
            // A new program counts its steps from the beginning; it has done the first before the exchange.
            self.step = 1;
        }
        let output = self.board.last();
        for byte in output.motor {
            if let Some(Received::Frame(frame)) = self.motor.feed(*byte) {
                match Message::decode(&frame) {
                    Ok(Message::PilCommand { command, .. }) => self.latest = Some(command),
                    Ok(Message::Done) => {}
                    other => panic!("{other:?}"),
                }
            }
        }
        for byte in output.line {
            if let Some(Received::Frame(frame)) = self.line.feed(*byte) {
                match Message::decode(&frame) {
                    Ok(Message::StoredFault(faults)) => {
                        self.faults.extend(faults.record.map(|record| FoundFault {
                            kind: record.kind,
                            boot: record.boot,
                            mode: record.mode,
                            steps: record.steps,
                            text: record.text.into(),
                        }))
                    }
                    Ok(Message::Log(text)) => self.logs.push(text.into()),
                    Ok(Message::Value { value, .. }) => self.values.push(value),
                    Ok(Message::Hello(hello)) => self.hash = Some(hello.config_hash),
                    Ok(Message::Done) => self.done += 1,
                    _ => {}
                }
            }
        }
    }

    pub(crate) fn starts(&self) -> u16 {
        self.board.last().starts
    }

    pub(crate) fn time_ms(&self) -> u32 {
        self.board.last().time_ms
    }

    pub(crate) fn mode(&self) -> Mode {
        self.latest.expect("a command").mode
    }

    pub(crate) fn torque_nm(&self) -> f32 {
        self.latest.expect("a command").torque_nm
    }
}

fn put(message: &Message<'_>, sequence: u16, to: &mut Vec<u8>) {
    let mut room = [0; MAX_FRAME];
    let used = message.encode(sequence, &mut room).expect("room");
    to.extend(&room[..used]);
}
