//! Blocks of an MDF file: name, links to other blocks, data. Links out of the file are rejected; lists end.

use std::cell::Cell;
use std::collections::HashSet;

/// Bytes of a block before its links.
const HEAD_BYTES: usize = 24;

/// The bytes of a file, and which blocks of its lists were read.
pub(super) struct File<'a> {
    pub(super) bytes: &'a [u8],
    /// Whether the file is marked as unfinished.
    pub(super) unfinished: bool,
    /// Bits of what was not updated in an unfinished file.
    pub(super) undone: u16,
    read: HashSet<usize>,
    /// End of a block that the file refers to and that lies beyond its own end.
    beyond: Cell<Option<usize>>,
}

/// One block.
#[derive(Clone, Copy)]
pub(super) struct Block<'a> {
    pub(super) name: [u8; 4],
    links: &'a [u8],
    pub(super) data: &'a [u8],
    /// Whether the file ends within the block.
    pub(super) cut: bool,
}

impl<'a> File<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let unfinished = bytes.starts_with(b"UnFinMF ");
        let undone = bytes.get(60..62).map_or(0, |flags| u16::from_le_bytes([flags[0], flags[1]]));
        let (undone, read, beyond) = (if unfinished { undone } else { 0 }, HashSet::new(), Cell::new(None));
        Self { bytes, unfinished, undone, read, beyond }
    }

    /// How the file was cut, if it refers to more than it has.
    pub(super) fn cut(&self) -> Option<String> {
        let (end, beyond) = (self.bytes.len(), self.beyond.get()?);
        Some(format!(
            "was cut or is damaged: the file ends within its data, at byte {end}, and refers to data up to byte {beyond}"
        ))
    }

    /// The block at a position, of any kind.
    pub(super) fn any(&self, at: usize) -> Option<Block<'a>> {
        let head_and_rest = self.bytes.get(at..).and_then(|rest| rest.split_at_checked(HEAD_BYTES));
        let Some((head, rest)) = head_and_rest else {
            self.beyond.set(Some(at.saturating_add(HEAD_BYTES)));
            return None;
        };
        let name = *head.first_chunk::<4>()?;
        let number = |at: usize| Some(u64::from_le_bytes(*head.get(at..)?.first_chunk()?));
        let links = usize::try_from(number(16)?).ok()?.checked_mul(8)?;
        let mut size = usize::try_from(number(8)?).ok()?.checked_sub(HEAD_BYTES);
        // A data block that was being written has the length of its head, or none yet; it reaches to the end of the
        // file.
        let writing = self.unfinished && matches!(&name, b"##DT" | b"##SD") && size.unwrap_or(0) == 0;
        if writing && !rest.starts_with(b"##") {
            size = Some(rest.len());
        }
        let size = size?;
        if size > rest.len() {
            self.beyond.set(Some((at + HEAD_BYTES).saturating_add(size)));
        }
        let all = &rest[..size.min(rest.len())];
        let (links, data) = all.split_at_checked(links)?;
        Some(Block { name, links, data, cut: size > rest.len() })
    }

    /// The block at a position, if it has this name.
    pub(super) fn block(&self, at: usize, name: &[u8; 4]) -> Option<Block<'a>> {
        self.any(at).filter(|block| block.name == *name)
    }

    /// As [`Self::block`], but each block only once: for lists and data.
    pub(super) fn once(&mut self, at: usize, name: &[u8; 4]) -> Option<Block<'a>> {
        let block = self.block(at, name)?;
        self.read.insert(at).then_some(block)
    }

    /// As [`Self::any`], but each block only once.
    pub(super) fn any_once(&mut self, at: usize) -> Option<Block<'a>> {
        let block = self.any(at)?;
        self.read.insert(at).then_some(block)
    }

    /// The text at a link; empty without a link. Of XML, the content of the first `<TX>`.
    pub(super) fn text(&self, at: Option<usize>) -> String {
        let Some(block) = at.and_then(|at| self.any(at)) else { return String::new() };
        let all = block.data.split(|byte| *byte == 0).next().unwrap_or_default();
        let text = String::from_utf8_lossy(all);
        let text = match &block.name {
            b"##TX" => &*text,
            b"##MD" => {
                let inside = text.split_once("<TX>").and_then(|(_, rest)| rest.split_once("</TX>"));
                inside.map_or("", |(inside, _)| inside)
            }
            _ => "",
        };
        text.trim().to_owned()
    }
}

impl Block<'_> {
    /// Target of a link; `None` for a null or missing link.
    pub(super) fn link(&self, n: usize) -> Option<usize> {
        let bytes = self.links.get(n.checked_mul(8)?..)?.first_chunk()?;
        usize::try_from(u64::from_le_bytes(*bytes)).ok().filter(|at| *at != 0)
    }

    /// Number of links.
    pub(super) fn links(&self) -> usize {
        self.links.len() / 8
    }

    /// A number in the block's data; 0 beyond its end.
    pub(super) fn u8(&self, at: usize) -> u8 {
        self.data.get(at).copied().unwrap_or(0)
    }

    /// As [`Self::u8`].
    pub(super) fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes(self.chunk(at))
    }

    /// As [`Self::u8`].
    pub(super) fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.chunk(at))
    }

    /// As [`Self::u8`].
    pub(super) fn u64(&self, at: usize) -> u64 {
        u64::from_le_bytes(self.chunk(at))
    }

    /// As [`Self::u8`].
    pub(super) fn f64(&self, at: usize) -> f64 {
        f64::from_le_bytes(self.chunk(at))
    }

    fn chunk<const N: usize>(&self, at: usize) -> [u8; N] {
        self.data.get(at..).and_then(|rest| rest.first_chunk()).copied().unwrap_or([0; N])
    }
}
