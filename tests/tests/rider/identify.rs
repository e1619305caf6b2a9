//! The identification: response, criteria, delay, impulse response, unusable records.

use sim_host::identify::{
    Drift, FitError, From, GAINS, Measured, Plan, Problem, Select, Signal, delay_profile, identify,
    impulse_response, reduce, rightmost_real, symbols,
};
use sim_host::num::RandomStream;
use sim_host::rider::{RiderTable, Row, catalogue};
use tests::identification::{ALL, gains, gray_box, linear_problem, pulses};

pub(crate) const NEVER: fn() -> bool = || false;

pub(crate) fn table(name: &str) -> RiderTable {
    catalogue::load(name).expect("shipped")
}

/// One row of each group.
pub(crate) fn one_per_speed(table: &RiderTable) -> Vec<Row> {
    table.groups().map(|group| group[group.len() / 2].clone()).collect()
}

pub(crate) fn fitted(problem: &Problem) -> sim_host::identify::Fit {
    problem.fit(&ALL, From::Everywhere, &NEVER).expect("a fit")
}

/// Situation: gains of both integrals, of one, and of none.
/// Must hold: the rightmost eigenvalue is that of the weighted sum of the integrals, as with a gain of one integral alone; it is
/// not the zero of the combination that nothing feeds back.
#[test]
fn two_integrals_make_no_eigenvalue_of_zero() {
    let table = table("young");
    let row = &table.rows[7];
    let model = gray_box(&table, row);
    let mut gains = gains(row);
    let one = rightmost_real(&model, &gains);
    gains[1] = 1e-3;
    let both = rightmost_real(&model, &gains);
    assert!(one < -0.1 && (both - one).abs() < 1e-4, "{one} {both}");
    gains[1] = 100.0;
    let far = rightmost_real(&model, &gains);
    assert!((far - one).abs() > 0.01, "{far}");
    (gains[1], gains[5]) = (0.0, 0.0);
    assert!(rightmost_real(&model, &gains).abs() > 1e-3);
}

/// Situation: the same pulses in samples of 1 and of 5 ms; delays of none, less than a sample, whole samples and others.
/// Must hold: the same response, so the discretisation is exact; another delay gives another one.
#[test]
fn the_response_does_not_depend_on_the_sample_time() {
    let table = table("undelayed");
    let row = &table.rows[7];
    let fine = pulses(12.0, 1);
    let coarse = linear_problem(gray_box(&table, row), &gains(row), &fine, &[(Signal::Steer, 0.0)]);
    let mut last = Vec::new();
    for delay_s in [0.0, 0.002, 0.0127, 0.03] {
        let model = sim_host::identify::GrayBox { delay_s, ..gray_box(&table, row) };
        let [a, b] = [&fine, &coarse.record.disturbances]
            .map(|disturbances| model.response(disturbances, &gains(row)).expect("a bounded response"));
        let most = b.iter().map(|x| x[1].abs()).fold(0.0, f64::max);
        let difference = (0..b.len()).map(|k| (a[5 * k][1] - b[k][1]).abs()).fold(0.0, f64::max);
        assert!(difference < 1e-7 * most, "{delay_s}: {difference:e} of {most}");
        let other = last.iter().zip(&b).map(|(x, y): (&[f64; 3], &[f64; 3])| (x[1] - y[1]).abs());
        assert!(last.is_empty() || other.fold(0.0, f64::max) > 1e-3 * most, "{delay_s}");
        last = b;
    }
}

