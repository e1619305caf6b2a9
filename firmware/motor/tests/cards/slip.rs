//! An encoder that slips on its shaft, has a wrong offset or reverses, and conditions that are no slip.
//!
//! Times and torques of the first test are in docs/motor.md.

use crate::bench::{Bench, last, mean, opened};
use crate::machine::Params;
use motor::example::EXAMPLE;
use motor::{Config, Fault, MotorCommand};

/// Duration of a call of the example \[ms\].
const CALL_MS: f64 = 0.05;
/// Largest torque at an unconfirmed angle, with the loop's overshoot and the transient of closing the bridge while the
/// handlebar turns at up to 0.5 rad/s \[N m\].
const UNCONFIRMED_NM: f64 = 2.9;

/// Encoder fault.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Slip {
    /// Offset error from the start \[electrical degrees\].
    Before(f64),
    /// Slip by electrical degrees in a number of calls while torque is applied.
    During(f64, u32),
    /// Counts reverse from one call on.
    Reversed,
}

/// The example with a handlebar at constant rate.
fn turned(off_deg: f64, rate_rad_s: f64, change: impl FnOnce(&mut Config)) -> Bench {
    let mut bench = Bench::started(|c| {
        c.encoder.offset_turns = Some(((off_deg / 360.0 + 0.5).rem_euclid(1.0) - 0.5) as f32);
        change(c);
    });
    bench.machine.params.inertia_kg_m2 = 1e6;
    bench.machine.steer_rate_rad_s = rate_rad_s;
    let _ = bench.run(600, MotorCommand::Off);
    bench
}

/// Result.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    /// Time from the beginning of the slip to the open bridge \[ms\].
    opened_ms: Option<f64>,
    /// Largest torque against the request until then \[N m\], and that at the end.
    worst_nm: f64,
    end_nm: f64,
}

/// Requests torque, slips the encoder, and waits for `ms` for the bridge to open.
fn slips(slip: Slip, rate_rad_s: f64, nm: f32, ms: f64) -> Outcome {
    let off_deg = if let Slip::Before(deg) = slip { deg } else { 0.0 };
    let mut bench = turned(off_deg, rate_rad_s, |_| ());
    if off_deg == 0.0 {
        // The angle is confirmed, then the slip begins.
        bench.machine.steer_rate_rad_s = f64::from(nm.signum());
        assert_eq!(opened(&bench.run(1000, MotorCommand::Torque(nm))), None);
        bench.machine.steer_rate_rad_s = rate_rad_s;
        assert_eq!(opened(&bench.run(200, MotorCommand::Torque(nm))), None);
    }
    if slip == Slip::Reversed {
        bench.encoder_zero = -2.0 * bench.machine.motor_turns;
        bench.encoder_reversed = true;
    }
    let (mut worst_nm, mut end_nm) = (0.0_f64, 0.0);
    for call in 1..=(ms / CALL_MS) as u32 {
        if let Slip::During(deg, calls) = slip {
            bench.encoder_zero = deg / 360.0 / 8.0 * (f64::from(call) / f64::from(calls)).min(1.0);
        }
        let record = bench.call(MotorCommand::Torque(nm), |_, _| ());
        if record.out.duties.is_none() {
            return Outcome { opened_ms: Some(f64::from(call) * CALL_MS), worst_nm, end_nm };
        }
        end_nm = -record.torque_nm * f64::from(nm.signum());
        worst_nm = worst_nm.max(end_nm);
    }
    Outcome { opened_ms: None, worst_nm, end_nm }
}

/// The worst of both directions of torque and rate.
fn worst(slip: Slip, rate_rad_s: f64, nm: f32, ms: f64) -> Outcome {
    let runs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
        .map(|(rate, torque)| slips(slip, rate * rate_rad_s, torque * nm, ms));
    let late = |outcome: &Outcome| outcome.opened_ms.unwrap_or(f64::INFINITY);
    let mut all = runs.into_iter().max_by(|a, b| late(a).total_cmp(&late(b))).expect("four runs");
    all.worst_nm = runs.iter().map(|outcome| outcome.worst_nm).fold(0.0, f64::max);
    all.end_nm = runs.iter().map(|outcome| outcome.end_nm).fold(f64::MIN, f64::max);
    all
}

