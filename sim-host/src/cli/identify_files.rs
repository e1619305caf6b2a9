//! The files of `identify weave`: gain and speed from their names, fits of their content, and the model's prediction.

use super::Failure;
use super::inputs::once;
use super::weave_args::WeaveArgs;
use crate::bicycle::Parameters;
use crate::eigen::LinearActuator;
use crate::range::within;
use crate::report::weave::{Curves, Predicted, RecordingEntry, RefusedEntry, WeaveEntry};
use crate::scenario::law::{self, LawChoiceError};
use crate::weave::label::{Label, Pattern};
use crate::weave::pool::pool;
use crate::weave::predict::weave;
use crate::weave::record::read;
use crate::weave::segment::identify as identify_segment;
use control::Law;
use nalgebra::Complex;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

/// Placeholder of the gain in a law.
const GAIN: &str = "{gain}";

/// Usable and unusable recordings.
type Sorted = (Vec<RecordingEntry>, Vec<RefusedEntry>);

/// Identifies each file.
///
/// # Errors
/// Wrong options, or a file given twice.
pub(super) fn identify(args: &WeaveArgs) -> Result<Sorted, Failure> {
    let pattern = Pattern::new(&args.label).map_err(|e| format!("--label: {e}"))?;
    args.speed.map_or(Ok(()), |v| within("--speed", v, 0.0, 30.0))?;
    args.gain.map_or(Ok(()), |k| within("--gain", k, 0.001, 20.0))?;
    once(&args.files)?;
    let done: Vec<Result<RecordingEntry, RefusedEntry>> =
        args.files.par_iter().map(|path| of_file(args, &pattern, path)).collect();
    let (mut used, mut refused) = (Vec::new(), Vec::new());
    for entry in done {
        match entry {
            Ok(entry) => used.push(entry),
            Err(entry) => refused.push(entry),
        }
    }
    let columns = |entry: &RecordingEntry| -> Vec<String> {
        entry.weave.axes.iter().map(|axis| axis.column.clone()).collect()
    };
    if let Some(other) = used.iter().find(|entry| columns(entry) != columns(&used[0])) {
        let [first, other] = [&used[0], other].map(|e| format!("{} has {}", e.file, columns(e).join(", ")));
        return Err(format!("{first}, but {other}: name the columns with --column").into());
    }
    Ok((used, refused))
}

fn of_file(args: &WeaveArgs, pattern: &Pattern, path: &Path) -> Result<RecordingEntry, RefusedEntry> {
    let file = path.display().to_string();
    let stem = path.file_stem().map_or(String::new(), |s| s.to_string_lossy().into_owned());
    let label = pattern.read(&stem);
    let Label { gain, speed_m_s } = label.unwrap_or_default();
    let gain = args.gain.or(gain).filter(|_| args.law.contains(GAIN) || args.gain.is_some());
    let speed_m_s = args.speed.or(speed_m_s);
    let refused = |why: String| RefusedEntry { file: file.clone(), gain, speed_m_s, why };
    let unknown = |what: &str, option: &str| {
        let pattern = pattern.text();
        refused(format!(
            "its {what} is not known: its name is not `{pattern}` (--label), and there is no {option}"
        ))
    };
    let speed = speed_m_s.ok_or_else(|| unknown("speed", "--speed"))?;
    within("speed (m/s)", speed, 0.0, 30.0).map_err(|e| refused(e.to_string()))?;
    if gain.is_none() && args.law.contains(GAIN) {
        return Err(unknown("gain", "--gain"));
    }
    law_of(&args.law, gain).map_err(|e| refused(e.to_string()))?;
    let text = crate::input_file::recorded_text(path).map_err(|e| refused(format!("can't be read: {e}")))?;
    let record = read(&text, &args.columns()).map_err(|e| refused(e.to_string()))?;
    let weave = identify_segment(&record, args.settings()).map_err(|why| {
        let notes = record.notes.iter().map(|note| format!("; {note}")).collect::<String>();
        refused(format!("{why}{notes}"))
    })?;
    Ok(RecordingEntry { file, gain, speed_m_s: speed, left_out: record.notes, weave })
}

