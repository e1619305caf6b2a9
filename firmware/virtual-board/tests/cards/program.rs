//! The program `virtual-board`: options, exit status, errors.

use crate::bed::product;
use sim_host::board::serial::Serial;
use sim_host::board::virtual_board::VirtualBoard;
use sim_host::board::{Client, RetryPolicy};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// For a board that starts on a machine as busy as can be: what is asked before it listens is lost, and asked again.
const TIMEOUT: RetryPolicy = RetryPolicy { answer: Duration::from_millis(400), tries: 1500 };

fn virtual_board(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_virtual-board")).args(arguments).output().expect("it can be started")
}

/// Situation: options that are wrong, and images that are none. Action: start the program. Must hold: exit status 2, and
/// one line that names the option or file and says what is wrong with it.
#[test]
fn wrong_options_and_images_are_named() {
    let here = env!("CARGO_MANIFEST_DIR");
    let text = format!("{here}/Cargo.toml");
    let own = env!("CARGO_BIN_EXE_virtual-board");
    for (arguments, words) in [
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
        assert!(words.iter().all(|word| error.contains(word)), "{arguments:?}: {error}");
    }
}

/// Situation: a file of notes given as the flash of the parameters, a folder that is not there. Action: start the program. Must hold:
/// exit status 2 before the board runs, one line that names the file; the notes are as they were.
#[test]
fn a_file_that_is_no_store_is_left_alone() {
    let Some(image) = product() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (notes, nowhere) = (folder.path().join("notes"), folder.path().join("none/store"));
    std::fs::write(&notes, "notes").unwrap();
    for (file, words) in
        [(&notes, "notes: 5 bytes, a flash of the parameters has 49152"), (&nowhere, "store: No such file")]
    {
        let [image, file] = [&image, file].map(|path| path.to_str().expect("text"));
        let output = virtual_board(&["--seconds", "0.01", "--image", image, "--store", file]);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(words) && error.lines().count() == 1, "{error}");
    }
    assert_eq!(std::fs::read(&notes).unwrap(), b"notes");
}

/// Situation: the program with its serial line on standard input and output, as `sim-host --virtual-board` starts it.
/// Action: ask who it is, for a parameter, set another, ask for its faults; then with an image that is none. Must hold:
/// the product's image answers as a board would, with the parameter's new value and no faults; the image that is none is
/// named.
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
    let refused = VirtualBoard::start(program, Some(Path::new("no-such-image"))).err().expect("no image");
    assert!(refused.to_string().contains("no-such-image"), "{refused}");
}

/// Situation: the program as a user starts it, for 3 s, its serial line at a pseudo terminal. Action: open the device it
/// names as a serial port, ask who is there, close it, open it again and set a parameter. Must hold: it is named once the
/// board has started; both are answered; the program ends by itself with status 0, and its log was written: the steps of
/// control, and that no motor is aligned.
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
            .and_then(|words| words.rsplit(' ').next())
            .map(str::to_owned);
        start.push(line);
    }
    let device = device.expect("a device");
    for words in ["board-vesc6", "imu: chip=0xd1"] {
        assert!(start.iter().any(|line| line.contains(words)), "{words} before {start:#?}");
    }
    let open = || {
        let port = Serial::open(&device, 115_200).expect("it can be opened");
        Client::new(Box::new(port), TIMEOUT)
    };
    assert_eq!(open().hello().expect("an answer").image, "board-vesc6");
    assert_eq!(open().set("limits.max_torque_nm", Some(0.5)).expect("an answer"), Some(0.5));
    let log: Vec<_> = lines.collect();
    assert!(child.wait().expect("an end").success(), "{log:#?}");
    for words in ["steps=", "motor"] {
        assert!(log.iter().any(|line| line.contains(words)), "{words}: {log:#?}");
    }
}
