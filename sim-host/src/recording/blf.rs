//! Reads binary CAN logs (BLF) of Vector's tools and of others that write it, such as python-can.
//!
//! A file is a header, then containers, mostly compressed, whose contents in a row are the objects; an object may begin in
//! one container and end in the next. Layout as read by python-can and by Lorenz's vector_blf; Vector has published none.
//! Objects other than CAN frames are skipped. Times are the file's start plus the object's; the start is read as UTC.

use super::Remark;
use super::frames::{Frames, Id, MOST_BYTES};
use super::remarks::Remarks;
use chrono::NaiveDate;
use std::io::Read;

/// First bytes of an object.
const OBJECT: &[u8; 4] = b"LOBJ";
/// Bytes of an object's header that all objects have: mark, sizes, kind.
const BASE: usize = 16;
/// Kind of a container.
const CONTAINER: u32 = 10;
/// Bytes of a container before its content.
const CONTAINER_HEAD: usize = 16;

/// Whether these bytes are such a log, by its first ones.
pub fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(b"LOGG")
}

/// Reads a log.
///
/// # Errors
/// It has no data frame, or its header is cut.
pub fn parse(bytes: &[u8]) -> Result<Frames, Remark> {
    let mut frames = Frames::default();
    let head = number(bytes, 4, 4).filter(|size| *size >= 56 && *size <= bytes.len() as u64);
    let head = head.ok_or_else(|| Remark::of_file("ends within its header".to_owned()))? as usize;
    let mut remarks = Remarks::default();
    let mut log = Log { start_s: start_s(bytes), frames: &mut frames, remarks: &mut remarks };
    log.containers(&bytes[head..]);
    frames.checked(remarks)
}

/// A file while it is read.
struct Log<'a> {
    start_s: f64,
    frames: &'a mut Frames,
    remarks: &'a mut Remarks,
}

/// An object: its kind, its format's version, its header's size and all of its bytes.
struct Object<'a> {
    kind: u32,
    version: u64,
    head: usize,
    bytes: &'a [u8],
}

/// What follows in a row of objects.
enum Next<'a> {
    /// A whole object, and where the next one is searched.
    Whole(Object<'a>, usize),
    /// An object that ends beyond the bytes.
    Cut(Object<'a>),
    /// No object where one is due.
    Damaged,
    End,
}

impl Log<'_> {
    /// Reads the file's objects: their contents in a row, up to what is damaged.
    fn containers(&mut self, mut bytes: &[u8]) {
        let mut row = Vec::new();
        loop {
            match next(bytes) {
                Next::Whole(object, end) => {
                    self.take(&object, &mut row);
                    bytes = bytes.get(end..).unwrap_or_default();
                }
                Next::Cut(object) => {
                    self.take(&object, &mut row);
                    self.remark("the file ends within an object; read up to there");
                    break;
                }
                Next::Damaged => {
                    self.remark("bytes that are no object; skipped up to the next one");
                    self.objects(&std::mem::take(&mut row));
                    bytes = later(bytes);
                }
                Next::End => break,
            }
        }
        self.objects(&row);
    }

    /// Adds a container's content, or an object that is in none, to the row.
    fn take(&mut self, object: &Object<'_>, row: &mut Vec<u8>) {
        if object.kind != CONTAINER {
            row.extend_from_slice(object.bytes);
            // The padding before the next object, which the row has inside a container.
            row.resize(row.len() + object.bytes.len() % 4, 0);
            return;
        }
        let body = object.bytes.get(BASE..).unwrap_or_default();
        let (Some(method), Some(size)) = (number(body, 0, 2), number(body, 8, 4)) else { return };
        let content = body.get(CONTAINER_HEAD..).unwrap_or_default();
        let before = row.len();
        let whole = match method {
            0 => {
                row.extend_from_slice(content);
                true
            }
            2 => flate2::read::ZlibDecoder::new(content).take(size).read_to_end(row).is_ok(),
            _ => {
                self.remark("containers of an unknown compression; left out");
                return self.objects(&std::mem::take(row));
            }
        };
        if !whole || row.len() - before < size as usize {
            self.remark("containers that are damaged or cut; read up to there");
            self.objects(&std::mem::take(row));
        }
    }

    /// Reads the objects in a row.
    fn objects(&mut self, mut bytes: &[u8]) {
        loop {
            match next(bytes) {
                Next::Whole(object, end) => {
                    if let Err(error) = self.event(&object) {
                        self.remark(error);
                    }
                    bytes = bytes.get(end..).unwrap_or_default();
                }
                Next::Cut(_) => return self.remark("objects that are cut; left out"),
                Next::Damaged => {
                    self.remark("bytes that are no object; skipped up to the next one");
                    bytes = later(bytes);
                }
                Next::End => return,
            }
        }
    }

    /// Reads an object; the error is why it is left out.
    fn event(&mut self, object: &Object<'_>) -> Result<(), &'static str> {
        const CUT: &str = "frames with fewer bytes than their kind has; left out";
        let body = object.bytes.get(object.head..).unwrap_or_default();
        let at = |place, bytes| number(body, place, bytes).ok_or(CUT);
        let classic = |mark: u64| mark & 0x80 != 0;
        let (bus, id, remote, length, data) = match object.kind {
            // CAN_MESSAGE, CAN_MESSAGE2
            1 | 86 => {
                let length = at(3, 1)?;
                if length > 15 {
                    return Err("frames whose length is invalid; left out");
                }
                (at(0, 2)?, at(4, 4)?, classic(at(2, 1)?), length.min(8), 8)
            }
            // CAN_FD_MESSAGE
            100 => (at(0, 2)?, at(4, 4)?, classic(at(2, 1)?), at(14, 1)?, 20),
            // CAN_FD_MESSAGE_64
            101 => (at(0, 1)?, at(4, 4)?, at(12, 4)? & 0x10 != 0, at(2, 1)?, 40),
            // CAN_ERROR, CAN_ERROR_EXT, CAN_FD_ERROR_64
            2 | 73 | 104 => {
                self.frames.errors += 1;
                return Ok(());
            }
            _ => return Ok(()),
        };
        if remote {
            self.frames.remote += 1;
            return Ok(());
        }
        let length = length as usize;
        if length > MOST_BYTES {
            return Err("frames whose length is invalid; left out");
        }
        let mut room = [0; MOST_BYTES];
        let data = match body.get(data..data + length) {
            Some(data) => data,
            // Vector's library fills up frames of this kind with zeros.
            None if object.kind == 101 => {
                let there = body.get(data..).ok_or(CUT)?;
                room[..there.len()].copy_from_slice(there);
                &room[..length]
            }
            None => return Err(CUT),
        };
        let extended = id & 0x8000_0000 != 0;
        let id = Id::new(id as u32 & 0x7fff_ffff, extended)
            .ok_or("frames whose identifier has too many bits; left out")?;
        let time_s = self.start_s + object.time_s().ok_or("objects of an unknown version; left out")?;
        self.frames.push(time_s, 0, &bus.to_string(), id, data);
        Ok(())
    }

    fn remark(&mut self, what: &'static str) {
        self.remarks.add(what, None, None, || what.to_owned());
    }
}

impl Object<'_> {
    /// Time since the start of the file \[s\]; `None` in an unknown version.
    fn time_s(&self) -> Option<f64> {
        if !matches!(self.version, 1 | 2) {
            return None;
        }
        let unit_s = match number(self.bytes, BASE, 4)? {
            1 => 1e-5,
            _ => 1e-9,
        };
        Some(number(self.bytes, BASE + 8, 8)? as f64 * unit_s)
    }
}

