//! Flashing of the board's images: the commands of docs/hardware.md, with a probe-rs that only records its arguments.

use std::fs::Permissions;
use std::os::unix::fs::PermissionsExt;
use std::process::Command;
use xtask::image;

/// Situation: a `probe-rs` at the front of `PATH` that prints its arguments.
/// Action: `cargo flash-vesc6` and `cargo align-vesc6`.
/// Must hold: each calls it once, to run its own image on this chip, and with both options without which probe-rs
/// halts the core at a reset or a hard fault, where docs/hardware.md promises a restart.
#[test]
fn a_flashed_chip_restarts_after_a_reset() {
    if !image::ready() {
        return;
    }
    image::build("board-vesc6").expect("the board's images build");
    let folder = tempfile::tempdir().unwrap();
    let probe = folder.path().join("probe-rs");
    std::fs::write(&probe, "#!/bin/sh\necho \"probe-rs $*\"\n").unwrap();
    std::fs::set_permissions(&probe, Permissions::from_mode(0o755)).unwrap();
    let before = std::env::var_os("PATH").unwrap_or_default();
    let path =
        std::env::join_paths([folder.path().to_owned()].into_iter().chain(std::env::split_paths(&before)));
    let path = path.unwrap();
    for (command, name) in [("flash-vesc6", "board-vesc6"), ("align-vesc6", "board-vesc6-align")] {
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
        let output = cargo.current_dir(image::root()).arg(command).env("PATH", &path).output().unwrap();
        let printed = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
        let calls: Vec<&str> = printed.lines().filter_map(|line| line.strip_prefix("probe-rs ")).collect();
        let [call] = calls[..] else { panic!("{command}: {printed}") };
        let texts: Vec<&str> = call.split(' ').collect();
        assert_eq!(texts[..3], ["run", "--chip", "STM32F405RG"], "{call}");
        assert!(
            ["--no-catch-reset", "--no-catch-hardfault"].iter().all(|word| texts.contains(word)),
            "{call}"
        );
        assert!(texts.last().is_some_and(|file| file.ends_with(&format!("/{name}"))), "{call}");
    }
}
