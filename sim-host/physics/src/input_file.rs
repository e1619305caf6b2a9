//! Reads whole files within a bound, so that a device or a mistaken path does not fill the memory.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Largest text file that is read (a bicycle, a law, a scenario, a result) \[bytes\].
pub const LARGEST_TEXT: u64 = 256 << 20;
/// Largest recording that is read, also after decompression \[bytes\].
pub const LARGEST_RECORDING: u64 = 4 << 30;

/// Reads a text file.
///
/// # Errors
/// It can't be opened or read, is a device, is larger than [`LARGEST_TEXT`], or is not in UTF-8.
pub fn text(path: &Path) -> io::Result<String> {
    in_utf8(bytes(path, LARGEST_TEXT)?)
}

/// Reads a recording as text.
///
/// # Errors
/// As of [`text`], with [`LARGEST_RECORDING`].
pub fn recorded_text(path: &Path) -> io::Result<String> {
    in_utf8(bytes(path, LARGEST_RECORDING)?)
}

/// Reads text from standard input.
///
/// # Errors
/// As of [`text`].
pub fn standard_input() -> io::Result<String> {
    in_utf8(within(io::stdin().lock(), LARGEST_TEXT)?)
}

/// Reads a file of at most `largest` bytes.
///
/// # Errors
/// It can't be opened or read, is a device, or is larger.
pub fn bytes(path: &Path, largest: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    if is_device(&file)? && path != Path::new("/dev/stdin") {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "is a device, not a file"));
    }
    within(file, largest)
}

/// Reads all that comes, at most `largest` bytes.
///
/// # Errors
/// A failed read, or more bytes.
pub fn within(from: impl Read, largest: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if from.take(largest + 1).read_to_end(&mut bytes)? as u64 > largest {
        let what = format!("is larger than {} MB, the most that is read", largest >> 20);
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, what));
    }
    Ok(bytes)
}

fn in_utf8(bytes: Vec<u8>) -> io::Result<String> {
    let invalid = "stream did not contain valid UTF-8";
    String::from_utf8(bytes).map_err(|_| io::Error::new(io::ErrorKind::InvalidData, invalid))
}

#[cfg(unix)]
fn is_device(file: &File) -> io::Result<bool> {
    use std::os::unix::fs::FileTypeExt;
    let kind = file.metadata()?.file_type();
    Ok(kind.is_char_device() || kind.is_block_device())
}

#[cfg(not(unix))]
fn is_device(_: &File) -> io::Result<bool> {
    Ok(false)
}

#[cfg(test)]
mod tests {
    use super::within;

    #[test]
    fn no_more_than_the_largest_is_read() {
        assert_eq!(within(&[7; 9][..], 9).expect("as large as allowed"), [7; 9]);
        let error = within(std::io::repeat(0), 1 << 20).expect_err("endless").to_string();
        assert!(error.contains("larger than 1 MB"), "{error}");
    }
}
