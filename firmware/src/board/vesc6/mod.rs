//! Board VESC 6 MK6 with an STM32F405RG: gate driver, shunts, IMU and clock of the board; encoder, steer sensor,
//! wheels, switch and link wired as in [`pins`] and docs/hardware.md. Not yet run on hardware.
#![allow(unsafe_code)]

mod adc;
mod brown_out;
mod can;
mod clock;
mod critical;
mod drive_faults;
mod flash;
mod gate;
mod halt;
mod imu;
mod leds;
mod motor;
mod outputs;
mod pins;
mod priority;
mod pwm;
mod reset;
mod sensors;
pub mod serial;
mod shared;
mod soft_spi;
mod time;
mod watchdog;
mod wheels;

pub use brown_out::raise_level;
pub use can::broadcast;
pub use drive_faults::record_drive_faults;
pub use flash::{Flash, StoreGuard, flash};
pub use outputs::outputs_off;
pub use reset::{end, log_stored_fault, reset_cause};
pub use sensors::sense;
pub use shared::{Report, report as motor_report, set_command};
pub use watchdog::feed_watchdog;

use crate::failure;
use crate::heartbeat::Task;
use crate::tasks::WATCHDOG;
use crate::telemetry::{DriveError, Telemetry};
use ::motor::MotorCommand;
use control::{Command, Mode};
use defmt_rtt as _;
use devices::vesc6::MOTOR;
use embassy_executor::{Executor, InterruptExecutor, SendSpawner, Spawner};
use embassy_stm32::gpio::{Input, Level, Pull};
use embassy_stm32::interrupt;
use pins::{Pins, fixed};
use sensors::Sensors;
use soft_spi::{Edge, SoftSpi};
use static_cell::StaticCell;

static CONTROL: InterruptExecutor = InterruptExecutor::new();

/// Starts the chip and its peripherals except the motor interrupt; the watchdog runs from here on, with its extended
/// timeout until [`run`].
///
/// # Panics
/// When called a second time.
pub fn start() -> MotorParts {
    failure::enable();
    halt::start();
    if let Some(mut core) = cortex_m::Peripherals::take() {
        priority::set(&mut core);
    }
    let peripherals = embassy_stm32::init(clock::config());
    time::start();
    clock::enable_flash_caches();
    start_parts(peripherals)
}

/// Initialised drivers for the motor interrupt.
#[must_use]
pub struct MotorParts {
    timer_in_step: bool,
    gate_driver_good: bool,
    encoder: SoftSpi,
    gate_fault: Input<'static>,
}

impl MotorParts {
    /// Starts the motor interrupt, with the encoder's offset if known \[electrical turns\].
    pub fn start(self, offset_turns: Option<f32>) {
        let mut config = MOTOR;
        config.encoder.offset_turns = offset_turns;
        let plan = config.plan();
        if !self.timer_in_step || plan.is_err() {
            defmt::error!(
                "motor: timer in step={=bool}, configuration good={=bool}",
                self.timer_in_step,
                plan.is_ok()
            );
            outputs_off();
        }
        if let Ok(plan) = plan {
            motor::start(plan, self.gate_driver_good, self.encoder, self.gate_fault);
        }
    }
}

/// Starts the executors and ends the extended timeout of the watchdog; `control`'s executor is above `thread`'s.
///
/// # Panics
/// When called a second time.
pub fn run(control: impl FnOnce(SendSpawner), thread: impl FnOnce(Spawner)) -> ! {
    static THREAD: StaticCell<Executor> = StaticCell::new();
    THREAD.init(Executor::new()).run(|spawner| {
        thread(spawner);
        watchdog::set_timeout(WATCHDOG);
        // UART5 is unused: its interrupt runs the control executor.
        control(CONTROL.start(interrupt::UART5));
    })
}

