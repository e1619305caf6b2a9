//! The engineer's line, as bytes that go over in lockstep: [`super::pil`] carries them once a millisecond.

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;

/// Bytes that wait, each way.
pub(super) const ROOM: usize = 1024;

static IN: Pipe<CriticalSectionRawMutex, ROOM> = Pipe::new();
pub(super) static OUT: Pipe<CriticalSectionRawMutex, ROOM> = Pipe::new();

/// Puts in what came from the engineer. Bytes that find no room are lost, as on any line.
pub(super) fn came(mut bytes: &[u8]) {
    // The ring takes no more than up to its end at a time.
    while !bytes.is_empty()
        && let Ok(taken @ 1..) = IN.try_write(bytes)
    {
        bytes = bytes.get(taken..).unwrap_or_default();
    }
}

/// Waits for bytes, and takes as many as are there and fit; how many.
pub async fn read(bytes: &mut [u8]) -> usize {
    IN.read(bytes).await
}

/// Waits until all bytes are taken.
pub async fn write(bytes: &[u8]) {
    OUT.write_all(bytes).await;
}
