//! Document, table and text of `sim-host identify loop`.

use super::tool::{SCHEMA, Tool};
use crate::closed_loop::{
    Bracket, Compared, Gain, Geometry, Identified, Law, MemoryLaw, Part, Signal, SteerDynamics, SteerScale,
};
use crate::weave::Estimate;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;

/// The settings.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedLoop {
    /// The map, by name or file.
    pub map: String,
    /// The bicycle that gives wheelbase and tilt; null: those of the map.
    pub bicycle: Option<String>,
    /// Origin of the stated law; null without one.
    pub stated: Option<String>,
    /// Start of the used part \[s\]; null: the whole recording.
    pub from_s: Option<f64>,
    /// End of the used part \[s\].
    pub to_s: Option<f64>,
}

/// A recording.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LoopEntry {
    /// The file.
    pub file: String,
    /// Wheelbase and tilt.
    pub geometry: Option<Geometry>,
    /// What was identified.
    pub identified: Identified,
    /// Numbers of the stated law beside the identified ones.
    pub compared: Vec<Compared>,
}

/// A recording that could not be used.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RefusedLoop {
    /// The file.
    pub file: String,
    /// The reason.
    pub why: String,
}

/// `identify loop`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LoopDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The settings.
    pub config: ResolvedLoop,
    /// The recordings.
    pub recordings: Vec<LoopEntry>,
    /// Files that could not be used.
    pub refused: Vec<RefusedLoop>,
}

impl LoopDocument {
    /// The document.
    pub fn new(config: ResolvedLoop, recordings: Vec<LoopEntry>, refused: Vec<RefusedLoop>) -> Self {
        Self { schema: SCHEMA, tool: Tool::this(), config, recordings, refused }
    }
}

/// A line of the table.
#[derive(Clone, Debug, Serialize)]
pub struct LoopRow {
    file: String,
    part: &'static str,
    number: String,
    unit: &'static str,
    value: f64,
    low: f64,
    high: f64,
    stated: Option<f64>,
}

/// All identified numbers.
pub fn rows(document: &LoopDocument) -> Vec<LoopRow> {
    document.recordings.iter().flat_map(rows_of).collect()
}

fn rows_of(entry: &LoopEntry) -> Vec<LoopRow> {
    let mut rows = Vec::new();
    let mut row = |part, number: String, unit, e: &Estimate, stated| {
        let (value, low, high) = (e.value, e.low, e.high);
        rows.push(LoopRow { file: entry.file.clone(), part, number, unit, value, low, high, stated });
    };
    let stated = |signal: Signal, frequency: Option<f64>| {
        let found = entry.compared.iter().find(|c| c.signal == signal && c.frequency_hz == frequency);
        found.map(|compared| compared.stated)
    };
    if let Some(scale) = entry.identified.steer_scale.found() {
        row("steer-scale", "scale".into(), "1", &scale.scale, None);
        row("steer-scale", "offset".into(), "rad", &scale.offset_rad, None);
        scale.trail_m.iter().for_each(|trail| row("steer-scale", "trail".into(), "m", trail, None));
    }
    if let Some(law) = entry.identified.law.found() {
        for Gain { signal, gain, per_speed, .. } in &law.gains {
            row("law", signal.name().into(), signal.gain_unit(), gain, stated(*signal, None));
            if let Some(slope) = per_speed {
                row("law", format!("{} per m/s", signal.name()), signal.gain_unit(), slope, None);
            }
        }
        row("law", "offset".into(), "N m", &law.offset_nm, None);
        law.vanishes_m_s.iter().for_each(|v| row("law", "roll-rate gain vanishes".into(), "m/s", v, None));
    }
    if let Some(law) = entry.identified.memory.found() {
        for response in &law.responses {
            let number = format!("{} at {} Hz", response.input.name(), response.frequency_hz);
            let stated = stated(response.input, Some(response.frequency_hz));
            row("memory", number, response.input.gain_unit(), &response.magnitude, stated);
        }
    }
    if let Some(steer) = entry.identified.steer_dynamics.found() {
        for (number, unit, bracket) in numbers(steer) {
            for (way, estimate) in
                [("of the torque", bracket.of_torque), ("of the motion", bracket.of_motion)]
            {
                row("steer-dynamics", format!("{number}, {way}"), unit, &estimate, None);
            }
        }
    }
    rows
}