fn law_of(template: &str, gain: Option<f64>) -> Result<Law, LawChoiceError> {
    law::parse(&gain.map_or(template.into(), |gain| template.replace(GAIN, &gain.to_string())))
}

/// The models that recordings are compared with.
pub(super) struct Models<'a> {
    pub(super) bicycle: &'a Parameters,
    /// The law, with `{gain}` in place of the gain.
    pub(super) law: &'a str,
    /// The motor of the second prediction.
    pub(super) motor: LinearActuator,
}

/// The upper weave eigenvalue \[1/s\] at each speed, with the ideal and the fitted motor.
type Both = [Vec<Option<Complex<f64>>>; 2];

impl Models<'_> {
    fn weave(&self, gain: Option<f64>, speeds: &[f64]) -> Result<Both, String> {
        let law = law_of(self.law, gain).map_err(|e| e.to_string())?;
        let of = |motor| weave(self.bicycle, &law, motor, speeds).map_err(|e| e.to_string());
        Ok([of(LinearActuator::default())?, of(self.motor)?])
    }
}

/// Sort key of gain and speed: no gain first.
fn key(gain: Option<f64>, speed: f64) -> (i64, i64) {
    let whole = |x: f64| (x * 1e6).round() as i64;
    (gain.map_or(-1, whole), whole(speed))
}

/// Repeats at one gain and speed.
struct Group<'a> {
    gain: Option<f64>,
    speed_m_s: f64,
    repeats: Vec<&'a RecordingEntry>,
    refused: usize,
}

/// Pools repeats by gain and speed, beside the model's weave.
pub(super) fn together(
    recordings: &[RecordingEntry],
    refused: &[RefusedEntry],
    models: &Models,
) -> Result<Vec<WeaveEntry>, String> {
    let mut groups: BTreeMap<(i64, i64), Group> = BTreeMap::new();
    for entry in recordings {
        let (gain, speed_m_s) = (entry.gain, entry.speed_m_s);
        let group = groups.entry(key(gain, speed_m_s));
        group.or_insert(Group { gain, speed_m_s, repeats: Vec::new(), refused: 0 }).repeats.push(entry);
    }
    // A file with an invalid speed or gain has no prediction.
    let known = |e: &RefusedEntry| {
        e.speed_m_s.filter(|v| (0.0..=30.0).contains(v) && law_of(models.law, e.gain).is_ok())
    };
    for entry in refused {
        if let (gain, Some(speed_m_s)) = (entry.gain, known(entry)) {
            let group = groups.entry(key(gain, speed_m_s));
            group.or_insert(Group { gain, speed_m_s, repeats: Vec::new(), refused: 0 }).refused += 1;
        }
    }
    let entries = groups.into_values().map(|Group { gain, speed_m_s, repeats, refused }| {
        let decays: Vec<_> = repeats.iter().map(|e| e.weave.decay_1_s).collect();
        let frequencies: Vec<_> = repeats.iter().map(|e| e.weave.frequency_rad_s).collect();
        let [perfect, fitted] = models.weave(gain, &[speed_m_s])?.map(|roots| roots[0].map(|r| [r.re, r.im]));
        Ok(WeaveEntry {
            gain,
            speed_m_s,
            repeats: repeats.len(),
            refused,
            decay_1_s: pool(&decays),
            frequency_rad_s: pool(&frequencies),
            predicted: Predicted { perfect, fitted },
        })
    });
    entries.collect()
}

/// The model's weave over speed, for each gain.
pub(super) fn curves(weave: &[WeaveEntry], models: &Models) -> Result<Vec<Curves>, String> {
    let speeds = weave.iter().map(|e| e.speed_m_s);
    let (low, high) = speeds.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    let (low, high) = ((low - 0.25).max(0.0), high + 0.25);
    let speeds: Vec<f64> = (0..=80).map(|i| low + (high - low) * f64::from(i) / 80.0).collect();
    let groups = weave.chunk_by(|a, b| a.gain == b.gain);
    let of_gain = |gain: Option<f64>| {
        let [perfect, fitted] = models.weave(gain, &speeds)?;
        Ok(Curves { gain, speeds: speeds.clone(), perfect, fitted })
    };
    groups.map(|group| of_gain(group[0].gain)).collect()
}
