//! A configuration as the store keeps it: the law, then each parameter's value beside the hash of its
//! name, so that another version of the program finds those it knows.

use crate::bytes::{Reader, Writer, from_bits, to_bits};
use crate::law::{self, LAW_BYTES, NoLaw};
use crate::parameter_list::{LAW, each_but_law};
use crate::requests::{CALIBRATION, check};
use control::Config;
use control::param::ParamError;

/// The layout of a record. Another one is not read.
pub const LAYOUT: u8 = 1;
/// Most parameters of a record, those of other versions included.
pub const MAX_ENTRIES: usize = 384;
/// A parameter's hash and the bits of its value.
const ENTRY_BYTES: usize = 8;
/// Most bytes of a record: layout, number, length of the law, law, and each parameter.
pub const RECORD_BYTES: usize = 1 + 4 + 2 + LAW_BYTES + ENTRY_BYTES * MAX_ENTRIES;

/// Why bytes are no record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRecord {
    /// It has another layout.
    Layout(u8),
    /// Its lengths do not fit together.
    Malformed,
}

/// A record's parts.
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Its number: each that is stored has a larger one than that before.
    pub number: u32,
    law: &'a [u8],
    entries: &'a [u8],
}

/// What became of a record's values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Applied {
    /// Values that are not allowed today; their parameters have the defaults.
    pub refused: u16,
    /// The first of them.
    pub first_refused: Option<ParamError>,
    /// Values of parameters that this version does not know.
    pub unknown: u16,
    /// Parameters that the record does not have; they have the defaults.
    pub missing: u16,
    /// One of those is of the calibration, so the polarity check was passed with another one.
    pub calibration_missing: bool,
}

/// Writes a record; how many bytes it takes, `None` when there are more than [`MAX_ENTRIES`] parameters.
///
/// Values of the record `before` that belong to no parameter of this version are kept, as far as there is room.
pub fn encode(
    config: &Config,
    number: u32,
    before: Option<&Record<'_>>,
    to: &mut [u8; RECORD_BYTES],
) -> Option<usize> {
    let mut law_bytes = [0; LAW_BYTES];
    let mut law_writer = Writer::new(&mut law_bytes);
    law::encode(&config.law, &mut law_writer);
    let law = law_writer.finish()?;

    let mut writer = Writer::new(to);
    writer.u8(LAYOUT);
    writer.u32(number);
    writer.u16(law.len() as u16);
    writer.put(law);
    let head = writer.used()?;
    each_but_law(&mut config.clone(), |view| {
        writer.u32(view.key().hash());
        writer.u32(to_bits(view.value));
        view.value
    });
    let mut used = writer.used()?;
    let known = used;
    for (hash, bits) in before.into_iter().flat_map(Record::entries) {
        let (written, free) = to.split_at_mut_checked(used)?;
        if free.len() < ENTRY_BYTES {
            break;
        }
        if find(written.get(head..known)?, hash).is_none() {
            let mut writer = Writer::new(free);
            writer.u32(hash);
            writer.u32(bits);
            used += ENTRY_BYTES;
        }
    }
    Some(used)
}

/// Reads the parts of a record.
///
/// # Errors
/// As of [`NoRecord`].
pub fn decode(bytes: &[u8]) -> Result<Record<'_>, NoRecord> {
    let mut from = Reader(bytes);
    let layout = from.u8().ok_or(NoRecord::Malformed)?;
    if layout != LAYOUT {
        return Err(NoRecord::Layout(layout));
    }
    parts(&mut from).ok_or(NoRecord::Malformed)
}

fn parts<'a>(from: &mut Reader<'a>) -> Option<Record<'a>> {
    let (number, length) = (from.u32()?, from.u16()?);
    let (law, entries) = from.0.split_at_checked(usize::from(length))?;
    entries.len().is_multiple_of(ENTRY_BYTES).then_some(Record { number, law, entries })
}

impl Record<'_> {
    /// Hash and bits of each parameter.
    pub fn entries(&self) -> impl Iterator<Item = (u32, u32)> {
        pairs(self.entries)
    }

    /// Gives `config` every value that is known and allowed alone; whether they fit together is
    /// for `Config::plan` to say.
    pub fn apply(&self, config: &mut Config) -> Applied {
        let mut applied = Applied::default();
        let refuse = |applied: &mut Applied, error: ParamError| {
            applied.refused += 1;
            applied.first_refused = applied.first_refused.or(Some(error));
        };
        match law::decode(&mut Reader(self.law)) {
            Ok(law) => config.law = law,
            Err(NoLaw::Refused(error)) => refuse(&mut applied, error),
            Err(NoLaw::Malformed) => refuse(&mut applied, LAW.error(f32::NAN)),
        }
        let mut used = 0;
        each_but_law(config, |view| {
            let Some(bits) = find(self.entries, view.key().hash()) else {
                applied.missing += 1;
                applied.calibration_missing |= view.leaf.group == CALIBRATION;
                return view.value;
            };
            used += 1;
            let value = from_bits(bits);
            match check(view, value) {
                Ok(()) => value,
                Err(_) => {
                    refuse(&mut applied, view.leaf.error(value.unwrap_or(f32::NAN)));
                    view.value
                }
            }
        });
        applied.unknown = ((self.entries.len() / ENTRY_BYTES) as u16).saturating_sub(used);
        applied
    }
}

fn find(entries: &[u8], hash: u32) -> Option<u32> {
    pairs(entries).find(|(other, _)| *other == hash).map(|(_, bits)| bits)
}

fn pairs(entries: &[u8]) -> impl Iterator<Item = (u32, u32)> {
    let mut from = Reader(entries);
    core::iter::from_fn(move || Some((from.u32()?, from.u32()?)))
}