/// The next object. Up to seven bytes before it are padding, whose length depends on the writer.
fn next(bytes: &[u8]) -> Next<'_> {
    const PADDING: usize = 7;
    let near = &bytes[..bytes.len().min(PADDING + OBJECT.len())];
    let Some(start) = near.windows(OBJECT.len()).position(|four| four == OBJECT) else {
        return if bytes.len() <= PADDING { Next::End } else { Next::Damaged };
    };
    let rest = &bytes[start..];
    let of = |place, size| number(rest, place, size).unwrap_or(0);
    let (head, version, size) = (of(4, 2) as usize, of(6, 2), of(8, 4) as usize);
    let object = |end: usize| Object { kind: of(12, 4) as u32, version, head, bytes: &rest[..end] };
    match size {
        _ if rest.len() < BASE => Next::Cut(object(rest.len())),
        _ if head < BASE || size < head => Next::Damaged,
        _ if size > rest.len() => Next::Cut(object(rest.len())),
        _ => Next::Whole(object(size), start + size),
    }
}

/// The bytes from the next object on, without the one at the beginning.
fn later(bytes: &[u8]) -> &[u8] {
    let rest = bytes.get(1..).unwrap_or_default();
    let place = rest.windows(OBJECT.len()).position(|four| four == OBJECT);
    place.map_or(&[], |place| &rest[place..])
}

/// Start of the measurement \[s since 1970\]; 0 without a date.
fn start_s(bytes: &[u8]) -> f64 {
    let field = |i: usize| number(bytes, 40 + 2 * i, 2).and_then(|n| u32::try_from(n).ok()).unwrap_or(0);
    let year = i32::try_from(field(0)).unwrap_or(0);
    NaiveDate::from_ymd_opt(year, field(1), field(3))
        .and_then(|date| date.and_hms_milli_opt(field(4), field(5), field(6), field(7)))
        .map_or(0.0, |start| start.and_utc().timestamp_millis() as f64 * 1e-3)
}

/// The little-endian number of `size` bytes at `place`; `None` beyond the end.
fn number(bytes: &[u8], place: usize, size: usize) -> Option<u64> {
    let bytes = bytes.get(place..place.checked_add(size)?)?;
    Some(bytes.iter().rev().fold(0, |all, byte| all << 8 | u64::from(*byte)))
}
