//! Ride of the virtual board on the bicycle of `sim-host`.
//!
//! The simulator uses the board as its controller and motor ([`Remote`]): in every step its exact sensor values are
//! applied to the sensor pins, the image runs, and the motor's mean torque over the step acts on the steer. Bicycle,
//! rider delay, warm start and fall detection are the simulator's own. Within a step the steer turns at the rate
//! predicted for its middle, and the IMU's rates are extrapolated.

pub mod border;
pub mod causes;
pub mod compare;
mod display;
pub mod rides;
pub mod wheel;

pub use display::Display;
pub use wheel::{Edge, Wheel};

use crate::parts::bmi160::Motion;
use crate::wiring::Wiring;
use crate::{Bench, Error, Options, parameters, power};
use control::{Plan, SensorFrame};
use sim_host::ride::{Conditions, Remote, RemoteError, Start, Stepped};
use std::path::PathBuf;

/// Longest time of the board from power-on to standby \[s\].
const BOOT_S: f64 = 3.0;

/// The board on the bicycle, powered on for each ride.
pub struct OnBicycle {
    image: PathBuf,
    options: Options,
    step_s: f64,
    gravity_m_s2: f64,
    ride: Option<Ride>,
}

/// The present ride.
struct Ride {
    bench: Bench,
    display: Display,
    wheels: [Wheel; 2],
    /// Start of the step after power-on \[ns\].
    at_ns: u64,
    /// Sensor values of the previous step; `None` if rates have jumped since.
    before: Option<Sensed>,
}

/// Sensor values at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sensed {
    gyro_rad_s: [f64; 3],
    accel_m_s2: [f64; 3],
    steer_rad: f64,
    steer_rate_rad_s: f64,
    /// Front, rear.
    wheels_m_s: [f64; 2],
    engage: bool,
}

impl Sensed {
    fn of(frame: &SensorFrame) -> Self {
        Self {
            gyro_rad_s: frame.gyro_rad_s.value.map(f64::from),
            accel_m_s2: frame.accel_m_s2.value.map(f64::from),
            steer_rad: frame.steer_rad.value.into(),
            steer_rate_rad_s: frame.steer_rate_rad_s.value.into(),
            wheels_m_s: [frame.front_wheel_m_s.value.into(), frame.rear_wheel_m_s.value.into()],
            engage: frame.engage,
        }
    }

    /// Straight, upright and steady riding.
    fn steady(speed_m_s: f64, gravity_m_s2: f64) -> Self {
        Self {
            gyro_rad_s: [0.0; 3],
            accel_m_s2: [0.0, 0.0, -gravity_m_s2],
            steer_rad: 0.0,
            steer_rate_rad_s: 0.0,
            wheels_m_s: [speed_m_s; 2],
            engage: false,
        }
    }
}

impl OnBicycle {
    /// A board with this image; the bicycle is that of the conditions, with the loop's time step.
    pub fn new(image: PathBuf, options: Options, conditions: &Conditions) -> Self {
        Self { image, options, step_s: conditions.step_s, gravity_m_s2: conditions.bicycle.g, ride: None }
    }

    /// The board of the present or last ride.
    pub fn bench(&mut self) -> Option<&mut Bench> {
        self.ride.as_mut().map(|ride| &mut ride.bench)
    }

    /// Last broadcasts of the board.
    pub fn display(&self) -> Display {
        self.ride.as_ref().map_or(Display::default(), |ride| ride.display)
    }
}

