//! Instead of a bus, in a build without SocketCAN.

use super::{Arrived, BusError};
use std::convert::Infallible;
use std::time::Duration;

/// Cannot be opened.
#[derive(Debug)]
pub struct Bus(Infallible);

impl Bus {
    /// Fails.
    ///
    /// # Errors
    /// [`BusError::Absent`].
    pub fn open(interface: &str) -> Result<Self, BusError> {
        Err(BusError::Absent { interface: interface.to_owned() })
    }

    /// Never called.
    ///
    /// # Errors
    /// None.
    pub fn receive(&self, _: Duration) -> Result<Option<Arrived>, BusError> {
        match self.0 {}
    }
}
