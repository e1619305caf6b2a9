//! Ring of the last fault records, in memory that survives a reset.
//!
//! The memory is random at power-on. Every slot has its own CRC, so that an intact record stays readable if writing
//! another one is interrupted.
//!
//! | bytes | |
//! | --- | --- |
//! | 0..4 | CRC-32 of the next 10 |
//! | 4..8 | magic number with the layout |
//! | 8..12 | number of program starts |
//! | 12..14 | faults recorded since the memory was last empty, wrapping; gives the slot of the next record |
//! | then for each slot | CRC-32 of the rest of the slot's content, u16 length, the record as in [`crate::Message::Fault`] |
//! | at the end | CRC-32 of the next 17; u32 steps, u32 us of the frame, u64 causes, u8 mode of the last control step |

use crate::bytes::{Reader, Writer};
use crate::frame::CRC;
use crate::report::{FAULT_BYTES, FaultRecord};
use control::{Causes, Mode};

/// Number of stored faults; a new one replaces the oldest.
pub const SLOTS: usize = 8;
/// Size of the ring \[bytes\].
pub const RING_BYTES: usize = LAST + 4 + STEP;
/// Offset of the last control step's entry, and its length without CRC \[bytes\].
const LAST: usize = HEAD + SLOTS * SLOT;
const STEP: usize = 17;
const HEAD: usize = 14;
const SLOT: usize = 4 + 2 + FAULT_BYTES;
/// Magic number of a ring with this layout.
const MARK: u32 = 0x5341_4602;

/// State of the controller at a control step; the default means no step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LastStep {
    /// Number of control steps.
    pub steps: u32,
    /// [`control::SensorFrame::now_us`] of its frame \[us\], wrapping.
    pub frame_us: u32,
    /// The controller's causes.
    pub causes: Causes,
    /// The controller's mode.
    pub mode: Mode,
}

/// Stores the state of the last control step, so that the start after a watchdog reset can report it.
pub fn stepped(memory: &mut [u8; RING_BYTES], last: &LastStep) {
    let Some((check, step)) = memory.get_mut(LAST..).and_then(|bytes| bytes.split_at_mut_checked(4)) else {
        return;
    };
    let mut writer = Writer::new(step);
    writer.u32(last.steps);
    writer.u32(last.frame_us);
    writer.u64(last.causes.0);
    writer.u8(last.mode as u8);
    Writer::new(check).u32(CRC.checksum(step));
}

/// State of the last control step, also of before a reset; `None` if its CRC is wrong.
pub fn last_step(memory: &[u8; RING_BYTES]) -> Option<LastStep> {
    let mut from = Reader(memory.get(LAST..)?);
    let check = from.u32()?;
    let whole = check == CRC.checksum(from.0);
    let (steps, frame_us, causes) = (from.u32()?, from.u32()?, Causes(from.u64()?));
    whole.then_some(LastStep { steps, frame_us, causes, mode: Mode::numbered(from.u8()?)? })
}

/// Header of the ring.
#[derive(Clone, Copy, Default)]
struct Head {
    starts: u32,
    noted: u16,
}

impl Head {
    fn read(memory: &[u8; RING_BYTES]) -> Option<Self> {
        let mut from = Reader(memory);
        let (check, mark) = (from.u32()?, from.u32()?);
        let head = Self { starts: from.u32()?, noted: from.u16()? };
        (mark == MARK && check == CRC.checksum(memory.get(4..HEAD)?)).then_some(head)
    }

    fn write(self, memory: &mut [u8; RING_BYTES]) {
        let mut writer = Writer::new(memory.get_mut(4..HEAD).unwrap_or_default());
        writer.u32(MARK);
        writer.u32(self.starts);
        writer.u16(self.noted);
        let check = CRC.checksum(writer.finish().unwrap_or_default());
        Writer::new(memory).u32(check);
    }
}

/// Initialises the ring; call once at every start. Memory with an invalid header becomes an empty ring. Returns the
/// number of starts since then, this one included.
pub fn start(memory: &mut [u8; RING_BYTES]) -> u32 {
    let head = Head::read(memory).unwrap_or_else(|| {
        memory.fill(0);
        Head::default()
    });
    let starts = head.starts.saturating_add(1);
    Head { starts, ..head }.write(memory);
    starts
}

/// Stores a fault record; does nothing before [`start`].
pub fn note(memory: &mut [u8; RING_BYTES], fault: &FaultRecord<'_>) {
    let Some(head) = Head::read(memory) else { return };
    let at = HEAD + usize::from(head.noted) % SLOTS * SLOT;
    let Some(slot) = memory.get_mut(at..at + SLOT) else { return };
    let Some((check, body)) = slot.split_at_mut_checked(4) else { return };
    let (length, record) = body.split_at_mut(2);
    let mut writer = Writer::new(record);
    fault.encode(&mut writer);
    let used = writer.used().unwrap_or_default();
    Writer::new(length).u16(used as u16);
    let sum = CRC.checksum(body.get(..2 + used).unwrap_or_default());
    Writer::new(check).u32(sum);
    Head { noted: head.noted.wrapping_add(1), ..head }.write(memory);
}

/// Faults recorded since the memory was last empty, wrapping; 0 without a valid ring.
pub fn noted(memory: &[u8; RING_BYTES]) -> u16 {
    Head::read(memory).map_or(0, |head| head.noted)
}

/// The stored faults with a valid CRC, newest first.
pub fn faults(memory: &[u8; RING_BYTES]) -> impl Iterator<Item = FaultRecord<'_>> {
    let noted = noted(memory);
    (0..SLOTS).filter_map(move |back| {
        let place = usize::from(noted.wrapping_sub(back as u16 + 1)) % SLOTS;
        let slot = memory.get(HEAD..)?.get(place * SLOT..)?;
        let (check, body) = slot.get(..SLOT)?.split_first_chunk()?;
        let length = usize::from(Reader(body).u16()?);
        let whole = body.get(..2 + length)?;
        let empty = u32::from_le_bytes(*check) != CRC.checksum(whole) || length == 0;
        if empty { None } else { FaultRecord::decode(&mut Reader(whole.get(2..)?)) }
    })
}

/// Deletes all faults; keeps the number of starts.
pub fn clear(memory: &mut [u8; RING_BYTES]) {
    let Some(head) = Head::read(memory) else { return };
    memory.fill(0);
    Head { noted: 0, ..head }.write(memory);
}
