//! The chip's revision, by DBGMCU_IDCODE.

/// Device number of the STM32F405, and that of the STM32F2, which its revision A has.
const F405: u16 = 0x413;
const F2: u16 = 0x411;
/// Revision A.
const REVISION_A: u16 = 0x1000;

/// Whether the flash's prefetch may be used: not on revision A (ES0182, "ART Accelerator prefetch queue instruction is
/// not supported"), which gives another device's number, 0x411 with revision 0x2000 (ES0182, "MCU device ID is
/// incorrect").
pub const fn has_prefetch(device: u16, revision: u16) -> bool {
    match device {
        F405 => revision != REVISION_A,
        F2 => false,
        _ => true,
    }
}
