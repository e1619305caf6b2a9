//! Reads a data group: separates its records and converts each channel group to columns or CAN frames.

use super::super::remarks::Remarks;
use super::super::{Column, Group, Remark};
use super::block::{Block, File};
use super::channel::{self, Kind};
use super::channel_group::ChannelGroup;
use super::record::{Shape, apart};
use super::{Content, bus, data};

/// Most channels per byte of a record; each bit can be a channel, and channels can share bits.
const MOST_CHANNELS_A_BYTE: usize = 16;

/// Reads a data group.
pub(super) fn read(file: &mut File, block: &Block, content: &mut Content) {
    let (mut places, mut groups, mut shapes) = (Vec::new(), Vec::new(), Vec::new());
    let mut next = block.link(1);
    while let Some(at) = next {
        let Some(found) = file.once(at, b"##CG") else { break };
        next = found.link(0);
        let shape = Shape::of(&found);
        let source = found.link(3).and_then(|at| file.block(at, b"##SI"));
        let source = file.text(source.and_then(|source| source.link(0)));
        let mut name = file.text(found.link(2));
        for other in [source.clone(), file.text(found.link(5))] {
            name = if name.is_empty() { other } else { name };
        }
        places.push(at);
        groups.push((name, source, channel::list(file, found.link(1))));
        shapes.push(shape);
    }
    let joined = data::joined(file, block.link(2));
    let (records, rest) = apart(&joined.bytes, usize::from(block.u8(0)), &shapes);
    let mut parts: Vec<ChannelGroup> = Vec::new();
    for (((at, (name, source, channels)), shape), records) in
        places.into_iter().zip(groups).zip(shapes).zip(records)
    {
        parts.push(ChannelGroup { at, name, source, shape, channels, bytes: &joined.bytes, records });
    }
    let titled =
        parts.iter().map(|part| part.name.as_str()).find(|name| !name.is_empty()).unwrap_or("without a name");
    let mut remarks: Vec<Remark> =
        [joined.broken, rest.filter(|_| !file.unfinished || joined.broken.is_some())]
            .into_iter()
            .flatten()
            .map(|error| Remark::of_file(format!("group {titled}: {error}")))
            .collect();
    if !file.unfinished && joined.broken.is_none() && rest.is_none() {
        for part in &mut parts {
            let (has, declared) = (part.records.len(), part.shape.count);
            if !part.shape.variable && (has as u64) < declared {
                let what = format!("group {}: its header states {declared} records, it has {has}", part.name);
                remarks.push(Remark::of_file(what));
            }
            part.records.truncate(usize::try_from(declared).unwrap_or(usize::MAX));
        }
    }
    content.remarks.append(&mut remarks);
    for part in parts.iter().filter(|part| !part.shape.variable && !part.records.is_empty()) {
        match bus::Sort::of(&part.channels) {
            Some(bus::Sort::Data) => bus::frames(file, part, &parts, content),
            Some(bus::Sort::Remote) => content.frames.remote += part.records.len() as u64,
            Some(bus::Sort::Error) => content.frames.errors += part.records.len() as u64,
            None => numbers(part, content),
        }
    }
}

/// The numeric channels of a group, as columns.
fn numbers(part: &ChannelGroup, content: &mut Content) {
    let mut remarks = Remarks::default();
    let mut left_out = |what: String| {
        content.remarks.push(Remark::of_file(format!("group {}: {what}; left out", part.name)))
    };
    if part.channels.len() > MOST_CHANNELS_A_BYTE * part.shape.bytes() {
        return left_out(format!("{} channels in {} bytes", part.channels.len(), part.shape.bytes()));
    }
    if part.shape.remote_master {
        return left_out("its times are in another group (MDF 4.2), which is not read".to_owned());
    }
    let mut columns = Vec::new();
    for channel in &part.channels {
        if matches!(channel.kind, Kind::Time | Kind::CountedTime) || channel.is_structure() {
            continue;
        }
        let mut add = |kind, what: &str| {
            remarks.add(kind, None, Some(&channel.name), || format!("{what}; left out"));
        };
        match &channel.conversion {
            _ if !channel.is_number() => {
                add("channels that are no numbers; left out", "is no number, but text, bytes or an array");
            }
            Err(error) => add("channels whose conversion is not read; left out", error),
            Ok(_) => columns.push(Column {
                name: channel.name.clone(),
                unit: channel.unit.clone(),
                values: part.values(channel),
            }),
        }
    }
    content.remarks.append(&mut remarks.done());
    if !columns.is_empty() {
        let times_s = part.times_s();
        content.groups.push(Group { name: part.name.clone(), times_s, lines: Vec::new(), columns });
    }
}
