//! The weave measured in recordings after a knock.

use control::Law;
use rayon::prelude::*;
use sim_host::bicycle::catalogue;
use sim_host::eigen::{Feedback, LinearActuator};
use sim_host::study::balance_assist::RIDERLESS;
use sim_host::weave::Estimate;
use sim_host::weave::pool::pool;
use sim_host::weave::record::{Axis, Columns, Record, read};
use sim_host::weave::segment::{Settings, identify};
use sim_host::weave::shape::Beside;
use sim_host::weave::window::{Begins, Ends};
use std::path::PathBuf;
use tests::knock::{Knocked, Recording, SplitMix64, csv};

/// The prototype with a motor that has a lag, friction and inertia.
fn prototype(kappa: f32, speed_m_s: f64) -> Knocked {
    let actuator = LinearActuator {
        scale: 1.0,
        delay_s: 0.0,
        time_constant_s: 0.015,
        viscous_nm_s_rad: 1.25,
        inertia_kg_m2: 0.13,
    };
    let bicycle = catalogue::load(RIDERLESS).expect("ships").parameters;
    Knocked { bicycle, feedback: Feedback::Law(Law::BalanceAssist { kappa }), actuator, speed_m_s }
}

/// Cut after the push, as long as the recordings of the prototype.
fn cut(after_s: f64, noise_rad_s: f64, memory_s: f64) -> Recording {
    Recording { before_s: 0.0, push_s: 0.2, after_s, rate_hz: 100.0, noise_rad_s, memory_s }
}

/// The record from the end of the push on.
fn after_push(mut record: Record, how: &Recording) -> Record {
    let from = record.times_s.partition_point(|t| *t < how.before_s + how.push_s);
    let start = record.times_s[from];
    record.times_s = record.times_s[from..].iter().map(|t| t - start).collect();
    for axis in &mut record.axes {
        axis.rates_rad_s.drain(..from);
    }
    record
}

/// Situation: recordings of the linear model without noise, of several gains, speeds and rates.
/// Action: find the weave.
/// Must hold: the model's eigenvalue, to 2 % of its size; without the caster mode, it is off by more at low speed.
#[test]
fn without_noise_the_eigenvalue_is_found() {
    for (kappa, speed, rate_hz) in
        [(8.0, 2.22, 100.0), (8.0, 3.89, 100.0), (10.0, 2.78, 400.0), (10.0, 4.44, 50.0)]
    {
        let knocked = prototype(kappa, speed);
        let how = Recording { rate_hz, ..cut(1.6, 1e-5, 0.03) };
        let record = after_push(knocked.record(&how, &mut SplitMix64(1)), &how);
        let weave = knocked.weave();
        let off = |beside| {
            let found = identify(&record, Settings { beside, ..Settings::default() }).expect("a weave");
            let (re, im) = (found.decay_1_s.value - weave.re, found.frequency_rad_s.value - weave.im);
            re.hypot(im) / weave.norm()
        };
        let [mode, offset] = [Beside::Mode, Beside::Offset].map(off);
        println!("K {kappa}, {speed} m/s: {weave:.3}, off by {mode:.4}, without the mode {offset:.4}");
        assert!(mode < 0.02, "{mode}");
        assert!(speed > 3.0 || offset > 2.0 * mode, "{offset}");
    }
}

/// Situation: 200 recordings of the linear model under noise with a correlation time of 5 to 50 ms, with the duration
/// and noise level of those of the prototype.
/// Action: find the weave in each.
/// Must hold: the 95 % intervals of decay and frequency contain the true value in 88 to 99 %; under the assumption of
/// white noise they would be narrower than the errors, which verifies the test itself.
#[test]
fn intervals_contain_the_true_value_as_often_as_stated() {
    let cases = [(8.0, 2.22, 1.2), (8.0, 2.78, 1.3), (8.0, 3.33, 1.3), (10.0, 2.78, 1.4), (10.0, 3.33, 2.0)];
    let cases = [&cases[..], &[(10.0, 3.89, 2.0), (10.0, 4.44, 1.7), (8.0, 4.44, 1.6)]].concat();
    let draw = |i: usize| {
        let mut random = SplitMix64(1000 + i as u64);
        let (kappa, speed, after_s) = cases[i % cases.len()];
        let how = cut(after_s, 0.03, 0.005 * 10.0_f64.powf(random.even()));
        let knocked = prototype(kappa, speed);
        let record = after_push(knocked.record(&how, &mut random), &how);
        let (found, weave) = (identify(&record, Settings::default()), knocked.weave());
        found.ok().map(|s| {
            let pair = [(s.decay_1_s, weave.re), (s.frequency_rad_s, weave.im)];
            pair.map(|(e, truth)| (e.holds(truth), (e.value - truth) / e.standard_error))
        })
    };
    let found: Vec<[(bool, f64); 2]> = (0..200).into_par_iter().filter_map(draw).collect();
    assert!(found.len() >= 198, "{} of 200 could be used", found.len());
    for (i, name) in ["decay", "frequency"].into_iter().enumerate() {
        let held = found.iter().filter(|f| f[i].0).count() as f64 / found.len() as f64;
        let mut off: Vec<f64> = found.iter().map(|f| f[i].1).collect();
        off.sort_by(f64::total_cmp);
        let middle = off[off.len() / 2];
        println!("{name}: held in {:.1} %, middle error {middle:.2} standard errors", 100.0 * held);
        assert!((0.88..=0.99).contains(&held), "{name}: {held}");
        assert!(middle.abs() < 0.4, "{name}: {middle}");
    }
}

