//! Simulated sensors for timing tests: a bicycle at 4 m/s whose roll rate oscillates by 0.1 rad/s at 1 Hz, and a
//! rider who requests assist. The motor reports every commanded torque; the handlebar does not move. At five times
//! the amplitude the sign check would report a reversed motor (fault 37).

use super::pil;
use crate::telemetry::DriveError;
use control::{Command, Sample, SensorFrame, Triple};
use core::cell::Cell;
use core::f32::consts::TAU;
use critical_section::Mutex;
use embassy_time::Instant;

/// Time of the rider's press \[ms\]: after the self-test, with no cause left that rejects the press.
const SWITCH_AFTER_MS: u64 = 500;

/// Roll rate and its quadrature component \[rad/s\].
static SWING: Mutex<Cell<(f32, f32)>> = Mutex::new(Cell::new((0.1, 0.0)));

/// Last commanded torque \[N m\].
static TORQUE: Mutex<Cell<f32>> = Mutex::new(Cell::new(0.0));

/// The sensors of this instant; from the host if connected.
pub fn sense() -> SensorFrame {
    pil::sense().unwrap_or_else(made_up)
}

fn made_up() -> SensorFrame {
    let angle = TAU / 1000.0;
    let (roll_rate, companion, torque_nm) = critical_section::with(|cs| {
        let (a, b) = SWING.borrow(cs).get();
        // Each half uses the other's newest value, which keeps the amplitude constant.
        let a = a - angle * b;
        let b = b + angle * a;
        SWING.borrow(cs).set((a, b));
        (a, b, TORQUE.borrow(cs).get())
    });
    let roll = companion / TAU;
    let now = Instant::now();
    SensorFrame {
        now_us: now.as_micros() as u32,
        gyro_rad_s: Triple::fresh([roll_rate, 0.0, 0.0]),
        accel_m_s2: Triple::fresh([0.0, -9.81 * roll, -9.81]),
        steer_rad: Sample::fresh(0.0),
        steer_rate_rad_s: Sample::fresh(0.0),
        front_wheel_m_s: Sample::fresh(4.0),
        rear_wheel_m_s: Sample::fresh(4.0),
        motor_torque_nm: Sample::fresh(torque_nm),
        engage: now.as_millis() > SWITCH_AFTER_MS,
        ..SensorFrame::missing()
    }
}

/// Accepts the command.
///
/// # Errors
/// None on this board.
pub fn drive(command: &Command) -> Result<(), DriveError> {
    critical_section::with(|cs| TORQUE.borrow(cs).set(command.torque_nm));
    Ok(())
}
