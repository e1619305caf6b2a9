//! Document and text of `replay`.

use super::tool::{SCHEMA, Tool};
use crate::counted::counted;
use crate::replay::{Compared, Fitted, Replayed, Summary};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// How recordings were replayed.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ReplayConfig {
    /// "product" or "thesis".
    pub preset: &'static str,
    /// The law's name.
    pub law: String,
    /// Name or file of the map; null for frames.
    pub map: Option<String>,
    /// "hold" or "interpolate"; null for frames.
    pub resample: Option<&'static str>,
    /// The injected faults.
    pub faults: Vec<String>,
    /// Parameters that differ from the preset's, with their values.
    pub parameters: BTreeMap<String, String>,
}

/// One recording, replayed.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ReplayResult {
    /// The recording.
    pub file: String,
    /// Data that is unusable or looks wrong.
    pub remarks: Vec<String>,
    /// Warnings about choices and injected faults without effect on this recording.
    pub without_effect: Vec<String>,
    /// Sensors and checks switched off because the recording lacks their data.
    #[serde(flatten)]
    pub fitted: Fitted,
    /// The result of the replay.
    #[serde(flatten)]
    pub replayed: Replayed,
}

/// `replay` of one recording.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ReplayDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// Configuration of the replay.
    pub config: ReplayConfig,
    /// The result.
    #[serde(flatten)]
    pub result: ReplayResult,
}

/// `replay` of several recordings.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ReplaysDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// Configuration of the replays.
    pub config: ReplayConfig,
    /// Each recording.
    pub recordings: Vec<ReplayResult>,
    /// Files that could not be used, each with the reason.
    pub unusable: Vec<String>,
    /// Summary of all recordings.
    pub summary: Summary,
}

/// Text output for one recording.
pub fn text(result: &ReplayResult) -> String {
    let mut text = String::new();
    let (from, to) = result.replayed.span_s;
    let _ = writeln!(
        text,
        "{}: {from:.3} to {to:.3} s, {} control periods, {:.1} s of it faster than 1 m/s",
        result.file, result.replayed.periods, result.replayed.riding_s
    );
    for remark in &result.remarks {
        let _ = writeln!(text, "  remark: {remark}");
    }
    if !result.fitted.switched_off.is_empty() {
        let _ = writeln!(text, "  not recorded, switched off: {}", result.fitted.switched_off.join(", "));
    }
    if !result.fitted.absent.is_empty() {
        let _ = writeln!(text, "  in the map, but not in the recording: {}", result.fitted.absent.join(", "));
    }
    for reason in &result.fitted.unchecked {
        let _ = writeln!(text, "  not checked: {reason}");
    }
    let _ = writeln!(
        text,
        "engaged {:.3} s, limp {:.3} s, fault {:.3} s; torque peak {:.2} N m, rms {:.2} N m, at the rate limit {:.0} % of the time",
        result.replayed.engaged_s,
        result.replayed.limp_s,
        result.replayed.fault_s,
        result.replayed.peak_torque_nm,
        result.replayed.rms_torque_nm,
        100.0 * result.replayed.rate_limited
    );
    const MOST: usize = 12;
    let modes: Vec<_> = result.replayed.modes.iter().map(|m| format!("{:.3} {}", m.from_s, m.mode)).collect();
    let more = if modes.len() > MOST { format!(", and {} more", modes.len() - MOST) } else { String::new() };
    let _ = writeln!(text, "modes: {}{more}", modes[..modes.len().min(MOST)].join(", "));
    let _ = writeln!(
        text,
        "\n{:>3}  {:<24} {:>10} {:>6} {:>10} {:>7}",
        "", "cause", "first [s]", "times", "total [s]", "alarms"
    );
    for c in &result.replayed.causes {
        let _ = writeln!(
            text,
            "{:>3}  {:<24} {:>10.3} {:>6} {:>10.3} {:>7}",
            c.number, c.name, c.first_s, c.count, c.total_s, c.alarms
        );
    }
    let _ = writeln!(text, "\n{:<20} {:>12} {:>10} {:>8}  residual", "check", "largest", "limit", "part");
    for c in result.replayed.checks.iter().filter(|c| c.largest_residual.is_some()) {
        let number = |x: Option<f64>| x.map_or("-".into(), |x| format!("{x:.4}"));
        let part = match (c.largest_residual, c.limit) {
            (Some(largest), Some(limit)) if limit > 0.0 => format!("{:.0} %", 100.0 * largest / limit),
            _ => "-".into(),
        };
        let _ = writeln!(
            text,
            "{:<20} {:>12} {:>10} {part:>8}  {}",
            c.name,
            number(c.largest_residual),
            number(c.limit),
            c.residual
        );
    }
    let mut beside = |name: &str, unit: &str, compared: &Option<Compared>, more: String| {
        if let Some(c) = compared {
            let [ours, theirs] = c.rms;
            let correlation = c.correlation.map_or(String::new(), |r| format!(", correlation {r:.3}"));
            let _ = writeln!(
                text,
                "{name} beside the log's own: rms {ours:.3} and {theirs:.3} {unit}, difference {:.3} rms, {:.3} at most{correlation}{more}",
                c.rms_difference, c.largest_difference
            );
        }
    };
    let inside = result
        .replayed
        .roll_inside_bound
        .map_or(String::new(), |part| format!("; inside the bound {:.1} %", 100.0 * part));
    beside("roll", "rad", &result.replayed.roll, inside);
    beside("torque", "N m", &result.replayed.torque, String::new());
    text
}

