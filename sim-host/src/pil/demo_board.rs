//! A board in QEMU on a bicycle that rolls straight and upright, the rider's switch off: for trying the board commands
//! without hardware.

use super::qemu::{LIMIT, Qemu};
use super::{BoardError, Lockstep};
use crate::board::transport::{Transport, TransportError};
use control::{Sample, SensorFrame, Triple};
use link::frame::MAX_FRAME;
use link::lockstep::ToBoard;
use link::message::Message;
use std::io;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The bicycle's speed \[m/s\].
const SPEED_M_S: f32 = 4.0;
/// Gravity \[m/s^2\].
const G_M_S2: f32 = 9.81;
/// Most bytes sent to the board in a millisecond: ten times the capacity of a line of 115200 baud.
const LINE_BYTES: usize = 115;

/// The line of the demonstration board. Its time advances only while the host waits for it, at most in real time.
pub struct DemoBoard {
    name: String,
    board: Qemu,
    /// Bytes not yet sent to the board.
    waiting: Vec<u8>,
    /// Number of the next sensor frame, from the chip's start.
    number: u16,
    now_us: u32,
    /// Real time of the last exchange.
    last: Instant,
}

impl DemoBoard {
    /// Starts the image.
    ///
    /// # Errors
    /// No image, no QEMU, or the image does not start.
    pub fn start(image: &Path) -> Result<Self, BoardError> {
        let board = Qemu::start(image, &[], LIMIT)?;
        let name = format!("{} in QEMU", image.display());
        // The chip has done its first control step, without sensors.
        Ok(Self { name, board, waiting: Vec::new(), number: 1, now_us: 0, last: Instant::now() })
    }

    /// Advances by one millisecond; returns the bytes that the board sent.
    fn millisecond(&mut self) -> Result<Vec<u8>, TransportError> {
        let mut room = [0; MAX_FRAME];
        let used = Message::PilFrame(self.sensors()).encode(self.number, &mut room).unwrap_or(0);
        let line: Vec<u8> = self.waiting.drain(..self.waiting.len().min(LINE_BYTES)).collect();
        let starts = self.board.last().starts;
        let exchanged = self.board.exchange(&ToBoard { sensors: &room[..used], line: &line });
        exchanged.map_err(|error| TransportError::Lost {
            line: self.name.clone(),
            error: io::Error::other(error.to_string()),
        })?;
        let received = self.board.last();
        self.number = if received.starts == starts { self.number.wrapping_add(1) } else { 1 };
        self.now_us = self.now_us.wrapping_add(1000);
        Ok(received.line.to_vec())
    }

    fn sensors(&self) -> SensorFrame {
        SensorFrame {
            now_us: self.now_us,
            gyro_rad_s: Triple::fresh([0.0; 3]),
            accel_m_s2: Triple::fresh([0.0, 0.0, -G_M_S2]),
            steer_rad: Sample::fresh(0.0),
            steer_rate_rad_s: Sample::fresh(0.0),
            front_wheel_m_s: Sample::fresh(SPEED_M_S),
            rear_wheel_m_s: Sample::fresh(SPEED_M_S),
            motor_torque_nm: Sample::fresh(0.0),
            ..SensorFrame::missing()
        }
    }
}

impl Transport for DemoBoard {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        self.waiting.extend(bytes);
        Ok(())
    }

    fn receive(&mut self, timeout: Duration) -> Result<Vec<u8>, TransportError> {
        let begin = Instant::now();
        loop {
            sleep(Duration::from_millis(1).saturating_sub(self.last.elapsed()));
            self.last = Instant::now();
            let received = self.millisecond()?;
            if !received.is_empty() || begin.elapsed() >= timeout {
                return Ok(received);
            }
        }
    }
}
