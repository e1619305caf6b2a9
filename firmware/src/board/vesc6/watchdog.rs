//! Independent watchdog: runs from its own oscillator and can't be stopped once started.

use crate::tasks::WATCHDOG;
use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_time::Duration;

/// Timeout while the chip can halt: at start, at most 0.8 s, and in an erase of a sector, at most 0.5 s plus 0.3 s in
/// which control catches up on its steps. With the fastest oscillator it is 1.36 s.
const STANDSTILL: Duration = Duration::from_millis(2000);

/// One count, at 32 kHz / 64; the oscillator has 17 to 47 kHz.
const COUNT: Duration = Duration::from_millis(2);

/// Starts the watchdog with the extended timeout.
pub(super) fn start() {
    IWDG.kr().write(|w| w.set_key(Key::START));
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY64));
    standstill(true);
}

/// Sets the extended timeout, or [`WATCHDOG`]; either restarts the count.
pub(super) fn standstill(is: bool) {
    let timeout = if is { STANDSTILL } else { WATCHDOG };
    settled();
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.rlr().write(|w| w.set_rl((timeout.as_ticks() / COUNT.as_ticks()) as u16));
    settled();
    feed_watchdog();
}

/// Waits, with a limit, until the registers are updated: five cycles of the oscillator.
fn settled() {
    for _ in 0..100_000 {
        let status = IWDG.sr().read();
        if !status.pvu() && !status.rvu() {
            break;
        }
    }
}

/// Restarts the watchdog's timeout.
pub fn feed_watchdog() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