impl Remote for OnBicycle {
    /// Powers the board on during a steady ride, and waits until its controller is in standby with only the switch
    /// open. The wheels, which turn at power-on, must have become valid.
    fn begin(&mut self, plan: &Plan, start: &Start) -> Result<(), RemoteError> {
        let failed = |reason: String| RemoteError(reason.into());
        let mut wiring = Wiring::new();
        wiring.power.set_axis(power::Axis::Driven);
        wiring.can.network.node = true;
        let parameters = parameters::stored(plan.config(), wiring.power.offset_turns())
            .map_err(|e| failed(format!("{e:?}")))?;
        let bench = Bench::power_on_with_store(&self.image, self.options, wiring, Some(&parameters))
            .map_err(|e| failed(e.to_string()))?;
        let mut ride = Ride {
            bench,
            display: Display::default(),
            wheels: [Wheel::default(); 2],
            at_ns: 0,
            before: None,
        };
        let steady = Sensed::steady(start.speed_m_s, self.gravity_m_s2);
        while !ride.display.waits_for_the_switch() {
            ride.step(&steady, self.step_s).map_err(|e| failed(e.to_string()))?;
            if ride.at_ns as f64 * 1e-9 > BOOT_S {
                return Err(failed(format!("not in standby {BOOT_S} s after power-on: {:?}", ride.display)));
            }
        }
        self.ride = Some(ride);
        Ok(())
    }

    fn disturb(&mut self) {
        if let Some(ride) = &mut self.ride {
            ride.before = None;
        }
    }

    fn step(&mut self, frame: &SensorFrame) -> Result<Stepped, RemoteError> {
        let ride = self.ride.as_mut().ok_or(RemoteError("no ride was begun".into()))?;
        let torque_nm =
            ride.step(&Sensed::of(frame), self.step_s).map_err(|e| RemoteError(e.to_string().into()))?;
        Ok(ride.display.stepped(torque_nm))
    }
}

impl Ride {
    /// One step of the loop; returns the mean motor torque on the steer \[N m\].
    fn step(&mut self, now: &Sensed, step_s: f64) -> Result<f64, Error> {
        let before = self.before.replace(*now).unwrap_or(*now);
        let slope = |is: f64, was: f64| (is - was) / step_s;
        let slopes = |is: [f64; 3], was: [f64; 3]| [0, 1, 2].map(|axis: usize| slope(is[axis], was[axis]));
        let middle = |is: f64, was: f64| is + 0.5 * (is - was);

        let (at_ns, now) = (self.at_ns, *now);
        let rate_rad_s = middle(now.steer_rate_rad_s, before.steer_rate_rad_s);
        let accel_slope = slopes(now.accel_m_s2, before.accel_m_s2);
        // The reading is the mean over the step that ends here.
        let accel = [0, 1, 2].map(|axis: usize| middle(now.accel_m_s2[axis], before.accel_m_s2[axis]));
        let gyro_slope = slopes(now.gyro_rad_s, before.gyro_rad_s);
        self.bench.with(move |board| {
            let wiring = &mut board.chip.wiring;
            wiring.power.drive(now.steer_rad, rate_rad_s);
            wiring.analog.switch_closed = now.engage;
            wiring.imu.moves(Motion {
                at_ns,
                values: [now.gyro_rad_s, accel],
                slopes: [gyro_slope, accel_slope],
            });
        });

        let mut edges = Vec::new();
        for (number, wheel) in self.wheels.iter_mut().enumerate() {
            let speed_m_s = middle(now.wheels_m_s[number], before.wheels_m_s[number]);
            edges.extend(wheel.roll(speed_m_s, step_s).into_iter().map(|edge| (number, edge)));
        }
        edges.sort_by(|(_, a), (_, b)| a.after_s.total_cmp(&b.after_s));
        for (number, edge) in edges {
            self.bench.run_until_ns(at_ns + (edge.after_s * 1e9) as u64)?;
            wheel::line(&mut self.bench, number, edge.high);
        }
        self.at_ns += (step_s * 1e9).round() as u64;
        self.bench.run_until_ns(self.at_ns)?;
        let (torque_nm, frames) = self.bench.with(move |board| {
            let wiring = &mut board.chip.wiring;
            (wiring.power.take_mean_torque_nm(step_s), std::mem::take(&mut wiring.can.network.received))
        });
        self.display.take(&frames);
        Ok(torque_nm)
    }
}