/// Situation: a record with gaps and noise; four gains are fitted.
/// Must hold: the variance accounted for is one less the sum of squared differences over the sum of squares, eq. 2.12,
/// computed here from the response, without a drift.
#[test]
fn variance_accounted_for_is_that_of_the_equation() {
    let table = table("undelayed");
    let row = &table.rows[4];
    let signals = [(Signal::Steer, 0.01)];
    let mut problem = linear_problem(gray_box(&table, row), &gains(row), &pulses(20.0, 2), &signals);
    problem.drift = Drift::None;
    (1000..1300).for_each(|k| problem.record.measured[0].valid[k] = false);
    let fit = problem.fit(&[0, 2, 5, 6], From::Gains(&gains(row)), &NEVER).expect("a fit");
    let response = problem.model.response(&problem.record.disturbances, &fit.gains).expect("bounded");
    let Measured { values, valid, .. } = &problem.record.measured[0];
    let (mut rest, mut all) = (0.0, 0.0);
    for k in (0..values.len()).filter(|k| valid[*k]) {
        rest += (values[k] - response[k][1]).powi(2);
        all += values[k] * values[k];
    }
    let expected = 1.0 - rest / all;
    assert!((fit.mean_vaf() - expected).abs() < 1e-12, "{} for {expected}", fit.mean_vaf());
    assert!((0.5..0.999).contains(&expected));
}

/// Situation: a young rider's noisy record; all gains are fitted, then reduced.
/// Must hold: the three gains that the rider lacks go first; Bayes's criterion and held-out data stop there; without a fourth
/// gain the variance accounted for drops by more than a tenth; the steps end below half, or where fewer gains
/// can't keep the rider upright.
#[test]
fn a_reduction_ends_at_the_riders_own_gains() {
    let table = table("young");
    let row = &table.rows[8];
    let problem =
        linear_problem(gray_box(&table, row), &gains(row), &pulses(40.0, 4), &[(Signal::Steer, 0.003)]);
    let steps = reduce(&problem, fitted(&problem), 0.5, &NEVER).expect("steps");
    let mut first: Vec<usize> = steps[..3].iter().map(|step| step.weakest.0).collect();
    first.sort_unstable();
    assert_eq!(first, [1, 3, 4], "K_phi_i, K_phi_dd, K_delta_p");
    assert_eq!(Select::Bic.index(&steps), 3);
    assert_eq!(Select::Full.index(&steps), 0);
    let vaf = |i: usize| steps[i].fit.mean_vaf();
    assert!(vaf(3) > 0.9 && vaf(3) - vaf(4) > 0.1, "{} {}", vaf(3), vaf(4));
    assert_eq!(Select::Vaf(0.9).index(&steps), 3);
    assert_eq!(Select::Onset(0.9).index(&steps), 3);
    let held = Select::CrossValidated.index(&steps);
    assert!(held <= 3, "{held}");
    let last = steps.last().expect("a step");
    assert!(last.fit.mean_vaf() < 0.5 || last.fit.active.len() <= 3, "{}", last.fit.active.len());
    assert!(steps[..steps.len() - 1].iter().all(|step| step.fit.mean_vaf() >= 0.5));
}

/// Situation: records of young riders, 30 ms late, quiet and very noisy.
/// Action: the likelihood of delays from 0 to 100 ms.
/// Must hold: the quiet record's interval contains 30 ms, is narrower than 10 ms and excludes 60 ms; the noisy record's is wider.
#[test]
fn a_quiet_record_tells_the_delay() {
    let table = table("young");
    let row = &table.rows[7];
    let delays: Vec<f64> = (0..=10).map(|i| 0.01 * f64::from(i)).collect();
    let widths = [0.001, 0.05].map(|noise| {
        let signals = [(Signal::Steer, noise)];
        let problem = linear_problem(gray_box(&table, row), &gains(row), &pulses(25.0, 5), &signals);
        let fit = problem.fit(&[0, 2, 5, 6, 7], From::Gains(&gains(row)), &NEVER).expect("a fit");
        let profile = delay_profile(&problem, &fit, &delays, &|| (), &NEVER).expect("a profile");
        let [low, high] = profile.interval_s.map(|end| end.unwrap_or(f64::NAN));
        if noise < 0.01 {
            assert!(low < 0.03 && 0.03 < high && high < 0.06, "{low} to {high}");
            assert!((profile.estimate_s - 0.03).abs() < 0.003, "{}", profile.estimate_s);
            assert!(profile.points.iter().all(|point| point.drop >= 0.0));
        }
        if low.is_nan() || high.is_nan() { 0.1 } else { high - low }
    });
    assert!(widths[0] < 0.01 && widths[1] > 2.0 * widths[0], "{widths:?}");
}

