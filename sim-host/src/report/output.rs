//! Files that are whole or not there: written beside their place and moved into it.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// A file to be: opened before the work, so that a place that can't be written to is known early,
/// and given its content and its name at the end.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
    file: NamedTempFile,
}

/// Why a file can't be written.
#[derive(Debug, thiserror::Error)]
#[error("can't write {path}: {source}")]
pub struct OutputError {
    path: PathBuf,
    source: io::Error,
}

impl Output {
    /// Makes ready to write `path`.
    ///
    /// # Errors
    /// When its folder is missing or can't be written to, or `path` is a folder.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let wrong = |source| OutputError { path: path.into(), source };
        if path.is_dir() {
            return Err(wrong(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder")));
        }
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = Builder::new();
        builder.prefix(".sim-host-").suffix(".tmp");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        // The kind alone: the error's text names the temporary file, which means nothing to the user.
        let file = builder.tempfile_in(folder).map_err(|e| wrong(e.kind().into()))?;
        Ok(Self { path: path.into(), file })
    }

    /// Writes the content and moves the file into its place.
    ///
    /// # Errors
    /// The system's; nothing is left behind then, and an older file stays.
    pub fn finish(mut self, content: &[u8]) -> Result<(), OutputError> {
        let wrong = |source| OutputError { path: self.path.clone(), source };
        self.file.write_all(content).and_then(|()| self.file.as_file().sync_all()).map_err(wrong)?;
        self.file.persist(&self.path).map(drop).map_err(|e| wrong(e.error))
    }
}