/// Situation: repeats with and without an additional scatter between them.
/// Action: combine them, 400 times each.
/// Must hold: the interval contains the true value in 93 % and more; the scatter is found within a third, in the
/// mean.
#[test]
fn combined_repeats_contain_the_true_value() {
    let mut random = SplitMix64(3);
    for (k, between) in [(3, 0.0), (3, 0.3), (5, 0.3), (10, 0.3)] {
        let mut scatter = Vec::new();
        let mut held = 0;
        for _ in 0..400 {
            let of_repeat = |_| {
                let error = 0.05 + 0.1 * random.even();
                Estimate::new(between * random.normal() + error * random.normal(), error, 1.96)
            };
            let pooled = pool(&(0..k).map(of_repeat).collect::<Vec<_>>()).expect("repeats");
            held += usize::from(pooled.mean.holds(0.0));
            scatter.push(pooled.between.expect("several"));
        }
        scatter.sort_by(f64::total_cmp);
        println!("{k} repeats, {between}: held in {} of 400, scatter {:.3}", held, scatter[200]);
        assert!(held >= 372, "{held}");
        assert!(between == 0.0 || (scatter[200] / between - 1.0).abs() < 0.34, "{}", scatter[200]);
        assert!(between > 0.0 || scatter[200] < 0.05, "{}", scatter[200]);
    }
}

/// Situation: a recording that begins before the push and continues long after; the same cut after the push.
/// Action: find the weave.
/// Must hold: the window begins at the push's largest rate and ends in the noise; the weave is the same, within the
/// intervals.
#[test]
fn the_window_is_found() {
    let knocked = prototype(8.0, 3.33);
    let how = Recording { before_s: 1.5, ..cut(8.0, 0.02, 0.02) };
    let record = knocked.record(&how, &mut SplitMix64(5));
    let whole = identify(&record, Settings::default()).expect("a weave");
    println!("{whole:?}");
    assert_eq!((whole.begins, whole.ends), (Begins::Knock, Ends::Noise));
    assert!((1.5..1.9).contains(&whole.from_s) && (3.5..8.0).contains(&whole.to_s), "{whole:?}");
    let part = identify(&after_push(record.clone(), &how), Settings::default()).expect("a weave");
    assert_eq!(part.begins, Begins::Record);
    let weave = knocked.weave();
    for found in [&whole, &part] {
        assert!((found.decay_1_s.value - weave.re).abs() < 0.15, "{found:?} {weave}");
        assert!((found.frequency_rad_s.value - weave.im).abs() < 0.15, "{found:?} {weave}");
    }
    let given = Settings { from_s: Some(2.0), to_s: Some(4.0), ..Settings::default() };
    let given = identify(&record, given).expect("a weave");
    assert_eq!((given.begins, given.ends), (Begins::Stated, Ends::Stated));
    assert!((given.from_s - 2.0).abs() < 0.02 && (given.to_s - 4.0).abs() < 0.02);
}

/// Situation: a recording that continues for a minute and a half after the push.
/// Action: find the weave.
/// Must hold: it is found as in a short one, and no more than 20 s are used.
#[test]
fn a_long_recording_is_no_harder() {
    let knocked = prototype(8.0, 4.44);
    let how = Recording { before_s: 2.0, ..cut(90.0, 0.02, 0.02) };
    let found = identify(&knocked.record(&how, &mut SplitMix64(11)), Settings::default()).expect("a weave");
    println!("{found:?}");
    assert!(found.ends == Ends::Noise && found.to_s - found.from_s < 20.0);
    assert!((found.decay_1_s.value - knocked.weave().re).abs() < 0.1, "{found:?}");
}