/// Cells of the table: rates of the handlebar \[rad/s\].
const RATES: [f64; 6] = [0.0, 0.3, 0.5, 1.0, 2.0, 5.0];
/// Duration of the observation \[ms\].
const OBSERVED_MS: f64 = 400.0;

/// Situation: 4 N m requested in either direction, the handlebar turned at 0 to 5 rad/s in either direction; the
/// encoder off by 45 to 180 electrical degrees from the start, slipping by 180 in 0.2 s, or reversing. Must hold:
/// from 1 rad/s on the bridge opens within 0.1 s, or 0.1 s of the slip's end. Where it does not, the torque in the
/// wrong direction is at most that of an unconfirmed angle, from the start, or within 0.35 s of the slip's beginning.
/// Equal to the table in docs/motor.md.
#[test]
fn a_slip_is_detected_or_bounded() {
    let page = include_str!("../../../../docs/motor.md");
    let slips = [
        ("off by 45 degrees", Slip::Before(45.0)),
        ("off by 90 degrees", Slip::Before(90.0)),
        ("off by 135 degrees", Slip::Before(135.0)),
        ("off by 180 degrees", Slip::Before(180.0)),
        ("slips by 180 degrees in 0.2 s", Slip::During(180.0, 4000)),
        ("turns round", Slip::Reversed),
    ];
    let mut wrong = Vec::new();
    for (name, slip) in slips {
        let outcome = RATES.map(|rate| worst(slip, rate, 4.0, OBSERVED_MS));
        let cell = |s: &Outcome| match s.opened_ms {
            Some(ms) => format!("{ms:.0}, {:.1}", s.worst_nm),
            None => format!("-, {:.1}", s.end_nm.max(0.0)),
        };
        let fresh = format!("| {name} | {} |", outcome.each_ref().map(cell).join(" | "));
        println!("{fresh}");
        let slipping_ms = if let Slip::During(..) = slip { 200.0 } else { 0.0 };
        for (rate, outcome) in RATES.iter().zip(&outcome) {
            let in_time = outcome.opened_ms.is_some_and(|ms| ms <= 100.0 + slipping_ms);
            assert!(in_time || *rate < 1.0 || name.contains(" 45 "), "{name}, {rate} rad/s: {outcome:?}");
            assert!(in_time || outcome.end_nm < UNCONFIRMED_NM, "{name}, {rate} rad/s: {outcome:?}");
        }
        let line = page.lines().find(|line| line.starts_with(&format!("| {name} |"))).unwrap_or_default();
        let same = |(a, b): (&str, &str)| match (a.trim().parse::<f64>(), b.trim().parse::<f64>()) {
            (Ok(a), Ok(b)) => (a - b).abs() <= 0.2 + 0.1 * a.max(b),
            _ => a.trim() == b.trim(),
        };
        let cells = |line: &str| line.replace(',', "|").split('|').map(str::to_owned).collect::<Vec<_>>();
        let (fresh_cells, documented) = (cells(&fresh), cells(line));
        let alike = fresh_cells.len() == documented.len()
            && fresh_cells.iter().zip(&documented).all(|(a, b)| same((a.as_str(), b.as_str())));
        if !alike {
            wrong.push(fresh);
        }
    }
    assert!(wrong.is_empty(), "docs/motor.md should have\n{}", wrong.join("\n"));
}

/// Numbers from 0 to 1.
struct SplitMix64(u64);

