//! Pages of the parameter list, each as long as one frame allows.

use crate::bytes::{Reader, Writer};
use crate::frame::MAX_PAYLOAD;
use crate::key::Key;
use crate::parameter_list::{Kind, ParameterView, each, get};
use control::Config;

/// Largest size of a page's entries \[bytes\]: a payload less the three numbers before them.
pub const PAGE_BYTES: usize = MAX_PAYLOAD - 5;

/// A page of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Page<'a> {
    /// Index of the first entry in the list.
    pub from: u16,
    /// Number of parameters.
    pub total: u16,
    /// Number of entries on this page; zero only past the end.
    pub count: u8,
    /// Encoded entries; [`Page::entries`] decodes them.
    pub bytes: &'a [u8],
}

/// A parameter in the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry<'a> {
    /// Key.
    pub key: Key<'a>,
    /// Meaning of its numbers.
    pub kind: Kind,
    /// Value; `None` is a limit that is off.
    pub value: Option<f32>,
    /// Value after a reset.
    pub default: Option<f32>,
    /// Least allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
    /// Names of a choice, in the order of their numbers, separated by spaces; empty for other kinds.
    pub names: &'a str,
}

impl Entry<'_> {
    /// Unit, from the suffix of the key.
    pub fn unit(&self) -> &'static str {
        self.key.unit()
    }
}

/// Encodes the page that begins with the parameter of index `from`.
pub fn fill<'a>(defaults: &Config, config: &Config, from: u16, room: &'a mut [u8; PAGE_BYTES]) -> Page<'a> {
    let (mut total, mut count, mut used, mut full) = (0, 0, 0, false);
    each(&mut config.clone(), |view| {
        if total >= from && !full {
            let mut writer = Writer::new(room.get_mut(used..).unwrap_or_default());
            encode(view, get(defaults, view.key()).map_or(view.value, |known| known.value), &mut writer);
            match writer.used() {
                Some(bytes) => (used, count) = (used + bytes, count + 1),
                None => full = true,
            }
        }
        total += 1;
        view.value
    });
    Page { from, total, count, bytes: room.get(..used).unwrap_or_default() }
}

fn encode(view: &ParameterView, default: Option<f32>, to: &mut Writer<'_>) {
    to.u8(view.kind as u8);
    to.scalar(view.value);
    to.scalar(default);
    to.f32(view.leaf.min);
    to.f32(view.leaf.max);
    to.text(view.key().parts());
    let parts = view.names.iter().enumerate().flat_map(|(i, name)| [if i == 0 { "" } else { " " }, *name]);
    to.text(parts);
}

fn decode<'a>(from: &mut Reader<'a>) -> Option<Entry<'a>> {
    let kind = Kind::numbered(from.u8()?)?;
    let (value, default) = (from.scalar()?, from.scalar()?);
    let (min, max) = (from.f32()?, from.f32()?);
    Some(Entry { kind, value, default, min, max, key: Key::whole(from.text()?), names: from.text()? })
}

impl<'a> Page<'a> {
    /// Decodes the entries. An undecodable entry ends the list early: fewer than [`Page::count`].
    pub fn entries(&self) -> impl Iterator<Item = Entry<'a>> + use<'a> {
        let mut from = Reader(self.bytes);
        (0..self.count).map_while(move |_| decode(&mut from))
    }
}