fn numbers(steer: &SteerDynamics) -> [(&'static str, &'static str, &Bracket); 3] {
    [
        ("inertia", "kg m^2", &steer.inertia_kg_m2),
        ("viscous friction", "N m s/rad", &steer.viscous_nm_s_rad),
        ("Coulomb friction", "N m", &steer.coulomb_nm),
    ]
}

/// All recordings as text.
pub fn text(document: &LoopDocument) -> String {
    let mut text = String::new();
    for entry in &document.recordings {
        let identified = &entry.identified;
        let _ = writeln!(
            text,
            "{}: {:.1} s at {:.1} Hz, a changing torque during {:.1} s{}",
            entry.file,
            identified.duration_s,
            1.0 / identified.period_s,
            identified.driven_s,
            identified.limit_nm.map_or(String::new(), |limit| format!(
                ", of which {:.1} % at the limit of {limit:.2} N m were left out",
                100.0 * identified.at_limit
            ))
        );
        part(&mut text, "steer angle", &identified.steer_scale, steer_scale);
        part(&mut text, "law", &identified.law, |text, found| law(text, found, &entry.compared));
        part(&mut text, "law with internal states", &identified.memory, |text, found| {
            memory(text, found, &entry.compared);
        });
        part(&mut text, "steer axis", &identified.steer_dynamics, steer_dynamics);
        text.push('\n');
    }
    text
}

fn part<T>(text: &mut String, name: &str, part: &Part<T>, write: impl FnOnce(&mut String, &T)) {
    match part {
        Part::Found(found) => write(text, found),
        Part::Not { cannot_be_identified } => {
            let _ = writeln!(text, "  {name}: cannot be identified: {cannot_be_identified}");
        }
    }
}

/// Four decimals, without a negative zero.
fn digits(x: f64) -> String {
    let text = format!("{x:.4}");
    if text == "-0.0000" { "0.0000".into() } else { text }
}

/// A number with its interval.
fn line(text: &mut String, what: &str, estimate: &Estimate, end: &str) {
    let interval = format!("{} to {}", digits(estimate.low), digits(estimate.high));
    let line = format!("    {what:44} {:>10} {interval:>24}  {end}", digits(estimate.value));
    let _ = writeln!(text, "{}", line.trim_end());
}

fn heading(text: &mut String, what: &str) {
    let _ = writeln!(text, "  {what:46} {:>10} {:>24}", "value", "95 % interval");
}

fn steer_scale(text: &mut String, found: &SteerScale) {
    heading(text, &format!("steer angle, from {:.1} s by yaw rate and speed", found.seconds));
    line(text, "scale [true / recorded]", &found.scale, &verdict(&found.scale));
    line(text, "offset [rad]", &found.offset_rad, "");
    found.trail_m.iter().for_each(|trail| line(text, "trail [m]", trail, ""));
    if let Some(bias) = &found.yaw_bias_rad_s {
        line(text, "bias of the yaw rate [rad/s]", bias, "");
    } else {
        let _ = writeln!(text, "    one speed only: a bias of the yaw rate is part of the offset");
    }
    let _ = writeln!(
        text,
        "    explains {:.2} % of the yaw rate; {:.0} % of the samples follow",
        100.0 * found.vaf,
        100.0 * found.followed
    );
}

/// What a scale means.
fn verdict(scale: &Estimate) -> String {
    let (low, high) = (scale.low, scale.high);
    if low > 1.1 {
        format!("WRONG: the recorded angle, or the speed, is too small by {:.2}", scale.value)
    } else if high < 0.9 && low > 0.0 {
        format!("WRONG: the recorded angle, or the speed, is too large by {:.2}", 1.0 / scale.value)
    } else if high < 0.0 {
        "WRONG: the sign of angle or yaw rate is reversed".into()
    } else if high - low > 0.5 {
        "not precise enough to judge".into()
    } else {
        String::new()
    }
}

/// The stated number of a comparison, in words.
fn beside(compared: &[Compared], signal: Signal, frequency_hz: Option<f64>) -> String {
    let found = compared.iter().find(|c| c.signal == signal && c.frequency_hz == frequency_hz);
    found.map_or(String::new(), |c| {
        let holds = if c.holds { "inside" } else { "outside" };
        let off = match c.stated {
            0.0 => String::new(),
            stated => format!(", {:+.1} %", 100.0 * (c.identified.value / stated - 1.0)),
        };
        format!("stated {}: {holds}{off}", digits(c.stated))
    })
}

