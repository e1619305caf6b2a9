//! The board as a `rigless` system: chip, crystal and supply.

use crate::chip::Chip;
use crate::chip::memory::Memory;
use crate::flash::{Array, Pace};
use crate::inject::Damage;
use crate::serial::Computer;
use crate::wiring::Wiring;
use rigless::machine::armv7m::{Core, Fpu, MpuRegions, Variant};
use rigless::machine::{Board, Target};
use rigless::mcu::{Mcu, Operate};
use rigless::snapshot::Store;
use rigless::soc::Error;
use std::num::{NonZeroU32, NonZeroU64};
use std::time::Duration;

/// Clock of the core \[Hz\].
pub(crate) const CORE_HZ: u64 = 168_000_000;

/// Index of USART3 in the library's list of serial ports.
const USART3: usize = 2;

/// Options of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Assumed clock cycles per instruction. The chip's value depends on the flash's wait states and was never
    /// measured; 1.0 is faster than possible, 1.6 pessimistic.
    pub cycles_per_instruction: f64,
    /// Frequency of the watchdog's oscillator \[Hz\]; 17 to 47 kHz (data sheet of the STM32F405).
    pub lsi_hz: u64,
    /// Supply of the chip \[mV\].
    pub chip_mv: u32,
    /// Flash timing.
    pub flash: Pace,
    /// Timeout of the emulator for a millisecond of simulated time, on this machine's clock.
    pub timeout: Duration,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            cycles_per_instruction: 1.3,
            lsi_hz: 32_000,
            chip_mv: 3300,
            flash: Pace::Typical,
            timeout: Duration::from_secs(120),
        }
    }
}

/// A VESC 6 MK6.
#[derive(Debug)]
pub struct Vesc6 {
    /// The chip with everything connected to it.
    pub chip: Chip,
    /// Flash array of the chip.
    pub flash: Array,
    /// The instruction that last accessed a register.
    pub(crate) last_access: u32,
    /// The instruction after whose access a model first reported a problem.
    pub(crate) troubled_by: Option<u32>,
    /// Executions of replaced instructions: time \[ns\] and address.
    pub hits: Vec<(u64, u32)>,
    /// Times at which the program restarted the watchdog's count \[ns\].
    pub watchdog_feeds: Vec<u64>,
    pub(crate) damage: Vec<Damage>,
    memory: Memory,
    options: Options,
}

impl Vesc6 {
    /// The board before power-on.
    ///
    /// # Errors
    /// An inconsistent description of the chip.
    pub fn new(options: Options, wiring: Wiring) -> Result<Self, Error> {
        let mut chip = Chip::new(wiring)?;
        chip.library.rcc.attach_crystals(8_000_000, 0);
        chip.library.rcc.calibrate_lsi(options.lsi_hz);
        chip.library.set_supply(options.chip_mv);
        chip.library.usart[USART3].attach(Computer::default());
        Ok(Self {
            chip,
            flash: Array::new(options.flash),
            last_access: 0,
            troubled_by: None,
            hits: Vec::new(),
            watchdog_feeds: Vec::new(),
            damage: Vec::new(),
            memory: Memory::new()?,
            options,
        })
    }
}

impl Vesc6 {
    /// The computer on the serial line.
    ///
    /// # Panics
    /// Never: it is connected when the board is created.
    pub fn computer(&mut self) -> &mut Computer {
        self.chip.library.usart[USART3].chip_mut().expect("connected in `new`")
    }
}

/// Snapshots are unused.
impl Store for Vesc6 {}

impl Board for Vesc6 {
    fn name(&self) -> &'static str {
        "vesc6-mk6"
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let rate = CORE_HZ as f64 / self.options.cycles_per_instruction;
        let core = Core {
            variant: Variant::M4,
            clock_hz: NonZeroU64::new(CORE_HZ).expect("not zero"),
            interrupt_lines: NonZeroU32::from(
                std::num::NonZeroU16::new(self.chip.cpu().interrupt_lines).expect("the chip has interrupts"),
            ),
            priority_bits: 4,
            refclk_divider: NonZeroU32::new(8).expect("not zero"),
            instructions_per_second: NonZeroU64::new(rate as u64).unwrap_or(NonZeroU64::MIN),
            boot: "flash",
        };
        let windows = rigless::cpu::armv7m::windows(self.chip.bus());
        let spec = core.spec_with_parts(&windows, Fpu::FpV4Sp, MpuRegions::Eight);
        vec![Target::new(self.name(), &mut self.memory, spec)]
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec![self.name()]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then_some(&mut self.chip)
    }
}
