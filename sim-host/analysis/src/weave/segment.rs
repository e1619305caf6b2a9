//! Identifies the weave in one recording: window, fit and plausibility checks.

use super::Estimate;
use super::fit::{Fit, FitError, Samples, fit};
use super::record::Record;
use super::shape::Beside;
use super::student::quantile;
use super::window::{Begins, Ends, Window, window};

/// Smallest number of samples in the window.
pub const FEWEST_SAMPLES: usize = 20;
/// Smallest variance explained by the weave, in units of the noise's variance, per axis. By chance it is
/// about two; for the best of many frequencies slightly more.
const LEAST_EXPLAINED: f64 = 15.0;
/// Smallest amplitude in some axis, in standard deviations of the noise.
const LEAST_AMPLITUDE: f64 = 3.0;

/// Settings of the identification.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Motion fitted in addition to the weave.
    pub beside: Beside,
    /// Start of the window after the first sample \[s\]; detected if absent.
    pub from_s: Option<f64>,
    /// End of the window \[s\]; detected if absent.
    pub to_s: Option<f64>,
}

/// The weave in an axis.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct AxisFit {
    /// Column of the axis.
    pub column: String,
    /// Amplitude of the weave at the window's start \[rad/s\].
    pub amplitude_rad_s: f64,
    /// Standard deviation of the noise \[rad/s\].
    pub noise_rad_s: f64,
    /// Time in which the correlation of the noise's slow part falls to 1/e \[s\].
    pub noise_memory_s: f64,
    /// Share of the slow part in the noise's variance.
    pub noise_share: f64,
}

/// Result for a recording.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Segment {
    /// Start of the window after the first sample \[s\].
    pub from_s: f64,
    /// End of the window \[s\].
    pub to_s: f64,
    /// Samples in the window.
    pub samples: usize,
    /// Start criterion: at the disturbance, with the recording, or given.
    #[schemars(with = "String", extend("enum" = ["knock", "record", "told"]))]
    pub begins: Begins,
    /// End criterion: with the recording, in the noise, at a gap, after 20 s, or given.
    #[schemars(with = "String", extend("enum" = ["record", "noise", "gap", "limit", "told"]))]
    pub ends: Ends,
    /// Periods of the weave in the window.
    pub periods: f64,
    /// Real part of the weave's eigenvalue, negative if it decays \[1/s\].
    pub decay_1_s: Estimate,
    /// Imaginary part \[rad/s\].
    pub frequency_rad_s: Estimate,
    /// The real mode fitted in addition \[1/s\]; null without.
    pub mode_1_s: Option<f64>,
    /// The axes.
    pub axes: Vec<AxisFit>,
}

/// A recording without a weave.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SegmentError {
    /// Too few samples.
    #[error("{0} samples in the window; at least {FEWEST_SAMPLES} are needed")]
    Samples(usize),
    /// No fit.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// An oscillation below the noise.
    #[error("no oscillation above the noise")]
    Noise,
    /// A window too short for the frequency found.
    #[error("no oscillation: less than half a period in the window of {span_s:.2} s")]
    Short {
        /// Duration of the window \[s\].
        span_s: f64,
    },
    /// A bound of the search.
    #[error(
        "no oscillation: the best has {decay_1_s:.2} 1/s and {frequency_rad_s:.2} rad/s, a bound of the search"
    )]
    Bound {
        /// Real part \[1/s\].
        decay_1_s: f64,
        /// Imaginary part \[rad/s\].
        frequency_rad_s: f64,
    },
    /// An interval as wide as the frequency.
    #[error(
        "no oscillation: {frequency_rad_s:.2} rad/s, but with an interval of {half_rad_s:.2} to either side"
    )]
    Uncertain {
        /// The frequency \[rad/s\].
        frequency_rad_s: f64,
        /// Half of the interval \[rad/s\].
        half_rad_s: f64,
    },
}

