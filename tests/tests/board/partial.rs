//! Files that are no recordings, cut or damaged: never a success with less.

use control::Config;
use link::message::Message;
use serde_json::Value;
use tests::cli::{Bench, Run, repository};
use tests::json_schema::violations;
use tests::link_board::{LinkBoard, faults, lock, shared, telemetry};
use tests::pty::Port;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

fn done(run: &Run) -> &str {
    assert_eq!(run.code, Some(0), "{run:?}");
    &run.stdout
}

/// A run that could read only a part of its input, and reported it.
fn partly(run: &Run) -> &str {
    assert_eq!(run.code, Some(3), "{run:?}");
    &run.stdout
}

/// Situation: files that are no recordings: a table, a picture's beginning, a bicycle, nothing, 100 kB of ff; and a
/// recording of a board with messages unknown to this program.
/// Action: list the faults of each, and monitor it.
/// Must hold: no file without a frame has "no faults"; unknown messages are counted and the exit code is 3.
#[test]
fn a_wrong_file_is_not_without_faults() {
    let bench = Bench::new(PROGRAM);
    let ride = bench.run("ride --speed 4 --time-limit 0.2 --csv ride.csv");
    assert_eq!(ride.code, Some(0), "{ride:?}");
    bench.write("png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x01\0\0\0\x01\0\x08\x06\0\0\0");
    bench.write("bicycle.toml", "schema = 1\nw = 1.02\n");
    bench.write("empty", "");
    bench.write("ff", [0xff; 100_000]);
    for file in ["ride.csv", "png", "bicycle.toml", "empty", "ff"] {
        for line in ["faults --json --file", "faults --file", "monitor --file"] {
            let run = bench.run(&format!("{line} {file}"));
            assert_eq!(run.code, Some(1), "{line} {file}: {run:?}");
            assert!(run.stderr.contains(&format!("{file}: no whole frame of the link")), "{}", run.stderr);
            assert!(!run.stdout.contains("no faults") && !run.stdout.contains("faults\":"), "{}", run.stdout);
        }
    }
    let mut board = LinkBoard::default();
    let mut bytes = board.unsolicited(&Message::Telemetry(telemetry(20)));
    for sequence in 2..5 {
        let mut room = [0; link::frame::MAX_FRAME];
        let used = link::frame::encode(0xfe, sequence, &[1, 2, 3], &mut room).expect("room");
        bytes.extend(&room[..used]);
    }
    bench.write("newer.link", bytes);
    let run = bench.run("monitor --file newer.link");
    assert!(partly(&run).contains("4 frames, 0 missing, 0 damaged, 3 not understood"), "{}", run.stdout);
    let run = bench.run("faults --file newer.link --json");
    let document: Value = serde_json::from_str(partly(&run)).expect("JSON");
    let schema = std::fs::read_to_string(repository("docs/schema/faults.json")).expect("a schema");
    let schema: Value = serde_json::from_str(&schema).expect("JSON");
    assert_eq!(
        document["recording"],
        serde_json::json!({"frames": 4, "damaged": 0, "unknown": 3, "rest": 0})
    );
    assert_eq!(violations(&schema, &document), [""; 0]);
}

/// Situation: a board's log line and a panic's text with control sequences of a terminal.
/// Action: monitor the recording and list its faults.
/// Must hold: the output has no control character but line ends; the text is there.
#[test]
fn a_boards_texts_do_not_control_the_terminal() {
    let (bench, mut board) = (Bench::new(PROGRAM), LinkBoard::default());
    let mut bytes = board.unsolicited(&Message::Log("gain\u{1b}[2J set"));
    let mut fault = faults()[0];
    fault.text = "panicked\u{1b}]0;title\u{7} at main.rs";
    bytes.extend(board.unsolicited(&Message::Fault(fault)));
    bench.write("ansi.link", bytes);
    for line in ["monitor --file ansi.link", "faults --file ansi.link"] {
        let run = bench.run(line);
        assert!(done(&run).chars().all(|c| c == '\n' || !c.is_control()), "{:?}", run.stdout);
        assert!(run.stdout.contains("panicked\\u{1b}]0;title"), "{}", run.stdout);
    }
}

