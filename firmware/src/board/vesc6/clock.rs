//! Clock set-up: 168 MHz from the 8 MHz crystal.

use crate::crash::{self, Registers};
use devices::silicon::has_prefetch;
use embassy_stm32::Config;
use embassy_stm32::pac::{DBGMCU, FLASH, RCC};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllQDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use link::report::FaultKind;

/// The chip's largest frequencies: core 168 MHz, APB1 42 MHz, APB2 84 MHz, USB 48 MHz.
pub(super) fn config() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse { freq: Hertz::mhz(8), mode: HseMode::Oscillator });
    config.rcc.pll_src = PllSource::HSE;
    // 8 MHz / 4 * 168 = 336 MHz.
    config.rcc.pll = Some(Pll {
        prediv: PllPreDiv::DIV4,
        mul: PllMul::MUL168,
        divp: Some(PllPDiv::DIV2),
        divq: Some(PllQDiv::DIV7),
        divr: None,
    });
    config.rcc.sys = Sysclk::PLL1_P;
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    config.rcc.apb1_pre = APBPrescaler::DIV4;
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    config.dma_interrupt_priority = super::priority::REST;
    config
}

/// Enables the flash caches, and prefetch where the chip supports it. The HAL leaves them off, and each word then
/// takes 6 cycles.
pub(super) fn enable_flash_caches() {
    let chip = DBGMCU.idcode().read();
    let prefetch = has_prefetch(chip.dev_id(), chip.rev_id());
    defmt::info!(
        "chip: device={=u16:#x} revision={=u16:#x} prefetch={=bool}",
        chip.dev_id(),
        chip.rev_id(),
        prefetch
    );
    FLASH.acr().modify(|w| {
        w.set_prften(prefetch);
        w.set_icen(true);
        w.set_dcen(true);
    });
}

/// Enables clock security: if the crystal fails, the break opens the bridge, and the chip restarts on its internal
/// oscillator.
pub(super) fn watch_crystal() {
    RCC.cr().modify(|w| w.set_csson(true));
}

#[cortex_m_rt::exception]
unsafe fn NonMaskableInt() -> ! {
    crash::end(FaultKind::Exception, Registers { exception: 2, values: [0; 6] }, "crystal lost")
}
