//! Resources of the chip that the images use, the documented numbers, and the absence of local paths in the images.

use std::process::Command;
use xtask::document::{margin_too_small, over_budget, path, stale, text};
use xtask::instructions::BUDGET;
use xtask::{image, instructions, size};

/// Situation: all images, built.
/// Action: measure their sizes and the instructions of every step of the border ride.
/// Must hold: no budget exceeded, and of those of instructions the required reserve is left; `docs/images.md` has the
/// same numbers within 3 %.
#[test]
fn images_keep_their_budgets_and_the_document_is_true() {
    if !image::ready() {
        return;
    }
    image::build("board-vesc6").expect("the board's image builds");
    let (sizes, counts) = (size::sizes().unwrap(), instructions::counts().unwrap());
    assert_eq!(over_budget(&sizes, &counts), [""; 0]);
    assert_eq!(margin_too_small(&counts), [""; 0]);
    let committed = std::fs::read_to_string(path()).unwrap();
    assert_eq!(stale(&committed, &text(&sizes, &counts)), [""; 0], "run `cargo xtask size`");
}

/// Situation: rows at nine tenths of their budget, one instruction more, at it, and one beyond; with every feature on
/// at 99 %, and one instruction more.
/// Action: list the rows without reserve, and those over their budget.
/// Must hold: each but the first of both is named once.
#[test]
fn a_row_that_leaves_less_than_a_tenth_is_named() {
    let row = |name, max| instructions::Count { name, mean: 100, max, budget: BUDGET, stack: 500 };
    let rows = [
        row("most", 2700),
        row("more", 2701),
        row("all", BUDGET),
        row("over", BUDGET + 1),
        row("everything on", 2970),
        row("everything on, more", 2971),
    ];
    let named = |lines: Vec<String>| -> Vec<String> {
        lines.iter().filter_map(|line| Some(line.split_once(':')?.0.to_owned())).collect()
    };
    assert_eq!(named(margin_too_small(&rows)), ["more", "all", "everything on, more"]);
    assert_eq!(named(over_budget(&[], &rows)), ["over"]);
}

/// Situation: a document whose numbers are off by 10 %, and one with a row missing.
/// Action: compare it with the right one.
/// Must hold: the rows are named; the right document has none.
#[test]
fn a_stale_document_is_named() {
    let count = |name, max| instructions::Count { name, mean: 100, max, budget: 200, stack: 500 };
    let right = text(&[], &[count("h", 150), count("f", 80)]);
    assert_eq!(stale(&right, &right), [""; 0]);
    assert_eq!(stale(&text(&[], &[count("h", 165), count("f", 81)]), &right).len(), 1);
    assert_eq!(stale(&text(&[], &[count("h", 150)]), &right).len(), 1);
}

/// Situation: the built images.
/// Action: search their bytes for name, version and commit.
/// Must hold: every image contains its identity.
#[test]
fn every_image_carries_its_identity() {
    if !image::ready() {
        return;
    }
    image::build("board-vesc6").expect("the board's image builds");
    for image in image::IMAGES {
        let bytes = std::fs::read(image::path(image.name)).unwrap();
        let identity = format!("{} {} ", image.name, env!("CARGO_PKG_VERSION"));
        let at = bytes.windows(identity.len()).position(|w| w == identity.as_bytes());
        let commit = at.map(|at| &bytes[at + identity.len()..][..7]);
        let valid = |commit: &[u8]| commit == b"unknown" || commit.iter().all(u8::is_ascii_hexdigit);
        assert!(commit.is_some_and(valid), "{}", image.name);
    }
}

/// Situation: the built images, whose panic messages contain names of source files.
/// Action: search the flashed bytes for the clone's folder and cargo's.
/// Must hold: neither is there, so that the same source gives the same bytes in any folder; a source file's name is,
/// which shows that the search covers the right bytes.
#[test]
fn no_image_names_a_folder_of_this_machine() {
    if !image::ready() {
        return;
    }
    image::build("board-vesc6").expect("the board's image builds");
    let folders = [Some(image::root().to_owned()), image::cargo_home(), std::env::home_dir()];
    let folders: Vec<String> =
        folders.into_iter().flatten().map(|folder| folder.display().to_string()).collect();
    let contain = |bytes: &[u8], word: &str| bytes.windows(word.len()).any(|w| w == word.as_bytes());
    for image in image::IMAGES {
        let bytes = image::loaded(&image::path(image.name)).unwrap();
        for folder in &folders {
            assert!(!contain(&bytes, folder), "{}: {folder}", image.name);
        }
        assert!(contain(&bytes, "src/"), "{}: no source file's name", image.name);
    }
}

/// Situation: the board's image as a file with addresses and as a plain binary, as other programmers take them.
/// Action: make both by objcopy.
/// Must hold: the first leaves the store of parameters unchanged, from 0x08004000 to 0x08010000, with bytes below and
/// above; the second fills it with zeros, which is why the document has the recipe of the first.
#[test]
fn a_hex_file_leaves_the_store_alone() {
    if !image::ready() {
        return;
    }
    image::build("board-vesc6").expect("the board's image builds");
    let path = image::path("board-vesc6");
    let plain = image::loaded(&path).unwrap();
    assert!(
        plain[0x4000..0x1_0000].iter().all(|byte| *byte == 0) && plain[..0x100].iter().any(|byte| *byte != 0)
    );
    let hex = path.with_extension("hex");
    let done = Command::new("arm-none-eabi-objcopy").args(["-O", "ihex"]).arg(&path).arg(&hex).status();
    assert!(done.expect("objcopy runs").success());
    let (mut base, mut below, mut above) = (0, 0, 0);
    for line in std::fs::read_to_string(hex).unwrap().lines() {
        let number = |from: usize, to: usize| u32::from_str_radix(&line[from..to], 16).expect("hexadecimal");
        match number(7, 9) {
            // The upper half of the addresses that follow.
            4 => base = number(9, 13) << 16,
            0 if base + number(3, 7) + number(1, 3) <= 0x0800_4000 => below += number(1, 3),
            0 if base + number(3, 7) >= 0x0801_0000 => above += number(1, 3),
            0 => panic!("bytes in the store: {line}"),
            _ => {}
        }
    }
    assert_eq!(below, 0x188, "the vector table");
    assert!((100_000..900_000).contains(&above), "{above}");
}
