//! The bytes of a group's records or of a channel's values, joined from their blocks.

use super::block::{Block, File};
use std::borrow::Cow;
use std::io::Read;

/// Limit of the unpacked bytes of one group, since a compressed file can claim any size.
const MOST_BYTES: u64 = 1 << 31;

/// Joined bytes, and why they are incomplete, if so.
pub(super) struct Joined<'a> {
    pub(super) bytes: Cow<'a, [u8]>,
    pub(super) broken: Option<&'static str>,
}

/// Joins the data at a link: one block or a list of blocks, compressed or not. A record can begin in one block and end
/// in the next.
pub(super) fn joined<'a>(file: &mut File<'a>, at: Option<usize>) -> Joined<'a> {
    let Some(at) = at else { return Joined { bytes: Cow::Borrowed(&[]), broken: None } };
    let Some(first) = file.any_once(at) else {
        return Joined { bytes: Cow::Borrowed(&[]), broken: Some("its data is not at its stated position") };
    };
    let mut bytes = Cow::Borrowed(&[][..]);
    let broken = match &first.name {
        b"##DL" => list(file, first, &mut bytes).err(),
        b"##HL" => match first.link(0).and_then(|at| file.once(at, b"##DL")) {
            Some(list_block) => list(file, list_block, &mut bytes).err(),
            None => Some("its list of data blocks is missing"),
        },
        b"##LD" => Some("each channel is stored separately (MDF 4.2), which is not supported"),
        _ => add(&first, &mut bytes).err(),
    };
    Joined { bytes, broken }
}

/// Appends the blocks of a list and of its continuations.
fn list<'a>(file: &mut File<'a>, first: Block<'a>, bytes: &mut Cow<'a, [u8]>) -> Result<(), &'static str> {
    let mut at = Some(first);
    while let Some(block) = at {
        for n in 1..block.links() {
            // A list that was being written has null links.
            let Some(place) = block.link(n) else { continue };
            let part = file.any_once(place).ok_or("a data block is not at its stated position")?;
            add(&part, bytes)?;
        }
        at = match block.link(0) {
            Some(next) => Some(file.once(next, b"##DL").ok_or("its list of data blocks is broken")?),
            None => None,
        };
    }
    Ok(())
}

/// Appends the bytes of one block.
fn add<'a>(block: &Block<'a>, bytes: &mut Cow<'a, [u8]>) -> Result<(), &'static str> {
    match &block.name {
        b"##DT" | b"##SD" | b"##RD" | b"##DV" => extend(bytes, Cow::Borrowed(block.data)),
        b"##DZ" => extend(bytes, Cow::Owned(unpacked(block)?)),
        _ => return Err("a block at its position is no data block"),
    }
    if block.cut { Err("the file ends within its data") } else { Ok(()) }
}

fn extend<'a>(bytes: &mut Cow<'a, [u8]>, more: Cow<'a, [u8]>) {
    if bytes.is_empty() { *bytes = more } else { bytes.to_mut().extend_from_slice(&more) }
}

/// Unpacks a compressed block. Transposition covers whole rows only; the remaining bytes follow unchanged.
fn unpacked(block: &Block) -> Result<Vec<u8>, &'static str> {
    let (kind, columns) = (block.u8(2), block.u32(4) as usize);
    let (size, packed) = (block.u64(8), block.u64(16));
    let packed = usize::try_from(packed).ok().and_then(|n| block.data.get(24..)?.get(..n));
    let packed = packed.ok_or("a compressed block is cut")?;
    if size > MOST_BYTES {
        return Err("a compressed block is too large");
    }
    let mut plain = Vec::new();
    flate2::read::ZlibDecoder::new(packed)
        .take(size)
        .read_to_end(&mut plain)
        .map_err(|_| "a compressed block is damaged")?;
    if plain.len() as u64 != size {
        return Err("a compressed block is shorter than its stated length");
    }
    match kind {
        0 => Ok(plain),
        1 if columns == 0 => Err("a transposed block has no columns"),
        1 => {
            let rows = plain.len() / columns;
            let whole = rows * columns;
            let mut straight = Vec::with_capacity(plain.len());
            straight.extend((0..whole).map(|n| plain[n % columns * rows + n / columns]));
            straight.extend_from_slice(&plain[whole..]);
            Ok(straight)
        }
        _ => Err("a block has an unknown compression"),
    }
}
