//! Files that are whole or not there: written beside their place and moved into it.

use std::fs::{OpenOptions, metadata};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::Builder;

/// How the names of files begin that are written beside their place.
pub(crate) const TEMPORARY: &str = ".sim-host-";

/// A place for a result: tried before the work, so that one that can't be written to is known
/// early, and filled at the end. Between the two nothing of it exists, so nothing can be left behind.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
    place: Place,
}

#[derive(Debug, PartialEq)]
enum Place {
    /// Standard output.
    Standard,
    /// A device or a pipe: written to, never replaced.
    Stream(PathBuf),
    /// A file: the folder, free of links, and its name in it.
    File(PathBuf, PathBuf),
}

/// Why a result can't be written.
#[derive(Debug, thiserror::Error)]
#[error("can't write {path}: {source}")]
pub struct OutputError {
    path: PathBuf,
    source: io::Error,
}

impl Output {
    /// Makes ready to write `path`; `-` is standard output.
    ///
    /// # Errors
    /// When its folder is missing or can't be written to, or `path` is a folder, a file that must
    /// not be written to, or a link to nothing.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let place = Place::find(path).map_err(|source| OutputError { path: path.into(), source })?;
        Ok(Self { path: path.into(), place })
    }

    /// Whether this is standard output.
    pub fn is_standard(&self) -> bool {
        self.place == Place::Standard
    }

    /// Whether both end in the same place.
    pub fn collides(&self, other: &Output) -> bool {
        self.place == other.place
    }

    /// Writes the content: a file is written beside its place and moved into it.
    ///
    /// # Errors
    /// The system's; nothing is left behind then, and an older file stays.
    pub fn finish(&self, content: &[u8]) -> Result<(), OutputError> {
        let written = match &self.place {
            Place::Standard => io::stdout().lock().write_all(content).and_then(|()| io::stdout().flush()),
            Place::Stream(path) => {
                OpenOptions::new().write(true).open(path).and_then(|mut f| f.write_all(content))
            }
            Place::File(folder, name) => replace(folder, name, content),
        };
        let path = || if self.is_standard() { "standard output".into() } else { self.path.clone() };
        written.map_err(|source| OutputError { path: path(), source })
    }
}

impl Place {
    fn find(path: &Path) -> io::Result<Self> {
        if path.as_os_str() == "-" {
            return Ok(Place::Standard);
        }
        let path = match metadata(path) {
            Ok(there) if there.is_dir() => {
                return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
            }
            Ok(there) if !there.is_file() => return Ok(Place::Stream(path.into())),
            Ok(_) => {
                OpenOptions::new().append(true).open(path)?;
                path.canonicalize()?
            }
            Err(_) if path.is_symlink() => return Err(io::Error::other("it is a link to nothing")),
            Err(_) => path.into(),
        };
        let name = path.file_name().ok_or_else(|| io::Error::other("it names no file"))?;
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(io::Error::other(format!("there is no folder {}", folder.display())));
        }
        // The kind alone: the error's text names the temporary file, which means nothing to the user.
        Builder::new().prefix(TEMPORARY).tempfile_in(folder).map_err(|e| e.kind())?;
        Ok(Place::File(folder.canonicalize()?, name.into()))
    }
}

fn replace(folder: &Path, name: &Path, content: &[u8]) -> io::Result<()> {
    let mut builder = Builder::new();
    builder.prefix(TEMPORARY).suffix(".tmp");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(content)?;
    file.as_file().sync_all()?;
    file.persist(folder.join(name)).map(drop).map_err(|e| e.error)
}
