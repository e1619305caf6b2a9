//! TIM1: three half bridges, centre-aligned, and the moment of the converters.
//!
//! The counter goes up and down; an upper switch is closed around its zero, the lower one around its top. The converters
//! start just before the top, and duty cycles are taken over at the top: what is sampled now is answered by the duty
//! cycles of the whole time from the next top to the one after, in their middle 1.5 periods later, as the motor's loop
//! counts on.
//!
//! The break opens all six switches without the program when the crystal fails. The gate driver's fault is not wired to
//! it on this board (TIM1's break inputs, PA6 and PB12, have other uses); the driver opens the switches itself.

use super::pins::{Pin, alternate};
use devices::vesc6::MOTOR;
use embassy_stm32::gpio::{AfType, OutputType, Speed};
use embassy_stm32::pac::TIM1;
use embassy_stm32::pac::timer::vals::{Bkp, Cms, Dir, Mms, Ocm, Ossi, Ossr};
use embassy_stm32::{peripherals, rcc};

/// The timer's clock \[Hz\].
const CLOCK_HZ: u32 = 168_000_000;
/// The counter's top: half a period.
const TOP: u16 = (CLOCK_HZ as f32 / MOTOR.rate_hz / 2.0) as u16;
/// How long before the top the converters start \[counts\]: half of the time for which they sample a current.
const LEAD: u16 = 60;
/// Time for which both switches of a phase are open at each change \[counts\].
const DEAD: u8 = (MOTOR.bridge.dead_time_s * CLOCK_HZ as f32 + 0.5) as u8;
// Up to 127 the register's number is the number of counts.
const _: () = assert!(DEAD > 0 && DEAD < 128);

/// Pins' function that is TIM1.
const FUNCTION: u8 = 1;

/// Sets the timer up with all six switches open, and starts it; whether duty cycles are taken over at the top.
pub(super) fn start(bridge: [Pin; 6]) -> bool {
    rcc::enable_and_reset::<peripherals::TIM1>();
    TIM1.cr1().modify(|w| {
        w.set_cms(Cms::CENTER_ALIGNED3);
        w.set_arpe(true);
    });
    TIM1.arr().write(|w| w.set_arr(TOP));
    for phase in 0..3 {
        TIM1.ccmr_output(phase / 2).modify(|w| {
            w.set_ocm(phase % 2, Ocm::PWM_MODE1);
            w.set_ocpe(phase % 2, true);
        });
    }
    // The converters' moment: high around the top.
    TIM1.ccmr_output(1).modify(|w| w.set_ocm(1, Ocm::PWM_MODE2));
    TIM1.ccr(3).write(|w| w.set_ccr(TOP - LEAD));
    TIM1.cr2().modify(|w| w.set_mms(Mms::COMPARE_OC4));
    TIM1.bdtr().modify(|w| {
        w.set_dtg(DEAD);
        w.set_ossi(Ossi::IDLE_LEVEL);
        w.set_ossr(Ossr::IDLE_LEVEL);
        w.set_bke(0, true);
        w.set_bkp(0, Bkp::ACTIVE_HIGH);
        // A break latches.
        w.set_aoe(false);
    });
    TIM1.ccer().modify(|w| {
        for phase in 0..3 {
            w.set_cce(phase, true);
            w.set_ccne(phase, true);
        }
    });
    for pin in bridge {
        alternate(pin, FUNCTION, AfType::output(OutputType::PushPull, Speed::High));
    }
    // From now on every second end of a ramp takes over. The counter of ends is still 0 here, so the first one does, at
    // the top, and with it every other at the top.
    TIM1.egr().write(|w| w.set_ug(true));
    TIM1.rcr().write(|w| w.set_rep(1));
    TIM1.cr1().modify(|w| w.set_cen(true));
    takes_over_at_top()
}

/// Whether the counter goes down just after an update, three times in a row.
fn takes_over_at_top() -> bool {
    (0..3).all(|_| {
        TIM1.sr().modify(|w| w.set_uif(false));
        let came = (0..100_000).any(|_| TIM1.sr().read().uif());
        came && TIM1.cr1().read().dir() == Dir::DOWN
    })
}

/// Duty cycles of the upper switches, from the next top on.
pub(super) fn duties(duties: [f32; 3]) {
    for (phase, duty) in duties.into_iter().enumerate() {
        TIM1.ccr(phase).write(|w| w.set_ccr((duty * f32::from(TOP) + 0.5) as u16));
    }
}

/// From now on [`is_over`] is about the next top.
pub(super) fn begin() {
    TIM1.sr().modify(|w| w.set_uif(false));
}

/// Whether a top has passed since [`begin`]: duty cycles that are set only now act a period too late.
pub(super) fn is_over() -> bool {
    TIM1.sr().read().uif()
}

/// Lets the duty cycles act, unless the break is in the way.
pub(super) fn close() {
    TIM1.bdtr().modify(|w| w.set_moe(true));
}

/// Whether duty cycles act. To be asked some cycles after [`close`], which the timer takes to show it.
pub(super) fn is_closed() -> bool {
    TIM1.bdtr().read().moe()
}

/// Opens all six switches.
pub(super) fn open() {
    TIM1.bdtr().modify(|w| w.set_moe(false));
}