/// Situation: a force that changes at random every 40 ms; noise of a known power.
/// Must hold: the impulse response explains the rest: its ratio of signal to noise is right to a fifth, and without noise its
/// coefficients are the model's response to an impulse.
#[test]
fn the_impulse_response_separates_signal_and_noise() {
    let table = table("undelayed");
    let row = &table.rows[8];
    let (model, truth) = (gray_box(&table, row), gains(row));
    let mut random = RandomStream::new(6, [0.0; 3], 3);
    let mut disturbances = pulses(60.0, 0);
    for forty in disturbances.samples.chunks_mut(40) {
        let force = if random.chance(0.5) { 20.0 } else { -20.0 };
        forty.fill([force, 0.0]);
    }
    let noise = 0.01;
    let record = |noise: f64| linear_problem(model, &truth, &disturbances, &[(Signal::Steer, noise)]).record;
    let (noisy, clean) = (record(noise), record(0.0));
    let power = clean.measured[0].values.iter().map(|x| x * x).sum::<f64>() / clean.len() as f64;
    let fir = impulse_response(&noisy, &noisy.measured[0], Drift::Offset, 4.0).expect("one");
    let ratio = fir.signal_to_noise * noise * noise / power;
    assert!((0.8..1.25).contains(&ratio), "{} {ratio}", fir.signal_to_noise);
    let fir = impulse_response(&clean, &clean.measured[0], Drift::Offset, 4.0).expect("one");
    // One newton during a sample of 1 ms: an impulse of 1 mN s.
    let mut impulse = pulses(4.5, 0);
    impulse.samples.fill([0.0; 2]);
    impulse.samples[0] = [1.0, 0.0];
    let answered = model.response(&impulse, &truth).expect("bounded");
    let most = answered.iter().map(|x| x[1].abs() * 1e3).fold(0.0, f64::max);
    for (i, coefficient) in fir.taps[0].iter().enumerate() {
        let at = ((i + 1) as f64 * fir.step_s * 1e3).round() as usize;
        let expected = answered[at][1] * 1e3;
        assert!(
            (coefficient - expected).abs() < 0.1 * most,
            "{at} ms: {coefficient} for {expected}, most {most}"
        );
    }
}

/// Situation: coloured noise, as a rider's own motion is: a random walk that returns with a time constant of 0.1 s.
/// Must hold: over several records the errors are as large as their standard errors say; those for white noise would be less than
/// half as large.
#[test]
fn standard_errors_hold_for_coloured_noise() {
    let table = table("undelayed");
    let row = &table.rows[7];
    let truth = gains(row);
    let (mut sum, mut count) = (0.0, 0.0);
    for seed in 0..12 {
        let mut problem =
            linear_problem(gray_box(&table, row), &truth, &pulses(30.0, seed), &[(Signal::Steer, 0.0)]);
        let mut random = RandomStream::new(seed, [0.0; 3], 9);
        let mut noise = 0.0;
        for value in &mut problem.record.measured[0].values {
            noise = 0.95 * noise + 0.002 * random.normal();
            *value += noise;
        }
        let fit = problem.fit(&[0, 2, 5, 6], From::Gains(&truth), &NEVER).expect("a fit");
        let errors = fit.standard_errors();
        for gain in [0, 2, 5, 6] {
            sum += ((fit.gains[gain] - truth[gain]) / errors[gain]).powi(2);
            count += 1.0;
        }
        // 1 + 2 sum rho^2 = (1 + 0.95^2) / (1 - 0.95^2), so one in 19.5, less what chance adds.
        let independent = fit.residuals[0].independent / problem.record.len() as f64;
        assert!((0.03..0.06).contains(&independent), "{independent}");
    }
    assert!((0.4..2.0).contains(&(sum / count)), "{}", sum / count);
}

