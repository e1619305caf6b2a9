//! Sensor inputs of the control step: the newest samples with their ages.

use super::imu;
use super::shared::{Report, is_held, report, set_temperature};
use super::soft_spi::SoftSpi;
use super::wheels::Edges;
use ::motor::Mode;
use control::SensorFrame;
use control::sensors::frame::{Sample, Triple};
use control::sensors::wheel_speed::WheelPulsesConfig;
use core::cell::Cell;
use devices::age::Age;
use devices::switch::Switch;
use devices::vesc6::{BOARD_TEMPERATURE, RIDER_NM, STEER_RAD, SWITCH_COUNTS, SWITCH_TICKS};
use devices::wheel::{self, WheelState};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_time::Instant;

/// State between two control periods.
pub(super) struct Sensors {
    /// SPI bus of the IMU, if it answered at the start.
    imu: Option<SoftSpi>,
    /// IMU time of the last sample.
    imu_time: u32,
    gyro: ([f32; 3], Age),
    accel: ([f32; 3], Age),
    edges: [Edges; 2],
    wheels: [WheelState; 2],
    wheel: WheelPulsesConfig,
    switch: Switch,
    steer: (f32, Age),
    rider: (f32, Age),
    steer_rate: Age,
    torque: Age,
    calls: u32,
    before: Instant,
}

/// Taken out during use, so that no critical section lasts as long as a transfer from the IMU.
static SENSORS: Mutex<CriticalSectionRawMutex, Cell<Option<&'static mut Sensors>>> =
    Mutex::new(Cell::new(None));

impl Sensors {
    /// Without samples.
    pub(super) fn new(imu: Option<SoftSpi>, edges: [Edges; 2]) -> Self {
        Self {
            imu,
            imu_time: 0,
            gyro: ([0.0; 3], Age::default()),
            accel: ([0.0; 3], Age::default()),
            edges,
            wheels: Default::default(),
            wheel: devices::vesc6::wheel(),
            switch: Switch::default(),
            steer: (0.0, Age::default()),
            rider: (0.0, Age::default()),
            steer_rate: Age::default(),
            torque: Age::default(),
            calls: 0,
            before: Instant::now(),
        }
    }
}

/// Stores the state for [`sense`].
pub(super) fn start(sensors: &'static mut Sensors) {
    SENSORS.lock(|cell| cell.set(Some(sensors)));
}

/// The newest samples with their ages \[control periods\]. Does not block; the transfer from the IMU takes some 0.1
/// ms. Call once per control period.
pub fn sense() -> SensorFrame {
    let Some(sensors) = SENSORS.lock(Cell::take) else { return SensorFrame::missing() };
    let frame = sensors.frame();
    SENSORS.lock(|cell| cell.set(Some(sensors)));
    frame
}

impl Sensors {
    fn frame(&mut self) -> SensorFrame {
        let now = Instant::now();
        let elapsed_us = now.saturating_duration_since(self.before).as_micros() as u32;
        self.before = now;
        self.read_imu();
        let report = report();
        let running = report.calls != self.calls;
        self.calls = report.calls;
        set_temperature(BOARD_TEMPERATURE.celsius(report.board_temperature));
        let [front, rear] =
            [0, 1].map(|i| wheel::step(&self.wheel, &mut self.wheels[i], self.edges[i].age_us(), elapsed_us));
        let closed = report.switch < SWITCH_COUNTS;
        // A drive that can't give torque reports nothing, so control does not engage: not during a store either, at whose end the
        // torque of an engaged assist would begin with a step.
        let able = matches!(report.mode, Mode::Ready | Mode::Running)
            && !report.gate_fault
            && !report.off
            && !is_held();
        SensorFrame {
            now_us: now.as_micros() as u32,
            gyro_rad_s: Triple { value: self.gyro.0, age_ticks: self.gyro.1.now() },
            accel_m_s2: Triple { value: self.accel.0, age_ticks: self.accel.1.now() },
            steer_rad: newest(&mut self.steer, STEER_RAD.value(report.steer).filter(|_| running)),
            steer_rate_rad_s: Sample {
                value: report.steer_rate_rad_s,
                age_ticks: self.steer_rate.step(running && fresh(&report)),
            },
            front_wheel_m_s: front,
            rear_wheel_m_s: rear,
            rider_torque_nm: newest(&mut self.rider, RIDER_NM.value(report.rider_torque).filter(|_| running)),
            motor_torque_nm: Sample { value: report.torque_nm, age_ticks: self.torque.step(running && able) },
            engage: self.switch.step(closed && running, SWITCH_TICKS),
            ..SensorFrame::missing()
        }
    }

    fn read_imu(&mut self) {
        let newest = self.imu.as_mut().map(imu::newest);
        // An IMU whose clock stops, or a stuck line, gives no new samples.
        let newest = newest.filter(|sample| sample.time != self.imu_time);
        self.gyro.1.step(newest.is_some_and(|sample| sample.gyro_new));
        self.accel.1.step(newest.is_some_and(|sample| sample.accel_new));
        if let Some(sample) = newest {
            self.imu_time = sample.time;
            (self.gyro.0, self.accel.0) = (sample.gyro_rad_s, sample.accel_m_s2);
        }
    }
}

/// Whether the encoder's angle is within the motor loop's timeout.
fn fresh(report: &Report) -> bool {
    report.encoder_age <= devices::vesc6::MOTOR.encoder.timeout_calls
}

/// The newest value and its age; the stored value stays without a new one.
fn newest(remembered: &mut (f32, Age), new: Option<f32>) -> Sample {
    let age_ticks = remembered.1.step(new.is_some());
    remembered.0 = new.unwrap_or(remembered.0);
    Sample { value: remembered.0, age_ticks }
}