/// Initialisation between clocks and executors; `outputs_off` works from its first lines on.
fn start_parts(peripherals: embassy_stm32::Peripherals) -> MotorParts {
    static SENSORS: StaticCell<Sensors> = StaticCell::new();
    let pins = Pins::of(peripherals);
    // Power latch: the button powers the board only while it is pressed.
    fixed(pins.hold_power, Level::High);
    fixed(pins.current_filter, Level::High);
    fixed(pins.sensor_port_5v, Level::Low);
    fixed(pins.phase_filter, Level::Low);
    pins.phase_voltages.into_iter().for_each(pins::analog);
    watchdog::start();
    brown_out::start();

    let timer_in_step = pwm::start(pins.bridge);
    clock::watch_crystal();
    let mut encoder = SoftSpi::new(pins.encoder_bus, Edge::Falling, ENCODER_CYCLES);
    let bus = SoftSpi::new(pins.gate_bus, Edge::Falling, GATE_CYCLES);
    let gate_driver_good = gate::start(pins.gate_enable, bus, &mut encoder);
    adc::start(pins.analog);

    let mut imu = SoftSpi::new(pins.imu_bus, Edge::Rising, IMU_CYCLES);
    let imu = imu::start(&mut imu).then_some(imu);
    let edges = wheels::start(pins.front_wheel, pins.rear_wheel);
    sensors::start(SENSORS.init(Sensors::new(imu, edges)));
    leds::start(pins.green, pins.red);
    serial::start(pins.link);
    can::start(pins.can_receive, pins.can_transmit);
    flash::start(pins.flash);
    MotorParts { timer_in_step, gate_driver_good, encoder, gate_fault: Input::new(pins.gate_fault, Pull::Up) }
}

/// Half clock periods of the buses \[cycles of 6 ns\]: gate driver 1 MHz, IMU below 2 MHz (its clock pin is slow),
/// encoder below its 10 MHz.
const GATE_CYCLES: u32 = 84;
const IMU_CYCLES: u32 = 42;
const ENCODER_CYCLES: u32 = 10;

#[interrupt]
fn UART5() {
    // SAFETY: this is the interrupt that CONTROL was started with.
    unsafe { CONTROL.on_interrupt() }
}

/// Passes the command to the motor interrupt, which opens the bridge if the next one is late.
///
/// # Errors
/// The reason for which no torque is given, from the interrupt's last report.
pub fn drive(command: &Command) -> Result<(), DriveError> {
    let wanted = command.torque_nm != 0.0 || matches!(command.mode, Mode::Engaged | Mode::Limp);
    let error = motor_report().error();
    set_command(if wanted { MotorCommand::Torque(command.torque_nm) } else { MotorCommand::Off });
    leds::show(error.is_none());
    error.map_or(Ok(()), Err)
}

/// Whether the task's heartbeat is lost: never, as this board has no fault injection.
pub const fn heartbeat_lost(_: Task) -> bool {
    false
}

/// Logs over RTT: control step, sensors, report of the motor interrupt.
pub fn report(t: &Telemetry) {
    defmt::info!(
        "steps={=u32} late={=u32} worst_us={=u32} torque_nm={=f32} mode={=str} motor={=str}",
        t.deadlines.steps,
        t.deadlines.late,
        t.deadlines.worst_us,
        t.command.torque_nm,
        t.command.mode.name(),
        t.drive.map_or_else(DriveError::reason, |()| "able")
    );
    let f = &t.frame;
    defmt::info!(
        "gyro_rad_s={} age={=u16} accel_m_s2={} age={=u16} steer_rad={=f32} age={=u16} front_m_s={=f32} age={=u16} \
         rear_m_s={=f32} age={=u16} rider_nm={=f32} age={=u16} switch={=bool}",
        f.gyro_rad_s.value,
        f.gyro_rad_s.age_ticks,
        f.accel_m_s2.value,
        f.accel_m_s2.age_ticks,
        f.steer_rad.value,
        f.steer_rad.age_ticks,
        f.front_wheel_m_s.value,
        f.front_wheel_m_s.age_ticks,
        f.rear_wheel_m_s.value,
        f.rear_wheel_m_s.age_ticks,
        f.rider_torque_nm.value,
        f.rider_torque_nm.age_ticks,
        f.engage
    );
    let m = motor_report();
    defmt::info!(
        "calls={=u32} late={=u32} mode={=u8} faults={=u32:#x} gate_pulses={=u32} supply_v={=f32} board_c={=f32} encoder={=u16} age={=u16} \
         flagged={=u32} damaged={=u32} steer_rad_s={=f32} iq_a={=f32} torque_nm={=f32} offset_turns={}",
        m.calls,
        m.late,
        m.mode as u8,
        m.faults.0,
        m.gate_pulses,
        m.supply_v,
        shared::temperature_c(),
        m.encoder_counts,
        m.encoder_age,
        m.encoder_flagged,
        m.encoder_damaged,
        m.steer_rate_rad_s,
        m.iq_a,
        m.torque_nm,
        m.offset_turns
    );
}