/// Text output for several recordings: a line each, their first remark if any, and the summary.
pub fn summary_text(results: &[ReplayResult], summary: &Summary) -> String {
    let mut text = String::new();
    let widest = results.iter().map(|r| r.file.len()).max().unwrap_or(4).max(4);
    let _ = writeln!(
        text,
        "{:<widest$} {:>9} {:>10} {:>7}  alarms (number: first, times)",
        "file", "riding s", "engaged s", "peak Nm"
    );
    for r in results {
        let alarms: Vec<_> = r
            .replayed
            .causes
            .iter()
            .filter(|c| c.alarms > 0)
            .map(|c| format!("{}: {:.3}, {}", c.number, c.alarms_s.first().unwrap_or(&f64::NAN), c.alarms))
            .collect();
        let alarms = if alarms.is_empty() { "none".into() } else { alarms.join("; ") };
        let _ = writeln!(
            text,
            "{:<widest$} {:>9.1} {:>10.1} {:>7.2}  {alarms}",
            r.file, r.replayed.riding_s, r.replayed.engaged_s, r.replayed.peak_torque_nm
        );
    }
    for r in results.iter().filter(|r| !r.remarks.is_empty()) {
        let more = match r.remarks.len() - 1 {
            0 => String::new(),
            more => format!(", and {more} more"),
        };
        let _ = writeln!(text, "remark: {}: {}{more}", r.file, r.remarks[0]);
    }
    let _ = writeln!(
        text,
        "\n{}, {:.1} min of riding, engaged {:.1} min",
        counted(summary.recordings, "recording", "recordings"),
        summary.riding_s / 60.0,
        summary.engaged_s / 60.0
    );
    for a in &summary.alarms {
        let rate = a.per_hour.map_or("-".into(), |rate| format!("{rate:.1}"));
        let _ = writeln!(
            text,
            "{:>3} {:<24} {} in {}, {rate} an hour of riding",
            a.number,
            a.name,
            counted(a.count, "time", "times"),
            counted(a.recordings, "recording", "recordings")
        );
    }
    if summary.alarms.is_empty() {
        let _ = writeln!(text, "no alarm");
    }
    if let Some(noticed) = summary.noticed {
        let after =
            summary.median_notice_s.map_or(String::new(), |s| format!(", in the median after {s:.3} s"));
        let _ = writeln!(text, "fault put in: noticed in {noticed} of {}{after}", summary.recordings);
    }
    text
}