/// Situation: noise alone, a drift, a decay without oscillation, a step, too few samples, an axis that is zero.
/// Action: find the weave.
/// Must hold: rejected with the reason in each of 20 draws, except one of noise at most.
#[test]
fn signals_without_oscillation_are_rejected() {
    let record = |rates: &dyn Fn(f64, &mut SplitMix64) -> f64, n: usize, seed: u64| {
        let mut random = SplitMix64(seed);
        let times_s: Vec<f64> = (0..n).map(|i| 0.01 * i as f64).collect();
        let rates_rad_s = times_s.iter().map(|t| rates(*t, &mut random)).collect();
        Record { times_s, axes: vec![Axis { column: "gyro_x".into(), rates_rad_s }], notes: Vec::new() }
    };
    let noise = |_: f64, random: &mut SplitMix64| 0.05 * random.normal();
    let drift = |t: f64, random: &mut SplitMix64| 0.3 * t + 0.02 * random.normal();
    let decay = |t: f64, random: &mut SplitMix64| 0.7 * (-3.0 * t).exp() + 0.02 * random.normal();
    let rest = |_: f64, _: &mut SplitMix64| 0.0;
    type Rates<'a> = &'a dyn Fn(f64, &mut SplitMix64) -> f64;
    let all: [(&str, Rates); 3] = [("noise", &noise), ("drift", &drift), ("decay", &decay)];
    for (name, rates) in all {
        let found = (0..20).filter_map(|seed| identify(&record(rates, 150, seed), Settings::default()).ok());
        let found: Vec<_> = found.collect();
        assert!(found.len() <= 1, "{name}: {found:?}");
    }
    let why = |record| identify(&record, Settings::default()).expect_err("refused").to_string();
    assert!(why(record(&decay, 19, 1)).contains("19 samples in the window; at least 20"));
    assert!(why(record(&rest, 50, 1)).contains("zero all along"));
    assert!(why(record(&noise, 150, 2)).contains("no oscillation"));
}

/// The folder of the prototype's recordings, named by `STEER_ASSIST_RECORDINGS`; they have no licence, so they are
/// not shipped.
fn recordings() -> Option<PathBuf> {
    let folder = std::env::var_os("STEER_ASSIST_RECORDINGS").map(PathBuf::from).filter(|f| f.is_dir());
    if folder.is_none() {
        println!("skipped: STEER_ASSIST_RECORDINGS names no folder of recordings (docs/testing.md)");
    }
    folder
}

/// Situation: the recordings of the prototype with gains 8 and 10, where they are available.
/// Action: find the weave in each.
/// Must hold: in nine of ten a finite interval; where there are two periods and more the frequency is known to 0.4
/// rad/s.
#[test]
fn recordings_of_the_prototype_can_be_used() {
    let Some(folder) = recordings() else { return };
    let entries = std::fs::read_dir(&folder).expect("a folder").map(|e| e.expect("an entry").path());
    let files: Vec<_> = entries.filter(|f| f.extension().is_some_and(|e| e == "csv")).collect();
    assert!(files.len() >= 10, "{} files", files.len());
    let of = |file: &PathBuf| {
        let text = std::fs::read_to_string(file).expect("text");
        identify(&read(&text, &Columns::default()).expect("a recording"), Settings::default())
    };
    let found: Vec<_> = files.par_iter().filter_map(|file| of(file).ok()).collect();
    assert!(10 * found.len() >= 9 * files.len(), "{} of {}", found.len(), files.len());
    for s in found {
        let wide = |e: &Estimate| e.high - e.low;
        assert!(wide(&s.decay_1_s).is_finite() && (1.0..25.0).contains(&s.frequency_rad_s.value), "{s:?}");
        assert!(s.periods < 2.0 || wide(&s.frequency_rad_s) < 0.8, "{s:?}");
    }
}

/// Situation: a record written as a file and read.
/// Action: compare.
/// Must hold: the same to the digits written.
#[test]
fn a_file_is_read_as_it_was_written() {
    let record = prototype(8.0, 3.0).record(&cut(1.0, 0.03, 0.02), &mut SplitMix64(7));
    let again = read(&csv(&record), &Columns::default()).expect("a recording");
    assert_eq!((again.notes.len(), again.times_s.len()), (0, record.times_s.len()));
    for (a, b) in record.axes.iter().zip(&again.axes) {
        assert_eq!(a.column, b.column);
        assert!(a.rates_rad_s.iter().zip(&b.rates_rad_s).all(|(x, y)| (x - y).abs() < 1e-5));
    }
    assert!(record.times_s.iter().zip(&again.times_s).all(|(x, y)| (x - y).abs() < 1e-6));
}
