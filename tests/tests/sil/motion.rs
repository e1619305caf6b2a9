//! The largest motion inside the basins, and the limits that must permit it.

use control::estimate::EstimateConfig;
use control::sensors::cross_check::{CrossCheckConfig, CrossCheckPlan, on_the_ground};
use control::{Config, Sensor};
use rayon::prelude::*;
use sim_host::bicycle::Geometry;
use sim_host::plant::Plant;
use sim_host::ride::{Conditions, Start, TracePoint, traced};
use tests::inside::{Border, borders, sensed, unchecked, with};
use toml::Table;

/// Ridden fractions of the height, for 4 s.
const PARTS: [f64; 3] = [0.4, 0.7, 0.99];
/// Time until which a change counts as part of the disturbance \[s\].
const BLOW_S: f64 = 0.05;
/// Largest part by which the table may exceed the ridden motion.
const SLACK: f64 = 0.03;

/// Recorded quantities: each sensor's values by its axes, and the residuals of the cross-checks.
const QUANTITIES: [&str; 14] = [
    "gyro_x",
    "gyro_y",
    "gyro_z",
    "accel_x",
    "accel_y",
    "accel_z",
    "steer",
    "steer_rate",
    "front_wheel",
    "rear_wheel",
    "wheels_unexplained",
    "yaw_unexplained",
    "steer_unexplained",
    "roll",
];

/// Of these, how many are sensors' axes.
const SENSED: usize = 10;

/// The largest of one quantity.
#[derive(Clone, Copy, Debug, Default)]
struct Largest {
    value: f64,
    /// In a control period of the first 50 ms, the disturbance included.
    step: f64,
    /// Per second after that.
    slope_per_s: f64,
}

impl Largest {
    fn or(self, other: Self) -> Self {
        Self {
            value: self.value.max(other.value),
            step: self.step.max(other.step),
            slope_per_s: self.slope_per_s.max(other.slope_per_s),
        }
    }
}

type Record = [Largest; QUANTITIES.len()];

/// The quantities at one control instant; `summed` is the steer angle as summed up by the steer check.
fn quantities(b: &Geometry, p: &TracePoint, summed: &mut f32) -> [f64; QUANTITIES.len()] {
    let frame = &p.frame;
    let ([gx, gy, gz], [ax, ay, az]) = (frame.gyro_rad_s.value, frame.accel_m_s2.value);
    let (steer, rate) = (frame.steer_rad.value, frame.steer_rate_rad_s.value);
    let (front, rear) = (frame.front_wheel_m_s.value, frame.rear_wheel_m_s.value);
    // As compared by `control::sensors::cross_check`.
    let (sin_roll, cos_roll) = (p.roll as f32).sin_cos();
    let cross =
        CrossCheckConfig { wheelbase_m: b.w as f32, tilt_rad: b.lam as f32, ..CrossCheckConfig::default() };
    let (sin, cos) = on_the_ground(
        &CrossCheckPlan::new(&cross, &EstimateConfig::default().balance, 1000.0),
        (sin_roll, cos_roll),
        steer,
    );
    let yaw = gy * sin_roll + gz * cos_roll - front * sin / b.w as f32;
    let turned = steer - (*summed + rate * 1e-3);
    *summed = steer - turned * (1.0 - 1.0 / 256.0);
    let roll = p.roll as f32;
    let all = [gx, gy, gz, ax, ay, az, steer, rate, front, rear, front * cos - rear, yaw, turned, roll];
    all.map(f64::from)
}

/// Record of a ride.
fn recorded(conditions: &Conditions, start: Start) -> Record {
    let b = &conditions.bicycle;
    let (ride, trace) = traced(conditions, start);
    assert!(!ride.fell(), "{start:?} falls");
    let v = start.speed_m_s;
    let mut before = [0.0, 0.0, 0.0, 0.0, 0.0, -b.g, 0.0, 0.0, v, v, 0.0, 0.0, 0.0, 0.0];
    let mut summed = 0.0;
    let mut record = Record::default();
    for p in &trace {
        let now = quantities(b, p, &mut summed);
        for ((largest, now), before) in record.iter_mut().zip(now).zip(before) {
            let change = (now - before).abs();
            let (step, slope_per_s) = if p.t <= BLOW_S { (change, 0.0) } else { (0.0, 1e3 * change) };
            *largest = largest.or(Largest { value: now.abs(), step, slope_per_s });
        }
        before = now;
    }
    record
}

