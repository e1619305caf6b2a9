//! Chip revision from DBGMCU_IDCODE.

/// Device identifier of the STM32F405, and that of the STM32F2, which revision A of the F405 reports.
const F405: u16 = 0x413;
const F2: u16 = 0x411;
/// Revision A.
const REVISION_A: u16 = 0x1000;

/// Whether the flash prefetch is permitted: not on revision A (ES0182, "ART Accelerator prefetch queue instruction is
/// not supported"), which reports another device identifier, 0x411 with revision 0x2000 (ES0182, "MCU device ID is
/// incorrect").
pub const fn has_prefetch(device: u16, revision: u16) -> bool {
    match device {
        F405 => revision != REVISION_A,
        F2 => false,
        _ => true,
    }
}
