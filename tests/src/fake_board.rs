//! The board's side of the lockstep (docs/pil.md), in this process: the reference for an image in QEMU, and its
//! substitute where only the host's side is tested.

use control::wire::{CONFIG_BYTES, decode_config};
use control::{Config, Plan, Sample, SensorFrame, State, Triple};
use link::frame::MAX_FRAME;
use link::lockstep::{FromBoard, MAX_CHUNK, ToBoard};
use link::rejection::{RejectReason, Rejection};
use link::{Decoder, Message, Received};
use sim_host::pil::{BoardError, Lockstep};

/// A board made of the control crate and the link's own messages.
pub struct FakeBoard {
    /// Time at which the chip is reset, and after how many milliseconds it is back.
    pub reset_at_ms: Option<(u32, u32)>,
    /// Time at which it is delayed, and for how many milliseconds; it then makes up for every step.
    pub held_up_at_ms: Option<(u32, u32)>,
    config: Vec<u8>,
    plan: Plan,
    controller: State,
    /// The number of the next control step.
    step: u16,
    /// The newest frame and its number.
    newest: Option<(u16, SensorFrame)>,
    decoder: Decoder,
    time_ms: u32,
    starts: u16,
    motor: Vec<u8>,
}

impl Default for FakeBoard {
    fn default() -> Self {
        let mut board = Self {
            reset_at_ms: None,
            held_up_at_ms: None,
            config: Vec::new(),
            plan: plan(&Config::product()).expect("the product"),
            controller: State::default(),
            step: 0,
            newest: None,
            decoder: Decoder::default(),
            time_ms: 0,
            starts: 1,
            motor: Vec::new(),
        };
        board.control();
        board
    }
}

fn plan(config: &Config) -> Result<Plan, Rejection<'static>> {
    config.clone().plan().map_err(Rejection::from)
}

/// The frame a number of control periods after its own.
pub fn aged(frame: &SensorFrame, late: u16) -> SensorFrame {
    let one = |s: Sample| Sample { age_ticks: s.age_ticks.saturating_add(late), ..s };
    let three = |t: Triple| Triple { age_ticks: t.age_ticks.saturating_add(late), ..t };
    SensorFrame {
        now_us: frame.now_us.wrapping_add(1000 * u32::from(late)),
        gyro_rad_s: three(frame.gyro_rad_s),
        accel_m_s2: three(frame.accel_m_s2),
        steer_rad: one(frame.steer_rad),
        steer_rate_rad_s: one(frame.steer_rate_rad_s),
        front_wheel_m_s: one(frame.front_wheel_m_s),
        rear_wheel_m_s: one(frame.rear_wheel_m_s),
        rider_torque_nm: one(frame.rider_torque_nm),
        motor_torque_nm: one(frame.motor_torque_nm),
        heading_error_rad: one(frame.heading_error_rad),
        lateral_error_m: one(frame.lateral_error_m),
        engage: frame.engage,
    }
}

impl FakeBoard {
    /// One control step; a millisecond elapses.
    fn control(&mut self) {
        let frame = match &self.newest {
            Some((number, frame)) => aged(frame, self.step.wrapping_sub(*number)),
            None => SensorFrame::missing(),
        };
        let command = control::step(&self.plan, &mut self.controller, &frame);
        let authority = self.controller.authority();
        let of = self.newest.map_or(u16::MAX, |(number, _)| number);
        self.send(&Message::PilCommand { command, authority }, of);
        self.step = self.step.wrapping_add(1);
        self.time_ms += 1;
    }

    fn send(&mut self, message: &Message<'_>, sequence: u16) {
        let mut room = [0; MAX_FRAME];
        let used = message.encode(sequence, &mut room).expect("it fits");
        self.motor.extend_from_slice(&room[..used]);
    }

    fn take(&mut self, sensors: &[u8]) {
        for byte in sensors {
            let Some(Received::Frame(frame)) = self.decoder.feed(*byte) else { continue };
            let sequence = frame.sequence;
            match Message::decode(&frame) {
                Ok(Message::PilFrame(frame)) => self.newest = Some((sequence, frame)),
                Ok(Message::PilConfig { at, bytes }) => {
                    self.config.truncate(usize::from(at));
                    self.config.extend_from_slice(bytes);
                }
                Ok(Message::PilReset) => {
                    match self.begin() {
                        Ok(()) => self.send(&Message::Done, sequence),
                        Err(rejection) => self.send(&Message::Rejected(rejection), sequence),
                    };
                }
                other => panic!("{other:?} in the direction of the board"),
            }
        }
    }

    fn begin(&mut self) -> Result<(), Rejection<'static>> {
        let whole: Result<[u8; CONFIG_BYTES], _> = std::mem::take(&mut self.config).try_into();
        if let Ok(bytes) = whole {
            self.plan = plan(&decode_config(&bytes).map_err(|_| Rejection::of(RejectReason::Malformed))?)?;
        }
        (self.controller, self.step, self.newest) = (State::default(), 0, None);
        Ok(())
    }

    fn chunk(&self) -> FromBoard<'_> {
        FromBoard { time_ms: self.time_ms, starts: self.starts, motor: &self.motor, line: &[] }
    }
}

impl Lockstep for FakeBoard {
    fn last(&self) -> FromBoard<'_> {
        self.chunk()
    }

    fn exchange(&mut self, to: &ToBoard<'_>) -> Result<(), BoardError> {
        to.encode(&mut [0; MAX_CHUNK]).ok_or(BoardError::TooMuch(to.sensors.len(), to.line.len()))?;
        self.motor.clear();
        let due = |at: Option<(u32, u32)>, now| at.filter(|(at, _)| *at == now).map(|(_, duration)| duration);
        if let Some(absent_ms) = due(self.reset_at_ms, self.time_ms) {
            let (time_ms, starts) = (self.time_ms + absent_ms, self.starts + 1);
            *self = Self { time_ms, starts, ..Self::default() };
        } else {
            self.take(to.sensors);
            for _ in 0..due(self.held_up_at_ms, self.time_ms).unwrap_or(0) {
                self.control();
                self.motor.clear();
            }
            self.control();
        }
        Ok(())
    }
}
