//! Wheel pulses: two timers capture the time of an edge without an interrupt.

use super::pins::{Pin, alternate};
use embassy_stm32::gpio::{AfType, Pull};
use embassy_stm32::pac::timer::TimGp16;
use embassy_stm32::pac::timer::vals::{CcmrInputCcs, Ckd, FilterValue};
use embassy_stm32::pac::{TIM3, TIM4};
use embassy_stm32::{peripherals, rcc};

/// Alternate function of TIM3 and TIM4.
const FUNCTION: u8 = 2;
/// Prescaler: the timers' clock over 1 MHz, less one.
const TO_1_MHZ: u16 = 84 - 1;

/// Timer of a wheel and its channel, from 0.
pub(super) struct Edges(TimGp16, usize);

/// Starts front and rear. An edge counts after the line was low for 12 us.
pub(super) fn start(front: Pin, rear: Pin) -> [Edges; 2] {
    rcc::enable_and_reset::<peripherals::TIM4>();
    rcc::enable_and_reset::<peripherals::TIM3>();
    [(front, TIM4, 0), (rear, TIM3, 1)].map(|(pin, tim, channel)| {
        alternate(pin, FUNCTION, AfType::input(Pull::Up));
        tim.psc().write_value(TO_1_MHZ);
        tim.cr1().modify(|w| w.set_ckd(Ckd::DIV4));
        tim.ccmr_input(0).modify(|w| {
            w.set_ccs(channel, CcmrInputCcs::TI4);
            w.set_icf(channel, FilterValue::FDTS_DIV32_N8);
        });
        tim.ccer().modify(|w| {
            w.set_ccp(channel, true);
            w.set_cce(channel, true);
        });
        tim.egr().write(|w| w.set_ug(true));
        tim.cr1().modify(|w| w.set_cen(true));
        Edges(tim, channel)
    })
}

impl Edges {
    /// Time since the newest edge, if one came since the last call \[us\]. Call more often than the timer's 65 ms.
    pub(super) fn age_us(&mut self) -> Option<u32> {
        let Self(tim, channel) = *self;
        if !tim.sr().read().ccif(channel) {
            return None;
        }
        // Reading the capture also clears its flag.
        let edge = tim.ccr(channel).read().ccr();
        Some(u32::from(tim.cnt().read().cnt().wrapping_sub(edge)))
    }
}
