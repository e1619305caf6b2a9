//! Text output of each image, word for word: `outputs/NAME.txt`. After an intended change: `UPDATE_EXPECT=1 cargo
//! test --test firmware outputs::`, and check the result with git.

use crate::steady_board::SteadyBoard;
use control::{Config, SensorFrame};
use expect_test::{ExpectFile, expect_file};
use std::fmt::Write;
use std::path::Path;
use xtask::instructions::field;
use xtask::process::Outcome;
use xtask::{image, qemu, rides};

/// Parts that change from commit to commit, or with QEMU's version, and have no meaning here.
const VARIES: [&str; 3] = ["worst_us=", "sp=", "stack_left="];

/// An image's text and its status, without the varying parts.
fn output<'a>(arguments: &str, lines: impl Iterator<Item = &'a str>, status: &str) -> String {
    let mut text = format!("$ {arguments}\n");
    for line in lines {
        let texts = line.split(' ').enumerate().map(|(i, word)| {
            let varying = VARIES.iter().find(|name| word.starts_with(**name));
            let commit = i == 2 && line.starts_with("qemu-");
            match varying {
                Some(name) => format!("{name}..."),
                None if commit => "COMMIT".into(),
                // Place of a panic, without the line.
                None if word.contains(".rs:") => word.split(':').next().unwrap_or_default().into(),
                None => word.into(),
            }
        });
        text += &texts.collect::<Vec<String>>().join(" ");
        text.push('\n');
    }
    let _ = writeln!(text, "{status}\n");
    text
}

fn run(image: &str, arguments: &[&str], directory: &Path) -> String {
    let outcome = qemu::run(image, arguments, directory, qemu::TIMED, qemu::LIMIT).unwrap();
    let Outcome { status, stdout, stderr } = &outcome;
    let lines = stdout.lines().chain(stderr.lines());
    output(&format!("{image} {}", arguments.join(" ")), lines, &format!("status {status:?}"))
}

fn same(text: &str, expected: ExpectFile) {
    expected.assert_eq(text);
}

/// Situation: the images that run by themselves, or on a file.
/// Action: run each with each of its arguments.
/// Must hold: their text is the stored one, word for word, and they end with the same status.
#[test]
fn every_image_prints_its_stored_output() {
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
    let counted = qemu::run("qemu-instructions", &[], &empty, qemu::COUNTED, qemu::LIMIT).unwrap();
    assert!(counted.stdout.contains("steps=300 mean="), "{counted:?}");
    std::fs::write(empty.join("rides.bin"), &ride[..ride.len() - 1]).unwrap();
    let cut = run("qemu-replay", &[], &empty);
    same(&(whole + &cut), expect_file!["outputs/qemu-replay.txt"]);
}

/// Situation: the image of the loop, on a ride of 2.2 s with the switch pressed; the same with a panic after 1.5 s.
/// Action: ride, then close the host's end.
/// Must hold: its text and its status are the stored ones; 8 to 28 KiB of its stack of 32 were never used.
#[test]
fn the_image_of_the_loop_prints_its_stored_output() {
    if !image::ready() {
        return;
    }
    let rides = [&[][..], &["fault=panic", "at_ms=1500"]].map(|texts: &[&str]| {
        let mut board = SteadyBoard::start(texts);
        board.ride(500, false);
        board.ride(1700, true);
        let (status, printed) = board.board.close();
        let left: u32 = field(&printed, "stack_left").expect("a number");
        assert!((8 << 10..28 << 10).contains(&left), "{left} bytes of stack left");
        output(&format!("qemu-pil {}", texts.join(" ")), printed.lines(), &status)
    });
    same(&rides.concat(), expect_file!["outputs/qemu-pil.txt"]);
}
