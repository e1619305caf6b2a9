//! Flight cards: a board and its images are named wherever they must be.

use std::process::Command;
use toml::{Table, Value};
use xtask::image::{IMAGES, boards, root};

fn text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap()
}

fn table(path: &str) -> Table {
    text(path).parse().unwrap()
}

/// Situation: the package `firmware` with its features and images.
/// Action: compare them with `IMAGES`, which builds, budgets and documents read.
/// Must hold: the same images, each with the feature of its board; a feature and a folder for each board and no others.
#[test]
fn every_image_and_board_is_listed() {
    let manifest = table("firmware/Cargo.toml");
    let bins = manifest["bin"].as_array().unwrap().iter();
    let mut declared: Vec<(&str, &str)> = bins
        .map(|bin| (bin["name"].as_str().unwrap(), bin["required-features"][0].as_str().unwrap()))
        .collect();
    let mut listed: Vec<(&str, &str)> = IMAGES.iter().map(|image| (image.name, image.board)).collect();
    let mut sources = names("firmware/src/bin");
    declared.sort();
    listed.sort();
    sources.sort();
    assert_eq!(declared, listed);
    let mut expected: Vec<String> = declared.iter().map(|(name, _)| format!("{name}.rs")).collect();
    expected.sort();
    assert_eq!(sources, expected);

    let features = manifest["features"].as_table().unwrap().keys();
    let mut features: Vec<&str> =
        features.filter(|name| name.starts_with("board-")).map(String::as_str).collect();
    let mut folders: Vec<String> =
        names("firmware/src/board").into_iter().map(|name| format!("board-{name}")).collect();
    let mut listed = boards();
    features.sort();
    folders.sort();
    listed.sort();
    assert_eq!(features, listed);
    assert_eq!(folders, listed);
}

/// Situation: the page of the images, and the aliases of cargo.
/// Action: look for each image, and for the command that flashes it.
/// Must hold: each image has a row; each of a board has an alias, each of QEMU none.
#[test]
fn every_image_is_documented_and_each_of_a_board_has_an_alias() {
    let (page, config) = (text("docs/firmware.md"), table(".cargo/config.toml"));
    let aliases: Vec<&str> = config["alias"].as_table().unwrap().values().filter_map(Value::as_str).collect();
    for image in IMAGES {
        assert!(
            page.contains(&format!("\n| `{}` |", image.name)),
            "docs/firmware.md has no row `{}`",
            image.name
        );
        let alias = aliases.contains(&format!("xtask flash {}", image.name).as_str());
        assert_eq!(alias, image.board != "board-qemu", ".cargo/config.toml, alias of {}", image.name);
    }
}

fn names(folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(root().join(folder)).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// Situation: no probe-rs on the path.
/// Action: flash a board's image.
/// Must hold: nothing is built; one line says what is missing and how to install it.
#[test]
fn a_missing_probe_is_told_with_its_installation() {
    let mut flash = Command::new(env!("CARGO_BIN_EXE_xtask"));
    let output = flash.args(["flash", "board-vesc6"]).env("PATH", "").output().expect("xtask runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && said.trim().lines().count() == 1, "{said}");
    assert!(said.contains("probe-rs") && said.contains("cargo install probe-rs-tools --locked"), "{said}");
}
