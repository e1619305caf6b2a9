//! A CAN bus of this machine, by SocketCAN: frames as they arrive. Nothing is sent.

#[cfg_attr(all(target_os = "linux", feature = "socketcan"), path = "bus.rs")]
#[cfg_attr(not(all(target_os = "linux", feature = "socketcan")), path = "absent.rs")]
mod bus;

use crate::recording::frames::Id;
use std::io;

pub use bus::Bus;

/// A frame and the time at which the system received it \[s since 1970\].
#[derive(Clone, Debug, PartialEq)]
pub struct Arrived {
    /// The time.
    pub time_s: f64,
    /// The frame.
    pub frame: ArrivedFrame,
}

/// What arrived.
#[derive(Clone, Debug, PartialEq)]
pub enum ArrivedFrame {
    /// A data frame.
    Data(Id, Vec<u8>),
    /// A request for data.
    Remote,
    /// An error of the bus, reported by the controller.
    Error,
}

/// Why a bus is unusable.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// The program was built without it.
    #[error(
        "{interface} is no file, and this build reads no CAN interface: on Linux, build sim-host with `--features full`"
    )]
    Absent {
        /// The name.
        interface: String,
    },
    /// The interface cannot be opened.
    #[error("can't open the CAN interface {interface}, which is no file either: {error}")]
    Open {
        /// Its name.
        interface: String,
        /// The system's error.
        error: io::Error,
    },
    /// The interface was lost, for example switched off.
    #[error("lost the CAN interface {interface}: {error}")]
    Lost {
        /// Its name.
        interface: String,
        /// The system's error.
        error: io::Error,
    },
}
