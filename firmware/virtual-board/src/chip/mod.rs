//! STM32F405: the STM32F427 of `rigless`, which has the same reference manual (RM0090), with own models of the ports,
//! TIM1, the ADCs, CAN1 and EXTI.
//!
//! | own model | reason |
//! | --- | --- |
//! | GPIOA to GPIOD | three software SPI buses, more than a million accesses per second |
//! | TIM1 | one event per PWM period instead of one per edge of six outputs |
//! | ADC1 to ADC3 | `rigless` has no external trigger |
//! | CAN1, EXTI | `rigless` has no model |

pub mod adc;
pub mod can;
pub mod exti;
pub mod gpio;
mod halt;
pub mod memory;
pub mod tim1;

use crate::wiring::{AsAdc, AsCan, AsExti, AsPort, AsTim1, Wiring};
use bytemuck::TransparentWrapper;
use exti::detector_interrupt;
use rigless::device::{ErasedDevice, Level, ResetCause};
use rigless::mcu::{Mcu, Operate};
use rigless::soc::stm32f427::Stm32f427;
use rigless::soc::stm32f427::generated::{dbg, pwr};
use rigless::soc::{Bus, Error};
use rigless::time::VirtualNanos;

/// Owner of the model of a bus slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    Library,
    Port(usize),
    Tim1,
    Adc(usize),
    Can,
    Exti,
}

/// Instances with an own model.
const OWN: [(&str, Owner); 10] = [
    ("GPIOA", Owner::Port(0)),
    ("GPIOB", Owner::Port(1)),
    ("GPIOC", Owner::Port(2)),
    ("GPIOD", Owner::Port(3)),
    ("TIM1", Owner::Tim1),
    ("ADC1", Owner::Adc(0)),
    ("ADC2", Owner::Adc(1)),
    ("ADC3", Owner::Adc(2)),
    ("CAN1", Owner::Can),
    ("EXTI", Owner::Exti),
];

/// The chip with everything connected to its pins.
#[derive(Debug)]
pub struct Chip {
    /// Peripherals of the library.
    pub library: Stm32f427,
    /// Own peripherals, and everything wired to them.
    pub wiring: Wiring,
    owners: Box<[Owner]>,
}

impl Chip {
    /// A chip after reset.
    ///
    /// # Errors
    /// An inconsistent description of the chip.
    pub fn new(wiring: Wiring) -> Result<Self, Error> {
        let library = Stm32f427::new()?;
        let mut owners = vec![Owner::Library; library.bus().slots().len()].into_boxed_slice();
        for (instance, owner) in OWN {
            owners[library.bus().slot(instance)?] = owner;
        }
        let mut chip = Self { library, wiring, owners };
        chip.check()?;
        chip.identify();
        Ok(chip)
    }

    /// Sets the identifier of an STM32F405 of revision Y (RM0090 rev 22, 38.6.1).
    fn identify(&mut self) {
        let Some(slot) = self.bus().slot_of("DBG") else { return };
        let registers = self.library.bus_mut().slot_mut(slot).registers_mut();
        registers.set(dbg::Register::DbgmcuIdcode, 0x100f_6413);
    }

    /// Sets the supply of the chip \[mV\]; the voltage detector reacts.
    pub fn set_supply(&mut self, millivolts: u32, now: VirtualNanos) {
        self.library.set_supply(millivolts);
        let status = self.library.power().1.get(pwr::Register::Csr);
        let interrupt = self.wiring.exti.detector(pwr::csr::PVDO.is_set(status));
        let Some(slot) = self.bus().slot_of("EXTI") else { return };
        self.library.bus_mut().drive(now, slot).1.drive_line(detector_interrupt(), Level::from(interrupt));
    }
}

impl Mcu for Chip {
    fn bus(&self) -> &Bus {
        self.library.bus()
    }

    fn bus_mut(&mut self) -> &mut Bus {
        self.library.bus_mut()
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        self.wiring.reset(at);
        self.library.reset(at, cause);
        self.identify();
    }

    fn poll(&mut self, now: VirtualNanos) {
        self.library.poll(now);
    }

    fn split(&mut self, slot: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        let Self { library, wiring, owners } = self;
        let own: &mut dyn ErasedDevice = match owners.get(slot) {
            Some(Owner::Port(0)) => AsPort::<0>::wrap_mut(wiring),
            Some(Owner::Port(1)) => AsPort::<1>::wrap_mut(wiring),
            Some(Owner::Port(2)) => AsPort::<2>::wrap_mut(wiring),
            Some(Owner::Port(_)) => AsPort::<3>::wrap_mut(wiring),
            Some(Owner::Tim1) => AsTim1::wrap_mut(wiring),
            Some(Owner::Adc(0)) => AsAdc::<0>::wrap_mut(wiring),
            Some(Owner::Adc(1)) => AsAdc::<1>::wrap_mut(wiring),
            Some(Owner::Adc(_)) => AsAdc::<2>::wrap_mut(wiring),
            Some(Owner::Can) => AsCan::wrap_mut(wiring),
            Some(Owner::Exti) => AsExti::wrap_mut(wiring),
            Some(Owner::Library) | None => return library.split(slot),
        };
        (library.bus_mut(), Some(own))
    }
}