/// Situation: the backup of a board, and the recording of a ride.
/// Action: cut each at 60 random places, and change a byte of the backup at 40; import, or read.
/// Must hold: the backup is imported only where all its parameters are unchanged; the recording ends without a
/// message only between two frames.
#[test]
fn a_cut_file_is_no_success() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    lock(&board).config.limits.max_torque_nm = Some(6.25);
    let port = Port::quiet(&board);
    let run = |line: &str| bench.run(&format!("param {line} --port {}", port.name));
    done(&run("export whole.toml"));
    let unchanged = lock(&board).config.clone();
    let whole = bench.read("whole.toml");
    assert!(whole.contains("\ncount = 2") && whole.contains("\nchecksum = \""), "{whole}");
    done(&run("reset"));
    let values = whole.trim_end().rsplit_once('#').expect("the last remark").0.trim_end().len();
    let mut random = 14_u32;
    let mut below = |n: usize| {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (random >> 8) as usize % n
    };
    for i in 0..100 {
        let mut bytes = whole.clone().into_bytes();
        let at = if i < 5 { [0, 1, 60, values - 1, values][i] } else { below(bytes.len()) };
        if i < 60 {
            bytes.truncate(at);
        } else {
            bytes[at] ^= 1_u8 << below(7);
        }
        bench.write("part.toml", &bytes);
        let part = run("import part.toml");
        if part.code == Some(0) {
            assert_eq!(lock(&board).config, unchanged, "byte {at}: {part:?}");
            assert!(!part.stdout.contains("others stay"), "byte {at}: {part:?}");
            done(&run("reset"));
        } else {
            part.rejected_naming(&["part.toml"]);
        }
        assert_eq!(lock(&board).config, Config::product(), "byte {at}");
    }
    let old: String = whole
        .lines()
        .filter(|l| !l.starts_with("count") && !l.starts_with("checksum"))
        .take(100)
        .fold(String::new(), |text, line| text + line + "\n");
    bench.write("old.toml", old);
    let part = run("import old.toml");
    assert!(
        done(&part).contains(" of the board's 2") && part.stdout.contains("the others stay"),
        "{}",
        part.stdout
    );
    let mut board = LinkBoard::default();
    let frames: Vec<Vec<u8>> =
        (1..=40).map(|i| board.unsolicited(&Message::Telemetry(telemetry(20 * i)))).collect();
    let ends: Vec<usize> = frames
        .iter()
        .scan(0, |end, f| {
            *end += f.len();
            Some(*end)
        })
        .collect();
    let bytes = frames.concat();
    for _ in 0..60 {
        let at = 1 + below(bytes.len() - 1);
        bench.write("cut.link", &bytes[..at]);
        let code = bench.run("faults --file cut.link").code;
        // The 0 before a frame may be there already.
        let between = ends.contains(&at) || ends.contains(&(at - 1));
        let expected = if at < ends[0] {
            Some(1)
        } else if between {
            Some(0)
        } else {
            Some(3)
        };
        assert_eq!(code, expected, "byte {at} of {}", bytes.len());
    }
}

/// Situation: a recording in which the board's clock goes back by 20 ms three times, and one in which it wraps
/// around.
/// Action: monitor each.
/// Must hold: the steps back are counted and take 20 ms each; the wrap is none.
#[test]
fn a_clock_that_steps_back_is_not_71_minutes_ahead() {
    let bench = Bench::new(PROGRAM);
    let record = |clock: &dyn Fn(u32) -> u32| {
        let mut board = LinkBoard::default();
        let frames = (1..=40).flat_map(|i| {
            let mut step = telemetry(20 * i);
            step.frame.now_us = clock(i);
            board.unsolicited(&Message::Telemetry(step))
        });
        frames.collect::<Vec<u8>>()
    };
    bench.write("back.link", record(&|i| 1_000_000 + 20_000 * i - 40_000 * (i / 10).min(3)));
    let back = bench.run("monitor --file back.link");
    assert!(
        done(&back).ends_with("0 restarts, clock back 3 times; the board's clock at 1.680 s\n"),
        "{}",
        back.stdout
    );
    bench.write("round.link", record(&|i| (20_000 * i).wrapping_sub(400_000)));
    let round = bench.run("monitor --file round.link");
    assert!(done(&round).ends_with("0 restarts; the board's clock at 4295.367 s\n"), "{}", round.stdout);
}

/// Situation: a board with the product's limits, whose rider override needs a largest torque.
/// Action: set the largest torque to none; then with the override off.
/// Must hold: rejected with the parameter that needs it, not as infinity; then set.
#[test]
fn a_limit_that_another_needs_is_reported() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    let port = Port::quiet(&board);
    let run = |line: &str| bench.run(&format!("param set {line} --port {}", port.name));
    let rejected = run("limits.max_torque_nm none");
    rejected.rejected_naming(&["limits.max_torque_nm = none", "limits.rider_torque is on", "0.1 to 50"]);
    assert!(!rejected.stderr.contains("inf"), "{}", rejected.stderr);
    done(&run("limits.rider_torque off"));
    assert!(done(&run("limits.max_torque_nm none")).contains("limits.max_torque_nm = none (was 7)"));
}
