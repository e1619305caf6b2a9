//! Any bytes give a recording or a reason.

use super::file;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use sim_host::recording::database::Database;
use sim_host::recording::frames::Frames;
use sim_host::recording::{asc, candump, decode, mdf};
use tests::draws::runner;

/// The bytes of the frames are no more than those of the file, and a column is no longer than its group.
fn sound(frames: &Frames, size: usize, database: &Database) -> Result<(), TestCaseError> {
    prop_assert!(frames.iter().map(|frame| frame.data.len()).sum::<usize>() <= size);
    prop_assert!(frames.iter().all(|frame| frame.data.len() <= 64));
    let decoded = decode::groups(frames, std::slice::from_ref(database));
    for group in &decoded.groups {
        let rows = group.times_s.as_ref().unwrap().len();
        prop_assert!(group.columns.iter().all(|column| column.values.len() == rows));
        prop_assert!(group.lines.is_empty() || group.lines.len() == rows);
    }
    prop_assert!(decoded.remarks.len() < 100);
    Ok(())
}

fn odd() -> Database {
    Database::parse(&std::fs::read(file("odd.dbc")).unwrap()).unwrap()
}

/// Replacements of pieces of a text, at any place.
fn changes() -> impl Strategy<Value = Vec<(prop::sample::Index, usize, String)>> {
    let odd = [
        "",
        " ",
        "\n",
        "\r",
        "\0",
        "#",
        "##",
        "###",
        "R",
        "(",
        ")",
        "[",
        "]",
        "x",
        "é",
        "Rx",
        "d",
        "CANFD",
        "-",
        "0",
        "1e999",
        "99999999999999999999",
        "base dec timestamps relative\n",
        "ErrorFrame",
        ".",
        "_9",
        "remote request",
    ];
    let piece = prop_oneof![4 => select(odd.to_vec()).prop_map(str::to_owned), 1 => any::<String>()];
    vec((any::<prop::sample::Index>(), 0..20_usize, piece), 0..6)
}

fn changed(text: &str, changes: &[(prop::sample::Index, usize, String)]) -> String {
    let mut letters: Vec<char> = text.chars().collect();
    for (at, many, piece) in changes {
        let at = at.index(letters.len() + 1);
        let end = (at + many).min(letters.len());
        letters.splice(at..end, piece.chars());
    }
    letters.into_iter().collect()
}

/// Situation: logs as text with pieces changed, and any text.
/// Action: read with both text readers, and decode.
/// Must hold: a recording or a reason, bounded by the file's size.
#[test]
fn texts_of_frames_are_read_or_rejected() {
    let logs: Vec<String> = ["odd.log", "odd.asc", "log2asc.asc", "ride.long.log"]
        .map(|name| std::fs::read_to_string(file(name)).unwrap().chars().take(3000).collect())
        .to_vec();
    let database = odd();
    runner(4000)
        .run(&(select(logs), changes(), any::<String>()), |(log, changes, noise)| {
            for text in [changed(&log, &changes), noise] {
                let _ = (candump::is_one(&text), asc::is_one(&text));
                for frames in [candump::parse(&text), asc::parse(&text)] {
                    match frames {
                        Ok(frames) => sound(&frames, text.len(), &database)?,
                        Err(error) => prop_assert!(!error.what.is_empty()),
                    }
                }
            }
            Ok(())
        })
        .unwrap();
}

/// Situation: databases with pieces changed.
/// Action: read; decode frames of any bytes.
/// Must hold: a database or a reason in one line; a value for each signal.
#[test]
fn texts_of_databases_are_read_or_rejected() {
    let bytes = std::fs::read(file("odd.dbc")).unwrap();
    let text: String = bytes.iter().map(|byte| char::from(*byte)).collect();
    let texts = [
        "BO_ ",
        "SG_ ",
        " m0",
        " M ",
        "m1M",
        "|",
        "@1",
        "\"",
        ";",
        "1E400",
        "-1",
        "SG_MUL_VAL_ 261 Outer Inner 0-9;",
    ];
    let piece = prop_oneof![select(texts.to_vec()).prop_map(str::to_owned), "[0-9]{1,20}"];
    let changes = vec((any::<prop::sample::Index>(), 0..20_usize, piece), 0..4);
    runner(4000)
        .run(&(changes, vec(any::<u8>(), 0..64)), |(changes, data)| {
            match Database::parse(changed(&text, &changes).as_bytes()) {
                Ok(database) => {
                    for message in &database.messages {
                        prop_assert_eq!(message.values(&data).count(), message.signals.len());
                    }
                }
                Err(error) => prop_assert!(!error.what.is_empty() && !error.what.contains('\n'), "{error}"),
            }
            Ok(())
        })
        .unwrap();
}