/// The largest of all rides, in the order of [`QUANTITIES`].
fn ridden() -> Record {
    let rides: Vec<(&Border, f64)> = borders().iter().flat_map(|b| PARTS.map(|part| (b, part))).collect();
    rides
        .into_par_iter()
        .map(|(border, part)| {
            let conditions = with(border.rider, sensed(unchecked(), Plant::default()));
            recorded(&Conditions { time_limit_s: 4.0, ..conditions }, border.start(part))
        })
        .reduce(Record::default, |a, b| std::array::from_fn(|i| a[i].or(b[i])))
}

fn table() -> Table {
    include_str!("../../../data/motion.toml").parse().expect("data/motion.toml is valid TOML")
}

fn number(table: &Table, group: &str, key: &str) -> Option<f64> {
    table.get(group)?.get(key)?.as_float()
}

/// Situation: rides in the basins of h, without a rider and with riders, at parts of the height up to the border; no
/// limit, no check.
/// Action: record the largest motion.
/// Must hold: nothing is larger than in the table, nor smaller by more than 3 %.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn the_table_is_the_largest_motion() {
    let table = table();
    let mut wrong = Vec::new();
    for (i, (quantity, ridden)) in QUANTITIES.into_iter().zip(ridden()).enumerate() {
        let keys = [("largest", ridden.value), ("step", ridden.step), ("slope_per_s", ridden.slope_per_s)];
        // Only sensor values have a limit on their change.
        let limited = if i < SENSED { 3 } else { 1 };
        for (key, ridden) in keys.into_iter().take(limited) {
            let Some(stated) = number(&table, quantity, key) else {
                wrong.push(format!("{quantity}.{key} is missing, ridden {ridden:.5}"));
                continue;
            };
            if ridden > stated || ridden < (1.0 - SLACK) * stated {
                wrong.push(format!("{quantity}.{key} = {stated}, ridden {ridden:.5}"));
            }
        }
    }
    assert!(wrong.is_empty(), "data/motion.toml:\n{}", wrong.join("\n"));
}

/// Situation: the flashed limits.
/// Action: compare.
/// Must hold: each is above the largest motion by the table's margin.
#[test]
fn every_limit_lies_above_the_motion() {
    let (table, config) = (table(), Config::product());
    let (input, cross) = (&config.input, &config.cross);
    let mut limits = Vec::new();
    let sensors: [(&Sensor, &[&str]); 6] = [
        (&input.gyro, &["gyro_x", "gyro_y", "gyro_z"]),
        (&input.accel, &["accel_x", "accel_y", "accel_z"]),
        (&input.steer, &["steer"]),
        (&input.steer_rate, &["steer_rate"]),
        (&input.front_wheel, &["front_wheel"]),
        (&input.rear_wheel, &["rear_wheel"]),
    ];
    for (sensor, quantities) in sensors {
        let largest = |key| quantities.iter().filter_map(|q| number(&table, q, key)).fold(0.0, f64::max);
        let name = quantities.join(", ");
        limits.push((name.clone(), "largest", Some(sensor.max), largest("largest")));
        let at_once = sensor.slope_per_s.map(|slope| sensor.step + slope / config.rate_hz);
        limits.push((name.clone(), "step", at_once, largest("step")));
        limits.push((name, "slope_per_s", sensor.slope_per_s, largest("slope_per_s")));
    }
    for (quantity, limit) in [
        ("wheels_unexplained", cross.wheels_m_s),
        ("yaw_unexplained", cross.yaw_rad_s),
        ("steer_unexplained", cross.steer_rad),
        ("roll", config.permit.fallen_rad),
    ] {
        let largest = number(&table, quantity, "largest").expect("a number");
        limits.push((quantity.into(), "largest", limit, largest));
    }
    // Size and delay of the drive's torque are bounded by the limits.
    let fall_nm = config.limits.fall_nm_s.map_or(0.0, |fall| fall / config.rate_hz);
    let most_nm = config.limits.max_torque_nm.unwrap_or(0.0);
    limits.push(("motor_unexplained".into(), "largest", cross.motor_nm, f64::from(fall_nm)));
    limits.push(("motor".into(), "largest", Some(input.motor.max), f64::from(most_nm)));
    let mut wrong = Vec::new();
    for (name, key, limit, largest) in limits {
        let Some(limit) = limit else {
            println!("{name} {key}: no limit, {largest}");
            continue;
        };
        let margin = number(&table, "margin", key).expect("a margin");
        let ratio = f64::from(limit) / largest;
        println!("{name} {key}: limit {limit}, largest {largest}, {ratio:.2} times");
        if ratio < margin {
            wrong.push(format!("{name} {key}: {ratio:.2} times the largest, margin {margin}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
