//! The nonlinear bicycle as a model: torques and a lateral force in, its motion and the exact sensors' values out.

use crate::controller::signal_variables;
use crate::model::{from_bytes, to_bytes};
use crate::setup::Setup;
use crate::variable::{Kind, Role, Variable};
use motion::bicycle::{ForcePoint, Geometry, KEYS, Parameters, RANGES};
use motion::plant::{ActuatorConfig, Plant, Sensor};
use motion::ride::{Applied, Assist, Conditions, Start, SteppedBicycle};

/// The sensors that the bicycle has; the rider's torque is an input.
fn sensors() -> impl Iterator<Item = Sensor> {
    Sensor::ALL.into_iter().filter(|sensor| *sensor != Sensor::RiderTorque)
}

pub(crate) fn variables(parameters: &Parameters, start: &Start, point: &ForcePoint) -> Vec<Variable> {
    let of_paper = KEYS.iter().zip(RANGES).zip(parameters.to_values());
    let mut all: Vec<_> = of_paper
        .map(|((key, (unit, min, max)), value)| {
            Variable::real(Role::Parameter, key, unit, "parameter of Meijaard et al. 2007")
                .starting(value)
                .within(min, max)
        })
        .collect();
    let parameter = |name, unit, about, value, most: f64| {
        Variable::real(Role::Parameter, name, unit, about).starting(value).within(-most, most)
    };
    all.extend([
        parameter("start_speed_m_s", "m/s", "forward speed at the start", start.speed_m_s, 30.0),
        parameter(
            "start_steer_rate_rad_s",
            "rad/s",
            "steer rate at the start",
            start.steer_rate_rad_s,
            100.0,
        ),
        parameter("start_roll_rate_rad_s", "rad/s", "roll rate at the start", start.roll_rate_rad_s, 100.0),
        parameter(
            "force_ahead_m",
            "m",
            "point of the lateral force: ahead of the rear contact",
            point.ahead_m,
            5.0,
        ),
        parameter("force_height_m", "m", "point of the lateral force: above the ground", point.height_m, 5.0),
    ]);
    let input = |name, unit, about| Variable::real(Role::Input, name, unit, about);
    all.extend([
        input("assist_torque_nm", "N m", "torque of the motor on the steer axis, right positive"),
        input(
            "rider_torque_nm",
            "N m",
            "the rider's torque on the handlebar at the start of a step, right positive",
        ),
        input("rider_torque_rate_nm_s", "N m/s", "its rate over the step"),
        input(
            "roll_torque_nm",
            "N m",
            "torque on the rear frame about the heading line through the rear contact, right positive",
        ),
        input(
            "lateral_force_n",
            "N",
            "force on the rear frame across the rear wheel's heading, right positive",
        ),
    ]);
    let output = |name, unit, about| Variable::real(Role::Output, name, unit, about);
    all.extend([
        output("roll_rad", "rad", "roll angle, right positive"),
        output("pitch_rad", "rad", "pitch angle"),
        output("roll_rate_rad_s", "rad/s", "roll rate"),
        output("yaw_rate_rad_s", "rad/s", "yaw rate"),
        output(
            "rear_wheel_rate_rad_s",
            "rad/s",
            "rear wheel's rate relative to the rear frame, negative forward",
        ),
        output("roll_acceleration_rad_s2", "rad/s^2", "roll acceleration under the present inputs").direct(),
        output("steer_acceleration_rad_s2", "rad/s^2", "steer acceleration under the present inputs")
            .direct(),
        output("front_lateral_m", "m", "lateral deviation of the front contact from the line of the start"),
    ]);
    all.extend(sensors().flat_map(|sensor| signal_variables(Role::Output, sensor)));
    let fallen = "whether the bicycle has fallen: from then on it stays as it was";
    all.push(Variable::of_kind(Kind::Boolean, Role::Output, "fallen", fallen));
    all.push(output("time_to_fall_s", "s", "time from the start to the fall; 0 before"));
    all
}