impl SplitMix64 {
    fn between(&mut self, least: f64, most: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        least + (most - least) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Situation: 80 encoders off by any angle beyond 60 electrical degrees, or by less than 6; any torque to 7 N m, any
/// rate of the handlebar from 1 to 8 rad/s. Must hold: the first open within 0.1 s, the others never.
#[test]
fn any_angle() {
    let mut random = SplitMix64(7);
    let mut latest: f64 = 0.0;
    for _ in 0..80 {
        let sense = if random.between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
        let (rate, nm) = (sense * random.between(1.0, 8.0), random.between(-7.0, 7.0) as f32);
        let deg = random.between(60.0, 300.0);
        let outcome = slips(Slip::Before(deg), rate, nm, 150.0);
        assert!(
            outcome.opened_ms.is_some_and(|ms| ms <= 100.0),
            "{deg} deg, {rate} rad/s, {nm} N m: {outcome:?}"
        );
        latest = latest.max(outcome.opened_ms.unwrap_or(0.0));
        let deg = random.between(-6.0, 6.0);
        let outcome = slips(Slip::Before(deg), rate, nm, 150.0);
        assert!(outcome.opened_ms.is_none(), "{deg} deg, {rate} rad/s, {nm} N m: {outcome:?}");
    }
    println!("latest {latest} ms");
    assert!(latest > 2.0, "{latest}");
}

/// Situation: 3 N m, the handlebar turned at 1 or 3 rad/s; the encoder creeps on its shaft, an electrical turn in 4
/// s. Must hold: open before the error is 75 electrical degrees, not before it is 20.
#[test]
fn a_creeping_encoder() {
    for rate in [1.0, -1.0, 3.0, -3.0] {
        let mut bench = turned(0.0, rate, |_| ());
        let mut off_deg = 0.0;
        let fault = loop {
            off_deg += 360.0 / 80_000.0;
            bench.encoder_zero = off_deg / 360.0 / 8.0;
            let record = bench.call(MotorCommand::Torque(3.0), |_, _| ());
            if record.out.duties.is_none() {
                break record.out.faults;
            }
            assert!(off_deg < 75.0, "{rate} rad/s");
        };
        println!("{rate} rad/s: open at {off_deg:.0} degrees");
        assert!(off_deg > 20.0, "{rate}: {off_deg}");
        let may = [Fault::AngleMismatch, Fault::VoltageResidual];
        assert!(fault.iter().all(|fault| may.contains(&fault)), "{rate}: {fault:?}");
    }
}

/// Situation: a free handlebar at rest, 4 N m requested; the encoder is off by 135 or 180 electrical degrees. Must
/// hold: the wrong torque is at most that of an unconfirmed angle, and the bridge opens before 0.5 rad/s: with half a
/// turn within 0.1 s; with an eighth less, whose torque is smaller, within 0.2 s.
#[test]
fn a_handlebar_at_rest_and_free() {
    for (deg, latest_ms) in [(180.0, 100.0), (135.0, 200.0)] {
        let mut bench = turned(deg, 0.0, |_| ());
        bench.machine.params.inertia_kg_m2 = Params::default().inertia_kg_m2;
        let records = bench.run(5000, MotorCommand::Torque(4.0));
        let open_ms = opened(&records).map(|call| call as f64 * CALL_MS);
        let worst_nm = records.iter().map(|r| -r.torque_nm).fold(0.0, f64::max);
        println!(
            "{deg} degrees: {open_ms:?} ms, {worst_nm:.2} N m, {:.2} rad/s",
            bench.machine.steer_rate_rad_s
        );
        assert!(open_ms.is_some_and(|ms| (30.0..latest_ms).contains(&ms)), "{deg}: {open_ms:?}");
        assert!((0.8..UNCONFIRMED_NM).contains(&worst_nm), "{deg}: {worst_nm}");
        assert!(last(&records).out.faults.has(Fault::AngleMismatch));
    }
}

/// Situation: no fault; the handlebar is held, 4 N m requested. Must hold: 2.5 N m, the limit of an unconfirmed
/// angle. Then the handlebar turns at 1 rad/s: 4 N m within 30 ms. It stops again: back to 2.5 N m after 0.2 s.
#[test]
fn confirmation_of_the_angle_permits_the_whole_torque() {
    let mut bench = turned(0.0, 0.0, |_| ());
    let before = mean(&bench.run(2000, MotorCommand::Torque(4.0))[1000..], |r| r.torque_nm);
    bench.machine.steer_rate_rad_s = 1.0;
    let proved = bench.run(4000, MotorCommand::Torque(4.0));
    let whole_ms = proved.iter().position(|r| r.torque_nm > 3.8).expect("proved") as f64 * CALL_MS;
    bench.machine.steer_rate_rad_s = 0.0;
    let stopped = bench.run(8000, MotorCommand::Torque(4.0));
    let little_ms =
        stopped.iter().position(|r| r.torque_nm < 2.7).expect("the confirmation expires") as f64 * CALL_MS;
    println!("{before:.2} N m; whole after {whole_ms:.1} ms; little after {little_ms:.1} ms");
    assert!((2.4..2.6).contains(&before) && (2.0..30.0).contains(&whole_ms), "{before} {whole_ms}");
    assert!((195.0..220.0).contains(&little_ms) && opened(&stopped).is_none(), "{little_ms}");
    let limit_nm = last(&stopped).out.limit_a * EXAMPLE.motor.torque_nm_a();
    assert!((limit_nm - EXAMPLE.angle.unproved_nm).abs() < 1e-3, "documented: {limit_nm}");
}

/// Situation: no fault, but parameter errors of motor and bridge: resistance 0.7 and 1.4, flux 0.9 and 1.1,
/// inductance 0.7 and 1.3 of the configured values, dead time half of it or half more, at 12, 24, 55 V; twice as long
/// at 24 V; alignment error 4 electrical degrees. Hands shake the handlebar with 12 N m at 3 Hz and it hits a stop
/// twice, while up to 7 N m are requested in either direction. Must hold: no fault in 0.4 s, and 7 N m in at least a
/// fourth of the time in which they are requested.
#[test]
fn parameter_errors_and_impacts_are_no_slip() {
    let bridges =
        [(0.25, 12.0), (0.25, 24.0), (0.25, 55.0), (0.75, 12.0), (0.75, 24.0), (0.75, 55.0), (1.0, 24.0)];
    for motor in 0..8 {
        for (dead_time_us, bus_v) in bridges {
            let mut bench = Bench::started(|c| {
                c.encoder.offset_turns = Some(4.0 / 360.0);
                (c.supply.low_v, c.supply.sag_v, c.supply.high_v) = (9.0, 10.0, 65.0);
            });
            let p = &mut bench.machine.params;
            let of = |bit: i32, low: f64, high: f64| if motor & bit == 0 { low } else { high };
            (p.resistance_ohm, p.flux_wb) = (p.resistance_ohm * of(1, 0.7, 1.4), p.flux_wb * of(2, 0.9, 1.1));
            p.inductance_d_h *= of(4, 0.7, 1.3);
            p.inductance_q_h = p.inductance_d_h;
            (p.dead_time_s, p.source_v, bench.machine.bus_v) = (dead_time_us * 1e-6, bus_v, bus_v);
            let (mut whole, mut before) = (0, 0.0);
            for call in 0..8000_u32 {
                let t = f64::from(call) * CALL_MS * 1e-3;
                bench.machine.load_nm = 12.0 * (t * 3.0 * std::f64::consts::TAU).sin();
                // The stop takes 2 ms and gives back 0.3 of the rate.
                match call % 4000 {
                    3000 => before = bench.machine.steer_rate_rad_s,
                    3001..=3040 => bench.machine.steer_rate_rad_s -= 1.3 / 40.0 * before,
                    _ => (),
                }
                let nm = [1.0, -7.0, 7.0, 4.0, -2.0, 0.2, 0.0, -0.5][(call / 1000 % 8) as usize];
                let record = bench.call(MotorCommand::Torque(nm), |_, _| ());
                let faults = record.out.faults;
                assert!(faults.is_empty(), "{motor:03b}, {dead_time_us} us, {bus_v} V, {t} s: {faults:?}");
                whole += usize::from((5.8..8.2).contains(&record.torque_nm.abs()));
            }
            assert!((500..2100).contains(&whole), "{motor:03b}, {dead_time_us} us, {bus_v} V: {whole}");
        }
    }
}
