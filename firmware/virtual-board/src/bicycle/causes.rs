//! Causes of differences between board and simulator, each with the simulator's model of it.
//!
//! The numbers are those of the board's configuration, not fitted to rides.

use super::rides::{PERIOD_S, Reason};
use crate::power;
use devices::vesc6::{MOTOR, SHUNT, STEER_RAD};
use sim_host::plant::{self, Sensor, Supply};
use sim_host::ride::Conditions;
use std::f64::consts::TAU;

/// Properties of the board that the exact simulator lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Rotor inertia behind the gear.
    Rotor,
    /// Friction of steer bearing and gear.
    Friction,
    /// Current loop: its bandwidth, and its delay from a sample to the resulting duty cycles.
    CurrentLoop,
    /// Bus transfers and the control step, from the release to the command: most of a period.
    Computing,
    /// Largest torque of the drive.
    Limit,
    /// Supply voltage against winding resistance and back-EMF.
    Supply,
    /// The drive reports measured currents in counts, which vary even at its limit.
    Report,
    /// Resolution of the IMU; its samples are up to a period old when read.
    Imu,
    /// Resolution of the steer sensor.
    Steer,
    /// Tracking loop of the encoder, two poles.
    SteerRate,
    /// Wheel speed is measured at pulses, as the mean since the previous one.
    Wheels,
}

impl Cause {
    /// All causes.
    pub const ALL: [Self; 11] = [
        Self::Rotor,
        Self::Friction,
        Self::CurrentLoop,
        Self::Computing,
        Self::Limit,
        Self::Supply,
        Self::Report,
        Self::Imu,
        Self::Steer,
        Self::SteerRate,
        Self::Wheels,
    ];

    /// Description, and its model in the simulator.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rotor => "rotor behind the gear (inertia on the steer)",
            Self::Friction => "friction of the Davis bicycle (`--actuator davis`)",
            Self::CurrentLoop => "current loop (first order, 1/bandwidth and 1.5 calls)",
            Self::Computing => "buses and control step (first order, 0.5 ms)",
            Self::Limit => "largest torque of the drive",
            Self::Supply => "supply, winding, back-EMF",
            Self::Report => "motor's report: white noise of a count of the current",
            Self::Imu => "IMU: counts, a period late",
            Self::Steer => "steer sensor: counts",
            Self::SteerRate => "steer rate: tracking loop, a period late",
            Self::Wheels => "wheels: a sample each pulse, half a pulse late",
        }
    }

    /// Enables the cause in the simulator, for a ride at this speed \[m/s\].
    ///
    /// # Errors
    /// The built-in friction is missing.
    pub fn act(self, conditions: &mut Conditions, speed_m_s: f64) -> Result<(), Reason> {
        let Conditions { bicycle, plant, .. } = conditions;
        let (sensors, actuator) = (&mut plant.sensors, &mut plant.actuator);
        match self {
            Self::Rotor => bicycle.rotor_kg_m2 = power::ROTOR_KG_M2,
            Self::Friction => actuator.friction = plant::catalogue::load("davis")?.friction,
            Self::CurrentLoop => {
                let answered_s = f64::from(motor::config::DELAY_TICKS / MOTOR.rate_hz);
                actuator.time_constant_s += 1.0 / (TAU * f64::from(MOTOR.current.bandwidth_hz)) + answered_s;
            }
            Self::Computing => actuator.time_constant_s += 0.5 * PERIOD_S,
            Self::Limit => actuator.limit_nm = Some(MOTOR.demand.max_nm.into()),
            Self::Supply => actuator.supply = Some(supply()),
            Self::Report => {
                let rounding_a = f64::from(SHUNT.ampere_per_count()) / 12.0_f64.sqrt();
                sensors.model_mut(Sensor::MotorReport).noise = torque_nm_a() * rounding_a;
            }
            Self::Imu => {
                let counts = [
                    (Sensor::Gyro, devices::bmi160::RAD_S_PER_COUNT),
                    (Sensor::Accel, devices::bmi160::M_S2_PER_COUNT),
                ];
                for (sensor, count) in counts {
                    let model = sensors.model_mut(sensor);
                    (model.quantum, model.delay_ticks) = (count.into(), 1);
                }
            }
            Self::Steer => {
                let counts = f64::from(STEER_RAD.most_counts - STEER_RAD.least_counts);
                sensors.model_mut(Sensor::Steer).quantum =
                    f64::from(STEER_RAD.value_at_most_counts - STEER_RAD.value_at_least_counts) / counts;
            }
            Self::SteerRate => {
                let late_s = 2.0 / (TAU * f64::from(MOTOR.encoder.tracking_hz));
                sensors.model_mut(Sensor::SteerRate).delay_ticks = (late_s / PERIOD_S).round() as u16;
            }
            Self::Wheels => {
                let wheel = devices::vesc6::wheel();
                let distance_m = TAU * f64::from(wheel.radius_m) / f64::from(wheel.pulses_per_turn);
                let ticks = (distance_m / speed_m_s / PERIOD_S).round() as u16;
                for sensor in [Sensor::FrontWheel, Sensor::RearWheel] {
                    let model = sensors.model_mut(sensor);
                    (model.every_ticks, model.delay_ticks) = (ticks, ticks / 2);
                }
            }
        }
        Ok(())
    }
}

/// Steer torque per q current \[N m/A\].
fn torque_nm_a() -> f64 {
    MOTOR.motor.torque_nm_a().into()
}

/// Winding and supply of the example at the steer axis.
fn supply() -> Supply {
    // Largest phase voltage per bus voltage: 1 / sqrt(3) for the circle; 1.5 for three phases.
    let reach = f64::from(MOTOR.bridge.duty_max - MOTOR.bridge.duty_min) / 3.0_f64.sqrt();
    // Torque k i of the phase current i = (v - w flux) / R, as a machine with the voltage constant k.
    Supply {
        voltage_v: 1.5 * reach * power::SOURCE_V,
        resistance_ohm: 1.5 * f64::from(MOTOR.motor.resistance_ohm),
        constant_nm_a: torque_nm_a(),
    }
}
