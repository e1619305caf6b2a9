//! Destinations of results: standard output and files, all checked before the computation.

use super::ended::{Failure, is_broken_pipe};
use crate::bicycle::catalogue::Bicycle;
use crate::report::figure::Picture;
use crate::report::mcap;
use crate::report::netcdf;
use crate::report::output::Output;
use crate::report::picture::{caption, png_with_caption, svg_with_caption};
use serde::Serialize;
use std::collections::BTreeSet;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

#[derive(clap::Args)]
pub(super) struct OutputArgs {
    /// Write JSON to FILE, or to standard output (also -)
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
    /// Write a CSV table; - is standard output
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a figure as SVG; - is standard output
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Write a figure as PNG; - is standard output
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// No text, plot or progress bar
    #[arg(long, short)]
    quiet: bool,
}

/// The checked outputs of one command.
pub(super) struct Outputs {
    json: Option<Output>,
    csv: Option<Output>,
    svg: Option<Output>,
    png: Option<Output>,
    frames: Option<Output>,
    netcdf: Option<Output>,
    mcap: Option<Output>,
    quiet: bool,
}

/// The files that only some commands write.
#[derive(Clone, Copy, Default)]
pub(super) struct Further<'a> {
    /// Sensor frames.
    pub(super) frames: Option<&'a Path>,
    /// A NetCDF file.
    pub(super) netcdf: Option<&'a Path>,
    /// An MCAP file.
    pub(super) mcap: Option<&'a Path>,
}

/// The results to write; those that were not requested are not computed.
pub(super) struct Results<D, C, S, T, F> {
    /// The JSON document.
    pub(super) document: D,
    /// The full configuration, for tables and figures.
    pub(super) config: C,
    /// The text output and plot.
    pub(super) summary: S,
    /// The CSV table.
    pub(super) table: T,
    /// The figure.
    pub(super) figure: F,
}

impl OutputArgs {
    /// Rejects figure options of a command without figures.
    pub(super) fn refuse_figures(&self, reason: &str) -> Result<(), Failure> {
        let requested =
            [("--svg", &self.svg), ("--png", &self.png)].into_iter().find(|(_, path)| path.is_some());
        requested.map_or(Ok(()), |(option, _)| Err(format!("{option}: {reason}").into()))
    }

    /// Checks every requested output.
    pub(super) fn open(&self, further: Further) -> Result<Outputs, Failure> {
        let open = |path: &Option<PathBuf>| path.as_deref().map(Output::create).transpose();
        if further.mcap.is_some() {
            mcap::available().map_err(|error| format!("--mcap: {error}"))?;
        }
        let outputs = Outputs {
            json: open(&self.json)?,
            csv: open(&self.csv)?,
            svg: open(&self.svg)?,
            png: open(&self.png)?,
            frames: further.frames.map(Output::create).transpose()?,
            netcdf: further.netcdf.map(Output::create).transpose()?,
            mcap: further.mcap.map(Output::create).transpose()?,
            quiet: self.quiet,
        };
        let all = outputs.all();
        for (i, (option, output)) in all.iter().enumerate() {
            if let Some((other, _)) = all[..i].iter().find(|(_, earlier)| earlier.collides(output)) {
                return Err(format!("{other} and {option} have the same place to write to").into());
            }
        }
        Ok(outputs)
    }
}

impl Outputs {
    fn all(&self) -> Vec<(&'static str, &Output)> {
        let named = [
            ("--json", &self.json),
            ("--csv", &self.csv),
            ("--svg", &self.svg),
            ("--png", &self.png),
            ("--frames", &self.frames),
            ("--netcdf", &self.netcdf),
            ("--mcap", &self.mcap),
        ];
        named.into_iter().filter_map(|(name, output)| output.as_ref().map(|o| (name, o))).collect()
    }

    /// Rejects a further output with the same destination.
    pub(super) fn refuse_place_of(&self, option: &str, further: &Output) -> Result<(), Failure> {
        match self.all().into_iter().find(|(_, output)| output.collides(further)) {
            Some((other, _)) => Err(format!("{other} and {option} have the same place to write to").into()),
            None => Ok(()),
        }
    }

    /// Whether to show a progress bar.
    pub(super) fn shows_progress(&self) -> bool {
        !self.quiet
    }

    /// Whether the text output is shown on a terminal, below a progress bar on the same or another.
    pub(super) fn shows_picture(&self) -> bool {
        self.shows_text() && std::io::stdout().is_terminal() && std::io::stderr().is_terminal()
    }

