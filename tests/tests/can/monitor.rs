//! `sim-host monitor --can`: a board's frames from recordings and from an interface.

use super::blf::{classic, container, log, object};
use control::sensors::polarity::PolarityStep;
use control::{ActiveLimits, Cause, Causes, Mode};
use link::can::{Message, Motion, PERIOD_MS, State};
use proptest::collection::vec;
use proptest::prelude::*;
use sim_host::board::broadcast::{Broadcast, BroadcastMonitor};
use std::process::{Command, Stdio};
use std::time::Duration;
use tests::cli::{Bench, SmallDisk, repository};
use tests::draws::runner;
use tests::python;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// The frames of the broadcast `n`, in the order of their priority; the mode changes at the tenth, and every value with
/// `n`.
pub(super) fn broadcast(n: u16) -> [Message; 3] {
    let x = f32::from(n);
    let state = State {
        mode: if n < 10 { Mode::Standby } else { Mode::Engaged },
        driven: n >= 10,
        engage: true,
        polarity: PolarityStep::Passed,
        limits: ActiveLimits::RATE,
        authority: Some(0.5),
        speed_m_s: Some(4.0 + 0.01 * x),
        steps: (n * 20) as u8,
    };
    let motion = Motion {
        roll_rate_rad_s: Some(-0.1 + 0.001 * x),
        steer_rad: (n != 7).then_some(0.0001 * x),
        commanded_nm: Some(-0.02 * x),
        measured_nm: None,
    };
    // 59 and 1 together have more bits than a double.
    let causes = if n < 10 { Causes::all(&[Cause::Crash, Cause::GyroLost]) } else { Causes::NONE };
    [Message::State(state), Message::Motion(motion), Message::Causes(causes)]
}

/// Time, identifier and bytes of every frame of the first broadcasts, from 1.7e9 s on.
fn ride(broadcasts: u16) -> Vec<(f64, u16, [u8; 8])> {
    let frames = (0..broadcasts).flat_map(|n| {
        let start_s = f64::from(n) * PERIOD_MS as f64 / 1e3;
        broadcast(n).into_iter().zip(0..3).map(move |(message, k)| {
            let frame = message.frame();
            (1.7e9 + start_s + 0.0003 * f64::from(k), frame.identifier, frame.bytes)
        })
    });
    frames.collect()
}

/// Frames as a log of candump.
fn candump(frames: &[(f64, u16, [u8; 8])]) -> String {
    let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02X}")).collect::<String>();
    frames.iter().map(|(t, id, bytes)| format!("({t:.6}) can0 {id:03X}#{}\n", hex(bytes))).collect()
}

/// Frames as a log of Vector.
fn blf(frames: &[(f64, u16, [u8; 8])]) -> Vec<u8> {
    let objects = frames.iter().map(|(t, id, bytes)| {
        object(86, ((t - 1.7e9) * 1e9).round() as u64, &classic(1, 0, 8, u32::from(*id), *bytes))
    });
    log(&container(&objects.collect::<Vec<_>>().concat()))
}

/// The rows of a table below its heading.
fn rows(table: &str) -> Vec<&str> {
    table.lines().filter(|line| !line.starts_with('#')).collect()
}

