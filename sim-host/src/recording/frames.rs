//! Data frames of CAN buses, in the order of the file.

use super::Remark;
use super::remarks::Remarks;
use std::collections::HashMap;
use std::fmt::{self, Display};

/// Most bytes of a frame (CAN FD).
pub const MOST_BYTES: usize = 64;

/// Identifier of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Id {
    /// The number: 11 bits, or 29 if it is extended.
    pub number: u32,
    /// Whether it has 29 bits. The same number with 11 bits is another identifier.
    pub extended: bool,
}

impl Id {
    /// An identifier; `None` if the number has too many bits.
    pub fn new(number: u32, extended: bool) -> Option<Self> {
        (number >> if extended { 29 } else { 11 } == 0).then_some(Self { number, extended })
    }
}

impl Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:#x}{}", self.number, if self.extended { " (29 bits)" } else { "" })
    }
}

/// One data frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<'a> {
    /// Time in the file \[s\].
    pub time_s: f64,
    /// Its line, from 1; 0 where the format has no lines.
    pub line: u64,
    /// Its bus, as an index into [`Frames::buses`].
    pub bus: u32,
    /// Its identifier.
    pub id: Id,
    /// Its bytes, at most [`MOST_BYTES`].
    pub data: &'a [u8],
}

/// The data frames of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frames {
    /// Names of the buses, as in the file.
    pub buses: Vec<String>,
    /// Remote frames, which request data and have none.
    pub remote: u64,
    /// Error frames.
    pub errors: u64,
    /// Data that is unusable as it is.
    pub remarks: Vec<Remark>,
    places: HashMap<String, u32>,
    heads: Vec<Head>,
    bytes: Vec<u8>,
}

/// A frame without its bytes, which are the `length` bytes from `at` on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Head {
    time_s: f64,
    line: u64,
    at: usize,
    id: Id,
    bus: u32,
    length: u8,
}

impl Frames {
    /// Adds a frame; bytes beyond [`MOST_BYTES`] are dropped.
    pub fn push(&mut self, time_s: f64, line: u64, bus: &str, id: Id, data: &[u8]) {
        let bus = self.places.get(bus).copied().unwrap_or_else(|| {
            let place = self.buses.len() as u32;
            self.buses.push(bus.to_owned());
            self.places.insert(bus.to_owned(), place);
            place
        });
        let data = &data[..data.len().min(MOST_BYTES)];
        self.heads.push(Head { time_s, line, at: self.bytes.len(), id, bus, length: data.len() as u8 });
        self.bytes.extend_from_slice(data);
    }

    /// The frames of a whole file, with the remarks about it.
    ///
    /// # Errors
    /// There is no data frame: the first remark, if there is one.
    pub(super) fn checked(self, remarks: Remarks) -> Result<Self, Remark> {
        let frames = Self { remarks: remarks.done(), ..self };
        match (frames.is_empty(), frames.remarks.first()) {
            (true, Some(first)) => Err(first.clone()),
            (true, None) => Err(Remark::of_file("no data frame in it".to_owned())),
            _ => Ok(frames),
        }
    }

    /// Number of data frames.
    pub fn len(&self) -> usize {
        self.heads.len()
    }

    /// Whether there is no data frame.
    pub fn is_empty(&self) -> bool {
        self.heads.is_empty()
    }

    /// The data frames, in the order of the file.
    pub fn iter(&self) -> impl Iterator<Item = Frame<'_>> {
        self.heads.iter().map(|head| Frame {
            time_s: head.time_s,
            line: head.line,
            bus: head.bus,
            id: head.id,
            data: &self.bytes[head.at..head.at + usize::from(head.length)],
        })
    }
}
