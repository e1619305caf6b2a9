//! No check triggers on a bicycle without faults.

use control::estimate::predict::PredictConfig;
use control::estimate::smooth::SmoothConfig;
use control::{Cause, Causes, Config, Limits, Mode};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use rayon::prelude::*;
use sim_host::plant::{Plant, Sensor};
use sim_host::ride::{Start, rides, traced};
use std::fmt;
use tests::basins::H;
use tests::draws::runner;
use tests::estimator_inputs::Noise;
use tests::fault_reactions::product;
use tests::inside::{AXES, RIDERS, SPEEDS, borders, sensed, unchecked, with};
use tests::sets::whole;

/// Number of rides drawn inside each basin, fewer by default.
fn drawn_per_basin() -> usize {
    if whole() { 40 } else { 16 }
}

/// The product's checks and engagement; law and torque as in the thesis.
fn checked() -> Config {
    let (predict, smooth) = (PredictConfig::default(), SmoothConfig::default());
    Config { law: H, limits: Limits::default(), predict, smooth, ..product() }
}

/// The same without a limit or a check.
fn without_checks() -> Config {
    let Config { predict, smooth, .. } = checked();
    Config { predict, smooth, ..unchecked() }
}

/// Sensors at the rate of those of the TU Delft sensor bicycle, with `part` of their noise, see [`Noise::SIZES`].
fn noisy(part: f64) -> Plant {
    let mut plant = Plant { seed: 1, ..Plant::default() };
    let [gyro, accel, steer, steer_rate, speed] = Noise::SIZES.map(f64::from);
    for (sensor, noise) in [
        (Sensor::Gyro, gyro),
        (Sensor::Accel, accel),
        (Sensor::Steer, steer),
        (Sensor::SteerRate, steer_rate),
        (Sensor::FrontWheel, speed),
        (Sensor::RearWheel, speed),
    ] {
        let model = plant.sensors.model_mut(sensor);
        (model.noise, model.every_ticks) = (part * noise, 10);
    }
    plant
}

/// Rides at 99 % of every border, and drawn ones between 0 and 99 % of the lower of the two neighbouring borders; to
/// either side.
fn starts() -> Vec<(Option<&'static str>, Start)> {
    let mut starts: Vec<_> = borders().iter().map(|border| (border.rider, border.start(0.99))).collect();
    let gap = SPEEDS.len() - 1;
    let draw = (0..RIDERS.len(), 0..AXES.len(), 0..gap, 0.0..1.0_f64, -0.99..0.99_f64);
    let mut runner = runner(1);
    for _ in 0..drawn_per_basin() * RIDERS.len() {
        let (rider, axis, i, along, part) = draw.new_tree(&mut runner).expect("a draw").current();
        let row = &borders()[(rider * AXES.len() + axis) * SPEEDS.len()..];
        let height = row[i].height_rad_s.min(row[i + 1].height_rad_s);
        let speed = SPEEDS[i] + along * (SPEEDS[i + 1] - SPEEDS[i]);
        starts.push((RIDERS[rider], AXES[axis].start(speed, part * height)));
    }
    starts
}

/// The first report of a ride before its fall, if any, and whether it fell.
struct Report {
    rider: Option<&'static str>,
    start: Start,
    trip: Option<String>,
    /// The causes of that instant.
    causes: Causes,
    fell: bool,
    /// Whether it falls without the checks too; not ridden where nothing was reported.
    falls_anyhow: bool,
}

impl Report {
    /// Whether a cause was reported in a ride that stays up, or that falls by the reaction to it.
    fn is_wrong(&self) -> bool {
        self.trip.is_some() && !(self.fell && self.falls_anyhow)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s } = self.start;
        let rider = self.rider.unwrap_or("nobody");
        write!(f, "{rider}, {speed_m_s:.3} m/s, steer rate {steer_rate_rad_s:.3}, ")?;
        writeln!(f, "roll rate {roll_rate_rad_s:.3} rad/s: {}", self.trip.as_deref().unwrap_or("nothing"))?;
        writeln!(f, "    falls: {}, without checks: {}", self.fell, self.falls_anyhow)
    }
}

fn ridden(config: &Config, plant: &Plant, rider: Option<&'static str>, start: Start) -> Report {
    let conditions = |config| with(rider, sensed(config, plant.clone()));
    let (ride, trace) = traced(&conditions(config.clone()), start);
    let fell = ride.fell();
    // The reports of a bicycle that lies down do not count.
    let lies = trace.iter().position(|p| fell && p.roll.abs() > 1.0).unwrap_or(trace.len());
    let first = trace[..lies].iter().find(|p| p.causes != 0 || p.mode != Mode::Engaged as u8);
    let causes = first.map_or(Causes::NONE, |p| Causes(p.causes));
    let trip = first.map(|p| {
        let causes: Vec<_> = Causes(p.causes).iter().collect();
        format!("{causes:?} in mode {} at {:.3} s, roll {:.2}, steer {:.2}", p.mode, p.t, p.roll, p.steer)
    });
    let falls_anyhow = trip.is_some() && rides(&conditions(without_checks()), &[start])[0].fell();
    Report { rider, start, trip, causes, fell, falls_anyhow }
}

