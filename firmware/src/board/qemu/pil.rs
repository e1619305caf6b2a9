//! Processor in the loop: the host simulates bicycle, sensors and motor.
//!
//! Once per millisecond, after the control step, the board sends its command to the host, then waits for the sensors
//! of the next step. QEMU's clock stops meanwhile. Format: [`link::lockstep`].

use super::semihosting::{Stream, exit};
use super::{Exit, reset, serial, stack, text, time};
use crate::{crash, tasks, telemetry};
use control::wire::{CONFIG_BYTES, decode_config};
use control::{Plan, SensorFrame};
use core::cell::RefCell;
use critical_section::Mutex;
use embassy_time::{Instant, Timer};
use link::frame::{Decoder, MAX_FRAME, Received};
use link::lockstep::{FromBoard, MAX_CHUNK, ToBoard};
use link::message::Message;
use link::rejection::{RejectReason, Rejection};
use link::requests::check_rate;
use static_cell::ConstStaticCell;

/// One control period \[us\].
const PERIOD_US: u32 = crate::deadline::PERIOD.as_micros() as u32;

/// Largest number of serial-link bytes per period: ten times the rate of 115200 baud.
const LINE_BYTES: usize = 115;

/// Size of the loop's buffer, for more than sensor frames \[bytes\].
const LONG: usize = 3 * MAX_FRAME / 2;

/// Sensor input of the controller.
struct Sensors {
    /// Newest sensor frame.
    frame: SensorFrame,
    /// A frame received since the last step, for the step of this number.
    fresh: Option<u16>,
    /// Number of the next step.
    step: u16,
    /// Number of the newest frame used; `None` before the first.
    used: Option<u16>,
}

impl Sensors {
    const NONE: Self = Self { frame: SensorFrame::missing(), fresh: None, step: 0, used: None };
}

static SENSORS: Mutex<RefCell<Option<Sensors>>> = Mutex::new(RefCell::new(None));

/// The sensors of this instant, as far as received; `None` without a host.
pub(super) fn sense() -> Option<SensorFrame> {
    critical_section::with(|cs| {
        let mut sensors = SENSORS.borrow(cs).borrow_mut();
        let s = sensors.as_mut()?;
        let late = match s.fresh.take() {
            Some(number) => {
                s.used = Some(number);
                s.step.wrapping_sub(number)
            }
            // Before the first frame every sensor is missing and stays so.
            None => u16::from(s.used.is_some()),
        };
        if late > 0 {
            age(&mut s.frame, late);
        }
        s.step = s.step.wrapping_add(1);
        Some(s.frame)
    })
}

/// Ages the samples by a number of periods.
fn age(frame: &mut SensorFrame, ticks: u16) {
    frame.now_us = frame.now_us.wrapping_add(PERIOD_US * u32::from(ticks));
    for triple in [&mut frame.gyro_rad_s, &mut frame.accel_m_s2] {
        triple.age_ticks = triple.age_ticks.saturating_add(ticks);
    }
    for sample in [
        &mut frame.steer_rad,
        &mut frame.steer_rate_rad_s,
        &mut frame.front_wheel_m_s,
        &mut frame.rear_wheel_m_s,
        &mut frame.rider_torque_nm,
        &mut frame.motor_torque_nm,
        &mut frame.heading_error_rad,
        &mut frame.lateral_error_m,
    ] {
        sample.age_ticks = sample.age_ticks.saturating_add(ticks);
    }
}

/// Loop bytes to the host.
struct Out {
    bytes: [u8; MAX_CHUNK / 4],
    used: usize,
}

impl Out {
    /// Appends a frame; a frame that does not fit is lost, as on a serial line.
    fn put(&mut self, message: &Message<'_>, sequence: u16) {
        self.used += message.encode(sequence, &mut self.bytes[self.used..]).unwrap_or(0);
    }
}

/// A configuration being received from the host.
struct Incoming {
    bytes: [u8; CONFIG_BYTES],
    /// Number of bytes received in order.
    have: usize,
}

impl Incoming {
    fn take(&mut self, at: u16, piece: &[u8]) {
        let at = usize::from(at);
        if at == 0 {
            self.have = 0;
        }
        if at == self.have
            && let Some(place) = self.bytes.get_mut(at..at + piece.len())
        {
            place.copy_from_slice(piece);
            self.have += piece.len();
        }
    }

    /// The plan of the received configuration, or of the one in use if it is incomplete.
    fn plan(&mut self) -> Result<Plan, Rejection<'static>> {
        let whole = core::mem::take(&mut self.have) == CONFIG_BYTES;
        let config = if whole { decode_config(&self.bytes)? } else { tasks::settings::config() };
        check_rate(&config, 1e6 / PERIOD_US as f32)?;
        Ok(config.plan()?)
    }
}

