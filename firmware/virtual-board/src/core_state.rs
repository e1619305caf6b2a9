//! Program counter of the emulated core, which its library does not expose.

/// Address of the next instruction. A saved state begins with the core's state, which begins with the sixteen registers
/// (`rigless` 0.4.0, `cpu/armv7m/state.rs`).
pub(crate) fn program_counter(saved: &[u8]) -> Option<u32> {
    let (core, _) = postcard::take_from_bytes::<&[u8]>(saved).ok()?;
    let (registers, _) = postcard::take_from_bytes::<[u32; 16]>(core).ok()?;
    Some(registers[15])
}
