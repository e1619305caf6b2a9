//! External interrupt controller (RM0090 rev 22, chapter 12), only line 16 of the voltage detector.

use crate::wiring::{AsExti, Wiring};
use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::emulator::InterruptLine;
use rigless::soc::Layout;
use rigless::soc::stm32f427::generated::exti::Register;

/// Line of the voltage detector (12.2.5), and its interrupt (table 62).
const DETECTOR: u32 = 1 << 16;
const DETECTOR_INTERRUPT: u16 = 1;

/// The controller.
#[derive(Clone, Copy, Debug, Default)]
pub struct Exti {
    mask: u32,
    rising: u32,
    falling: u32,
    pending: u32,
}

impl Exti {
    /// Handles a change of the detector's output; returns whether its interrupt becomes pending.
    pub fn detector(&mut self, supply_is_low: bool) -> bool {
        let edge = if supply_is_low { self.rising } else { self.falling };
        self.pending |= edge & DETECTOR;
        self.pending & self.mask & DETECTOR != 0
    }
}

/// Interrupt line of the detector.
///
/// # Panics
/// Never: the number is valid.
pub fn detector_interrupt() -> InterruptLine {
    InterruptLine::new(DETECTOR_INTERRUPT).expect("a line of the chip")
}

impl Device for AsExti {
    type Register = Register;

    fn read(&mut self, register: Register, _: &mut RegisterFile, _: &mut DeviceContext<'_>) -> Option<u64> {
        let exti = &Wiring::of_exti(self).exti;
        (register == Register::Pr).then_some(u64::from(exti.pending))
    }

    fn write(
        &mut self,
        register: Register,
        value: u64,
        _: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let (value, exti) = (value as u32, &mut Wiring::of_exti(self).exti);
        match register {
            Register::Imr => exti.mask = value,
            Register::Rtsr => exti.rising = value,
            Register::Ftsr => exti.falling = value,
            Register::Pr => exti.pending &= !value,
            Register::Emr | Register::Swier => {
                if value != 0 {
                    context.tell(register.spec().name, "only interrupts by an edge are modelled");
                }
            }
        }
        if (exti.mask | exti.rising | exti.falling) & !DETECTOR != 0 {
            context.tell(register.spec().name, "only the voltage detector's line is modelled");
        }
        let level = Level::from(exti.pending & exti.mask & DETECTOR != 0);
        context.drive_line(detector_interrupt(), level);
    }
}
