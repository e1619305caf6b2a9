//! TIM1 as used by the board (RM0090 rev 22, chapter 17): centre-aligned, repetition counter, preloaded compare
//! registers, main output enable, break by the crystal's failure, OC4REF as trigger output.
//!
//! Any other enabled feature is reported and ends the run.

use crate::wiring::{AsTim1, Wiring};
use rigless::device::{Device, DeviceContext, Level, RegisterFile, RequestChange};
use rigless::soc::Layout;
use rigless::soc::stm32f427::generated::tim1::Register;
use rigless::soc::stm32f427::peripherals::rcc::CLOCK_FAILURE;

/// Clock of the timer \[Hz\]: twice APB2, 84 MHz (section 6.2, 7.2).
pub const CLOCK_HZ: u64 = 168_000_000;

const CEN: u32 = 1;
const ARPE: u32 = 1 << 7;
const CMS: u32 = 0b11 << 5;
const DIR: u32 = 1 << 4;
const UIF: u32 = 1;
const BIF: u32 = 1 << 7;
const UG: u32 = 1;
const BG: u32 = 1 << 7;
const BKE: u32 = 1 << 12;
const AOE: u32 = 1 << 14;
const MOE: u32 = 1 << 15;
/// CR2.MMS: OC4REF is the trigger output.
const MMS_OC4REF: u32 = 0b111 << 4;

/// The timer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tim1 {
    cr1: u32,
    cr2: u32,
    ccmr: [u32; 2],
    ccer: u32,
    sr: u32,
    bdtr: u32,
    arr: u32,
    rcr: u32,
    compare: [u32; 4],
    /// Active compare values.
    shadow: [u32; 4],
    /// Number of ramp ends until the next update.
    repetitions: u32,
    /// Time at which the counter started from 0 \[ns\].
    began_ns: u64,
    /// Number of ramp ends handled since then.
    ramps: u64,
}

impl Tim1 {
    fn is_running(&self) -> bool {
        self.cr1 & CEN != 0 && self.arr > 0
    }

    fn counts_since_begin(&self, now_ns: u64) -> u64 {
        (u128::from(now_ns.saturating_sub(self.began_ns)) * u128::from(CLOCK_HZ) / 1_000_000_000) as u64
    }

    /// First time at which this number of counts has elapsed \[ns\].
    fn instant_ns(&self, counts: u64) -> u64 {
        self.began_ns + (u128::from(counts) * 1_000_000_000).div_ceil(u128::from(CLOCK_HZ)) as u64
    }

    /// End of the present ramp \[ns\]; `None` while the counter is stopped.
    pub fn next_ramp_end_ns(&self) -> Option<u64> {
        self.is_running().then(|| self.instant_ns((self.ramps + 1) * u64::from(self.arr)))
    }

    /// Handles the end of a ramp: an update when the repetition counter has reached zero (17.3.3).
    pub fn end_ramp(&mut self) {
        self.ramps += 1;
        if self.repetitions > 0 {
            self.repetitions -= 1;
        } else {
            self.update();
        }
    }

    fn update(&mut self) {
        self.repetitions = self.rcr;
        self.shadow = self.compare;
        self.sr |= UIF;
    }

    /// The counter, and whether it counts down.
    pub fn counter(&self, now_ns: u64) -> (u32, bool) {
        if !self.is_running() {
            return (0, false);
        }
        let (arr, counts) = (u64::from(self.arr), self.counts_since_begin(now_ns));
        let phase = counts % (2 * arr);
        if phase < arr { (phase as u32, false) } else { ((2 * arr - phase) as u32, true) }
    }

    /// Next rising edge of OC4REF after a time \[ns\]: channel 4 in PWM mode 2 rises where the upward count reaches
    /// its compare value (17.3.9). `None` unless it is the trigger output of a running timer.
    pub fn next_trigger_ns(&self, after_ns: u64) -> Option<u64> {
        const PWM_MODE_2: u32 = 0b111;
        let triggers = self.cr2 & MMS_OC4REF == MMS_OC4REF && self.ccmr[1] >> 12 & 0b111 == PWM_MODE_2;
        if !triggers || !self.is_running() {
            return None;
        }
        let period = 2 * u64::from(self.arr);
        let counts = self.counts_since_begin(after_ns);
        let at = |turn: u64| self.instant_ns(turn * period + u64::from(self.shadow[3]));
        let turn = counts / period;
        Some(if at(turn) > after_ns { at(turn) } else { at(turn + 1) })
    }

    /// Active duty cycles of the upper switches; `None` while the outputs are off.
    pub fn duties(&self) -> Option<[f64; 3]> {
        const ALL_SIX: u32 = 0x555;
        let on = self.bdtr & MOE != 0 && self.ccer & ALL_SIX == ALL_SIX && self.is_running();
        on.then(|| [0, 1, 2].map(|phase| (f64::from(self.shadow[phase]) / f64::from(self.arr)).min(1.0)))
    }