fn law(text: &mut String, found: &Law, compared: &[Compared]) {
    let what = format!(
        "law at {:.2} m/s, from {:.1} s, lag {:.0} ms",
        found.speed_m_s,
        found.seconds,
        1e3 * found.lag_s
    );
    heading(text, &what);
    for gain in &found.gains {
        let acts = if gain.acts { "" } else { "no effect" };
        let end = [acts.to_owned(), beside(compared, gain.signal, None)];
        let end = end.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join("; ");
        line(text, &format!("{} [{}]", gain.signal.name(), gain.signal.gain_unit()), &gain.gain, &end);
        if let Some(slope) = gain.per_speed.as_ref().filter(|_| gain.acts) {
            line(text, "    its change per m/s", slope, "");
        }
    }
    line(text, "offset [N m]", &found.offset_nm, "");
    if let Some(speed) = &found.vanishes_m_s {
        line(text, "gain of the roll rate vanishes at [m/s]", speed, "");
    }
    for refused in &found.refused {
        let what = if refused.per_speed { " over speed" } else { "" };
        let _ = writeln!(text, "    {}{what}: cannot be identified: {}", refused.signal.name(), refused.why);
    }
    let _ = writeln!(
        text,
        "    explains {:.2} % of the torque; {:.1} % of the samples follow it, to {:.3} %",
        100.0 * found.vaf,
        100.0 * found.followed,
        100.0 * found.vaf_followed
    );
    for band in &found.bands {
        let acting: Vec<String> = band
            .gains
            .iter()
            .filter(|gain| gain.acts)
            .map(|gain| {
                let Estimate { value, low, high, .. } = gain.gain;
                let slope = gain.per_speed.filter(|slope| !slope.holds(0.0));
                let slope = slope.map_or(String::new(), |slope| format!(" {:+.3} per m/s", slope.value));
                format!("{} {value:.3} [{low:.3}, {high:.3}]{slope}", gain.signal.name())
            })
            .collect();
        let _ = writeln!(
            text,
            "    {:.0} to {:.0} m/s ({:.2} m/s, {:.0} s): {}",
            band.from_m_s,
            band.to_m_s,
            band.speed_m_s,
            band.seconds,
            if acting.is_empty() { "nothing acts".into() } else { acting.join(", ") }
        );
    }
}

fn memory(text: &mut String, found: &MemoryLaw, compared: &[Compared]) {
    let MemoryLaw { states, vaf, vaf_without, from_s, to_s, speed_m_s, responses } = found;
    if *states == 0 {
        let _ = writeln!(text, "  law with internal states: none are needed ({:.2} % without)", 100.0 * vaf);
        return;
    }
    heading(text, &format!("law with {states} states, {from_s:.1} to {to_s:.1} s at {speed_m_s:.2} m/s"));
    for response in responses {
        let input = response.input;
        let what = format!("{} at {} Hz [{}]", input.name(), response.frequency_hz, input.gain_unit());
        let end = [
            format!("phase {:.0} deg", response.phase_deg),
            beside(compared, input, Some(response.frequency_hz)),
        ];
        let end = end.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join("; ");
        line(text, &what, &response.magnitude, &end);
    }
    let _ = writeln!(
        text,
        "    explains {:.2} % of the torque, simulated from its inputs; {:.2} % without internal states",
        100.0 * vaf,
        100.0 * vaf_without
    );
}

fn steer_dynamics(text: &mut String, found: &SteerDynamics) {
    let what = format!("steer axis, from {:.1} s; two regressions each", found.seconds);
    heading(text, &what);
    for (number, unit, bracket) in numbers(found) {
        line(text, &format!("{number} [{unit}], of the torque"), &bracket.of_torque, "");
        line(text, "    of the motion", &bracket.of_motion, "");
    }
    let _ = writeln!(
        text,
        "    explains {:.1} % of the torque, {:.1} % of the steer acceleration",
        100.0 * found.vaf,
        100.0 * found.vaf_motion
    );
}
