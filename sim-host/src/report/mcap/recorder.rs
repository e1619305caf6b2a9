//! Writes rows to an MCAP file as they come.

use super::McapError;
use crate::report::tool::Tool;
use ::mcap::WriteOptions;
use ::mcap::records::{MessageHeader, Metadata};
use schemars::{JsonSchema, schema_for};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::error::Error;
use std::io::{Seek, Write};

/// Rows between two chunks: what a killed program loses at most.
const CHUNK_ROWS: u32 = 50;

/// A file that is being written. It is closed by [`Recorder::finish`]; without it, it ends with a whole chunk and has no
/// summary.
pub struct Recorder<W: Write + Seek> {
    writer: ::mcap::Writer<W>,
    channel: u16,
    rows: u32,
}

impl<W: Write + Seek> Recorder<W> {
    /// Begins a file of rows of a type; `config` is the full configuration.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn new<R: JsonSchema>(to: W, topic: &str, config: &impl Serialize) -> Result<Self, McapError> {
        let tool = Tool::this();
        let library = format!("{} {} commit {}", tool.name, tool.version, tool.commit);
        // Chunks are made in memory: a file that was cut has whole ones.
        let options = WriteOptions::new().compression(None).disable_seeking(true).library(library.clone());
        let mut writer = options.create(to).map_err(failed)?;
        let config = serde_json::to_string(config).map_err(failed)?;
        let metadata = [("program", library), ("configuration", config)];
        let metadata = metadata.map(|(key, value)| (key.to_owned(), value)).into();
        writer.write_metadata(&Metadata { name: tool.name.to_string(), metadata }).map_err(failed)?;
        let schema = schema::<R>().to_string();
        let schema = writer.add_schema(&R::schema_name(), "jsonschema", schema.as_bytes()).map_err(failed)?;
        let channel = writer.add_channel(schema, topic, "json", &BTreeMap::new()).map_err(failed)?;
        Ok(Self { writer, channel, rows: 0 })
    }

    /// Adds a row at a time \[s\]; a negative one counts as 0. True if the file then ends with a whole chunk.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&mut self, time_s: f64, row: &impl Serialize) -> Result<bool, McapError> {
        // By the text, so that an f32 has its own digits.
        let text = serde_json::to_string(row).map_err(failed)?;
        let mut row: Value = serde_json::from_str(&text).map_err(failed)?;
        if let Some(row) = row.as_object_mut() {
            row.retain(|_, value| !value.is_null());
        }
        let log_time = (time_s * 1e9).round() as u64;
        let header =
            MessageHeader { channel_id: self.channel, sequence: self.rows, log_time, publish_time: log_time };
        self.writer.write_to_known_channel(&header, row.to_string().as_bytes()).map_err(failed)?;
        self.rows = self.rows.wrapping_add(1);
        let whole = self.rows.is_multiple_of(CHUNK_ROWS);
        if whole {
            self.writer.flush().map_err(failed)?;
        }
        Ok(whole)
    }

    /// Closes the file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(mut self) -> Result<(), McapError> {
        self.writer.finish().map(drop).map_err(failed)
    }
}

/// The cause of an error: the text of the outermost one does not tell that of the system.
fn failed(error: impl Error + 'static) -> McapError {
    let first: &(dyn Error + 'static) = &error;
    let cause = std::iter::successors(Some(first), |error| (**error).source()).last();
    McapError::Write(cause.unwrap_or(first).to_string())
}

/// The JSON schema of a flat row: per key its type, as one word, and its description with the unit. Foxglove accepts no
/// list of types.
fn schema<R: JsonSchema>() -> Value {
    let full = Value::from(schema_for!(R));
    let mut properties = serde_json::Map::new();
    for (key, property) in full["properties"].as_object().into_iter().flatten() {
        let word = property["type"].as_array().map_or(&property["type"], |words| &words[0]);
        properties.insert(key.clone(), json!({"type": word, "description": property["description"]}));
    }
    json!({"title": full["title"], "type": "object", "properties": properties})
}
