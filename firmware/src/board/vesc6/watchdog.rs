//! The independent watchdog: runs from its own oscillator and can't be stopped once started.

use crate::tasks::WATCHDOG;
use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_time::Duration;

/// Patience while the chip stands still: at start, 0.8 s at most, and in an erase of a sector, 0.5 s at most and 0.3 s in
/// which control makes up for its steps. With the fastest oscillator it is 1.36 s.
const STANDSTILL: Duration = Duration::from_millis(2000);

/// One count, of 32 kHz / 64; the oscillator is anything from 17 to 47 kHz.
const COUNT: Duration = Duration::from_millis(2);

/// Starts it, with the patience of a standstill.
pub(super) fn start() {
    IWDG.kr().write(|w| w.set_key(Key::START));
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY64));
    standstill(true);
}

/// Lengthens its patience for a standstill, or makes it [`WATCHDOG`]; either begins anew.
pub(super) fn standstill(is: bool) {
    let patience = if is { STANDSTILL } else { WATCHDOG };
    settled();
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.rlr().write(|w| w.set_rl((patience.as_ticks() / COUNT.as_ticks()) as u16));
    settled();
    feed_watchdog();
}

/// Waits, not for ever, until the registers took what was written last: five of the oscillator's cycles.
fn settled() {
    for _ in 0..100_000 {
        let status = IWDG.sr().read();
        if !status.pvu() && !status.rvu() {
            break;
        }
    }
}

/// Starts the watchdog's patience anew.
pub fn feed_watchdog() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
