//! Injected conversions of the three ADCs, started by TIM1's trigger output (RM0090 rev 22, chapter 13).
//!
//! All three convert simultaneously. Regular conversions are not modelled and end the run.

use crate::wiring::{AsAdc, Wiring};
use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::soc::Layout;
use rigless::soc::stm32f427::generated::adc1::Register;
use rigless::time::{EventId, VirtualNanos};

const JEOC: u32 = 1 << 2;
const JSTRT: u32 = 1 << 3;
const JEOCIE: u32 = 1 << 7;
const SCAN: u32 = 1 << 8;
const ADON: u32 = 1;
const SWSTART: u32 = 1 << 30;
const JSWSTART: u32 = 1 << 22;
const EXTEN: u32 = 0b11 << 28;
/// CR2.JEXTEN: rising edge; CR2.JEXTSEL: TIM1's trigger output (13.13.3).
const JEXTEN: u32 = 0b11 << 20;
const JEXTEN_RISING: u32 = 0b01 << 20;
const JEXTSEL: u32 = 0xf << 16;
const JEXTSEL_TIM1_TRGO: u32 = 1 << 16;

/// Sampling time of a channel, by its number in SMPR \[cycles of the converter's clock\] (13.13.4).
const SAMPLE_CYCLES: [u64; 8] = [3, 15, 28, 56, 84, 112, 144, 480];
/// Conversion time to 12 bits \[cycles\] (13.6).
const CONVERSION_CYCLES: u64 = 12;
/// The clock: APB2, 84 MHz, over the common prescaler of 4 \[Hz\].
const CLOCK_HZ: u64 = 21_000_000;
/// Polling interval for a trigger while TIM1 gives none.
const RETRY_NS: u64 = 50_000;

/// One ADC.
#[derive(Clone, Copy, Debug, Default)]
pub struct Adc {
    sr: u32,
    cr1: u32,
    cr2: u32,
    smpr: [u32; 2],
    jsqr: u32,
    data: [u16; 4],
    /// End of the running conversion; only used in the first ADC, for all three.
    event: Option<(EventId, Phase)>,
}

/// Events of the ADC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Trigger,
    Done,
}

impl Adc {
    fn is_armed(&self) -> bool {
        self.cr2 & ADON != 0
            && self.cr2 & JEXTEN == JEXTEN_RISING
            && self.cr2 & JEXTSEL == JEXTSEL_TIM1_TRGO
            && self.cr1 & SCAN != 0
    }

    /// Channels of the injected sequence, in order: the last JL+1 places of JSQR (13.13.12).
    fn channels(&self) -> impl Iterator<Item = u8> + use<> {
        let (jsqr, length) = (self.jsqr, (self.jsqr >> 20 & 0b11) + 1);
        (4 - length..4).map(move |place| (jsqr >> (5 * place) & 0x1f) as u8)
    }

    fn sample_cycles(&self, channel: u8) -> u64 {
        let field = |register: u32, place: u8| register >> (3 * place) & 0b111;
        let number =
            if channel < 10 { field(self.smpr[1], channel) } else { field(self.smpr[0], channel - 10) };
        SAMPLE_CYCLES[number as usize]
    }

    /// Duration of the whole sequence \[ns\].
    fn sequence_ns(&self) -> u64 {
        let cycles: u64 =
            self.channels().map(|channel| self.sample_cycles(channel) + CONVERSION_CYCLES).sum();
        cycles * 1_000_000_000 / CLOCK_HZ
    }

    fn interrupts(&self) -> bool {
        self.sr & JEOC != 0 && self.cr1 & JEOCIE != 0
    }
}

impl Wiring {
    fn arm(&mut self, context: &mut DeviceContext<'_>) {
        let now_ns = context.now().0;
        let at = self.tim1.next_trigger_ns(now_ns).unwrap_or(now_ns + RETRY_NS);
        self.adc[0].event = Some((context.schedule(VirtualNanos(at)), Phase::Trigger));
    }

    /// Samples all ADCs. An unconnected channel is reported and ends the run, instead of reading as zero.
    fn convert(&mut self, context: &mut DeviceContext<'_>) {
        for number in 0..self.adc.len() {
            if self.adc[number].is_armed() {
                for (rank, channel) in self.adc[number].channels().enumerate() {
                    match self.counts(channel) {
                        Some(counts) => self.adc[number].data[rank] = counts,
                        None => context.tell(
                            Register::Jsqr.spec().name,
                            "converts a channel without a signal, or whose pin is not analog",
                        ),
                    }
                }
                self.adc[number].sr |= JSTRT;
            }
        }
    }
}

impl<const N: usize> Device for AsAdc<N> {
    type Register = Register;

    fn read(&mut self, register: Register, _: &mut RegisterFile, _: &mut DeviceContext<'_>) -> Option<u64> {
        let adc = &Wiring::of_adc(self).adc[N];
        let rank = register.index().wrapping_sub(Register::Jdr1.index());
        match register {
            Register::Sr => Some(u64::from(adc.sr)),
            _ => adc.data.get(rank).map(|counts| u64::from(*counts)),
        }
    }

    fn write(
        &mut self,
        register: Register,
        value: u64,
        _: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let value = value as u32;
        let wiring = Wiring::of_adc(self);
        let adc = &mut wiring.adc[N];
        match register {
            Register::Sr => adc.sr &= value,
            Register::Cr1 => adc.cr1 = value,
            Register::Cr2 => {
                adc.cr2 = value;
                if value & (SWSTART | JSWSTART | EXTEN) != 0 {
                    context
                        .tell(register.spec().name, "only injected conversions started by TIM1 are modelled");
                }
            }
            Register::Smpr1 => adc.smpr[0] = value,
            Register::Smpr2 => adc.smpr[1] = value,
            Register::Jsqr => adc.jsqr = value,
            _ if value != 0 => context.tell(register.spec().name, "not modelled"),
            _ => (),
        }
        let raised = adc.interrupts();
        context.interrupt(0, Level::from(raised));
        if N == 0 && wiring.adc[0].is_armed() && wiring.adc[0].event.is_none() {
            wiring.arm(context);
        }
    }

    fn on_event(&mut self, event: EventId, _: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let wiring = Wiring::of_adc(self);
        let Some((_, phase)) = wiring.adc[N].event.filter(|(id, _)| *id == event) else { return };
        let now_ns = context.now().0;
        wiring.advance(now_ns);
        if phase == Phase::Trigger && wiring.tim1.next_trigger_ns(now_ns.saturating_sub(1)) == Some(now_ns) {
            wiring.convert(context);
            let over = VirtualNanos(now_ns + wiring.adc[N].sequence_ns());
            wiring.adc[N].event = Some((context.schedule(over), Phase::Done));
            return;
        }
        if phase == Phase::Done {
            wiring.calls.begin(now_ns);
            for adc in &mut wiring.adc {
                adc.sr |= JEOC;
            }
            context.interrupt(0, Level::from(wiring.adc[N].interrupts()));
        }
        wiring.arm(context);
    }
}
