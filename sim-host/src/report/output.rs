//! Writes result files atomically: to a temporary file in the same folder, then renamed.

#[cfg(unix)]
use std::fs::File;
use std::fs::{Metadata, OpenOptions, metadata};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// Prefix of the temporary files' names.
pub(crate) const TEMPORARY: &str = ".sim-host-";

/// The destination of a result: checked before the computation, so that an error appears early, and written at the end.
/// Nothing is created in between, so nothing is left behind.
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
    Stream(FileIdentity),
    /// A file: its folder with links resolved, and its name in it.
    File(PathBuf, PathBuf),
}

/// What two paths of one file, device or pipe have in common: device and inode.
#[cfg(unix)]
type FileIdentity = (u64, u64);
/// What two paths of one file, device or pipe have in common.
#[cfg(not(unix))]
type FileIdentity = PathBuf;

#[cfg(unix)]
fn identity(_: &Path, there: &Metadata) -> io::Result<FileIdentity> {
    use std::os::unix::fs::MetadataExt;
    Ok((there.dev(), there.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path, _: &Metadata) -> io::Result<FileIdentity> {
    path.canonicalize()
}

/// Whether a path is another name of standard output, such as `/dev/stdout`.
#[cfg(unix)]
fn is_standard_output(path: &Path, there: &Metadata) -> bool {
    use std::os::fd::AsFd;
    let standard = io::stdout().as_fd().try_clone_to_owned().and_then(|file| File::from(file).metadata());
    standard.is_ok_and(|standard| identity(path, there).ok() == identity(path, &standard).ok())
}

#[cfg(not(unix))]
fn is_standard_output(_: &Path, _: &Metadata) -> bool {
    false
}

/// Why a result cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("can't write {path}: {source}")]
pub struct OutputError {
    path: PathBuf,
    source: io::Error,
}

impl OutputError {
    /// The error of standard output.
    pub fn of_standard(source: io::Error) -> Self {
        Self { path: "standard output".into(), source }
    }

    /// Whether the folder is missing.
    pub(crate) fn is_not_found(&self) -> bool {
        self.source.kind() == io::ErrorKind::NotFound
    }
}

impl Output {
    /// Prepares to write `path`; `-` is standard output.
    ///
    /// # Errors
    /// The folder is missing or not writable, or `path` is a folder, a file without write permission, or a dangling
    /// symlink.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let place = Place::find(path).map_err(|source| OutputError { path: path.into(), source })?;
        Ok(Self { path: path.into(), place })
    }

    /// The path as given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether this is standard output.
    pub fn is_standard(&self) -> bool {
        self.place == Place::Standard
    }

    /// Whether both have the same destination.
    pub fn collides(&self, other: &Output) -> bool {
        self.place == other.place
    }

    /// Writes the content; a file is written to a temporary file and renamed.
    ///
    /// # Errors
    /// The system's error; the destination is then unchanged and no temporary file remains.
    pub fn finish(&self, content: &[u8]) -> Result<(), OutputError> {
        let written = match &self.place {
            Place::Standard => io::stdout().lock().write_all(content).and_then(|()| io::stdout().flush()),
            Place::Stream(_) => {
                OpenOptions::new().write(true).open(&self.path).and_then(|mut f| f.write_all(content))
            }
            Place::File(folder, name) => temporary(folder, content)
                .and_then(|file| file.persist(folder.join(name)).map(drop).map_err(|e| e.error)),
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
            // Also a file to which standard output is redirected: replacing it would lose what else is written there.
            Ok(there) if is_standard_output(path, &there) => return Ok(Place::Standard),
            Ok(there) if !there.is_file() => return Ok(Place::Stream(identity(path, &there)?)),
            Ok(_) => {
                OpenOptions::new().append(true).open(path)?;
                path.canonicalize()?
            }
            Err(_) if path.is_symlink() => return Err(io::Error::other("it is a dangling symlink")),
            Err(_) => path.into(),
        };
        let name = path.file_name().ok_or_else(|| io::Error::other("it names no file"))?;
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(io::Error::other(format!("there is no folder {}", folder.display())));
        }
        Builder::new().prefix(TEMPORARY).tempfile_in(folder).map_err(|e| without_name(&e, folder))?;
        Ok(Place::File(folder.canonicalize()?, name.into()))
    }
}

/// Replaces a file, whole or not at all; without the check in advance of [`Output::create`].
///
/// # Errors
/// The system's error.
pub(crate) fn replace(path: &Path, content: &[u8]) -> Result<(), OutputError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let written = temporary(folder, content).and_then(|file| file.persist(path).map_err(|e| e.error));
    written.map(drop).map_err(|source| OutputError { path: path.into(), source })
}

/// Writes a file, whole or not at all, unless it exists: of several processes one does, and the others get false.
///
/// # Errors
/// The system's error.
pub(crate) fn write_new(path: &Path, content: &[u8]) -> Result<bool, OutputError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let written =
        temporary(folder, content).and_then(|file| file.persist_noclobber(path).map_err(|e| e.error));
    match written {
        Ok(_) => Ok(true),
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => Ok(false),
        Err(source) => Err(OutputError { path: path.into(), source }),
    }
}

/// The error of a temporary file in `folder`, without its name, which the user does not know.
fn without_name(error: &io::Error, folder: &Path) -> io::Error {
    match error.kind() {
        io::ErrorKind::NotFound if folder.is_dir() => {
            io::Error::other(format!("no file can be made in {}", folder.display()))
        }
        kind @ io::ErrorKind::NotFound => {
            io::Error::new(kind, format!("there is no folder {}", folder.display()))
        }
        kind @ io::ErrorKind::StorageFull => io::Error::new(kind, "No space left on device"),
        kind => kind.into(),
    }
}

/// A temporary file in `folder` with the content; removed when dropped.
fn temporary(folder: &Path, content: &[u8]) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(TEMPORARY).suffix(".tmp");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(|e| without_name(&e, folder))?;
    file.as_file_mut().write_all(content)?;
    file.as_file().sync_all()?;
    Ok(file)
}