fn refusal(change: impl Fn(&mut Problem)) -> FitError {
    let table = table("undelayed");
    let row = &table.rows[4];
    let mut problem =
        linear_problem(gray_box(&table, row), &gains(row), &pulses(8.0, 2), &[(Signal::Steer, 0.001)]);
    change(&mut problem);
    problem.fit(&ALL, From::Everywhere, &NEVER).expect_err("refused")
}

/// Situation: records that can't be fitted.
/// Must hold: the reason is named.
#[test]
fn unusable_records_are_refused_with_the_reason() {
    let undisturbed =
        refusal(|p| p.record.disturbances.samples.iter_mut().for_each(|sample| *sample = [0.0; 2]));
    assert_eq!(undisturbed, FitError::Undisturbed);
    let still = refusal(|p| p.record.measured[0].values.iter_mut().for_each(|x| *x = 0.25));
    assert_eq!(still, FitError::Still("steer"));
    let number = refusal(|p| p.record.measured[0].values[7] = f64::NAN);
    assert_eq!(number, FitError::NotANumber { signal: "steer", sample: 7 });
    let force = refusal(|p| p.record.disturbances.samples[9][0] = f64::INFINITY);
    assert_eq!(force, FitError::NotANumber { signal: "the lateral force", sample: 9 });
    assert!(matches!(refusal(|p| p.skip_s = 4.0), FitError::Short { .. }));
    assert!(matches!(refusal(|p| p.record.measured[0].valid[60..].fill(false)), FitError::Few { .. }));
    assert_eq!(refusal(|p| p.record.measured.clear()), FitError::Nothing("no measured signal"));
}

/// Situation: a request to stop.
/// Must hold: the identification ends as interrupted.
#[test]
fn an_identification_can_be_stopped() {
    let table = table("undelayed");
    let row = &table.rows[4];
    let problem =
        linear_problem(gray_box(&table, row), &gains(row), &pulses(8.0, 2), &[(Signal::Steer, 0.001)]);
    let plan = Plan {
        gains: ALL.to_vec(),
        reduce_until: Some(0.5),
        select: Select::Full,
        delays_s: Vec::new(),
        estimate_delay: false,
        nonlinear: None,
        filter: false,
    };
    let stopped = identify(problem, &plan, &|_| (), &|| true).expect_err("stopped");
    assert_eq!(stopped, FitError::Interrupted);
}

/// Situation: steer, roll and roll rate with different noise, fitted together.
/// Must hold: each gain's standard error is smaller than from the steer angle alone; the gains within three of them.
#[test]
fn more_signals_tell_more() {
    let table = table("young");
    let row = &table.rows[7];
    let truth = gains(row);
    let all = [(Signal::Steer, 0.004), (Signal::Roll, 0.002), (Signal::RollRate, 0.01)];
    let fits = [&all[..1], &all[..]].map(|signals| {
        let problem = linear_problem(gray_box(&table, row), &truth, &pulses(30.0, 8), signals);
        fitted(&problem)
    });
    let [alone, together] = fits.each_ref().map(|fit| fit.standard_errors());
    for gain in 0..GAINS {
        assert!(together[gain] < alone[gain], "{}", symbols()[gain]);
        let z = (fits[1].gains[gain] - truth[gain]) / together[gain];
        assert!(z.abs() < 3.0, "{}: {z}", symbols()[gain]);
    }
    let noise: Vec<f64> = fits[1].residuals.iter().map(|residuals| residuals.mean_square.sqrt()).collect();
    for ((_, expected), found) in all.iter().zip(noise) {
        assert!((found / expected - 1.0).abs() < 0.1, "{found} for {expected}");
    }
}
