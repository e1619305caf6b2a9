//! What an identification leaves unexplained: correlations of residuals, and the impulse responses beside it.

use sim_host::bicycle::ForcePoint;
use sim_host::bicycle::catalogue;
use sim_host::bicycle::linear::Linear;
use sim_host::identify::{
    Disturbances, Drift, GrayBox, Hold, Measured, PerGain, Record, Signal, impulse_response,
};
use sim_host::report::identify::correlation::{
    autocorrelation, cross_correlation, independent_band, white_band,
};
use sim_host::rider::Neuromuscular;
use tests::knock::SplitMix64;

const COUNT: usize = 20_000;

/// `x[k] = a x[k - 1] + e[k]` with normal `e` of deviation 1.
fn autoregressive(a: f64, seed: u64) -> Vec<f64> {
    let (mut random, mut x) = (SplitMix64(seed), 0.0);
    let mut next = || {
        x = a * x + random.normal();
        x
    };
    (0..COUNT).map(|_| next()).collect()
}

/// Situation: first-order autoregressive sequences, whole and with a quarter of the samples missing at random.
/// Action: correlate each with itself.
/// Must hold: 1 at lag 0, the coefficient's powers at the others within the scatter of such an estimate.
#[test]
fn an_autoregressive_sequence_has_its_known_correlation() {
    for (a, seed) in [(0.9, 1), (0.5, 2), (-0.7, 3)] {
        let whole = autoregressive(a, seed);
        let mut random = SplitMix64(seed);
        let gappy: Vec<f64> =
            whole.iter().map(|x| if random.even() < 0.25 { f64::NAN } else { *x }).collect();
        for values in [whole, gappy] {
            let r = autocorrelation(&values, 40);
            assert!(r.len() == 41 && (r[0] - 1.0).abs() < 1e-9, "{r:?}");
            for (lag, r) in r.iter().enumerate() {
                let known = a.powi(lag as i32);
                assert!((r - known).abs() < 0.06, "{a} {lag}: {r} {known}");
            }
        }
    }
}

/// Situation: white noise. Action: correlate it with itself, and with other white noise.
/// Must hold: about 95 % of the lags are inside of the band, neither all nor few.
#[test]
fn white_noise_is_inside_of_its_band() {
    let (a, b) = (autoregressive(0.0, 4), autoregressive(0.0, 5));
    let inside = |r: &[f64], band: f64| r.iter().filter(|r| r.abs() < band).count() as f64 / r.len() as f64;
    let share = inside(&autocorrelation(&a, 2000)[1..], white_band(&a));
    assert!((0.935..0.965).contains(&share), "{share}");
    let share = inside(&cross_correlation(&a, &b, 1000), independent_band(&a, &b, 100));
    assert!((0.92..0.975).contains(&share), "{share}");
}

/// Situation: independent sequences of the coefficients a and b.
/// Must hold: the band is wider than that of white noise by the known root of (1 + ab) / (1 - ab).
#[test]
fn coloured_sequences_have_a_wider_band() {
    for (a, b) in [(0.9, 0.9), (0.8, 0.5), (0.6, -0.5)] {
        let (x, y) = (autoregressive(a, 6), autoregressive(b, 7));
        let ratio = independent_band(&x, &y, 400) / white_band(&x);
        let known: f64 = ((1.0 + a * b) / (1.0 - a * b)).sqrt();
        assert!((ratio / known - 1.0).abs() < 0.15, "{a} {b}: {ratio} {known}");
    }
}

/// Situation: a sequence and the same three samples later, negated; one that does not move; one that is missing.
/// Must hold: a correlation of -1 at lag 3; no correlation without motion or samples.
#[test]
fn a_delayed_sequence_is_found_at_its_lag() {
    let a = autoregressive(0.0, 8);
    let b: Vec<f64> = [0.0; 3].into_iter().chain(a.iter().map(|x| -x)).take(COUNT).collect();
    let r = cross_correlation(&a, &b, 5);
    assert!(r.len() == 11 && (r[5 + 3] + 1.0).abs() < 1e-3, "{r:?}");
    assert!(r.iter().enumerate().all(|(at, r)| at == 8 || r.abs() < 0.05), "{r:?}");
    for still in [vec![0.0; COUNT], vec![f64::NAN; COUNT]] {
        assert_eq!(cross_correlation(&a, &still, 2), [0.0; 5]);
    }
}

/// Situation: the response of a stable closed loop to random force pulses, sampled so slowly that each sample has a coefficient, and
/// so fast that a coefficient stands for several samples.
/// Action: estimate the impulse response without a model; compute the model's.
/// Must hold: both agree in shape and size.
#[test]
fn black_box_and_model_have_the_same_impulse_response() {
    let bicycle = Linear::new(&catalogue::load("rigid_jason").expect("ships").parameters);
    let model = GrayBox {
        bicycle,
        force_input: bicycle.lateral_force_input(ForcePoint::SADDLE).into(),
        neuromuscular: Neuromuscular::SHOULDERS,
        speed_m_s: 5.0,
        delay_s: 0.03,
    };
    let gains: PerGain = [65.0, 0.0, 42.0, 0.0, 0.0, 360.0, -6.5, -0.22];
    for (sample_s, hold) in [(0.04, Hold::Zero), (0.01, Hold::Zero), (0.005, Hold::Linear)] {
        let mut random = SplitMix64(9);
        let mut samples = vec![[0.0; 2]; (60.0 / sample_s) as usize];
        for pulse in samples.chunks_mut((0.4 / sample_s) as usize) {
            let force = 40.0 * random.normal();
            pulse.iter_mut().for_each(|x| x[0] = force);
        }
        let disturbances = Disturbances { sample_s, samples, hold };
        let response = model.response(&disturbances, &gains).expect("stable");
        let values: Vec<f64> = response.iter().map(|x| x[1]).collect();
        let measured = Measured { signal: Signal::Steer, valid: vec![true; values.len()], values };
        let record = Record { disturbances, measured: vec![measured] };
        let fir = impulse_response(&record, &record.measured[0], Drift::None, 4.0).expect("excited");
        let every = (fir.step_s / sample_s).round() as usize;
        let own = model.impulse_response(&gains, (0, hold), sample_s, every * fir.taps[0].len() + 1);
        let own = own.expect("stable");
        let at_taps: Vec<f64> = (1..=fir.taps[0].len()).map(|tap| own[tap * every][1]).collect();
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let apart: Vec<f64> = fir.taps[0].iter().zip(&at_taps).map(|(a, b)| a - b).collect();
        let error = norm(&apart) / norm(&at_taps);
        assert!(norm(&at_taps) > 0.0 && error < 0.1, "{sample_s}: {every} {error}");
    }
}