/// Situation: 100 broadcasts as a log of candump and as one of Vector.
/// Action: monitor each, with a table. Must hold: the tables are equal; a row per broadcast with its values and time;
/// empty where the board does not know a value; the causes in full and in halves; nothing missing; a line of text for
/// the changed mode.
#[test]
fn a_recording_becomes_rows() {
    let (bench, frames) = (Bench::new(PROGRAM), ride(100));
    bench.write("ride.log", candump(&frames));
    bench.write("ride.blf", blf(&frames));
    let run = bench.run("monitor --can ride.log --csv log.csv");
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{run:?}");
    assert!(run.stdout.starts_with("CAN: ride.log\n"), "{}", run.stdout);
    let engaged = "0.200 s engaged, torque -0.20 N m, roll rate -0.09 rad/s, steer 0.00 rad, speed rear 4.10 m/s, \
                   authority 0.50, limits rate, causes none, missing 0";
    assert!(run.stdout.contains(engaged), "{}", run.stdout);
    assert!(run.stdout.contains("59 Crash: "), "{}", run.stdout);
    assert!(run.stdout.ends_with("300 frames, 0 missing; 1.980 s\n"), "{}", run.stdout);
    let quiet = bench.run("monitor --can ride.blf --csv -");
    assert_eq!(quiet.code, Some(0), "{quiet:?}");
    let table = bench.read("log.csv");
    let (head, data) = (rows(&table)[0], &rows(&table)[1..]);
    assert_eq!(
        head,
        "t,steps_low,driven,mode,causes,limits,torque,engage,authority,measured_roll_rate,measured_steer,\
         measured_rear_speed,measured_motor_torque,polarity,causes_low,causes_high"
    );
    assert_eq!(data.len(), 100);
    for (n, (row, other)) in data.iter().zip(&rows(&quiet.stdout)[1..]).enumerate() {
        let [cells, other] = [row, other].map(|row| row.split(',').collect::<Vec<_>>());
        let [t, other_t] = [&cells, &other].map(|cells| cells[0].parse::<f64>().unwrap());
        // A time since 1970 has steps of 0.24 us as a double.
        assert!((t - 0.02 * n as f64).abs() < 1e-6 && (t - other_t).abs() < 1e-6, "{row}");
        assert_eq!(cells[1..], other[1..]);
        let causes = if n < 10 { 1_u64 << 59 | 2 } else { 0 };
        let halves = [causes, causes & 0xffff_ffff, causes >> 32].map(|x| x.to_string());
        assert_eq!([cells[4], cells[14], cells[15]], halves.each_ref().map(String::as_str));
        let near = |cell: &str, value: f64| (cell.parse::<f64>().unwrap() - value).abs() < 1.1e-3;
        assert!(near(cells[6], -0.02 * n as f64) && near(cells[11], 4.0 + 0.01 * n as f64), "{row}");
        assert_eq!((cells[10].is_empty(), cells[12]), (n == 7, ""), "{row}");
    }
}

/// Situation: a log with two lost broadcasts, a lost frame, a frame of seven bytes, one with a mode that does not exist,
/// frames of another node and of another bus, an error frame, a request, a line that is no frame.
/// Action: monitor it.
/// Must hold: each is named and counted, exit code 3; the other rows are there, with empty cells for what is missing.
#[test]
fn what_is_missing_or_wrong_is_counted() {
    let (bench, frames) = (Bench::new(PROGRAM), ride(50));
    // Broadcasts 20 and 21 as a whole, and the causes of 30.
    let kept = |n: usize| !(60..66).contains(&n) && n != 92;
    let some: Vec<_> = frames.iter().enumerate().filter(|(n, _)| kept(*n)).map(|(_, frame)| *frame).collect();
    let (first, rest) = some.split_at(120);
    let odd = "(1700000000.850000) can0 320#04000000000000\n(1700000000.850000) can0 320#0900000000000000\n\
               (1700000000.850000) can0 7DF#0102\n(1700000000.850000) can1 320#0400000000000000\n\
               (1700000000.850000) can0 20000004#0000000000000000\n(1700000000.850000) can0 321#R8\n\
               (1700000000.850000) can0 321#XX\n";
    bench.write("odd.log", candump(first) + odd + &candump(rest));
    let run = bench.run("monitor --can odd.log --csv odd.csv");
    assert_eq!(run.code, Some(3), "{run:?}");
    let counted = "143 frames, 7 missing, 1 of a wrong length, 1 not understood, 2 of others, 1 error frame, \
                   1 remote frame; 0.980 s\n";
    assert!(run.stdout.ends_with(counted), "{}", run.stdout);
    assert_eq!(
        run.stderr,
        "warning: part of the data was not decoded: 1 frame of a wrong length, 1 frame not understood, line 127: its \
         bytes are no hexadecimal digits; left out\n\
         warning: error frames: 1; left out\nwarning: remote frames, which have no data: 1; left out\n"
    );
    let table = bench.read("odd.csv");
    let data = &rows(&table)[1..];
    assert_eq!(data.len(), 48);
    let partial: Vec<&&str> = data.iter().filter(|row| row.ends_with(",,")).collect();
    assert_eq!(partial.len(), 1, "{partial:?}");
    assert!(partial[0].starts_with("0.6"), "{partial:?}");
}

