//! Memories of an STM32F405xG (data sheet DS8626, figure 18; RM0090 rev 22, table 5): half of the flash and less RAM
//! than the library's chip, and a flash array that reacts to stores.
//!
//! The emulator uses the memories from here and the rest from [`super::Chip`].

use rigless::device::{ErasedDevice, ResetCause};
use rigless::mcu::Mcu;
use rigless::soc::stm32f427::generated::{CPU, PERIPHERALS};
use rigless::soc::{Bus, EraseBlocks, Error, Region};
use rigless::time::VirtualNanos;
use std::num::{NonZeroU32, NonZeroU64};
use std::ops::Range;

/// Addresses of the flash array.
pub const FLASH: Range<u64> = 0x0800_0000..0x0810_0000;
/// Addresses of the RAM that can contain the stack.
pub const RAM: Range<u64> = 0x2000_0000..0x2002_0000;

/// Sectors of the flash, by address.
static SECTORS: [EraseBlocks; 3] = [blocks(16, 4), blocks(64, 1), blocks(128, 7)];

static MEMORY: [Region; 5] = [
    Region::flash("flash", FLASH.start, FLASH.end - FLASH.start)
        .erased_in(&SECTORS)
        .erased_to(0xff)
        .programmed_by("FLASH"),
    Region::ram("ccm", 0x1000_0000, 64 << 10),
    Region::system("system", 0x1fff_0000, 32 << 10),
    Region::ram("sram", RAM.start, RAM.end - RAM.start),
    Region::ram("backup_sram", 0x4002_4000, 4 << 10),
];

const fn blocks(kib: u64, count: u32) -> EraseBlocks {
    match (NonZeroU64::new(kib << 10), NonZeroU32::new(count)) {
        (Some(size), Some(count)) => EraseBlocks { size, count },
        _ => panic!("sectors of no size"),
    }
}

/// Addresses of a sector; `None` if the chip has no sector of that number.
pub fn sector(number: u32) -> Option<Range<u64>> {
    let sizes = SECTORS.iter().flat_map(|run| (0..run.count.get()).map(|_| run.size.get()));
    let mut end = FLASH.start;
    sizes
        .map(|size| {
            end += size;
            end - size..end
        })
        .nth(number as usize)
}

/// The memories, as a chip of which only the memories are used.
#[derive(Debug)]
pub struct Memory {
    bus: Bus,
}

impl Memory {
    /// The memories.
    ///
    /// # Errors
    /// An inconsistent description.
    pub fn new() -> Result<Self, Error> {
        Ok(Self { bus: Bus::builder(CPU, &MEMORY, PERIPHERALS).build()? })
    }
}

impl Mcu for Memory {
    fn bus(&self) -> &Bus {
        &self.bus
    }

    fn bus_mut(&mut self) -> &mut Bus {
        &mut self.bus
    }

    fn reset(&mut self, _: VirtualNanos, _: ResetCause) {}

    fn poll(&mut self, _: VirtualNanos) {}

    fn split(&mut self, _: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        (&mut self.bus, None)
    }
}
