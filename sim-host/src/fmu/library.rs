//! The dynamic library of the crate `fmi`, which cargo builds beside this program.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::io;
use std::path::{Path, PathBuf};

/// The library can't be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LibraryError {
    /// It is not there.
    #[error(
        "there is no {name} beside this program in {}: build it with `cargo build --release -p fmi`, or name it with --library",
        .folder.display()
    )]
    Missing {
        /// Its name.
        name: String,
        /// The program's folder.
        folder: PathBuf,
    },
    /// Another file.
    #[error("{} is not the dynamic library of the crate fmi", .path.display())]
    Other {
        /// Its path.
        path: PathBuf,
    },
    /// It can't be read.
    #[error("can't read {}: {source}", .path.display())]
    Read {
        /// Its path.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

/// Name of a function that the library exports.
const FUNCTION: &[u8] = b"fmi3InstantiateCoSimulation";

/// The bytes of the library: of the file `given`, or of the one beside this program.
///
/// # Errors
/// It is missing, can't be read, or is another file.
pub fn library(given: Option<&Path>) -> Result<Vec<u8>, LibraryError> {
    let path = given.map_or_else(beside_the_program, |path| Ok(path.into()))?;
    match std::fs::read(&path) {
        Ok(bytes) if bytes.windows(FUNCTION.len()).any(|name| name == FUNCTION) => Ok(bytes),
        Ok(_) => Err(LibraryError::Other { path }),
        Err(source) => Err(LibraryError::Read { path, source }),
    }
}

fn beside_the_program() -> Result<PathBuf, LibraryError> {
    let name = format!("{DLL_PREFIX}fmi{DLL_SUFFIX}");
    let program = std::env::current_exe().and_then(|program| program.canonicalize()).unwrap_or_default();
    let folder = program.parent().unwrap_or(Path::new(".")).to_path_buf();
    // Cargo leaves the library of a dependency in `deps`; one beside the program can be of an earlier build.
    let places = [folder.join("deps").join(&name), folder.join(&name)];
    let built = |path: &PathBuf| path.metadata().and_then(|file| file.modified()).ok();
    let newest = places.into_iter().filter(|path| path.is_file()).max_by_key(built);
    newest.ok_or(LibraryError::Missing { name, folder })
}
