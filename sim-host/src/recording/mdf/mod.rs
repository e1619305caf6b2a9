//! Reads measurement files (MDF 4, ASAM) of data loggers and measuring programs.
//!
//! Supported: groups of numeric channels, as columns with their conversions applied, and CAN frames of bus logging
//! (`CAN_DataFrame`), which a database decodes; sorted and unsorted, whole, in lists and compressed. An unfinished file
//! (`UnFinMF`, as a logger leaves it on loss of power) or a cut one is read up to the last whole record, with a remark.
//! Skipped with a remark: conversions by formula, arrays, text, files that store each channel separately (4.2).
//!
//! Block layout: ASAM MDF 4.1.0, as described with asammdf (`asammdf/blocks/v4_blocks.py`). Every link is checked; none
//! is followed twice.

mod block;
mod bus;
mod channel;
mod channel_group;
mod content;
mod conversion;
mod data;
mod group;
mod record;

use super::Remark;
use block::File;
pub use content::Content;

/// Bytes before the first block.
const HEAD_BYTES: usize = 64;

/// Whether the bytes are an MDF file, finished or not.
pub fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(b"MDF     ") || bytes.starts_with(b"UnFinMF ")
}

/// Reads a measurement file.
///
/// # Errors
/// The version is not 4, or the file has neither numbers nor CAN frames.
pub fn parse(bytes: &[u8]) -> Result<Content, Remark> {
    let fails = |what: &str| Remark::of_file(what.to_owned());
    if bytes.len() < HEAD_BYTES {
        return Err(fails(&format!("was cut: it has {} of the {HEAD_BYTES} bytes of its head", bytes.len())));
    }
    let version = bytes.get(28..30).map_or(0, |v| u16::from_le_bytes([v[0], v[1]]));
    if !(400..500).contains(&version) {
        let text = String::from_utf8_lossy(bytes.get(8..16).unwrap_or_default());
        let text = text.trim_matches(|c: char| c.is_whitespace() || c == '\0');
        return Err(fails(&format!("is of MDF `{text}`; only MDF 4 is read, convert it")));
    }
    let mut file = File::new(bytes);
    let mut content = Content::default();
    let header = file.block(HEAD_BYTES, b"##HD");
    let no_header = || file.cut().unwrap_or_else(|| "has no header where MDF 4 has it".to_owned());
    let header = header.ok_or_else(|| Remark::of_file(no_header()))?;
    let mut next = header.link(0);
    while let Some(at) = next {
        let Some(found) = file.once(at, b"##DG") else {
            content
                .remarks
                .push(Remark::of_file("the list of its groups is broken; the rest is left out".to_owned()));
            break;
        };
        next = found.link(0);
        group::read(&mut file, &found, &mut content);
    }
    if file.unfinished {
        let what = "was not finished, as when a logger's power goes; read up to its last whole record";
        content.remarks.insert(0, Remark::of_file(what.to_owned()));
    } else if let Some(what) = file.cut() {
        content.remarks.insert(0, Remark::of_file(what));
    }
    match content.groups.is_empty() && content.frames.is_empty() {
        true => Err(content
            .remarks
            .into_iter()
            .next()
            .unwrap_or_else(|| fails("holds no record of numbers or frames"))),
        false => Ok(content),
    }
}