/// Situation: a log in which the count of control steps stands still for ten broadcasts, and one whose times go back.
/// Action: monitor them. Must hold: both are counted.
#[test]
fn a_stopped_controller_is_counted() {
    let (bench, mut frames) = (Bench::new(PROGRAM), ride(40));
    for n in 21..=30 {
        frames[3 * n].2[7] = frames[60].2[7];
    }
    bench.write("stopped.log", candump(&frames));
    let run = bench.run("monitor --can stopped.log");
    assert!(
        run.stdout.ends_with("120 frames, 0 missing, 10 broadcasts with control stopped; 0.780 s\n"),
        "{run:?}"
    );
    let mut frames = ride(40);
    frames[60..].iter_mut().for_each(|(t, ..)| *t -= 0.3);
    bench.write("back.log", candump(&frames));
    let run = bench.run("monitor --can back.log");
    assert!(run.stdout.contains("120 frames, 0 missing, 1 time back"), "{run:?}");
}

/// Situation: a log whose logger gets its date after 20 of 40 broadcasts, a day ahead: between two broadcasts, and between the frames
/// of one, after the first and after the second; one in which the board was off for ten seconds; one in which control stood still for ten
/// seconds without a frame.
/// Action: monitor them.
/// Must hold: in the first nothing is missing, all frames are in the table, and the jump is told with its size and place, exit code 0;
/// in the others the frames of the gap are missing, and no jump is told.
#[test]
fn a_jump_of_the_loggers_date_is_no_gap() {
    let bench = Bench::new(PROGRAM);
    for (at, rows_of_it) in [(60, 40), (61, 41), (62, 41)] {
        let mut frames = ride(40);
        frames[at..].iter_mut().for_each(|(t, ..)| *t += 86400.0);
        bench.write("date.log", candump(&frames));
        let run = bench.run("monitor --can date.log --csv date.csv");
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{at}: {run:?}");
        let counted = "120 frames, 0 missing, 1 jump of the clock ahead; 86400.780 s\n";
        assert!(run.stdout.ends_with(counted), "{at}: {}", run.stdout);
        let told = run.stdout.lines().filter(|line| line.contains("clock jumped ahead by 86400.0")).count();
        assert_eq!(told, 1, "{at}: {}", run.stdout);
        assert_eq!(rows(&bench.read("date.csv")).len(), rows_of_it + 1, "{at}");
    }
    // 507 periods are 10140 steps, 156 modulo 256; 504 of a controller that stands still are none.
    let gap = |periods: f64, stands: bool| {
        let mut frames = ride(40);
        frames[60..].iter_mut().for_each(|(t, ..)| *t += periods * 0.02);
        let lost = if stands { 0 } else { ((periods as u64 * 20) % 256) as u8 };
        let stood = frames[54].2[7];
        for k in 0..40 {
            let steps = &mut frames[3 * k].2[7];
            *steps = match (stands, k >= 19) {
                (true, true) => stood,
                (true, false) => *steps,
                (false, _) => {
                    if k >= 20 {
                        steps.wrapping_add(lost)
                    } else {
                        *steps
                    }
                }
            };
        }
        bench.write("gap.log", candump(&frames));
        bench.run("monitor --can gap.log")
    };
    for (run, missing) in [(gap(507.0, false), 1521), (gap(504.0, true), 1512)] {
        assert_eq!(run.code, Some(0), "{run:?}");
        assert!(run.stdout.contains(&format!("120 frames, {missing} missing")), "{}", run.stdout);
        assert!(!run.stdout.contains("jump"), "{}", run.stdout);
    }
}

