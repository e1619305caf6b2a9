//! Peripherals that stop while a debugger halts the core, selected by DBGMCU (RM0090 rev 22, 38.16.4 and 38.16.5).

use super::Chip;
use rigless::mcu::Mcu;
use rigless::soc::FieldSpec;
use rigless::soc::stm32f427::generated::dbg::{Register, dbgmcu_apb1_fz, dbgmcu_apb2_fz};
use rigless::soc::stm32f427::peripherals::rcc::Apb;
use rigless::time::VirtualNanos;

/// The library's timers used by the program, each with its bit in DBGMCU_APB1_FZ.
const TIMERS: [(&str, &FieldSpec); 3] = [
    ("TIM3", dbgmcu_apb1_fz::DBG_TIM3_STOP),
    ("TIM4", dbgmcu_apb1_fz::DBG_TIM4_STOP),
    ("TIM5", dbgmcu_apb1_fz::DBG_TIM5_STOP),
];

impl Chip {
    /// Halts the core.
    pub(crate) fn halt(&mut self, at: VirtualNanos) {
        let stops_tim1 = dbgmcu_apb2_fz::DBG_TIM1_STOP.is_set(self.freeze_register(Register::DbgmcuApb2Fz));
        self.wiring.halt(stops_tim1, at.0);
        self.clock_counters(at, 0, 0);
    }

    /// Resumes the core.
    pub(crate) fn go_on(&mut self, at: VirtualNanos) {
        self.wiring.go_on(at.0);
        let (clocks, registers) = self.library.clocks();
        let (timers_hz, watchdog_hz) = (clocks.timer_clock(registers, Apb::One), clocks.lsi_hz());
        self.clock_counters(at, timers_hz, watchdog_hz);
    }

    /// Sets the clock of the counters that DBGMCU stops \[Hz\].
    fn clock_counters(&mut self, at: VirtualNanos, timers_hz: u64, watchdog_hz: u64) {
        let frozen = self.freeze_register(Register::DbgmcuApb1Fz);
        // The vendor's description misspells the watchdog's bit.
        let watchdog = ("IWDG", dbgmcu_apb1_fz::DBG_IWDEG_STOP, watchdog_hz);
        let timers = TIMERS.map(|(instance, stop)| (instance, stop, timers_hz));
        for (instance, stop, hz) in timers.into_iter().chain([watchdog]) {
            let Some(slot) = self.bus().slot_of(instance).filter(|_| stop.is_set(frozen)) else { continue };
            if let (bus, Some(counter)) = self.library.split(slot) {
                let (registers, mut context) = bus.drive(at, slot);
                counter.on_clock(hz, registers, &mut context);
            }
        }
    }

    fn freeze_register(&self, register: Register) -> u64 {
        self.bus().registers("DBG").map_or(0, |debug| debug.get(register))
    }
}
