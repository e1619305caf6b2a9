//! Recordings of CAN frames and measurement files become columns.
//!
//! The files are in `tests/data/can`; its README names the programs that made them.

mod asc;
mod blf;
mod candump;
mod cantools;
mod dbc;
mod dispatch;
mod mcap;
mod mdf;
mod monitor;
mod noise;
mod product;
mod values;

use sim_host::recording::{Group, ReadOptions, Recording, RecordingError, read};
use std::path::{Path, PathBuf};

/// Path of a file of `tests/data/can`.
fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/can").join(name)
}

/// A file of `tests/data/can`, read with databases of it.
fn recorded(name: &str, dbc: &[&str]) -> Result<Recording, RecordingError> {
    read_with(&file(name), &dbc.iter().map(|name| file(name)).collect::<Vec<_>>())
}

fn read_with(path: &Path, dbc: &[PathBuf]) -> Result<Recording, RecordingError> {
    read(path, &ReadOptions { strict: false, dbc: dbc.to_vec() })
}

/// A text as a file in a folder of its own, read with a database of `tests/data/can`.
fn written(name: &str, bytes: impl AsRef<[u8]>, dbc: &[&str]) -> Result<Recording, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let dbc: Vec<PathBuf> = dbc.iter().map(|name| file(name)).collect();
    read_with(&path, &dbc)
        .map_err(|error| error.to_string().replace(&format!("{}/", folder.path().display()), ""))
}

fn group<'a>(recording: &'a Recording, name: &str) -> &'a Group {
    let names: Vec<&str> = recording.groups.iter().map(|group| group.name.as_str()).collect();
    recording
        .groups
        .iter()
        .find(|group| group.name == name)
        .unwrap_or_else(|| panic!("no {name} in {names:?}"))
}

fn column<'a>(group: &'a Group, name: &str) -> &'a [f64] {
    let found = group.columns.iter().find(|column| column.name == name);
    &found.unwrap_or_else(|| panic!("no {name} in {}", group.name)).values
}

fn remarks(recording: &Recording) -> Vec<String> {
    recording.remarks.iter().map(ToString::to_string).collect()
}

/// Whether two rows of numbers are the same, NaN where NaN is.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b || a.is_nan() && b.is_nan())
}