/// Connects to the host, until the host closes its end; text then goes to standard error.
pub fn begin() {
    stack::paint_all();
    text::aside();
    time::coarse();
    critical_section::with(|cs| SENSORS.borrow(cs).replace(Some(Sensors::NONE)));
}

/// Exchanges data with the host once per millisecond, right after the control step.
#[embassy_executor::task]
pub async fn exchange() {
    static CHUNK: ConstStaticCell<[u8; MAX_CHUNK]> = ConstStaticCell::new([0; MAX_CHUNK]);
    static OUT: ConstStaticCell<Out> = ConstStaticCell::new(Out { bytes: [0; MAX_CHUNK / 4], used: 0 });
    static INCOMING: ConstStaticCell<Incoming> =
        ConstStaticCell::new(Incoming { bytes: [0; CONFIG_BYTES], have: 0 });
    let (chunk, out, incoming) = (CHUNK.take(), OUT.take(), INCOMING.take());
    let (mut decoder, mut host) = (Decoder::default(), Stream::open());
    let mut now_ms = Instant::now().as_millis();
    loop {
        // After a delay, missed exchanges are skipped.
        now_ms = Instant::now().as_millis().max(now_ms) + 1;
        Timer::at(Instant::from_millis(now_ms)).await;
        let taken = hand_over(&mut host, chunk, out);
        let Some(length) = taken.then(|| host.read(chunk, whole)).flatten() else {
            text::line(format_args!("done: stack_left={}", stack::never_used()));
            exit(Exit::Success)
        };
        let Some(ToBoard { sensors, line: bytes }) = ToBoard::decode(&chunk[..length]) else {
            text::line(format_args!("the host handed over {length} bytes that are no chunk"));
            exit(Exit::Input)
        };
        serial::came(bytes);
        let mut sensors_left = sensors;
        let mut all = || {
            while !sensors_left.is_empty() {
                if let Some(Received::Frame(frame)) = decoder.take(&mut sensors_left)
                    && let Ok(message) = Message::decode(&frame)
                {
                    take(&message, frame.sequence, incoming, out);
                }
            }
        };
        // Simulated hardware takes no time; decoding a configuration would take more than a period.
        if sensors.len() > LONG { time::held(all) } else { all() }
    }
}

/// Length of a chunk from the host, from its header.
fn whole(start: &[u8]) -> Option<usize> {
    let [a, b, c, d] = *start.first_chunk()?;
    Some(4 + usize::from(u16::from_le_bytes([a, b])) + usize::from(u16::from_le_bytes([c, d])))
}

/// `false` if the host has closed the connection.
fn hand_over(host: &mut Stream, chunk: &mut [u8; MAX_CHUNK], out: &mut Out) -> bool {
    if let Some((command, authority)) = telemetry::commanded() {
        let number = critical_section::with(|cs| {
            SENSORS.borrow(cs).borrow().as_ref().and_then(|sensors| sensors.used).unwrap_or(u16::MAX)
        });
        out.put(&Message::PilCommand { command, authority }, number);
    }
    let mut line = [0; LINE_BYTES];
    let length = serial::OUT.try_read(&mut line).unwrap_or(0);
    let from = FromBoard {
        time_ms: reset::total_ms(),
        starts: crash::starts() as u16,
        motor: &out.bytes[..out.used],
        line: &line[..length],
    };
    let used = from.encode(chunk).unwrap_or(0);
    out.used = 0;
    host.write(&chunk[..used])
}

fn take(message: &Message<'_>, sequence: u16, incoming: &mut Incoming, out: &mut Out) {
    match message {
        Message::PilFrame(frame) => critical_section::with(|cs| {
            if let Some(sensors) = SENSORS.borrow(cs).borrow_mut().as_mut() {
                (sensors.frame, sensors.fresh) = (*frame, Some(sequence));
            }
        }),
        Message::PilConfig { at, bytes } => incoming.take(*at, bytes),
        Message::PilReset => {
            let answer = match incoming.plan() {
                Ok(plan) => {
                    tasks::settings::queue_plan(plan, true);
                    critical_section::with(|cs| SENSORS.borrow(cs).replace(Some(Sensors::NONE)));
                    Message::Done
                }
                Err(rejection) => Message::Rejected(rejection),
            };
            out.put(&answer, sequence);
        }
        _ => out.put(&Message::Rejected(Rejection::of(RejectReason::NotHere)), sequence),
    }
}
