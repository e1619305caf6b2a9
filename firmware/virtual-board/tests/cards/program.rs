//! The program `virtual-board`: options, exit status, errors.

use crate::bed::product;
use sim_host::board::serial::Serial;
use sim_host::board::virtual_board::{VirtualBoard, default_program};
use sim_host::board::{Client, RetryPolicy};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;
use xtask::virtual_board::{cargo_build, program};

/// For a board that starts on a very busy machine: requests sent before it listens are lost, and repeated.
const TIMEOUT: RetryPolicy = RetryPolicy { answer: Duration::from_millis(400), tries: 1500 };

fn virtual_board(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_virtual-board")).args(arguments).output().expect("it can be started")
}

/// Situation: the command that builds the program, in any environment.
/// Action: compare its target directory with the places where `cargo xtask virtual-board` and `sim-host` look.
/// Must hold: the program is built where both start it, whatever `CARGO_TARGET_DIR` says.
#[test]
fn it_is_built_where_it_is_started() {
    let build = cargo_build();
    let into =
        build.get_args().skip_while(|word| *word != "--target-dir").nth(1).expect("a target directory");
    let built = Path::new(into).join("virtual-board/virtual-board");
    assert_eq!([default_program(), program()], [built.clone(), built]);
}

/// Situation: wrong options, and files that are no images.
/// Action: start the program.
/// Must hold: exit status 2, and one line that names the option or file and the reason.
#[test]
fn wrong_options_and_images_are_named() {
    let here = env!("CARGO_MANIFEST_DIR");
    let text = format!("{here}/Cargo.toml");
    let own = env!("CARGO_BIN_EXE_virtual-board");
    for (arguments, texts) in [
        (vec!["--seconds", "0"], vec!["--seconds", "0.001", "100000"]),
        (vec!["--cycles-per-instruction", "0.5"], vec!["--cycles-per-instruction", "1", "4"]),
        (vec!["--image", "no-such-image"], vec!["no-such-image", "No such file"]),
        (vec!["--image", &text], vec!["Cargo.toml"]),
        (vec!["--image", own], vec!["virtual-board"]),
        (vec!["--image", "x", "--align"], vec!["--align"]),
    ] {
        let output = virtual_board(&arguments);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(texts.iter().all(|text| error.contains(text)), "{arguments:?}: {error}");
    }
}

/// Situation: a file of notes given as the flash of the parameters, a folder that does not exist.
/// Action: start the program.
/// Must hold: exit status 2 before the board runs, one line that names the file; the notes are unchanged.
#[test]
fn a_file_that_is_no_store_is_left_alone() {
    let Some(image) = product() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (notes, nowhere) = (folder.path().join("notes"), folder.path().join("none/store"));
    std::fs::write(&notes, "notes").unwrap();
    for (file, texts) in
        [(&notes, "notes: 5 bytes, a flash of the parameters has 49152"), (&nowhere, "store: No such file")]
    {
        let [image, file] = [&image, file].map(|path| path.to_str().expect("text"));
        let output = virtual_board(&["--seconds", "0.01", "--image", image, "--store", file]);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(texts) && error.lines().count() == 1, "{error}");
    }
    assert_eq!(std::fs::read(&notes).unwrap(), b"notes");
}

/// Situation: the program with its serial line on standard input and output, as `sim-host --virtual-board` starts it.
/// Action: request its identity and a parameter, set another, request its faults; then with a file that is no image.
/// Must hold: the product's image answers as a board would, with the parameter's new value and no faults; the wrong
/// file is named.
#[test]
fn the_tools_of_a_board_reach_it() {
    let Some(image) = product() else { return };
    let program = Path::new(env!("CARGO_BIN_EXE_virtual-board"));
    let line = VirtualBoard::start(program, Some(&image)).expect("it starts");
    let mut client = Client::new(Box::new(line), TIMEOUT);
    assert_eq!(client.hello().expect("an answer").image, "board-vesc6");
    let rate_hz = client.get("rate_hz").expect("an answer");
    assert_eq!(rate_hz, Some(1000.0));
    assert_eq!(client.set("limits.max_torque_nm", Some(0.5)).expect("an answer"), Some(0.5));
    assert!(client.faults().expect("an answer").is_empty());
    let error = VirtualBoard::start(program, Some(Path::new("no-such-image"))).err().expect("no image");
    assert!(error.to_string().contains("no-such-image"), "{error}");
}

/// Situation: the program as a user starts it, for 3 s, its serial line at a pseudo terminal.
/// Action: open the device it names as a serial port, request the identity, close it, open it again and set a
/// parameter.
/// Must hold: it is named once the board has started; both are answered; the program ends by itself with status 0,
/// and its log was written: the steps of control, and that no motor is aligned.
#[test]
fn its_pseudo_terminal_is_a_serial_port() {
    let Some(image) = product() else { return };
    let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-board"));
    command.args(["--seconds", "3", "--image"]).arg(image).stderr(Stdio::piped());
    let mut child = command.spawn().expect("it starts");
    let mut lines =
        BufReader::new(child.stderr.take().expect("its log")).lines().map(|line| line.expect("text"));
    let (mut start, mut device) = (Vec::new(), None);
    while device.is_none() {
        let line = lines.next().expect("a line");
        device = line
            .strip_prefix("serial line at ")
            .and_then(|texts| texts.rsplit(' ').next())
            .map(str::to_owned);
        start.push(line);
    }
    let device = device.expect("a device");
    for texts in ["board-vesc6", "imu: chip=0xd1"] {
        assert!(start.iter().any(|line| line.contains(texts)), "{texts} before {start:#?}");
    }
    let open = || {
        let port = Serial::open(&device, 115_200).expect("it can be opened");
        Client::new(Box::new(port), TIMEOUT)
    };
    assert_eq!(open().hello().expect("an answer").image, "board-vesc6");
    assert_eq!(open().set("limits.max_torque_nm", Some(0.5)).expect("an answer"), Some(0.5));
    let log: Vec<_> = lines.collect();
    assert!(child.wait().expect("an end").success(), "{log:#?}");
    for texts in ["steps=", "motor"] {
        assert!(log.iter().any(|line| line.contains(texts)), "{texts}: {log:#?}");
    }
}