    /// Dead time \[s\] (BDTR.DTG, 17.4.18).
    pub fn dead_time_s(&self) -> f64 {
        let dtg = self.bdtr & 0xff;
        let counts = match dtg >> 5 {
            0..4 => dtg,
            4 | 5 => 2 * (64 + (dtg & 0x3f)),
            6 => 8 * (32 + (dtg & 0x1f)),
            _ => 16 * (32 + (dtg & 0x1f)),
        };
        f64::from(counts) / CLOCK_HZ as f64
    }

    /// Whether the outputs are enabled.
    pub const fn main_output(&self) -> bool {
        self.bdtr & MOE != 0
    }

    /// Switches the outputs off, like a break (17.3.12).
    pub fn trip(&mut self) {
        self.bdtr &= !MOE;
        self.sr |= BIF;
    }

    /// Switches the outputs off, like a halted core with DBG_TIM1_STOP set (17.3.21).
    pub fn freeze_outputs(&mut self) {
        self.bdtr &= !MOE;
    }

    /// Switches the outputs on again when that core resumes.
    pub fn release_outputs(&mut self) {
        self.bdtr |= MOE;
    }

    fn written(&mut self, register: Register, value: u32, now_ns: u64) -> Result<(), &'static str> {
        match register {
            Register::Cr1 => {
                let starts = value & CEN != 0 && self.cr1 & CEN == 0;
                self.cr1 = value;
                if starts {
                    (self.began_ns, self.ramps) = (now_ns, 0);
                }
                let centred = value & CMS != 0;
                if value & CEN != 0 && !(centred && value & ARPE != 0) {
                    return Err("only centre-aligned counting with a preloaded top is modelled");
                }
            }
            Register::Cr2 => self.cr2 = value,
            Register::Sr => self.sr &= value,
            Register::Egr => {
                if value & UG != 0 {
                    (self.began_ns, self.ramps) = (now_ns, 0);
                    self.update();
                }
                if value & BG != 0 {
                    self.trip();
                }
                if value & !(UG | BG) != 0 {
                    return Err("only the update and the break are modelled as generated events");
                }
            }
            Register::Ccmr1Output | Register::Ccmr1Input => self.ccmr[0] = value,
            Register::Ccmr2Output | Register::Ccmr2Input => self.ccmr[1] = value,
            Register::Ccer => self.ccer = value,
            Register::Arr if self.is_running() => return Err("a new top while counting is not modelled"),
            Register::Arr => self.arr = value & 0xffff,
            Register::Rcr => self.rcr = value & 0xff,
            Register::Ccr1 | Register::Ccr2 | Register::Ccr3 | Register::Ccr4 => {
                let channel = register.index() - Register::Ccr1.index();
                self.compare[channel] = value & 0xffff;
                let preloaded = self.ccmr[channel / 2] >> (3 + 8 * (channel % 2)) & 1 == 1;
                if !preloaded {
                    self.shadow[channel] = self.compare[channel];
                }
            }
            Register::Bdtr => {
                self.bdtr = value;
                if value & AOE != 0 {
                    return Err("automatic output enable is not modelled");
                }
            }
            Register::Psc
            | Register::Dier
            | Register::Smcr
            | Register::Cnt
            | Register::Dcr
            | Register::Dmar => {
                if value != 0 {
                    return Err("not modelled");
                }
            }
        }
        Ok(())
    }
}

impl Device for AsTim1 {
    type Register = Register;

    fn read(
        &mut self,
        register: Register,
        _: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) -> Option<u64> {
        let now_ns = context.now().0;
        let wiring = Wiring::of_tim1(self);
        wiring.advance(now_ns);
        wiring.calls.accessed(now_ns);
        let tim1 = &wiring.tim1;
        let (count, down) = tim1.counter(now_ns);
        match register {
            Register::Cr1 => Some(u64::from(tim1.cr1 & !DIR | if down { DIR } else { 0 })),
            Register::Sr => Some(u64::from(tim1.sr)),
            Register::Cnt => Some(u64::from(count)),
            Register::Bdtr => Some(u64::from(tim1.bdtr)),
            _ => None,
        }
    }

    fn write(
        &mut self,
        register: Register,
        value: u64,
        _: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let now_ns = context.now().0;
        let wiring = Wiring::of_tim1(self);
        wiring.advance(now_ns);
        wiring.calls.accessed(now_ns);
        let before = wiring.tim1.main_output();
        if let Err(reason) = wiring.tim1.written(register, value as u32, now_ns) {
            context.tell(register.spec().name, reason);
        }
        wiring.note_main_output(before, now_ns);
    }

    /// Passes a failure from the clock security system to the break (17.3.12).
    fn on_request(&mut self, change: RequestChange, _: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let failed =
            change.instance == "RCC" && change.request == CLOCK_FAILURE && change.level == Level::High;
        let wiring = Wiring::of_tim1(self);
        if failed && wiring.tim1.bdtr & BKE != 0 {
            let now_ns = context.now().0;
            wiring.advance(now_ns);
            let before = wiring.tim1.main_output();
            wiring.tim1.trip();
            wiring.note_main_output(before, now_ns);
        }
    }
}
