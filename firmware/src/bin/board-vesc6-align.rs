//! Image that aligns the motor's encoder and stores the offset in flash; needed once per motor, encoder and wiring.
//! It also sets the chip's brown-out reset, once per board.
//!
//! While the rider's switch is held after a deliberate press ([`control::safety::press`]: open for half a second
//! before), the motor moves the handlebar by less than a degree there and back, for 3.5 s; then the bridge opens and
//! the offset is stored. A new press repeats the alignment. Releasing the switch opens the bridge at once. This image
//! requests no other torque.
#![no_std]
#![no_main]

use control::safety::press::{Press, PressConfig, PressState};
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use devices::vesc6::MOTOR;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant, Ticker, Timer};
use firmware::tasks::settings::StoredConfig;
use firmware::{board, crash};
use link::alignment::Alignment;
use motor::MotorCommand;
use static_cell::StaticCell;

/// Number of periods of [`hold`].
static PERIODS: AtomicU32 = AtomicU32::new(0);

/// An offset found but not yet stored \[electrical turns\].
static FOUND: Signal<CriticalSectionRawMutex, f32> = Signal::new();

#[cortex_m_rt::entry]
fn main() -> ! {
    static STORED: StaticCell<StoredConfig> = StaticCell::new();
    crash::start(board::reset_cause());
    defmt::info!(
        "{=str} start {=u32} after {=str}",
        firmware::identity!(),
        crash::starts(),
        crash::cause().name()
    );
    board::log_stored_fault();
    let motor = board::start();
    board::raise_level();
    let stored = STORED.init(StoredConfig::open());
    // No offset from program or flash: the log shows the one found.
    motor.start(None);
    board::run(
        |control| control.spawn(defmt::unwrap!(hold().ok())),
        |thread| {
            thread.spawn(defmt::unwrap!(log_and_store(stored).ok()));
            thread.spawn(defmt::unwrap!(board::record_drive_faults().ok()));
        },
    )
}

/// Requests one alignment per deliberate press of the switch while it is held; runs in place of the control task.
#[embassy_executor::task]
async fn hold() {
    let mut release = Instant::from_millis(Instant::now().as_millis());
    let mut switch = PressState::default();
    let (mut aligning, mut found) = (false, false);
    loop {
        release += Duration::from_millis(1);
        Timer::at(release).await;
        let press = switch.step(&PressConfig::product(), board::sense().engage);
        aligning = press == Press::Pressed || (aligning && press.is_closed());
        let report = board::motor_report();
        if let (true, false, Some(offset_turns)) = (report.aligned, found, report.offset_turns) {
            FOUND.signal(offset_turns);
        }
        found = aligning && (found || report.aligned);
        board::set_command(if aligning && !found { MotorCommand::Align } else { MotorCommand::Off });
        PERIODS.store(PERIODS.load(Relaxed).wrapping_add(1), Relaxed);
    }
}

/// Logs the motor's state twice per second, stores an offset found, and feeds the watchdog while [`hold`] runs.
#[embassy_executor::task]
async fn log_and_store(stored: &'static mut StoredConfig) {
    let mut tick = Ticker::every(Duration::from_millis(10));
    let mut counted = 0;
    for count in (0..50_u32).cycle() {
        tick.next().await;
        let periods = PERIODS.load(Relaxed);
        if periods != counted {
            board::feed_watchdog();
        }
        counted = periods;
        if let Some(offset_turns) = FOUND.try_take() {
            store(stored, offset_turns).await;
        }
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

/// Stores an offset. The bridge is open, as nothing is requested after the alignment.
async fn store(stored: &mut StoredConfig, offset_turns: f32) {
    let alignment = Alignment { offset_turns, motor_id: MOTOR.motor_id() };
    match stored.save_alignment(&alignment).await {
        Ok(()) => defmt::info!("encoder offset: {=f32} turns, stored", offset_turns),
        Err(_) => {
            defmt::error!("encoder offset: {=f32} turns, not stored: the flash did not keep it", offset_turns)
        }
    }
    if let Some(program) = MOTOR.encoder.offset_turns {
        defmt::warn!("encoder offset: that of the program is used instead: {=f32} turns", program);
    }
}