/// Situation: a log with frames of CAN FD, of the board's identifiers and of others, and remote frames with their length codes, as
/// `candump -L` and the screen show them; standard output is a table.
/// Action: monitor.
/// Must hold: frames of eight bytes are read; others are counted; what has no data is left out with a warning that counts it.
#[test]
fn frames_of_other_kinds_are_read_or_told() {
    let bench = Bench::new(PROGRAM);
    let mut log = candump(&ride(10));
    log = log.replacen(" 320#", " 320##1", 1);
    log += "(1700000000.500000) can0 7DF##0010203040506070809101112\n(1700000000.500000) can0 321#R8_B\n\
            (1700000000.500000) can0 321#R\n(1700000000.500000) can0 20000004#0000000000000000\n";
    bench.write("kinds.log", log);
    let run = bench.run("monitor --can kinds.log --csv -");
    assert_eq!(run.code, Some(0), "{run:?}");
    assert_eq!(rows(&run.stdout).len(), 11, "{}", run.stdout);
    assert_eq!(
        run.stderr,
        "warning: error frames: 1; left out\nwarning: remote frames, which have no data: 2; left out\n"
    );
    let run = bench.run("monitor --can kinds.log");
    assert!(
        run.stdout.contains("30 frames, 0 missing, 1 of others, 1 error frame, 2 remote frames"),
        "{run:?}"
    );
}

/// Situation: a small file system that is full after some rows, with a recording and with a recording of the link.
/// Action: monitor them with --mcap, and with --csv; with a place in a folder that is not there.
/// Must hold: exit code 1; the file and "No space left", or the missing folder, are named; no part of an MCAP file is left.
#[test]
fn a_full_disk_is_named() {
    let bench = Bench::new(PROGRAM);
    bench.write("ride.log", candump(&ride(2000)));
    bench
        .run("monitor --can ride.log --mcap no/ride.mcap")
        .rejected_naming(&["no/ride.mcap", "no folder no"]);
    let Some(_disk) = SmallDisk::mounted(bench.path("disk"), 64 * 1024) else {
        eprintln!("skipped: no right to mount a small file system");
        return;
    };
    let run = bench.run("monitor --can ride.log --mcap disk/ride.mcap");
    assert_eq!(run.code, Some(1), "{run:?}");
    assert!(run.stderr.contains("can't write disk/ride.mcap: No space left"), "{}", run.stderr);
    assert_eq!(std::fs::read_dir(bench.path("disk")).unwrap().count(), 0);
    let run = bench.run("monitor --can ride.log --csv disk/ride.csv");
    assert_eq!(run.code, Some(1), "{run:?}");
    assert!(run.stderr.contains("can't write disk/ride.csv: No space left"), "{}", run.stderr);
    bench
        .run("ride --speed 4 --mcap disk/again.mcap -q")
        .rejected_naming(&["disk/again.mcap", "No space left"]);
    let names = std::fs::read_dir(bench.path("disk")).unwrap().map(|entry| entry.unwrap().file_name());
    assert_eq!(names.collect::<Vec<_>>(), ["ride.csv"]);
}

/// Situation: a small file system that is full after some rows, and a place beside it.
/// Action: monitor a recording of CAN and one of the link with the table on the one and MCAP on the other, and both on the small one.
/// Must hold: exit code 1; each file that can't be written is named; the table ends with a whole row; the MCAP file beside it is
/// complete, with at least the rows of the table; of a full MCAP file nothing is left, and the table beside it has rows.
#[test]
fn a_file_is_completed_where_another_is_full() {
    let bench = Bench::new(PROGRAM);
    bench.write("ride.log", candump(&ride(3000)));
    let Some(_disk) = SmallDisk::mounted(bench.path("disk"), 64 * 1024) else {
        eprintln!("skipped: no right to mount a small file system");
        return;
    };
    let failed = |files: &str, named: &[&str]| {
        let run = bench.run(&format!("monitor --can ride.log {files}"));
        assert_eq!(run.code, Some(1), "{run:?}");
        for name in named {
            assert!(run.stderr.contains(&format!("can't write {name}: No space left")), "{}", run.stderr);
        }
    };
    let whole_rows = |table: &str| {
        let table = bench.read(table);
        assert!(table.ends_with('\n'), "{}", &table[table.len() - 80..]);
        let width = |row: &str| row.split(',').count();
        let rows = rows(&table);
        assert!(rows.len() > 50 && rows.iter().all(|row| width(row) == width(rows[0])));
        rows.len() - 1
    };
    failed("--csv disk/ride.csv --mcap ride.mcap", &["disk/ride.csv"]);
    let rows = whole_rows("disk/ride.csv");
    let mcap = std::fs::read(bench.path("ride.mcap")).unwrap();
    assert!(mcap.ends_with(b"\x89MCAP0\r\n"), "no end");
    let messages = mcap.windows(15).filter(|bytes| *bytes == b"\"authority\":0.5").count();
    assert!(messages >= rows, "{messages} {rows}");
    std::fs::remove_file(bench.path("disk/ride.csv")).unwrap();
    failed("--mcap disk/ride.mcap --csv ride.csv", &["disk/ride.mcap"]);
    assert!(!bench.path("disk/ride.mcap").exists());
    whole_rows("ride.csv");
    let full = vec![0; 62 * 1024];
    std::fs::write(bench.path("disk/full"), full).unwrap();
    failed("--mcap disk/ride.mcap --csv disk/ride.csv", &["disk/ride.csv"]);
}

