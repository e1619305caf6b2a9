//! What is doubtful about an identified rider: warnings about the fit, and gains that the record does not determine.

use super::document::Unidentified;
use crate::identify::{Fit, Identified, symbols};

/// Relative standard error above which a gain is not identified: its 95 % interval contains zero.
const LOOSE: f64 = 0.5;
/// Correlation from which two gains count as inseparable.
const TOGETHER: f64 = 0.95;

/// Share of a signal that the black box explains and the model does not, from which the model counts as wrong.
const MISSED: f64 = 0.05;
/// Growth from which a closed loop counts as unstable \[1/s\]: less is not noticed in a ride.
const UNSTABLE_1_S: f64 = 1e-3;

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
        let there = fir.as_ref().map_or(0.0, |fir| fir.signal_to_noise / (1.0 + fir.signal_to_noise));
        if *vaf < there - MISSED {
            warnings.push(format!(
                "the model explains {:.1} % of {}, the impulse response without a model {:.1} %: check the sign and unit of the \
                 disturbance, --delay, --bicycle, --force-at and --feedback",
                100.0 * vaf,
                signal.name(),
                100.0 * there
            ));
        }
    }
    if fit.rightmost_1_s > UNSTABLE_1_S {
        let doubling_s = std::f64::consts::LN_2 / fit.rightmost_1_s;
        warnings.push(format!("the closed loop is unstable: its motion doubles every {doubling_s:.1} s"));
    }
    warnings
}

/// The gains of a fit that the record does not determine.
pub(super) fn unidentified(fit: &Fit) -> Vec<Unidentified> {
    let errors = fit.standard_errors();
    let doubt = |(place, gain): (usize, &usize)| {
        let relative = errors[*gain] / fit.gains[*gain].abs();
        let others = (0..fit.active.len()).filter(|other| *other != place);
        let partner = others
            .max_by(|a, b| fit.correlation(place, *a).abs().total_cmp(&fit.correlation(place, *b).abs()));
        let together = partner.map(|other| (symbols()[fit.active[other]], fit.correlation(place, other)));
        (relative > LOOSE).then(|| Unidentified {
            gain: symbols()[*gain],
            why: match together {
                Some((name, correlation)) if correlation.abs() > TOGETHER => {
                    format!("its 95 % interval contains zero; it can't be separated from {name} (correlation {correlation:.3})")
                }
                _ => "its 95 % interval contains zero: the record does not need it".into(),
            },
        })
    };
    fit.active.iter().enumerate().filter_map(doubt).collect()
}
