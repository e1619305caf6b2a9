//! The flashed control step as a model: the sensors' samples in, the torque with mode, limits and causes out.

use crate::parameters;
use crate::variable::{Kind, Role, Variable};
use control::law::gain_schedule::GainSchedule;
use control::wire::{CONFIG_BYTES, decode_config};
use control::{CAUSES, Command, Config, LIMITS, Law, Mode, Plan, State, step};
use motion::plant::{Held, Measured, Sensor};
use motion::ride::{Engaged, clock_us, engaged, frame_of};
use std::sync::LazyLock;

/// Names of the modes, by their number.
static MODES: LazyLock<Vec<&str>> =
    LazyLock::new(|| (0..).map_while(Mode::numbered).map(Mode::name).collect());

/// Variables of a sensor's values: names, unit, meaning.
pub(crate) fn signals(sensor: Sensor) -> (&'static [&'static str], &'static str, &'static str) {
    match sensor {
        Sensor::Gyro => {
            (&["gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"], "rad/s", "angular velocity of the rear frame")
        }
        Sensor::Accel => (
            &["accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"],
            "m/s^2",
            "specific force at the IMU, mean over the last period",
        ),
        Sensor::Steer => (&["steer_rad"], "rad", "steer angle, right positive"),
        Sensor::SteerRate => (&["steer_rate_rad_s"], "rad/s", "steer rate"),
        Sensor::FrontWheel => (
            &["front_wheel_m_s"],
            "m/s",
            "rotation rate of the front wheel times its radius, forward positive",
        ),
        Sensor::RearWheel => {
            (&["rear_wheel_m_s"], "m/s", "rotation rate of the rear wheel times its radius, forward positive")
        }
        Sensor::RiderTorque => {
            (&["rider_torque_nm"], "N m", "the rider's torque on the handlebar, right positive")
        }
        Sensor::MotorReport => (&["motor_torque_nm"], "N m", "torque that the drive reports"),
        Sensor::Path => (&["heading_rad", "lateral_m"], "", "deviation from the path, right positive"),
    }
}

/// Variables of the values of a sensor.
pub(crate) fn signal_variables(role: Role, sensor: Sensor) -> impl Iterator<Item = Variable> {
    let (names, unit, about) = signals(sensor);
    names.iter().map(move |name| {
        let unit = match *name {
            "heading_rad" => "rad",
            "lateral_m" => "m",
            _ => unit,
        };
        Variable::real(role, name, unit, about)
    })
}

/// The configuration from hexadecimal digits.
pub(crate) fn decoded(digits: &str) -> Result<Config, String> {
    let pairs = (0..digits.len() / 2)
        .map(|i| digits.get(2 * i..2 * i + 2).and_then(|pair| u8::from_str_radix(pair, 16).ok()));
    let bytes: Option<Vec<u8>> = pairs.collect();
    let bytes = bytes.and_then(|bytes| <[u8; CONFIG_BYTES]>::try_from(bytes).ok());
    let bytes = bytes
        .ok_or_else(|| format!("the configuration is not {CONFIG_BYTES} bytes in hexadecimal digits"))?;
    decode_config(&bytes).map_err(|e| e.to_string())
}

/// All variables; `speed_m_s` is that of the warm start, `g_m_s2` gravity.
pub(crate) fn variables(config: &Config, speed_m_s: f64, g_m_s2: f64) -> Vec<Variable> {
    let mut all = parameters::declared(config);
    all.extend(parameters::law_variables(&config.law));
    all.push(
        Variable::of_kind(
            Kind::Boolean,
            Role::Parameter,
            "start_engaged",
            "booted and engaged in steady riding before the start; otherwise the start is the boot",
        )
        .starting(1.0),
    );
    all.push(
        Variable::real(Role::Parameter, "start_speed_m_s", "m/s", "speed of that steady riding")
            .starting(speed_m_s)
            .within(0.0, 30.0),
    );
    for sensor in Sensor::ALL {
        let steady = |name: &str| match name {
            "accel_z_m_s2" => -g_m_s2,
            "front_wheel_m_s" | "rear_wheel_m_s" => speed_m_s,
            _ => 0.0,
        };
        all.extend(signal_variables(Role::Input, sensor).map(|variable| {
            let start = steady(&variable.name);
            variable.starting(start)
        }));
        let name = sensor.name().replace('-', "_");
        let about = "control periods since the sample arrived; 65535: no sample";
        all.push(
            Variable::of_kind(Kind::Integer, Role::Input, &format!("{name}_age_ticks"), about)
                .within(0.0, 65535.0),
        );
    }
    all.push(Variable::of_kind(Kind::Boolean, Role::Input, "engage", "the rider's switch").starting(1.0));
    all.push(Variable::real(
        Role::Output,
        "assist_torque_nm",
        "N m",
        "torque of the motor on the steer axis until the next step, right positive",
    ));
    all.push(Variable::real(Role::Output, "gain_nm_s_rad", "N m s/rad", "gain of the law"));
    all.push(Variable::of_kind(Kind::Choice(&MODES), Role::Output, "mode", "mode of the controller"));
    let limits = LIMITS.map(|named| named.name).join(", ");
    let limits = format!("limits that changed the torque, bits from 0: {limits}");
    all.push(Variable::of_kind(Kind::Integer, Role::Output, "limits", &limits));
    all.push(Variable::of_kind(
        Kind::Integer,
        Role::Output,
        "causes_low",
        "causes with the codes 0 to 31, as bits",
    ));
    all.push(Variable::of_kind(
        Kind::Integer,
        Role::Output,
        "causes_high",
        "causes with the codes from 32 on, as bits",
    ));
    all.extend(CAUSES.iter().map(|cause| {
        Variable::of_kind(Kind::Boolean, Role::Output, &format!("cause_{}", cause.name()), cause.meaning())
    }));
    all
}

