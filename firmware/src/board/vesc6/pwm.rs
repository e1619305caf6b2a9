//! TIM1: PWM of three half bridges, centre-aligned, and the ADC trigger.
//!
//! The counter counts up and down; an upper switch is closed around zero, the lower one around the top. The ADCs
//! start just before the top, and duty cycles are loaded at the top: the duty cycles that result from a sample act
//! from the next top to the one after, on average 1.5 periods later, as the motor loop assumes.
//!
//! If the crystal fails, the break opens all six switches without the program. The gate driver's fault is not wired
//! to the break on this board (TIM1's break inputs, PA6 and PB12, have other uses); the driver opens the switches
//! itself.

use super::pins::{Pin, alternate};
use devices::vesc6::MOTOR;
use embassy_stm32::gpio::{AfType, OutputType, Speed};
use embassy_stm32::pac::TIM1;
use embassy_stm32::pac::timer::vals::{Bkp, Cms, Dir, Mms, Ocm, Ossi, Ossr};
use embassy_stm32::{peripherals, rcc};

/// Clock of the timer \[Hz\].
const CLOCK_HZ: u32 = 168_000_000;
/// Top of the counter: half a period.
const TOP: u16 = (CLOCK_HZ as f32 / MOTOR.rate_hz / 2.0) as u16;
/// Lead of the ADC trigger before the top \[counts\]: half of the sampling time of a current.
const LEAD: u16 = 60;
/// Dead time \[counts\].
const DEAD: u8 = (MOTOR.bridge.dead_time_s * CLOCK_HZ as f32 + 0.5) as u8;
// Up to 127 the register value is the number of counts.
const _: () = assert!(DEAD > 0 && DEAD < 128);

/// Alternate function of TIM1.
const FUNCTION: u8 = 1;

/// Configures and starts the timer with all six switches open; returns whether duty cycles are loaded at the top.
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
    // ADC trigger: high around the top.
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
    // From here on every second ramp end loads. The repetition counter is still 0 here, so the first one loads, at
    // the top, and then every other at the top.
    TIM1.egr().write(|w| w.set_ug(true));
    TIM1.rcr().write(|w| w.set_rep(1));
    TIM1.cr1().modify(|w| w.set_cen(true));
    updates_at_top()
}

/// Whether the counter counts down just after an update, three times in a row.
fn updates_at_top() -> bool {
    (0..3).all(|_| {
        TIM1.sr().modify(|w| w.set_uif(false));
        let came = (0..100_000).any(|_| TIM1.sr().read().uif());
        came && TIM1.cr1().read().dir() == Dir::DOWN
    })
}

/// Sets the duty cycles of the upper switches, from the next top on.
pub(super) fn duties(duties: [f32; 3]) {
    for (phase, duty) in duties.into_iter().enumerate() {
        TIM1.ccr(phase).write(|w| w.set_ccr((duty * f32::from(TOP) + 0.5) as u16));
    }
}

/// Makes [`period_elapsed`] refer to the next top.
pub(super) fn begin() {
    TIM1.sr().modify(|w| w.set_uif(false));
}

/// Whether a top has passed since [`begin`]: duty cycles set after it act a period too late.
pub(super) fn period_elapsed() -> bool {
    TIM1.sr().read().uif()
}

/// Enables the outputs, unless a break is active.
pub(super) fn close() {
    TIM1.bdtr().modify(|w| w.set_moe(true));
}

/// Whether the outputs are enabled; valid some cycles after [`close`].
pub(super) fn is_closed() -> bool {
    TIM1.bdtr().read().moe()
}

/// Opens all six switches.
pub(super) fn open() {
    TIM1.bdtr().modify(|w| w.set_moe(false));
}
