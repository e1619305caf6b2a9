//! Text output of `identify weave`.

use super::document::{Predicted, WeaveDocument, WeaveEntry};
use crate::weave::Estimate;
use crate::weave::pool::Pooled;
use std::fmt::Write;
use std::path::Path;

/// The recordings, the pooled repeats beside the linear model, and the number of predictions within the intervals.
pub fn text(document: &WeaveDocument) -> String {
    let mut text = recordings(document);
    text += "\nRepeats together, [95 % interval], scatter between them; the linear model's beside it:\n";
    let _ = writeln!(
        text,
        "{:>5} {:>6} {:>7}  {:<30} {:<30} {:<15} fitted motor",
        "gain", "m/s", "repeats", "decay [1/s]", "frequency [rad/s]", "perfect motor"
    );
    for entry in &document.weave {
        let number = |pooled: Option<Pooled>| {
            pooled.map_or("none".into(), |p| {
                let between = p.between.map_or(String::new(), |b| format!(" {b:.2}"));
                format!("{}{between}", interval(&p.mean))
            })
        };
        let root =
            |root: Option<[f64; 2]>| root.map_or("no pair".into(), |[re, im]| format!("{re:.2}, {im:.2}"));
        let Predicted { perfect, fitted } = &entry.predicted;
        let of = format!("{} of {}", entry.repeats, entry.repeats + entry.refused);
        let line = format!(
            "{:>5} {:>6.2} {of:>7}  {:<30} {:<30} {:<15} {}",
            gain(entry.gain),
            entry.speed_m_s,
            number(entry.decay_1_s),
            number(entry.frequency_rad_s),
            root(*perfect),
            root(*fitted),
        );
        text += line.trim_end();
        text.push('\n');
    }
    text.push('\n');
    text += &verdict(&document.weave);
    text
}

fn gain(gain: Option<f64>) -> String {
    gain.map_or("-".into(), |gain| gain.to_string())
}

fn interval(e: &Estimate) -> String {
    format!("{:.2} [{:.2}, {:.2}]", e.value, e.low, e.high)
}

fn recordings(document: &WeaveDocument) -> String {
    let config = &document.config;
    let beside =
        if config.beside == "mode" { ", an offset and a decaying real mode" } else { " and an offset" };
    let columns = config.columns.join(", ");
    let mut text = format!("Weave{beside} fitted to {columns}; windows in s after the first sample:\n");
    let _ = writeln!(
        text,
        "{:<28} {:>5} {:>6}  {:<25} {:>7}  {:<22} frequency [rad/s]",
        "file", "gain", "m/s", "window", "periods", "decay [1/s]"
    );
    for entry in &document.recordings {
        let name =
            Path::new(&entry.file).file_name().map_or(entry.file.clone().into(), |n| n.to_string_lossy());
        let w = &entry.weave;
        let lowercase = |text: &str| text.to_lowercase();
        let (begins, ends) = (lowercase(&format!("{:?}", w.begins)), lowercase(&format!("{:?}", w.ends)));
        let window = format!("{:.2} {begins}, {:.2} {ends}", w.from_s, w.to_s);
        let line = format!(
            "{name:<28} {:>5} {:>6.2}  {window:<25} {:>7.2}  {:<22} {}",
            gain(entry.gain),
            entry.speed_m_s,
            w.periods,
            interval(&w.decay_1_s),
            interval(&w.frequency_rad_s),
        );
        let _ = writeln!(text, "{line}");
    }
    text
}

/// The number of predictions within the intervals.
fn verdict(weave: &[WeaveEntry]) -> String {
    type Root = fn(&Predicted) -> Option<[f64; 2]>;
    let motors: [(&str, Root); 2] = [("perfect", |p| p.perfect), ("fitted", |p| p.fitted)];
    let mut text = String::new();
    for (name, root) in motors {
        let inside = |part: usize, measured: fn(&WeaveEntry) -> Option<Pooled>| {
            let pairs = weave.iter().filter_map(|e| Some((measured(e)?, root(&e.predicted)?)));
            let (held, all) = pairs.fold((0, 0), |(held, all), (m, root)| {
                (held + usize::from(m.mean.holds(root[part])), all + 1)
            });
            format!("{held} of {all}")
        };
        let (decays, frequencies) = (inside(0, |e| e.decay_1_s), inside(1, |e| e.frequency_rad_s));
        let _ = writeln!(
            text,
            "With the {name} motor the model lies in the interval of {decays} decays and {frequencies} frequencies."
        );
    }
    text
}