/// The controller.
#[derive(Clone, Debug)]
pub(crate) struct Controller {
    config: Config,
    g_m_s2: f64,
    running: Option<(Plan, Engaged)>,
}

/// A serialized state.
#[derive(bitcode::Encode, bitcode::Decode)]
struct Stored {
    state: State,
    ticks: u32,
    command: Command,
}

impl Controller {
    pub(crate) fn new(configuration: &str, g_m_s2: f64) -> Result<Self, String> {
        Ok(Self { config: decoded(configuration)?, g_m_s2, running: None })
    }

    /// Boots with the parameters, and engages if they say so.
    pub(crate) fn begin(&mut self, values: &[f64]) -> Result<(), String> {
        let (table, last) = values.split_at(values.len() - 4);
        let &[law, slope, warm, speed_m_s] = last else { return Err("parameters are missing".into()) };
        let mut config = self.config.clone();
        parameters::set(&mut config, table);
        let points = match &self.config.law {
            Law::Table(points) => points.clone(),
            _ => GainSchedule::default(),
        };
        config.law = Law::numbered(law as u8, slope as f32, points).unwrap_or_default();
        let plan = config.plan().map_err(|e| e.to_string())?;
        let start = if warm == 1.0 { engaged(&plan, speed_m_s, self.g_m_s2) } else { Engaged::boot() };
        self.running = Some((plan, start));
        Ok(())
    }

    /// One control period.
    pub(crate) fn step(&mut self, inputs: &[f64]) {
        let Some((plan, now)) = &mut self.running else { return };
        let mut inputs = inputs.iter().copied();
        let mut next = || inputs.next().unwrap_or(f64::NAN);
        let held = Sensor::ALL.map(|sensor| {
            let mut value = [0.0; 3];
            let (names, ..) = signals(sensor);
            value.iter_mut().take(names.len()).for_each(|value| *value = next());
            Held { value, age_ticks: next() as u16 }
        });
        let frame = frame_of(plan, &Measured::new(held, clock_us(plan, now.ticks), next() == 1.0));
        now.command = step(plan, &mut now.state, &frame);
        now.ticks = now.ticks.wrapping_add(1);
    }

    pub(crate) fn outputs(&self, to: &mut [f64]) {
        let Some((_, now)) = &self.running else { return };
        let Command { torque_nm, gain_nm_s_rad, limits, mode, causes } = now.command;
        let [low, high] =
            [causes.0 as u32, (causes.0 >> 32) as u32].map(|bits| f64::from(bits.cast_signed()));
        let numbers = [
            f64::from(torque_nm),
            f64::from(gain_nm_s_rad),
            f64::from(mode as u8),
            f64::from(limits.0),
            low,
            high,
        ];
        let present = CAUSES.iter().map(|cause| f64::from(u8::from(causes.has(*cause))));
        to.iter_mut().zip(numbers.into_iter().chain(present)).for_each(|(to, value)| *to = value);
    }

    /// The state; its size does not grow with the time.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        self.running.as_ref().map_or_else(Vec::new, |(_, now)| {
            let Engaged { state, ticks, command } = now.clone();
            bitcode::encode(&Stored { state, ticks, command })
        })
    }

    /// Restores a state; [`Controller::begin`] has been called.
    pub(crate) fn load(&mut self, bytes: &[u8]) -> Result<(), String> {
        let decoded =
            bitcode::decode(bytes).map_err(|e| format!("the controller's state can't be decoded: {e}"));
        let Stored { state, ticks, command } = decoded?;
        let Some((_, now)) = &mut self.running else { return Err("the controller has not begun".into()) };
        *now = Engaged { state, ticks, command };
        Ok(())
    }
}