/// Finds the weave in a recording.
///
/// # Errors
/// Too few samples, no oscillation, or less than half a period.
pub fn identify(record: &Record, settings: Settings) -> Result<Segment, SegmentError> {
    let axes: Vec<&[f64]> = record.axes.iter().map(|axis| &axis.rates_rad_s[..]).collect();
    let mut part = window(&record.times_s, &axes, (settings.from_s, settings.to_s));
    let mut fitted = fit_part(record, part, settings.beside)?;
    // The time at which the weave falls below the noise depends on the fit, and the fit on the window.
    for _ in 0..3 {
        let Some(shorter) = without_noise(record, part, &fitted) else { break };
        let Ok(again) = fit_part(record, shorter, settings.beside) else { break };
        (part, fitted) = (shorter, again);
    }
    let span_s = record.times_s[part.to - 1] - record.times_s[part.from];
    check_plausible(&fitted, span_s)?;
    let [decay_error, frequency_error] = fitted.standard_errors;
    let wide = quantile(fitted.freedom);
    let axes =
        record.axes.iter().zip(&fitted.noise).zip(&fitted.amplitude_rad_s).map(|((axis, noise), a)| {
            AxisFit {
                column: axis.column.clone(),
                amplitude_rad_s: *a,
                noise_rad_s: noise.deviation_rad_s,
                noise_memory_s: noise.memory_s,
                noise_share: noise.share,
            }
        });
    Ok(Segment {
        from_s: record.times_s[part.from],
        to_s: record.times_s[part.to - 1],
        samples: part.to - part.from,
        begins: part.begins,
        ends: part.ends,
        periods: fitted.periods(span_s),
        decay_1_s: Estimate::new(fitted.shape.decay_1_s, decay_error, wide),
        frequency_rad_s: Estimate::new(fitted.shape.frequency_rad_s, frequency_error, wide),
        mode_1_s: fitted.shape.mode_1_s,
        axes: axes.collect(),
    })
}

fn fit_part(record: &Record, part: Window, beside: Beside) -> Result<Fit, SegmentError> {
    let samples = part.to.saturating_sub(part.from);
    if samples < FEWEST_SAMPLES {
        return Err(SegmentError::Samples(samples));
    }
    let times = &record.times_s[part.from..part.to];
    let axes = record.axes.iter().map(|axis| axis.rates_rad_s[part.from..part.to].to_vec());
    let times_s = times.iter().map(|t| t - times[0]).collect();
    Ok(fit(&Samples { times_s, axes_rad_s: axes.collect() }, beside)?)
}

/// The part in which the weave exceeds the noise in some axis, if that is shorter by a twentieth or more.
fn without_noise(record: &Record, part: Window, fitted: &Fit) -> Option<Window> {
    let times = &record.times_s[part.from..part.to];
    let above = fitted.amplitude_rad_s.iter().zip(&fitted.noise).map(|(a, n)| a / n.deviation_rad_s);
    let lasts_s = libm::log(above.fold(0.0, f64::max)) / -fitted.shape.decay_1_s;
    let used = times.partition_point(|t| t - times[0] <= lasts_s);
    let enough = used >= FEWEST_SAMPLES && fitted.periods(lasts_s) >= 1.0;
    let shorter = fitted.shape.decay_1_s < 0.0 && 20 * used < 19 * times.len();
    (enough && shorter).then_some(Window { to: part.from + used, ends: Ends::Noise, ..part })
}

fn check_plausible(fitted: &Fit, span_s: f64) -> Result<(), SegmentError> {
    let least = LEAST_EXPLAINED * fitted.noise.len() as f64;
    let (frequency, error) = (fitted.shape.frequency_rad_s, fitted.standard_errors[1]);
    let above = fitted
        .amplitude_rad_s
        .iter()
        .zip(&fitted.noise)
        .any(|(a, n)| *a >= LEAST_AMPLITUDE * n.deviation_rad_s);
    if fitted.explained < least || !above {
        return Err(SegmentError::Noise);
    }
    if fitted.periods(span_s) <= 0.501 {
        return Err(SegmentError::Short { span_s });
    }
    if fitted.at_bound.iter().any(|at| *at) {
        let decay_1_s = fitted.shape.decay_1_s;
        return Err(SegmentError::Bound { decay_1_s, frequency_rad_s: frequency });
    }
    let half = quantile(fitted.freedom) * error;
    if half >= frequency {
        return Err(SegmentError::Uncertain { frequency_rad_s: frequency, half_rad_s: half });
    }
    Ok(())
}
