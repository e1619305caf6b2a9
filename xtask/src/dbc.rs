//! The database of the board's CAN frames, from the tables of the encoder.

use crate::Result;
use crate::paths::root;
use link::can::layout::{LAYOUTS, Layout};
use link::can::signal::{Content, Quantity, Signal};
use link::can::{BIT_HZ, PERIOD_MS};
use std::fmt::Write;

/// Path of the database in the repository.
pub const PATH: &str = "data/can/assist.dbc";

/// Writes the database.
///
/// # Errors
/// The file cannot be written.
pub fn dbc() -> Result<()> {
    std::fs::write(root().join(PATH), text()).map_err(|error| format!("can't write {PATH}: {error}"))?;
    println!("{PATH}");
    Ok(())
}

/// A signal of the database: one of the encoder's, or one bit of its set.
struct Row {
    name: &'static str,
    start: u8,
    bits: u8,
    signed: bool,
    factor: f64,
    /// Smallest and largest value.
    range: (f64, f64),
    unit: &'static str,
    meaning: &'static str,
    /// Codes with a name.
    names: Vec<(i64, &'static str)>,
}

/// The database as text: messages, comments, cycle times, names of values.
pub fn text() -> String {
    const HEAD: &str = "VERSION \"\"\n\nNS_ :\n\tCM_\n\tBA_DEF_\n\tBA_\n\tVAL_\n\tVAL_TABLE_\n\tBA_DEF_DEF_\n\nBS_:\n\n\
                        BU_: Assist Display\n";
    let mut text = HEAD.to_owned();
    let tables: Vec<(&Layout, Vec<Row>)> =
        LAYOUTS.iter().map(|layout| (layout, layout.signals.iter().flat_map(rows).collect())).collect();
    text += "VAL_TABLE_ Cause";
    for cause in control::CAUSES {
        let _ = write!(text, " {} \"{}\"", cause.code(), cause.name());
    }
    text += " ;\n";
    for (layout, rows) in &tables {
        let _ = writeln!(text, "\nBO_ {} {}: 8 Assist", layout.identifier, layout.name);
        for Row { name, start, bits, signed, factor, range: (least, most), unit, .. } in rows {
            let sign = if *signed { '-' } else { '+' };
            let _ = writeln!(
                text,
                " SG_ {name} : {start}|{bits}@1{sign} ({factor},0) [{least}|{most}] \"{unit}\" Display"
            );
        }
    }
    let _ = writeln!(
        text,
        "\nCM_ \"State of a steer assist on CAN, classic 2.0A, {} kbit/s, every {PERIOD_MS} ms. Positive is to the \
         right, forward for the speed.\";",
        BIT_HZ / 1000
    );
    for (layout, rows) in &tables {
        let id = layout.identifier;
        let _ = writeln!(text, "CM_ BO_ {id} \"{}\";", layout.meaning);
        for Row { name, meaning, .. } in rows {
            let _ = writeln!(text, "CM_ SG_ {id} {name} \"{meaning}\";");
        }
    }
    text += "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\nBA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n";
    for (layout, _) in &tables {
        let _ = writeln!(text, "BA_ \"GenMsgCycleTime\" BO_ {} {PERIOD_MS};", layout.identifier);
    }
    for (layout, rows) in &tables {
        for Row { name, names, .. } in rows.iter().filter(|row| !row.names.is_empty()) {
            let _ = write!(text, "VAL_ {} {name}", layout.identifier);
            for (code, name) in names {
                let _ = write!(text, " {code} \"{name}\"");
            }
            text += " ;\n";
        }
    }
    text
}

/// The rows of a signal: one, or one for each element of a set.
fn rows(signal: &Signal) -> Vec<Row> {
    let &Signal { name, start, bits, content, meaning } = signal;
    let whole = |most: f64, names| Row {
        name,
        start,
        bits,
        signed: false,
        factor: 1.0,
        range: (0.0, most),
        unit: "",
        meaning,
        names,
    };
    match content {
        Content::Flag => vec![whole(1.0, vec![])],
        Content::Count => vec![whole((1_u64 << bits) as f64 - 1.0, vec![])],
        Content::Choice(named) => {
            let names: Vec<_> =
                (0..=u8::MAX).filter_map(|code| Some((i64::from(code), named(code)?))).collect();
            vec![whole(names.iter().map(|(code, _)| *code).max().unwrap_or(0) as f64, names)]
        }
        Content::Set(named) => (0..bits)
            .filter_map(|bit| {
                let element = named(bit)?;
                let (name, meaning, start) = (element.name, element.meaning, start + bit);
                Some(Row { name, meaning, start, bits: 1, ..whole(1.0, vec![]) })
            })
            .collect(),
        Content::Quantity(Quantity { step, unit, codes: (least, most), unknown }) => {
            // The step as it is written: an f32 has other digits as an f64.
            let factor: f64 = step.to_string().parse().unwrap_or_default();
            let value = |code: i16| (f64::from(code) * factor * 1e9).round() / 1e9;
            let names = vec![(i64::from(unknown), "not known")];
            let range = (value(least), value(most));
            vec![Row { signed: least < 0, factor, range, unit, ..whole(0.0, names) }]
        }
    }
}
