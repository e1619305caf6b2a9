//! Summary of many recordings: false alarms of each check per hour of riding, and detection of an injected fault.

use super::run::Replayed;
use schemars::JsonSchema;
use serde::Serialize;

/// One cause over many recordings.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Alarms {
    /// Its number.
    pub number: u8,
    /// Its name.
    pub name: &'static str,
    /// Times that it began while a bicycle rode.
    pub count: u32,
    /// Number of recordings in which it began.
    pub recordings: u32,
    /// Rate per hour of riding; null without riding.
    pub per_hour: Option<f64>,
}

/// Summary of many recordings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Summary {
    /// Number of recordings.
    pub recordings: u32,
    /// Time ridden faster than 1 m/s \[s\].
    pub riding_s: f64,
    /// Time with the assist engaged \[s\].
    pub engaged_s: f64,
    /// Causes that began while a bicycle rode, by number.
    pub alarms: Vec<Alarms>,
    /// With an injected fault: number of recordings in which any of these causes began after it.
    pub noticed: Option<u32>,
    /// With an injected fault: median time from the fault to the first of these causes, over recordings with one \[s\].
    pub median_notice_s: Option<f64>,
}

impl Summary {
    /// From these replays; `fault_s` is the start of the injected fault, counted from the first sample.
    pub fn new<'a>(all: impl IntoIterator<Item = &'a Replayed>, fault_s: Option<f64>) -> Self {
        let mut summary = Self::default();
        let mut notices = Vec::new();
        for replayed in all {
            summary.recordings += 1;
            summary.riding_s += replayed.riding_s;
            summary.engaged_s += replayed.engaged_s;
            for cause in replayed.causes.iter().filter(|cause| cause.alarms > 0) {
                let at = summary.alarms.partition_point(|alarms| alarms.number < cause.number);
                if summary.alarms.get(at).is_none_or(|alarms| alarms.number != cause.number) {
                    let (number, name) = (cause.number, cause.name);
                    summary
                        .alarms
                        .insert(at, Alarms { number, name, count: 0, recordings: 0, per_hour: None });
                }
                summary.alarms[at].count += cause.alarms;
                summary.alarms[at].recordings += 1;
            }
            if let Some(fault_s) = fault_s {
                let begins_s = replayed.span_s.0 + fault_s;
                let after_s =
                    replayed.causes.iter().flat_map(|cause| &cause.alarms_s).map(|at_s| at_s - begins_s);
                notices.extend(after_s.filter(|after_s| *after_s >= -1e-9).reduce(f64::min));
            }
        }
        let hours = summary.riding_s / 3600.0;
        for alarms in &mut summary.alarms {
            alarms.per_hour = (hours > 0.0).then(|| f64::from(alarms.count) / hours);
        }
        if fault_s.is_some() {
            notices.sort_by(f64::total_cmp);
            summary.noticed = Some(notices.len() as u32);
            summary.median_notice_s = notices.get(notices.len() / 2).copied();
        }
        summary
    }
}
