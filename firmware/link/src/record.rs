//! Stored form of a configuration: the law, then each parameter's value with the hash of its name, so that another
//! version of the firmware finds the parameters it has.

use crate::bytes::{Reader, Writer, from_bits, to_bits};
use crate::law::{self, LAW_BYTES, NoLaw};
use crate::parameter_list::each_but_law;
use crate::requests::{CALIBRATION, check};
use control::Config;
use control::law::LAW;
use control::param::ParamError;

/// Version of the layout; records of another layout are not read.
pub const LAYOUT: u8 = 1;
/// Largest number of parameters in a record, those of other versions included.
pub const MAX_ENTRIES: usize = 384;
/// Size of a parameter's hash and value \[bytes\].
const ENTRY_BYTES: usize = 8;
/// Largest record \[bytes\]: layout, number, length of the law, law, and each parameter.
pub const RECORD_BYTES: usize = 1 + 4 + 2 + LAW_BYTES + ENTRY_BYTES * MAX_ENTRIES;

/// Error of decoding a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRecord {
    /// Another layout.
    Layout(u8),
    /// Inconsistent lengths.
    Malformed,
}

/// Reason why a stored record is invalid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InvalidRecord {
    /// The flash or its pages can't be read.
    Unreadable,
    /// The newest record is lost; an older one can remain.
    Lost,
    /// Not a record.
    NoRecord(NoRecord),
    /// Inconsistent values.
    Inconsistent(ParamError),
}

/// A decoded record.
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Record number; increases with each stored record.
    pub number: u32,
    law: &'a [u8],
    entries: &'a [u8],
}

/// Result of applying a record to a configuration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Applied {
    /// Number of rejected values; their parameters have the defaults.
    pub rejected: u16,
    /// First rejected value.
    pub first_rejected: Option<ParamError>,
    /// Number of values of unknown parameters.
    pub unknown: u16,
    /// Number of parameters missing in the record; they have the defaults.
    pub missing: u16,
    /// A calibration parameter is missing, so the polarity check was passed with another calibration.
    pub calibration_missing: bool,
}

/// Encodes a record and returns its length \[bytes\]; `None` if there are more than [`MAX_ENTRIES`] parameters.
///
/// Values of the previous record `before` for parameters unknown to this version are kept, as far as they fit.
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

/// Decodes a record.
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
    /// Hash and value bits of each parameter.
    pub fn entries(&self) -> impl Iterator<Item = (u32, u32)> {
        pairs(self.entries)
    }

    /// Sets every known value that is valid by itself in `config`; `Config::plan` checks whether the values are
    /// consistent.
    pub fn apply(&self, config: &mut Config) -> Applied {
        let mut applied = Applied::default();
        let reject = |applied: &mut Applied, error: ParamError| {
            applied.rejected += 1;
            applied.first_rejected = applied.first_rejected.or(Some(error));
        };
        match law::decode(&mut Reader(self.law)) {
            Ok(law) => config.law = law,
            Err(NoLaw::Rejected(error)) => reject(&mut applied, error),
            Err(NoLaw::Malformed) => reject(&mut applied, LAW.error(f32::NAN)),
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
                    reject(&mut applied, view.leaf.error(value.unwrap_or(f32::NAN)));
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
