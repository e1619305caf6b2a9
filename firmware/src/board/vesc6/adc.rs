//! The three ADCs, triggered together by TIM1.
//!
//! The HAL has no injected conversions for this family, so the registers are written here. Each ADC converts its phase
//! current first, so that all three are simultaneous, then the slowly changing values.

use super::pins::{Pin, analog};
use embassy_stm32::pac::adc::Adc;
use embassy_stm32::pac::adc::vals::{Exten, SampleTime};
use embassy_stm32::pac::adccommon::vals::Adcpre;
use embassy_stm32::pac::{ADC1, ADC2, ADC3, ADC123_COMMON};
use embassy_stm32::{peripherals, rcc};

/// Selection of TIM1's trigger output for injected conversions.
const TIM1_TRGO: u8 = 1;

/// Channels of each ADC, in order: currents of a, b, c; steer, rider's torque, supply; switch, board temperature. The
/// first ADC has the longest sequence, so its end is the end of all.
const CHANNELS: [(Adc, [u8; 3]); 3] = [(ADC1, [10, 5, 14]), (ADC2, [11, 6, 3]), (ADC3, [12, 13, 13])];

/// Conversions of one PWM period \[counts\].
pub(super) struct Counts {
    pub(super) phases: [u16; 3],
    pub(super) steer: u16,
    pub(super) rider_torque: u16,
    pub(super) supply: u16,
    pub(super) switch: u16,
    pub(super) board_temperature: u16,
}

/// Configures the ADCs; enables their interrupt at the peripheral, but not in the NVIC.
pub(super) fn start(pins: [Pin; 8]) {
    pins.into_iter().for_each(analog);
    rcc::enable_and_reset::<peripherals::ADC1>();
    rcc::enable_and_reset::<peripherals::ADC2>();
    rcc::enable_and_reset::<peripherals::ADC3>();
    // 84 MHz / 4 = 21 MHz, of 36 allowed.
    ADC123_COMMON.ccr().modify(|w| w.set_adcpre(Adcpre::DIV4));
    for (adc, channels) in CHANNELS {
        // Currents 15 cycles, other channels 56: 7.8 us in total.
        for channel in 0..18 {
            let time = if (10..13).contains(&channel) { SampleTime::CYCLES15 } else { SampleTime::CYCLES56 };
            if channel < 10 {
                adc.smpr2().modify(|w| w.set_smp(channel, time));
            } else if channel < 18 {
                adc.smpr1().modify(|w| w.set_smp(channel - 10, time));
            }
        }
        adc.jsqr().write(|w| {
            w.set_jl(2);
            // A sequence of three starts at the second position.
            channels.into_iter().enumerate().for_each(|(place, channel)| w.set_jsq(place + 1, channel));
        });
        adc.cr1().modify(|w| w.set_scan(true));
        adc.cr2().modify(|w| {
            w.set_adon(true);
            w.set_jextsel(TIM1_TRGO);
            w.set_jexten(Exten::RISING_EDGE);
        });
    }
    ADC1.cr1().modify(|w| w.set_jeocie(true));
}

/// The last conversions.
pub(super) fn counts() -> Counts {
    ADC1.sr().modify(|w| w.set_jeoc(false));
    let [[a, steer, switch], [b, rider_torque, board_temperature], [c, supply, _]] =
        CHANNELS.map(|(adc, _)| [0, 1, 2].map(|place| adc.jdr(place).read().jdata()));
    Counts { phases: [a, b, c], steer, rider_torque, supply, switch, board_temperature }
}

/// Clears pending interrupts: the first one then comes from the end of a future conversion, at its place in the PWM
/// period.
pub(super) fn clear_pending() {
    ADC1.sr().modify(|w| w.set_jeoc(false));
}

/// Whether the next conversions have already ended.
pub(super) fn next_conversion_ended() -> bool {
    ADC1.sr().read().jeoc()
}