/// Situation: a log of Vector that was cut; one without a board's frames; a file that is no log; a name that is neither
/// a file nor an interface; outputs that a recording cannot have; options without effect on a recording.
/// Action: monitor. Must hold: the first is read up to its end and reported, exit code 3; the others are rejected, with
/// the reason, wrong usage with exit code 2 and the option; no table is left.
#[test]
fn what_cannot_be_monitored_is_rejected() {
    let bench = Bench::new(PROGRAM);
    let whole = blf(&ride(30));
    bench.write("cut.blf", &whole[..whole.len() / 2]);
    let run = bench.run("monitor --can cut.blf");
    assert_eq!(run.code, Some(3), "{run:?}");
    assert!(run.stderr.contains("cut"), "{}", run.stderr);
    let frames: u32 = run.stdout.lines().last().unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((40..=45).contains(&frames), "{}", run.stdout);

    bench.write("other.log", "(1.0) can0 7DF#0102\n");
    bench.run("monitor --can other.log --csv no.csv").rejected_naming(&[
        "other.log",
        "1 frame, none",
        "0x320 to 0x322",
    ]);
    bench.write("no.log", "nothing\n");
    bench.run("monitor --can no.log").rejected_naming(&["no.log"]);
    bench.run("monitor --can nowhere0").rejected_naming(&["nowhere0", "no file"]);
    bench.write("ride.log", candump(&ride(3)));
    for (line, option) in [
        ("--can ride.log --record again.log", "--record"),
        ("--can ride.log --for 3s", "--for"),
        ("--can ride.log --baud 9600", "--baud"),
        ("--can ride.log --reopen 3s", "--reopen"),
        ("--file ride.link --baud 9600", "--baud"),
        ("--file ride.link --for 3s", "--for"),
        ("--qemu --baud 9600", "--baud"),
        ("--virtual-board --reopen 3s", "--reopen"),
    ] {
        let run = bench.run(&format!("monitor {line}"));
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{line}: {run:?}");
        assert!(run.stderr.contains(option), "{line}: {}", run.stderr);
    }
    bench.run("monitor --can ride.log --mcap -").rejected_naming(&["--mcap", "standard output"]);
    bench.run("monitor --can ride.log --csv a --mcap a").rejected_naming(&["--csv", "--mcap"]);
    let run = bench.run("monitor --can ride.log --file ride.link");
    assert_eq!(run.code, Some(2), "{run:?}");
    assert_eq!(bench.files(), ["cut.blf", "no.log", "other.log", "ride.log"]);
}

