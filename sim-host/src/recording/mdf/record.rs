//! Separates the records of channel groups that were written in one stream.

use super::block::Block;
use std::ops::Range;

/// Record length of a channel group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// The number that precedes its records in an unsorted data group.
    pub(super) id: u64,
    /// Bytes of channels, and of the invalidation bits after them.
    pub(super) data_bytes: usize,
    pub(super) invalidation_bytes: usize,
    /// Whether its records are bytes of variable length for a channel of another group.
    pub(super) variable: bool,
    /// Number of records; unreliable in an unfinished file.
    pub(super) count: u64,
    /// Whether its master is in another group.
    pub(super) remote_master: bool,
}

impl Shape {
    pub(super) fn of(group: &Block) -> Self {
        Self {
            id: group.u64(0),
            count: group.u64(8),
            variable: group.u16(16) & 1 != 0,
            remote_master: group.u16(16) & 8 != 0,
            data_bytes: group.u32(24) as usize,
            invalidation_bytes: group.u32(28) as usize,
        }
    }

    /// Bytes of a record.
    pub(super) fn bytes(&self) -> usize {
        self.data_bytes + self.invalidation_bytes
    }
}

/// Positions of the records of each shape, and why the rest could not be read, if so.
pub(super) fn apart(
    bytes: &[u8],
    id_bytes: usize,
    shapes: &[Shape],
) -> (Vec<Vec<Range<usize>>>, Option<&'static str>) {
    let mut records = vec![Vec::new(); shapes.len()];
    if id_bytes == 0 {
        let [shape] = shapes else {
            return (records, Some("its records have no number of their group"));
        };
        let size = shape.bytes();
        let Some(whole) = bytes.len().checked_div(size) else { return (records, None) };
        records[0] = (0..whole).map(|n| n * size..(n + 1) * size).collect();
        return (records, (whole * size < bytes.len()).then_some("its last record is not whole"));
    }
    if !matches!(id_bytes, 1 | 2 | 4 | 8) {
        return (records, Some("the size of its record numbers is invalid"));
    }
    let number = |at: usize, n: usize| {
        let bytes = bytes.get(at..)?.get(..n)?;
        Some(bytes.iter().rev().fold(0, |all, byte| all << 8 | u64::from(*byte)))
    };
    let mut at = 0;
    while at < bytes.len() {
        let Some(id) = number(at, id_bytes) else { return (records, Some("its last record is not whole")) };
        let Some(place) = shapes.iter().position(|shape| shape.id == id) else {
            return (records, Some("a record has a number of no group; what follows is left out"));
        };
        let start = at + id_bytes;
        let size = match shapes[place].variable {
            true => number(start, 4).map(|size| 4 + size as usize),
            false => Some(shapes[place].bytes()),
        };
        let Some(record) = size.map(|size| start..start + size).filter(|record| record.end <= bytes.len())
        else {
            return (records, Some("its last record is not whole"));
        };
        at = record.end;
        records[place].push(record);
    }
    (records, None)
}
