//! The image that finds the offset of the motor's encoder, once for each motor, encoder and wiring. It also sets the chip's
//! brown-out reset, once for each board.
//!
//! While the rider's switch is held, the motor moves the handlebar by less than a degree there and back, for 3.5 s. The
//! offset comes over RTT; it is written down as `encoder.offset_turns` of `parts::vesc6::MOTOR`. Released, the switch
//! opens the bridge at once. Nothing else makes torque in this image.
#![no_std]
#![no_main]

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use embassy_time::{Duration, Instant, Ticker, Timer};
use firmware::{board, crash};
use motor::Ask;

/// Periods done by [`hold`].
static PERIODS: AtomicU32 = AtomicU32::new(0);

#[cortex_m_rt::entry]
fn main() -> ! {
    crash::start(board::reset_cause());
    defmt::info!(
        "{=str} start {=u32} after {=str}",
        firmware::identity!(),
        crash::starts(),
        crash::cause().name()
    );
    board::log_kept_fault();
    board::start();
    board::raise_level();
    board::run(
        |control| control.spawn(defmt::unwrap!(hold().ok())),
        |thread| {
            thread.spawn(defmt::unwrap!(tell().ok()));
            thread.spawn(defmt::unwrap!(board::watch_drive().ok()));
        },
    )
}

/// Asks for the alignment while the switch is held, in place of control.
#[embassy_executor::task]
async fn hold() {
    let mut release = Instant::from_millis(Instant::now().as_millis());
    loop {
        release += Duration::from_millis(1);
        Timer::at(release).await;
        let held = board::sense().engage;
        board::order(if held { Ask::Align } else { Ask::Off });
        PERIODS.store(PERIODS.load(Relaxed).wrapping_add(1), Relaxed);
    }
}

/// Says twice a second what the motor does, and feeds the watchdog while [`hold`] is alive.
#[embassy_executor::task]
async fn tell() {
    let mut tick = Ticker::every(Duration::from_millis(10));
    let mut seen = 0;
    for count in (0..50_u32).cycle() {
        tick.next().await;
        let periods = PERIODS.load(Relaxed);
        if periods != seen {
            board::feed_watchdog();
        }
        seen = periods;
        if count == 0 {
            let report = board::motor_report();
            defmt::info!(
                "mode={=u8} faults={=u32:#x} encoder={=u16} age={=u16} offset_turns={}",
                report.mode as u8,
                report.faults.0,
                report.encoder_counts,
                report.encoder_age,
                report.offset_turns
            );
        }
    }
}
