//! The serial link as bytes in the lockstep exchange: [`super::pil`] transfers them once per millisecond.

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;

/// Buffers, one per direction.
pub(super) const ROOM: usize = 1024;

static IN: Pipe<CriticalSectionRawMutex, ROOM> = Pipe::new();
pub(super) static OUT: Pipe<CriticalSectionRawMutex, ROOM> = Pipe::new();

/// Stores bytes from the host. Bytes that do not fit are lost, as on a serial line.
pub(super) fn came(mut bytes: &[u8]) {
    // The ring accepts bytes only up to its end at once.
    while !bytes.is_empty()
        && let Ok(taken @ 1..) = IN.try_write(bytes)
    {
        bytes = bytes.get(taken..).unwrap_or_default();
    }
}

/// Waits for bytes and reads as many as are available and fit; returns their number.
pub async fn read(bytes: &mut [u8]) -> usize {
    IN.read(bytes).await
}

/// Waits until all bytes are queued.
pub async fn write(bytes: &[u8]) {
    OUT.write_all(bytes).await;
}