/// What acts, from the values of the inputs.
fn applied(inputs: &[f64]) -> Applied {
    let &[assist_nm, rider_nm, rider_rate_nm_s, roll_nm, lateral_force_n] = inputs else {
        return Applied::default();
    };
    Applied { assist_nm, rider_nm, rider_rate_nm_s, roll_nm, lateral_force_n }
}

/// The bicycle.
#[derive(Clone, Debug)]
pub(crate) struct Bicycle {
    conditions: Conditions,
    point: ForcePoint,
    bicycle: Option<SteppedBicycle>,
}

impl Bicycle {
    /// From its setup; `None` for another model's.
    pub(crate) fn new(setup: &Setup) -> Option<Self> {
        let Setup::Bicycle {
            parameters,
            force_point,
            imu,
            imu_point_m,
            friction,
            stop,
            fall,
            step_s,
            time_limit_s,
            ..
        } = setup
        else {
            return None;
        };
        let actuator = ActuatorConfig { friction: *friction, stop: *stop, ..ActuatorConfig::default() };
        let mut plant = Plant { actuator, ..Plant::default() };
        plant.sensors.imu.point_m = *imu_point_m;
        let conditions = Conditions {
            imu: *imu,
            plant,
            fall: *fall,
            time_limit_s: *time_limit_s,
            step_s: *step_s,
            ..Conditions::thesis(Geometry::new(parameters), Assist::None)
        };
        Some(Self { conditions, point: *force_point, bicycle: None })
    }

    pub(crate) fn begin(&mut self, values: &[f64]) -> Result<(), String> {
        let missing = || "parameters are missing".to_owned();
        let (parameters, rest) = values.split_first_chunk::<26>().ok_or_else(missing)?;
        let &[speed_m_s, steer_rate_rad_s, roll_rate_rad_s, ahead_m, height_m] = rest else {
            return Err(missing());
        };
        self.conditions.bicycle = Geometry::new(&Parameters::from_values(parameters));
        self.conditions.check().map_err(|e| e.to_string())?;
        self.point = ForcePoint { ahead_m, height_m };
        let start = Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s };
        self.bicycle = Some(SteppedBicycle::new(&self.conditions, &start));
        Ok(())
    }

    /// One time step; returns a fall in it, in words.
    pub(crate) fn step(&mut self, inputs: &[f64]) -> Option<String> {
        let bicycle = self.bicycle.as_mut()?;
        let before = bicycle.fall();
        let applied = applied(inputs);
        bicycle.step(&self.conditions, self.point, &applied);
        let (time_s, by) = bicycle.fall().filter(|_| before.is_none())?;
        Some(format!("fallen after {time_s:.6} s: {}", by.name()))
    }

    /// Roll and steer acceleration under these inputs.
    pub(crate) fn accelerations(&self, inputs: &[f64]) -> [f64; 2] {
        let accelerations =
            |now: &SteppedBicycle| now.accelerations_rad_s2(&self.conditions, self.point, &applied(inputs));
        self.bicycle.as_ref().map_or([0.0; 2], accelerations)
    }

    pub(crate) fn outputs(&self, to: &mut [f64]) {
        let Some(bicycle) = &self.bicycle else { return };
        let now = bicycle.now();
        let ([roll, _, pitch], [roll_rate, _]) = (now.angles_rad, now.rates_rad_s);
        let motion = [
            roll,
            pitch,
            roll_rate,
            now.yaw_rate_rad_s,
            now.rear_wheel_rate_rad_s,
            // The accelerations, which depend on the inputs: `accelerations`.
            0.0,
            0.0,
            now.front_lateral_m,
        ];
        let measured = sensors().flat_map(|sensor| {
            let (names, ..) = crate::controller::signals(sensor);
            now.reading.of(sensor).into_iter().take(names.len())
        });
        let fall = bicycle.fall().map(|(time_s, _)| time_s);
        let ended = [f64::from(u8::from(fall.is_some())), fall.unwrap_or(0.0)];
        to.iter_mut()
            .zip(motion.into_iter().chain(measured).chain(ended))
            .for_each(|(to, value)| *to = value);
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        to_bytes(&self.bicycle)
    }

    pub(crate) fn load(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.bicycle = from_bytes(bytes)?;
        Ok(())
    }
}
