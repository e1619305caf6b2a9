//! Decodes CAN frames to columns: one group per message, one column per signal.

use super::database::Database;
use super::frames::{Frames, Id};
use super::{Column, Group, Remark};
use std::collections::{BTreeMap, HashMap};

/// Most unknown identifiers that are listed.
const LISTED: usize = 20;

/// Result of decoding frames with databases.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decoded {
    /// A group for each message, in the order of its first frame.
    pub groups: Vec<Group>,
    /// Data that could not be used.
    pub remarks: Vec<Remark>,
    /// Number of frames that each database decoded.
    pub used: Vec<u64>,
}

/// Rows of a message during decoding.
struct Rows {
    bus: u32,
    database: usize,
    message: usize,
    group: Group,
    times_s: Vec<f64>,
    short: u64,
}

/// Decodes frames. A message in two databases is decoded by the first of them.
///
/// A group has its message's name; a message on several buses has the bus appended in brackets, and messages of the
/// same name have their identifier.
pub fn groups(frames: &Frames, databases: &[Database]) -> Decoded {
    let mut rows: Vec<Rows> = Vec::new();
    let mut places: HashMap<(u32, Id), usize> = HashMap::new();
    let mut unknown: BTreeMap<Id, u64> = BTreeMap::new();
    let mut used = vec![0; databases.len()];
    for frame in frames.iter() {
        let place = match places.get(&(frame.bus, frame.id)) {
            Some(place) => *place,
            None => {
                let found = databases
                    .iter()
                    .enumerate()
                    .find_map(|(at, database)| database.message(frame.id).map(|(place, _)| (at, place)));
                let Some((database, message)) = found else {
                    *unknown.entry(frame.id).or_default() += 1;
                    continue;
                };
                rows.push(Rows::new(frame.bus, database, message, databases));
                places.insert((frame.bus, frame.id), rows.len() - 1);
                rows.len() - 1
            }
        };
        let row = &mut rows[place];
        let message = &databases[row.database].messages[row.message];
        used[row.database] += 1;
        row.short += u64::from(frame.data.len() < message.bytes());
        row.times_s.push(frame.time_s);
        if frame.line > 0 {
            row.group.lines.push(frame.line);
        }
        for (column, value) in row.group.columns.iter_mut().zip(message.values(frame.data)) {
            column.values.push(value);
        }
    }
    let mut remarks = unread(frames, &unknown);
    let twice = |id: Id| databases.iter().filter(|database| database.message(id).is_some()).count() > 1;
    let names: Vec<String> = rows.iter().map(|row| row.group.name.clone()).collect();
    let same = |row: &Rows, other: &Rows| other.group.name == row.group.name;
    let full: Vec<String> = rows
        .iter()
        .map(|row| {
            let message = &databases[row.database].messages[row.message];
            let on_buses = rows.iter().any(|other| same(row, other) && other.bus != row.bus);
            let of_ids = rows.iter().any(|other| {
                same(row, other) && databases[other.database].messages[other.message].id != message.id
            });
            let mut name = message.name.clone();
            if on_buses {
                name += &format!(" ({})", frames.buses[row.bus as usize]);
            }
            if of_ids {
                name += &format!(" ({})", message.id);
            }
            name
        })
        .collect();
    for (row, name) in rows.iter().zip(&names) {
        let message = &databases[row.database].messages[row.message];
        if row.short > 0 {
            let what = format!("frames that end before its signals do: {}; these are blank there", row.short);
            remarks.push(Remark::of_file(format!("message {name}: {what}")));
        }
        if twice(message.id) {
            let what = format!("message {name}: two databases have {}; the first is used", message.id);
            remarks.push(Remark::of_file(what));
        }
        remarks.extend(
            message
                .unused
                .iter()
                .map(|error| Remark::of_file(format!("message {name}: {error}; left blank"))),
        );
    }
    let groups = rows
        .into_iter()
        .zip(full)
        .map(|(row, name)| Group { name, times_s: Some(row.times_s), ..row.group })
        .collect();
    Decoded { groups, remarks, used }
}

impl Rows {
    fn new(bus: u32, database: usize, message: usize, databases: &[Database]) -> Self {
        let layout = &databases[database].messages[message];
        let column = |name: &String, unit: &String| Column {
            name: name.clone(),
            unit: unit.clone(),
            values: Vec::new(),
        };
        let columns = layout.signals.iter().map(|signal| column(&signal.name, &signal.unit)).collect();
        let group = Group { name: layout.name.clone(), columns, ..Group::default() };
        Self { bus, database, message, group, times_s: Vec::new(), short: 0 }
    }
}

/// Skipped content, with its number of occurrences.
fn unread(frames: &Frames, unknown: &BTreeMap<Id, u64>) -> Vec<Remark> {
    let mut remarks: Vec<Remark> = unknown
        .iter()
        .take(LISTED)
        .map(|(id, count)| Remark::of_file(format!("frames of {id} are in no database: {count}; left out")))
        .collect();
    if unknown.len() > LISTED {
        let (ids, count) = (unknown.len() - LISTED, unknown.values().skip(LISTED).sum::<u64>());
        let what = format!("frames of {ids} more identifiers are in no database: {count}; left out");
        remarks.push(Remark::of_file(what));
    }
    for (count, what) in
        [(frames.remote, "remote frames, which have no data"), (frames.errors, "error frames")]
    {
        if count > 0 {
            remarks.push(Remark::of_file(format!("{what}: {count}; left out")));
        }
    }
    remarks
}
