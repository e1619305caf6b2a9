//! Instead of the recorder, in a build without it.

use super::McapError;
use schemars::JsonSchema;
use serde::Serialize;
use std::convert::Infallible;
use std::io::{Seek, Write};
use std::marker::PhantomData;

/// Cannot be made.
pub struct Recorder<W>(Infallible, PhantomData<W>);

impl<W: Write + Seek> Recorder<W> {
    /// Fails.
    ///
    /// # Errors
    /// [`McapError::Absent`].
    pub fn new<R: JsonSchema>(_: W, _: &str, _: &impl Serialize) -> Result<Self, McapError> {
        Err(McapError::Absent)
    }

    /// Never called.
    ///
    /// # Errors
    /// None.
    pub fn write(&mut self, _: f64, _: &impl Serialize) -> Result<bool, McapError> {
        match self.0 {}
    }

    /// Never called.
    ///
    /// # Errors
    /// None.
    pub fn finish(self) -> Result<(), McapError> {
        match self.0 {}
    }
}
