//! The interface of the kernel.

use super::{Arrived, ArrivedFrame, BusError};
use crate::recording::frames::Id;
use socketcan::{CanFrame, CanSocket, EmbeddedFrame, Frame, ShouldRetry, Socket, SocketOptions};
use std::io;
use std::time::{Duration, UNIX_EPOCH};

/// An open interface.
#[derive(Debug)]
pub struct Bus {
    interface: String,
    socket: CanSocket,
}

impl Bus {
    /// Opens an interface by its name, such as `can0`; errors of the bus are received, too.
    ///
    /// # Errors
    /// [`BusError::Open`].
    pub fn open(interface: &str) -> Result<Self, BusError> {
        let opened = || {
            let socket = CanSocket::open(interface)?;
            socket.set_error_filter_accept_all()?;
            socket.set_recv_timestamp(true)?;
            Ok(socket)
        };
        let interface = interface.to_owned();
        match opened() {
            Ok(socket) => Ok(Self { interface, socket }),
            Err(error) => Err(BusError::Open { interface, error }),
        }
    }

    /// The next frame, or `None` if none arrives within `timeout`.
    ///
    /// # Errors
    /// [`BusError::Lost`].
    pub fn receive(&self, timeout: Duration) -> Result<Option<Arrived>, BusError> {
        let lost = |error: io::Error| BusError::Lost { interface: self.interface.clone(), error };
        self.socket.set_read_timeout(timeout).map_err(lost)?;
        let (frame, time) = match self.socket.read_frame_with_timestamp() {
            Ok(arrived) => arrived,
            Err(error) if error.should_retry() || error.kind() == io::ErrorKind::Interrupted => {
                return Ok(None);
            }
            Err(error) => return Err(lost(error)),
        };
        let frame = match frame {
            CanFrame::Data(frame) => match Id::new(frame.raw_id(), frame.is_extended()) {
                Some(id) => ArrivedFrame::Data(id, frame.data().to_vec()),
                None => ArrivedFrame::Error,
            },
            CanFrame::Remote(_) => ArrivedFrame::Remote,
            CanFrame::Error(_) => ArrivedFrame::Error,
        };
        let time_s = time.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64();
        Ok(Some(Arrived { time_s, frame }))
    }
}