fn reports(config: &Config, plant: &Plant) -> Vec<Report> {
    starts().into_par_iter().map(|(rider, start)| ridden(config, plant, rider, start)).collect()
}

fn listed(reports: &[Report], what: impl Fn(&&Report) -> bool) -> String {
    reports.iter().filter(what).map(|t| t.to_string()).collect()
}

/// Situation: rides drawn inside the basins of h, without a rider and with riders, and at their borders; exact
/// sensors.
/// Action: ride with every check of the product.
/// Must hold: engaged throughout, no cause reported in any ride that does not fall; a ride that falls falls without
/// checks too, as the borders are those of the gyro's own rate and the product rides on the estimated one: at most 4
/// of the 72 rides at 99 % of a border, and no other.
#[test]
fn no_check_trips_inside_the_basins() {
    let reports = reports(&checked(), &Plant::default());
    assert_eq!(reports.len(), 72 + drawn_per_basin() * RIDERS.len());
    let wrong = listed(&reports, |t| (t.trip.is_some() || t.fell) && !(t.fell && t.falls_anyhow));
    assert!(wrong.is_empty(), "{wrong}");
    let (border, drawn) = reports.split_at(72);
    let fell = |reports: &[Report]| reports.iter().filter(|t| t.fell).count();
    assert!(fell(border) <= 4 && fell(drawn) == 0, "{}", listed(&reports, |t| t.fell));
}

/// The largest noise, as a part of [`Noise::SIZES`], with which every check of the product may be on, and every one
/// but the roll's correlation.
const BORNE: f64 = 0.5;
const BORNE_WITHOUT: f64 = 0.75;

/// Rides with `part` of the noise: none that does not fall reports a cause, and a report in one that falls is not the
/// reason of the fall, except in at most 3 of the 72 at the border, which noise drives to the force of a crash; about
/// a third fall, most of them at the border.
fn no_trip_with_noise(config: &Config, part: f64) {
    let reports = reports(config, &noisy(part));
    let fell = reports.iter().filter(|t| t.fell).count();
    println!(
        "{fell} of {} rides fall; reported before:\n{}",
        reports.len(),
        listed(&reports, |t| t.trip.is_some())
    );
    let (border, drawn) = reports.split_at(72);
    let crash = |t: &Report| t.causes.has(Cause::Crash);
    let crashes = border.iter().filter(|t| crash(t) && t.is_wrong()).count();
    let others = listed(border, |t| t.is_wrong() && !crash(t)) + &listed(drawn, |t| t.is_wrong());
    assert!(others.is_empty() && crashes <= 3, "{part} of the noise, {crashes} crashes: {others}");
    assert!((30..90).contains(&fell), "{fell} of {}", reports.len());
}

/// Number of rides with `part` of the noise and every check on in which a correct gyro is reported as reversed.
fn reported_gyros(part: f64) -> usize {
    let reports = reports(&checked(), &noisy(part));
    reports.iter().filter(|t| t.is_wrong() && t.causes.has(Cause::GyroDisagrees)).count()
}

/// Situation: the same rides, sensors with the noise of a real bicycle, which makes the basins smaller. Must hold: engaged
/// throughout, no cause reported in any ride that stays up with half of the noise and every check on, nor with three quarters of
/// it and without the roll's correlation; with more and every check on, noise alone looks like a reversed roll rate in as few
/// rides as docs/sensors.md says.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn no_check_trips_by_noise() {
    no_trip_with_noise(&checked(), BORNE);
    let mut config = checked();
    config.cross.roll_correlation = false;
    no_trip_with_noise(&config, BORNE_WITHOUT);
    let page = include_str!("../../../docs/sensors.md");
    for (part, also) in [(BORNE, "every check"), (BORNE_WITHOUT, "every other check")] {
        let [gyro, _, steer, _, speed] = Noise::SIZES.map(|size| f64::from(size) * part);
        let row = format!("| {also} | {gyro:.3} rad/s | {steer:.3} rad | {speed:.3} m/s |");
        assert!(page.contains(&row), "docs/sensors.md should have: {row}");
    }
    let rides = 72 + drawn_per_basin() * RIDERS.len();
    let [some, all] = [BORNE_WITHOUT, 1.0].map(reported_gyros);
    let line = format!("it reports a correct gyro in {some} of the {rides} rides, with all of it in {all},");
    assert!(page.contains(&line), "docs/sensors.md should have: {line}");
}
