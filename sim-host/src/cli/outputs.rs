//! Where results go: standard output and files, all opened before the work begins.

use super::Failure;
use crate::report::figure::Picture;
use crate::report::output::Output;
use crate::report::picture::{caption, png_with_caption, svg_with_caption};
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(super) struct OutputArgs {
    /// Write JSON to FILE, or to standard output
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
    /// Write a CSV table
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a figure as SVG
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Write a figure as PNG
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// No text, plot or progress bar
    #[arg(long, short)]
    quiet: bool,
}

/// The opened outputs of one command.
pub(super) struct Outputs {
    json_to_stdout: bool,
    json: Option<Output>,
    csv: Option<Output>,
    svg: Option<Output>,
    png: Option<Output>,
    quiet: bool,
}

impl OutputArgs {
    /// Opens every output asked for.
    pub(super) fn open(&self) -> Result<Outputs, Failure> {
        let open = |path: &Option<PathBuf>| path.as_deref().map(Output::create).transpose();
        let to_stdout = self.json.as_deref() == Some(Path::new("-"));
        Ok(Outputs {
            json_to_stdout: to_stdout,
            json: if to_stdout { None } else { open(&self.json)? },
            csv: open(&self.csv)?,
            svg: open(&self.svg)?,
            png: open(&self.png)?,
            quiet: self.quiet,
        })
    }
}

impl Outputs {
    /// Whether text and plots go to standard output.
    pub(super) fn talks(&self) -> bool {
        !self.quiet && !self.json_to_stdout
    }

    /// Whether a progress bar may be shown.
    pub(super) fn shows_progress(&self) -> bool {
        !self.quiet
    }

    /// Writes everything that was asked for; `table` and `figure` are made only when needed.
    pub(super) fn write(
        self,
        document: &impl Serialize,
        config: &impl Serialize,
        table: impl FnOnce() -> Result<Vec<u8>, csv::Error>,
        figure: impl FnOnce() -> Picture,
    ) -> Result<(), Failure> {
        if let Some(file) = self.csv {
            file.finish(&table()?)?;
        }
        if self.svg.is_some() || self.png.is_some() {
            let (figure, caption) = (figure(), caption(config));
            if let Some(file) = self.svg {
                file.finish(svg_with_caption(&figure.svg(), &caption).as_bytes())?;
            }
            if let Some(file) = self.png {
                file.finish(&png_with_caption(&figure.png()?, &caption))?;
            }
        }
        if self.json_to_stdout || self.json.is_some() {
            let text = serde_json::to_string_pretty(document)? + "\n";
            match self.json {
                Some(file) => file.finish(text.as_bytes())?,
                None => print(&text)?,
            }
        }
        Ok(())
    }
}

/// Text to standard output; a closed pipe is an error of its own kind, not a panic.
pub(super) fn print(text: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.flush()
}
