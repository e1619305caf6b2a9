//! Rows as an MCAP file, which Foxglove, PlotJuggler and the `mcap` packages of several languages open.
//!
//! One channel of JSON messages with a schema, one per row, at the row's time. A value that is missing has no key. The
//! metadata record `sim-host` has the program and the configuration.

#[cfg_attr(feature = "mcap", path = "recorder.rs")]
#[cfg_attr(not(feature = "mcap"), path = "absent.rs")]
mod recorder;

use schemars::JsonSchema;
use serde::Serialize;
use std::io::Cursor;

pub use recorder::Recorder;

/// Why no MCAP file is written.
#[derive(Debug, thiserror::Error)]
pub enum McapError {
    /// The program was built without it.
    #[error("this build writes no MCAP: build sim-host with `--features full`")]
    Absent,
    /// The file cannot be written.
    #[error("{0}")]
    Write(String),
}

/// Checks that this build writes MCAP.
///
/// # Errors
/// [`McapError::Absent`].
pub fn available() -> Result<(), McapError> {
    if cfg!(feature = "mcap") { Ok(()) } else { Err(McapError::Absent) }
}

/// A whole file with the rows, each with its time \[s\], not negative.
///
/// # Errors
/// [`McapError::Absent`].
pub fn file<R: Serialize + JsonSchema>(
    topic: &str,
    config: &impl Serialize,
    rows: impl IntoIterator<Item = (f64, R)>,
) -> Result<Vec<u8>, McapError> {
    let mut bytes = Cursor::new(Vec::new());
    let mut recorder = Recorder::new::<R>(&mut bytes, topic, config)?;
    for (time_s, row) in rows {
        recorder.write(time_s, &row)?;
    }
    recorder.finish()?;
    Ok(bytes.into_inner())
}
