//! What each image says, word for word: `outputs/NAME.txt`. After a change that is wanted:
//! `UPDATE_EXPECT=1 cargo test --test firmware outputs::`, and look at what git shows.

use control::{Config, SensorFrame};
use expect_test::{ExpectFile, expect_file};
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;
use xtask::process::Outcome;
use xtask::{image, qemu, rides};

const LIMIT: Duration = Duration::from_secs(120);

/// What changes from commit to commit, or from QEMU to QEMU, and means nothing here.
const VARIES: [&str; 2] = ["worst_us=", "sp="];

/// An image's words and its status, without what varies.
fn said(arguments: &str, outcome: &Outcome) -> String {
    let mut text = format!("$ {arguments}\n");
    for line in outcome.stdout.lines().chain(outcome.stderr.lines()) {
        let words = line.split(' ').enumerate().map(|(i, word)| {
            let varying = VARIES.iter().find(|name| word.starts_with(**name));
            let commit = i == 2 && line.starts_with("qemu-");
            match varying {
                Some(name) => format!("{name}..."),
                None if commit => "COMMIT".into(),
                // Where a panic happened, without the line.
                None if word.contains(".rs:") => word.split(':').next().unwrap_or_default().into(),
                None => word.into(),
            }
        });
        text += &words.collect::<Vec<String>>().join(" ");
        text.push('\n');
    }
    let _ = writeln!(text, "status {:?}\n", outcome.status);
    text
}

fn run(image: &str, arguments: &[&str], directory: &Path) -> String {
    let outcome = qemu::run(image, arguments, directory, qemu::TIMED, LIMIT).unwrap();
    said(&format!("{image} {}", arguments.join(" ")), &outcome)
}

fn same(text: &str, expected: ExpectFile) {
    expected.assert_eq(text);
}

/// Situation: the images that run by themselves, or on a file.
/// Action: run each in each of its ways.
/// Must hold: they say what they said before, word for word, and end with the same status.
#[test]
fn every_image_says_what_it_said() {
    if !image::ready() {
        return;
    }
    let empty = qemu::directory("outputs").unwrap();
    let control = [&["seconds=2"][..], &["seconds=1", "block_us=2500"], &["seconds=1", "block_us=200000"]];
    let control = control.map(|arguments| run("qemu-control", arguments, &empty));
    same(&control.concat(), expect_file!["outputs/qemu-control.txt"]);

    let faults = ["panic", "stack", "undefined", "bus", "interrupt", "nonsense"];
    let faults = faults.map(|fault| run("qemu-fault", &[fault], &empty));
    same(&faults.concat(), expect_file!["outputs/qemu-fault.txt"]);

    let ride = rides::encode(&[(&Config::product(), &[SensorFrame::missing(); 300])]);
    std::fs::write(empty.join("rides.bin"), &ride).unwrap();
    let whole = run("qemu-replay", &[], &empty);
    let counted = qemu::run("qemu-instructions", &[], &empty, qemu::COUNTED, LIMIT).unwrap();
    assert!(counted.stdout.contains("steps=300 mean="), "{counted:?}");
    std::fs::write(empty.join("rides.bin"), &ride[..ride.len() - 1]).unwrap();
    let cut = run("qemu-replay", &[], &empty);
    same(&(whole + &cut), expect_file!["outputs/qemu-replay.txt"]);
}