/// Situation: the same ride in ASC and BLF as python-can writes them.
/// Action: monitor each. Must hold: the rows of candump's log, but for rounded times.
#[test]
fn python_cans_logs_give_the_same_rows() {
    let Some(python) = python::venv("can") else { return };
    let bench = Bench::new(PROGRAM);
    bench.write("ride.log", candump(&ride(100)));
    let [log, asc, blf] = ["ride.log", "ride.asc", "ride.blf"].map(|name| bench.path(name));
    python::checked(&python, "can_convert.py", &[log.as_os_str(), asc.as_os_str(), blf.as_os_str()]);
    let tables = ["ride.log", "ride.asc", "ride.blf"].map(|name| {
        let run = bench.run(&format!("monitor --can {name} --csv -"));
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{name}");
        run.stdout
    });
    let [log, others @ ..] = tables.each_ref().map(|table| rows(table));
    for other in others {
        assert_eq!(other.len(), 101);
        for (row, other) in log.iter().zip(other).skip(1) {
            let ((t, rest), (other_t, other_rest)) =
                (row.split_once(',').unwrap(), other.split_once(',').unwrap());
            assert!((t.parse::<f64>().unwrap() - other_t.parse::<f64>().unwrap()).abs() < 2e-6);
            assert_eq!(rest, other_rest);
        }
    }
}

/// Situation: frames of any times, identifiers and lengths, among them the board's.
/// Action: process them.
/// Must hold: every frame is counted once, and every decoded one is in one row.
#[test]
fn any_frames_are_counted_once() {
    let time = prop_oneof![4 => 0.0..2.0_f64, 1 => any::<f64>().prop_filter("a time", |t| t.is_finite())];
    let id = prop_oneof![4 => (0x320_u16..0x323).prop_map(Some), 1 => any::<Option<u16>>()];
    let data = prop_oneof![4 => any::<[u8; 8]>().prop_map(Vec::from), 1 => vec(any::<u8>(), 0..=64)];
    let small = data.prop_map(|mut data| {
        // Mostly modes that exist.
        data.first_mut().into_iter().for_each(|mode| *mode %= 8);
        data
    });
    runner(1000)
        .run(&vec((time, id, small), 0..200), |frames| {
            let mut monitor = BroadcastMonitor::default();
            let mut rows = Vec::new();
            for (time_s, id, data) in &frames {
                rows.extend(monitor.take(*time_s, *id, data));
            }
            rows.extend(monitor.end());
            let counts = monitor.counts;
            let all = counts.frames + counts.wrong_length + counts.unknown + counts.other;
            prop_assert_eq!(all, frames.len() as u64);
            let parts = |row: &Broadcast| {
                u64::from(row.state.is_some())
                    + u64::from(row.motion.is_some())
                    + u64::from(row.causes.is_some())
            };
            prop_assert_eq!(rows.iter().map(parts).sum::<u64>(), counts.frames);
            prop_assert!(rows.iter().all(|row| parts(row) > 0));
            Ok(())
        })
        .unwrap();
}

/// Situation: an interface of the kernel (vcan), on which Python's standard library sends a board's frames.
/// Action: monitor it for a while, with a table and a log. Must hold: a row per broadcast, and the log gives them again.
/// Skipped where the kernel has no vcan or this user may not add one.
#[test]
fn an_interface_is_monitored() {
    const INTERFACE: &str = "vcantest0";
    let ip = |arguments: &[&str]| Command::new("ip").args(arguments).stderr(Stdio::null()).status();
    let _ = ip(&["link", "delete", INTERFACE]);
    let added = ip(&["link", "add", "dev", INTERFACE, "type", "vcan"]);
    if !added.is_ok_and(|status| status.success()) {
        return eprintln!("skipped: no vcan here; recordings are monitored by the tests beside this one");
    }
    assert!(ip(&["link", "set", INTERFACE, "up"]).is_ok_and(|status| status.success()));
    let bench = Bench::new(PROGRAM);
    bench.write("ride.log", candump(&ride(50)));
    let mut command =
        bench.command(&format!("monitor --can {INTERFACE} --for 4s --csv live.csv --record live.log"));
    let mut child = command.stdout(Stdio::null()).spawn().expect("the program runs");
    std::thread::sleep(Duration::from_secs(1));
    let send = repository("tests/python/can_send.py");
    let sent = Command::new("python3").arg(send).arg(INTERFACE).arg(bench.path("ride.log")).status();
    assert!(sent.is_ok_and(|status| status.success()));
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    let _ = ip(&["link", "delete", INTERFACE]);
    let live = bench.read("live.csv");
    assert_eq!(rows(&live).len(), 51);
    let again = bench.run("monitor --can live.log --csv -");
    assert_eq!(rows(&again.stdout).len(), 51, "{again:?}");
}
