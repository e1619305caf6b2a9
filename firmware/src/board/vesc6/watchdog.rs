//! Independent watchdog: runs from its own oscillator and can't be stopped once started.

use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_time::Duration;

/// Timeout at start, at most 0.8 s, and in a store, which is fed at the start and end of each erase and write. The
/// longest time between two feeds is the erase of a sector, at most 0.5 s, after which control catches up on its steps,
/// at most 0.6 s; searches of the sectors take less. With the fastest oscillator the timeout is 1.36 s.
pub(super) const EXTENDED: Duration = Duration::from_millis(2000);

/// One count, at 32 kHz / 64; the oscillator has 17 to 47 kHz.
const COUNT: Duration = Duration::from_millis(2);

/// Starts the watchdog with the extended timeout.
pub(super) fn start() {
    IWDG.kr().write(|w| w.set_key(Key::START));
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY64));
    set_timeout(EXTENDED);
}

/// Sets the timeout and restarts the count.
pub(super) fn set_timeout(timeout: Duration) {
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
