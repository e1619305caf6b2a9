//! A channel group with its records, separated from those of other groups.

use super::channel::{Channel, Kind};
use super::record::Shape;
use std::ops::Range;

/// A channel group and its records.
pub(super) struct ChannelGroup<'a> {
    /// Position of its block.
    pub(super) at: usize,
    pub(super) name: String,
    /// Name of the source, such as a bus.
    pub(super) source: String,
    pub(super) shape: Shape,
    pub(super) channels: Vec<Channel>,
    pub(super) bytes: &'a [u8],
    pub(super) records: Vec<Range<usize>>,
}

impl ChannelGroup<'_> {
    /// Its records.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u8]> {
        self.records.iter().map(|record| &self.bytes[record.clone()])
    }

    /// The channel with the time of each record.
    pub(super) fn master(&self) -> Option<&Channel> {
        self.channels.iter().find(|c| matches!(c.kind, Kind::Time | Kind::CountedTime) && c.is_number())
    }

    /// The times of its records \[s\], from the master channel.
    pub(super) fn times_s(&self) -> Option<Vec<f64>> {
        self.master().map(|master| self.values(master))
    }

    /// A channel's values, one per record.
    pub(super) fn values(&self, channel: &Channel) -> Vec<f64> {
        let value = |(n, record)| channel.value(n, record, self.shape.data_bytes);
        self.iter().enumerate().map(value).collect()
    }
}