/// Situation: measurement files of every kind with bytes, numbers of 64 bits or a complete block's length changed,
/// and cut; any bytes after the mark of one.
/// Action: read and decode.
/// Must hold: a recording or a reason; the numbers in it are bounded by the file's size.
#[test]
fn measurement_files_are_read_or_rejected() {
    let files: Vec<Vec<u8>> =
        ["ride.mf4", "odd.mf4", "logger.mf4", "unsorted.mf4", "sorted.mf4", "channels.mf4"]
            .map(|name| std::fs::read(file(name)).unwrap())
            .to_vec();
    let database = odd();
    let number = select(vec![0, 1, 2, 24, 64, 255, 1 << 16, (1 << 31) - 1, 1 << 32, u64::MAX / 8, u64::MAX]);
    let byte = (any::<prop::sample::Index>(), any::<u8>(), Just(None)).boxed();
    let whole = (any::<prop::sample::Index>(), Just(0), number.prop_map(Some)).boxed();
    let near = (0..64_u64).prop_map(|n| Some(n * 8 + 64));
    let link = (any::<prop::sample::Index>(), Just(0), near).boxed();
    let changes = vec(prop_oneof![byte, whole, link], 0..6);
    runner(15_000)
        .run(
            &(select(files), changes, any::<prop::sample::Index>(), any::<bool>()),
            |(mut bytes, changes, end, cut)| {
                for (at, byte, number) in changes {
                    match number {
                        None => {
                            let at = at.index(bytes.len());
                            bytes[at] = byte;
                        }
                        Some(number) => {
                            let at = at.index(bytes.len() / 8) * 8;
                            bytes[at..at + 8].copy_from_slice(&u64::to_le_bytes(number));
                        }
                    }
                }
                if cut {
                    bytes.truncate(end.index(bytes.len()));
                }
                match mdf::parse(&bytes) {
                    Ok(content) => {
                        sound(&content.frames, 1100 * bytes.len(), &database)?;
                        for group in &content.groups {
                            let rows = group.columns[0].values.len();
                            prop_assert!(group.columns.iter().all(|column| column.values.len() == rows));
                            prop_assert!(group.times_s.as_ref().is_none_or(|times_s| times_s.len() == rows));
                            prop_assert!(rows * group.columns.len() <= 16 * 1100 * bytes.len());
                        }
                        prop_assert!(content.remarks.len() < 1000);
                    }
                    Err(error) => prop_assert!(!error.what.is_empty()),
                }
                Ok(())
            },
        )
        .unwrap();
    runner(500)
        .run(&vec(any::<u8>(), 0..2000), |noise| {
            let marked = [&b"UnFinMF 4.10    by hand\0\0\0\0\0\x9a\x01"[..], &noise].concat();
            let _ = (mdf::parse(&marked), mdf::parse(&noise));
            Ok(())
        })
        .unwrap();
}

/// Situation: measurement files in whose blocks one number after another has its largest value: positions, sizes,
/// counts, bits, links.
/// Action: read.
/// Must hold: a recording or a reason.
#[test]
fn the_largest_numbers_in_measurement_files() {
    for name in ["logger.mf4", "sorted.mf4", "channels.mf4"] {
        let bytes = std::fs::read(file(name)).unwrap();
        let blocks = (0..bytes.len() - 32).step_by(8).filter(|at| bytes[*at..].starts_with(b"##"));
        for at in blocks {
            for place in (at + 8..(at + 160).min(bytes.len() - 8)).step_by(4) {
                for number in [[0xff; 4], [0, 0, 0, 0x80], [0; 4]] {
                    let mut changed = bytes.clone();
                    changed[place..place + 4].copy_from_slice(&number);
                    let _ = mdf::parse(&changed);
                }
            }
        }
    }
}