    /// Whether the text output goes to standard output.
    fn shows_text(&self) -> bool {
        !self.quiet && !self.all().iter().any(|(_, output)| output.is_standard())
    }

    /// Whether an output has the efforts of rides.
    pub(super) fn has_efforts(&self) -> bool {
        self.json.is_some() || self.netcdf.is_some()
    }

    /// Writes the frames, if requested.
    pub(super) fn write_frames(&self, frames: impl FnOnce() -> Vec<u8>) -> Result<(), Failure> {
        self.frames.as_ref().map_or(Ok(()), |output| Ok(output.finish(&frames())?))
    }

    /// Writes the NetCDF file, if requested.
    pub(super) fn write_netcdf(&self, file: impl FnOnce() -> netcdf::File) -> Result<(), Failure> {
        self.netcdf
            .as_ref()
            .map_or(Ok(()), |output| Ok(output.finish(&file().bytes(netcdf::Format::of(output.path()))?)?))
    }

    /// Writes the MCAP file, if requested.
    pub(super) fn write_mcap(
        &self,
        content: impl FnOnce() -> Result<Vec<u8>, mcap::McapError>,
    ) -> Result<(), Failure> {
        self.mcap.as_ref().map_or(Ok(()), |output| Ok(output.finish(&content()?)?))
    }

    /// Writes all other requested results, the text output last. A failed output does not prevent the others; neither
    /// does a reader such as `head` that closes standard output.
    pub(super) fn write<D, C, S, T, F>(&self, results: Results<D, C, S, T, F>) -> Result<(), Failure>
    where
        D: Serialize,
        C: Serialize,
        S: FnOnce() -> String,
        T: FnOnce() -> Result<Vec<u8>, csv::Error>,
        F: FnOnce() -> Picture,
    {
        let Results { document, config, summary, table, figure } = results;
        let mut done = self.data(&document, table);
        if self.svg.is_some() || self.png.is_some() {
            let (figure, caption) = (figure(), caption(&config));
            if let Some(output) = &self.svg {
                let svg = svg_with_caption(&figure.svg(), &caption);
                done.push(output.finish(svg.as_bytes()).map_err(Failure::from));
            }
            if let Some(output) = &self.png {
                let png = figure.png().map_err(Failure::from);
                done.push(png.and_then(|png| Ok(output.finish(&png_with_caption(&png, &caption))?)));
            }
        }
        self.ended(done, summary)
    }

    /// Writes results without a figure; [`OutputArgs::refuse_figures`] has rejected figures before.
    pub(super) fn write_data(
        &self,
        document: &impl Serialize,
        table: impl FnOnce() -> Result<Vec<u8>, csv::Error>,
        summary: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        self.ended(self.data(document, table), summary)
    }

    /// Writes the document and the table, if requested.
    fn data(
        &self,
        document: &impl Serialize,
        table: impl FnOnce() -> Result<Vec<u8>, csv::Error>,
    ) -> Vec<Result<(), Failure>> {
        let json = self.json.as_ref().map(|output| write_json(output, document));
        let csv = self
            .csv
            .as_ref()
            .map(|output| table().map_err(Failure::from).and_then(|table| Ok(output.finish(&table)?)));
        json.into_iter().chain(csv).collect()
    }

    /// Writes the text output, and reports failed outputs.
    fn ended(
        &self,
        mut done: Vec<Result<(), Failure>>,
        summary: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        if self.shows_text() {
            done.push(print(&summary()));
        }
        // A closed pipe is no failure, so it comes last.
        let failures = done.into_iter().filter_map(Result::err);
        failures.min_by_key(|e| is_broken_pipe(&**e)).map_or(Ok(()), Err)
    }
}

/// Writes a document as JSON.
pub(super) fn write_json(output: &Output, document: &impl Serialize) -> Result<(), Failure> {
    Ok(output.finish((serde_json::to_string_pretty(document)? + "\n").as_bytes())?)
}

/// Prints text to standard output; a closed pipe is a distinct error, not a panic.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    Ok(Output::create(Path::new("-"))?.finish(text.as_bytes())?)
}

/// Prints a line to standard error; ignores a closed standard error.
pub(super) fn complain(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Prints a line to standard error once: the cells of a sweep repeat their warnings.
pub(super) fn complain_once(text: &str) {
    static SAID: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    if SAID.lock().unwrap_or_else(PoisonError::into_inner).insert(text.into()) {
        complain(text);
    }
}

/// Prints doubts about a bicycle to standard error.
pub(super) fn warn(bicycle: &Bicycle) {
    for warning in &bicycle.warnings {
        complain_once(&format!("warning: {}: {warning}", bicycle.name));
    }
}
