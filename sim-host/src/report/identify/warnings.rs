//! What is doubtful about an identified rider: warnings about the fit, and gains that do not differ significantly from zero.

use super::correlation::NORMAL_95;
use super::document::Unidentified;
use super::text::number;
use crate::identify::{DROP_95, Fit, Identified, LocalOptimum, PerGain, symbols};

/// Correlation from which two gains count as inseparable.
const TOGETHER: f64 = 0.95;

/// Share of a signal that the black box explains and the model does not, from which the model counts as wrong.
const MISSED: f64 = 0.05;
/// Signal to noise below which errors are larger than their standard errors say (docs/identify.md, "Measured").
const LOW_SIGNAL_TO_NOISE: f64 = 1.5;

/// Why the gains may be wrong by more than their standard errors.
pub(super) fn warnings(found: &Identified) -> Vec<String> {
    let fit = found.fit();
    let mut warnings = Vec::new();
    if let Some(Err(error)) = &found.refined {
        warnings.push(format!(
            "these are the gains of the linear bicycle, without standard errors, because they could not be refined on the \
             nonlinear one and may be wrong by a multiple of the noise's effect: {error}"
        ));
    }
    for ((signal, vaf), fir) in fit.vaf.iter().zip(&found.impulse_responses) {
        let (name, to_noise) = (signal.name(), fir.as_ref().map_or(0.0, |fir| fir.signal_to_noise));
        let low = fir.is_some() && to_noise < LOW_SIGNAL_TO_NOISE;
        if low {
            warnings.push(format!(
                "the signal to noise of {name} is {to_noise:.2}, below {LOW_SIGNAL_TO_NOISE}: errors may be a multiple of the \
                 standard errors; a longer record, stronger or more pushes, or a --feedback with fewer gains help"
            ));
        }
        let there = to_noise / (1.0 + to_noise);
        if *vaf < there - MISSED {
            let noise = if low { "; with that noise it may be chance" } else { "" };
            warnings.push(format!(
                "the model explains {:.1} % of {name}, the impulse response without a model {:.1} %: check the sign and unit of the \
                 disturbance, --delay, --bicycle, --force-at and --feedback{noise}",
                100.0 * vaf,
                100.0 * there
            ));
        }
    }
    if !fit.is_stable() {
        let doubling_s = std::f64::consts::LN_2 / fit.rightmost_1_s;
        warnings.push(format!(
            "the closed loop is unstable: its motion doubles every {doubling_s:.1} s. Its gains have no standard errors: growth is \
             exponential in the gains, but a covariance assumes linearity"
        ));
    }
    warnings.extend(rival(&found.steps[0].fit));
    warnings
}

/// Another optimum that the record does not tell from the best one: its log-likelihood is within a 95 % interval, one of its
/// gains is not.
fn rival(full: &Fit) -> Option<String> {
    let (best, errors) = (&full.optima[0], full.standard_errors());
    let far = |gains: &PerGain, gain: usize| (gains[gain] - best.gains[gain]).abs() / errors[gain];
    let farthest = |optimum: &LocalOptimum| {
        let gains = full.active.iter().copied();
        gains.max_by(|a, b| far(&optimum.gains, *a).total_cmp(&far(&optimum.gains, *b)))
    };
    let others = full.optima[1..].iter().filter(|optimum| optimum.drop < DROP_95);
    let (other, gain) = others
        .filter_map(|optimum| Some((optimum, farthest(optimum)?)))
        .find(|(optimum, gain)| !full.is_stable() || far(&optimum.gains, *gain) > NORMAL_95)?;
    let [at, rather] = [other, best].map(|optimum| number(optimum.gains[gain]));
    Some(format!(
        "another optimum of the full fit explains nearly as much of the record: its log-likelihood is {:.2} lower, within the \
         {DROP_95:.2} of a 95 % interval, and its {} is {at} in place of {rather} (\"optima\" has all)",
        other.drop,
        symbols()[gain]
    ))
}

/// The gains of a fit that do not differ significantly from zero.
pub(super) fn insignificant(fit: &Fit) -> Vec<Unidentified> {
    let errors = fit.standard_errors();
    let doubt = |(place, &gain): (usize, &usize)| {
        let others = (0..fit.active.len()).filter(|other| *other != place);
        let closest = others
            .max_by(|a, b| fit.correlation(place, *a).abs().total_cmp(&fit.correlation(place, *b).abs()));
        let closest = closest.map(|other| (symbols()[fit.active[other]], fit.correlation(place, other)));
        Some(Unidentified { gain: symbols()[gain], why: why(fit.gains[gain], errors[gain], closest)? })
    };
    fit.active.iter().enumerate().filter_map(doubt).collect()
}

/// Why a gain with a standard error does not differ significantly from zero, if so; `closest` is the gain with the largest
/// correlation.
fn why(gain: f64, std_error: f64, closest: Option<(&str, f64)>) -> Option<String> {
    let insignificant = "does not differ significantly from zero: its 95 % interval contains zero";
    let together = closest.filter(|(_, correlation)| correlation.abs() > TOGETHER);
    (NORMAL_95 * std_error >= gain.abs()).then(|| match together {
        Some((name, correlation)) => {
            format!("{insignificant}; it can't be identified separately from {name} (correlation {correlation:.3})")
        }
        None => insignificant.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::{NORMAL_95, why};

    /// Situation: a gain of -2 with a standard error on both sides of that with which its 95 % interval ends at zero, alone and
    /// with correlated gains.
    /// Action: ask what is doubtful.
    /// Must hold: nothing with the smaller error; with the larger one that it does not differ significantly from zero. Only a
    /// correlation of more than 0.95 makes two gains inseparable.
    #[test]
    fn a_gain_whose_interval_contains_zero_is_insignificant() {
        let [below, above] = [0.999, 1.001].map(|of_limit| of_limit * 2.0 / NORMAL_95);
        assert_eq!(why(-2.0, below, Some(("K_delta_d", 0.99))), None);
        let alone = "does not differ significantly from zero: its 95 % interval contains zero";
        assert_eq!(why(-2.0, above, None).as_deref(), Some(alone));
        assert_eq!(why(-2.0, above, Some(("K_delta_d", 0.94))).as_deref(), Some(alone));
        let together =
            format!("{alone}; it can't be identified separately from K_delta_d (correlation -0.960)");
        assert_eq!(why(-2.0, above, Some(("K_delta_d", -0.96))), Some(together));
    }
}
