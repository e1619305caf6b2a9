//! Table of measured weaves, from and to TOML: `data/weave_measured.toml`, written by `sim-host identify
//! weave --toml`.

use super::pool::Pooled;
use super::shape::Beside;
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// A table of measured weaves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// Origin of the recordings.
    pub source: String,
    /// Fitted columns.
    pub columns: Vec<String>,
    /// Motion fitted in addition to the weave and an offset: "mode" or "offset".
    pub beside: String,
    /// The weave at each gain and speed.
    #[serde(default)]
    pub weave: Vec<MeasuredWeave>,
}

/// The weave at one gain and speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredWeave {
    /// The controller's gain.
    pub gain: Option<f64>,
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
    /// Number of usable recordings.
    pub repeats: usize,
    /// Number of rejected recordings.
    pub refused: usize,
    /// Real part of the eigenvalue \[1/s\]: value, lower and upper end of the 95 % interval.
    pub decay_1_s: [f64; 3],
    /// Its standard deviation between repeats \[1/s\].
    pub decay_between_1_s: Option<f64>,
    /// Imaginary part \[rad/s\], in the same form.
    pub frequency_rad_s: [f64; 3],
    /// Its standard deviation between repeats \[rad/s\].
    pub frequency_between_rad_s: Option<f64>,
}

/// Value and interval as three numbers.
pub fn three(pooled: &Pooled) -> [f64; 3] {
    [pooled.mean.value, pooled.mean.low, pooled.mean.high]
}

/// Name of the additional motion.
pub fn beside_name(beside: Beside) -> &'static str {
    match beside {
        Beside::Mode => "mode",
        Beside::Offset => "offset",
    }
}

impl Measured {
    /// The table as TOML, with four decimals.
    pub fn to_toml(&self) -> String {
        let number = |x: f64| format!("{x:.4}");
        let row = |x: [f64; 3]| format!("[{}]", x.map(number).join(", "));
        let mut text = String::from(
            "# The weave measured in recordings after a knock: eigenvalues with 95 % intervals [value, low, high].\n\
             # Made by `sim-host identify weave FILES --toml FILE`; see docs/cli.md. Speeds in m/s, gains as set in\n\
             # the controller, decay (real part) in 1/s, frequency (imaginary part) in rad/s; `between` is the\n\
             # standard deviation between repeats.\n\n",
        );
        let quoted = |text: &str| toml::Value::from(text).to_string();
        let columns: Vec<String> = self.columns.iter().map(|c| quoted(c)).collect();
        let _ = writeln!(text, "source = {}", quoted(&self.source));
        let _ = writeln!(text, "columns = [{}]\nbeside = {}", columns.join(", "), quoted(&self.beside));
        for w in &self.weave {
            let _ = writeln!(text, "\n[[weave]]");
            if let Some(gain) = w.gain {
                let _ = writeln!(text, "gain = {gain:?}");
            }
            let _ = writeln!(text, "speed_m_s = {}\nrepeats = {}", number(w.speed_m_s), w.repeats);
            let _ = writeln!(text, "refused = {}\ndecay_1_s = {}", w.refused, row(w.decay_1_s));
            if let Some(between) = w.decay_between_1_s {
                let _ = writeln!(text, "decay_between_1_s = {}", number(between));
            }
            let _ = writeln!(text, "frequency_rad_s = {}", row(w.frequency_rad_s));
            if let Some(between) = w.frequency_between_rad_s {
                let _ = writeln!(text, "frequency_between_rad_s = {}", number(between));
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let weave = |gain| MeasuredWeave {
            gain,
            speed_m_s: 2.5,
            repeats: 2,
            refused: 1,
            decay_1_s: [-1.0, -1.5, -0.5],
            decay_between_1_s: gain,
            frequency_rad_s: [9.0, 8.75, 9.25],
            frequency_between_rad_s: Some(0.125),
        };
        let table = Measured {
            source: "a \"place\"".into(),
            columns: vec!["gyro_x".into()],
            beside: "mode".into(),
            weave: vec![weave(Some(8.0)), weave(None)],
        };
        assert_eq!(toml::from_str::<Measured>(&table.to_toml()).unwrap(), table);
    }
}
