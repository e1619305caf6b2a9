//! CAN frames in channel groups of bus logging (ASAM MDF bus logging): `CAN_DataFrame` with its parts.

use super::super::Remark;
use super::super::frames::{Id, MOST_BYTES};
use super::block::File;
use super::channel::{Channel, Kind};
use super::channel_group::ChannelGroup;
use super::{Content, data};
use std::collections::HashMap;
use std::ops::Range;

/// Bytes of a frame by its length code (DLC).
const LENGTHS: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];
/// Bit that marks an identifier of 29 bits, in files without a channel for it.
const EXTENDED: u64 = 1 << 31;

/// Kind of a bus logging group.
pub(super) enum Sort {
    Data,
    Remote,
    Error,
}

impl Sort {
    /// The kind, from the names of the channels.
    pub(super) fn of(channels: &[Channel]) -> Option<Self> {
        let has = |name: &str| channels.iter().any(|channel| channel.name.split('.').next() == Some(name));
        match () {
            () if has("CAN_DataFrame") => Some(Sort::Data),
            () if has("CAN_RemoteFrame") => Some(Sort::Remote),
            () if has("CAN_ErrorFrame") => Some(Sort::Error),
            () => None,
        }
    }
}

/// Where the bytes of frames are if not in the record itself.
enum Elsewhere<'a> {
    /// In a block: the record has the position of a length that precedes the bytes.
    Block(std::borrow::Cow<'a, [u8]>),
    /// In records of another group, by their position in the joined records, and in the order of the records.
    Records(&'a [u8], HashMap<u64, Range<usize>>, Vec<Range<usize>>),
}

impl Elsewhere<'_> {
    fn bytes(&self, place: u64, number: usize, in_order: bool) -> Option<&[u8]> {
        match self {
            Elsewhere::Block(all) => {
                let rest = all.get(usize::try_from(place).ok()?..)?;
                let (size, rest) = rest.split_first_chunk()?;
                rest.get(..u32::from_le_bytes(*size) as usize)
            }
            Elsewhere::Records(all, places, order) => {
                let range = if in_order { order.get(number) } else { places.get(&place) }?;
                all.get(range.clone())
            }
        }
    }
}

/// Reads the frames of a group.
pub(super) fn frames<'a>(
    file: &mut File<'a>,
    part: &ChannelGroup,
    parts: &[ChannelGroup],
    content: &mut Content,
) {
    let find = |name: &str| {
        part.channels.iter().find(|c| c.name.strip_prefix("CAN_DataFrame.").is_some_and(|end| end == name))
    };
    let mut left_out = |what: &str| {
        content.remarks.push(Remark::of_file(format!("frames of CAN in group {}: {what}", part.name)))
    };
    let (Some(id), Some(bytes)) = (find("ID"), find("DataBytes")) else {
        return left_out("have no ID or no DataBytes; left out");
    };
    let Some(times_s) = part.times_s() else { return left_out("have no time; left out") };
    let elsewhere = match bytes.kind {
        Kind::Variable => match parts.iter().find(|other| Some(other.at) == bytes.data) {
            Some(other) => Some(of_records(other)),
            None => Some(Elsewhere::Block(data::joined(file, bytes.data).bytes)),
        },
        _ => None,
    };
    // Loggers write the positions only when they finish a file.
    let in_order = file.undone & 1 << 6 != 0;
    let (ide, length, code, bus) = (find("IDE"), find("DataLength"), find("DLC"), find("BusChannel"));
    let (mut missing, mut wrong) = (0, 0);
    for (n, (record, time_s)) in part.iter().zip(times_s).enumerate() {
        let number = |channel: Option<&Channel>| channel.and_then(|channel| channel.bits_of(record));
        let raw = id.bits_of(record).unwrap_or(u64::MAX);
        let extended = number(ide).map_or(raw & EXTENDED != 0, |ide| ide != 0);
        let Some(id) =
            Id::new((raw & 0x7fff_ffff & if extended { 0x1fff_ffff } else { !0 }) as u32, extended)
        else {
            wrong += 1;
            continue;
        };
        let inside = || record.get(bytes.byte_offset..)?.get(..bytes.bits as usize / 8);
        let all = match &elsewhere {
            Some(elsewhere) => bytes.bits_of(record).and_then(|place| elsewhere.bytes(place, n, in_order)),
            None => inside(),
        };
        let by_code = || number(code).and_then(|code| LENGTHS.get(code as usize)).copied();
        let length = number(length).map(|length| length as usize).or_else(by_code).unwrap_or(MOST_BYTES);
        let Some(all) = all else {
            missing += 1;
            continue;
        };
        let name = match number(bus) {
            Some(bus) => format!("CAN{bus}"),
            None => part.source.clone(),
        };
        content.frames.push(time_s, 0, &name, id, &all[..length.min(all.len())]);
    }
    let mut left_out = |what: String| {
        content.remarks.push(Remark::of_file(format!("frames of CAN in group {}: {what}", part.name)))
    };
    if missing > 0 {
        left_out(format!("{missing} without the bytes that belong to them; left out"));
    }
    if wrong > 0 {
        left_out(format!("{wrong} with more bits in the identifier than it may have; left out"));
    }
}

/// The bytes of records of variable length: a length precedes each, and positions count both.
fn of_records<'a>(other: &'a ChannelGroup) -> Elsewhere<'a> {
    let (mut places, mut order, mut place) = (HashMap::new(), Vec::new(), 0);
    for record in &other.records {
        let bytes = record.start + 4..record.end;
        places.insert(place, bytes.clone());
        place += record.len() as u64;
        order.push(bytes);
    }
    Elsewhere::Records(other.bytes, places, order)
}
