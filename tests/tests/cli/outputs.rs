//! Output files: their contents, and that they are complete or absent.
#![cfg(unix)]

use control::wire::FRAME_BYTES;
use serde_json::Value;
use sim_host::report::output::Output;
use tests::cli::{Bench, SmallDisk};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
const COMMANDS: [&str; 3] = [
    "basin --speeds 4:5:0.5 --scan-step 2 --max-rate 4 --time-limit 1",
    "ride --speed 4 --steer-rate 5 --preset product",
    "eigen --speeds 0:10:1 --law h",
];

/// The program's name, version and commit as in texts, from a document.
fn identity(document: &Value) -> String {
    let tool = |key: &str| document["tool"][key].as_str().unwrap();
    assert_eq!(tool("version"), env!("CARGO_PKG_VERSION"));
    let commit = tool("commit");
    assert!(commit == "unknown" || commit.chars().all(|c| c.is_ascii_hexdigit()), "{commit}");
    format!("{} {} commit {commit}", tool("name"), tool("version"))
}

/// Checks that every value of `config` is in the document.
fn agrees(config: &Value, document: &Value) {
    let keys = config.as_object().unwrap();
    assert!(keys.contains_key("config") || keys.contains_key("bicycle"));
    for (key, value) in keys {
        assert_eq!(value, &document[key], "{key}");
    }
}

/// The text of a PNG's `tEXt` chunk with the keyword Description.
fn png_description(png: &[u8]) -> String {
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    let mut rest = &png[8..];
    while let [a, b, c, d, kind @ ..] = rest {
        let length = u32::from_be_bytes([*a, *b, *c, *d]) as usize;
        let data = &kind[4..4 + length];
        if let Some(text) = data.strip_prefix(b"Description\0").filter(|_| kind.starts_with(b"tEXt")) {
            return text.iter().map(|&byte| char::from(byte)).collect();
        }
        rest = &kind[4 + length + 4..];
    }
    panic!("no description");
}

/// Situation: each command that writes files, with all of them requested.
/// Action: run it.
/// Must hold: CSV, SVG and PNG contain the document's version, commit and configuration.
#[test]
fn every_file_carries_version_commit_and_configuration() {
    for line in COMMANDS {
        let bench = Bench::new(PROGRAM);
        let run = bench.run(&format!("{line} --json o.json --csv o.csv --svg o.svg --png o.png"));
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{line}");
        assert_eq!(bench.files(), ["o.csv", "o.json", "o.png", "o.svg"]);
        let document: Value = serde_json::from_str(&bench.read("o.json")).unwrap();
        let identity = identity(&document);
        let csv = bench.read("o.csv");
        let mut head = csv.lines().map(|l| l.strip_prefix("# ").unwrap_or(""));
        assert_eq!(head.next(), Some(identity.as_str()));
        agrees(&serde_json::from_str(head.next().unwrap()).unwrap(), &document);
        let svg = bench.read("o.svg");
        let description = svg.split("<desc>").nth(1).expect("a description").split("</desc>").next().unwrap();
        let svg_text = description.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
        let png_text = png_description(&std::fs::read(bench.path("o.png")).unwrap());
        for text in [svg_text, png_text] {
            let config = text.strip_prefix(&format!("{identity} ")).expect("the identity");
            agrees(&serde_json::from_str(config).unwrap(), &document);
        }
    }
}

/// Situation: tables of each command.
/// Action: read them.
/// Must hold: the documented columns, as many rows as there are results, every cell a number or text, no NaN.
#[test]
fn tables_have_their_documented_columns() {
    let bench = Bench::new(PROGRAM);
    let columns = [
        "speed_m_s,rate_rad_s,outcome,time_to_fall_s,fall,capped",
        "t,roll,steer,pitch,roll_rate,steer_rate,yaw_rate,rear_wheel_rate,rear_speed,front_speed,\
         measured_roll_rate,measured_speed,torque,limits,rider_torque,motor_torque,mode,causes,causes_low,causes_high",
        "speed_m_s,re1,im1,re2,im2,re3,im3,re4,im4",
    ];
    // Three speeds of two scan points and a border each; 6 s of 1 ms; eleven speeds.
    for ((line, columns), rows) in COMMANDS.into_iter().zip(columns).zip([9, 6000, 11]) {
        let table = bench.run(&format!("{line} --csv -")).stdout;
        let mut lines = table.lines().skip(2);
        assert_eq!(lines.next(), Some(columns));
        assert_eq!(lines.clone().count(), rows, "{line}");
        let width = columns.split(',').count();
        assert!(lines.all(|l| l.split(',').count() == width && !l.contains("NaN") && !l.contains("inf")));
    }
}

/// Situation: an older, longer file where the result goes, and a link to a file.
/// Action: write there.
/// Must hold: the file is the new result and nothing else; the link is still one.
#[test]
fn results_replace_older_files_and_follow_links() {
    let bench = Bench::new(PROGRAM);
    bench.write("out.json", "x".repeat(100_000));
    std::os::unix::fs::symlink("out.json", bench.path("link.json")).unwrap();
    assert_eq!(bench.run("ride --speed 4 --json link.json").code, Some(0));
    assert!(serde_json::from_str::<Value>(&bench.read("out.json")).is_ok());
    assert!(bench.path("link.json").is_symlink());
    assert_eq!(bench.files(), ["link.json", "out.json"]);
}

/// Situation: a named pipe as output.
/// Action: write there, and read the other end.
/// Must hold: the document is received; the pipe is still a pipe.
#[test]
fn a_pipe_is_written_to_and_not_replaced() {
    let bench = Bench::new(PROGRAM);
    let run = bench
        .shell("mkfifo pipe && { \"$0\" ride --speed 4 -q --json pipe & cat pipe; wait; test -p pipe; }");
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(serde_json::from_str::<Value>(&run.stdout).is_ok());
    assert_eq!(bench.files(), ["pipe"]);
}

/// Situation: standard output is redirected to a file.
/// Action: write a document to `/dev/stdout`, after another line.
/// Must hold: the file has the line and the document, and no text besides.
#[test]
fn standard_output_by_another_name_is_not_replaced() {
    let bench = Bench::new(PROGRAM);
    let run = bench.shell("{ echo first; \"$0\" ride --speed 4 --json /dev/stdout; } > out");
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{run:?}");
    let text = bench.read("out");
    let document = text.strip_prefix("first\n").unwrap_or_else(|| panic!("{text}"));
    assert!(serde_json::from_str::<Value>(document).is_ok(), "{document}");
}

/// Situation: standard output takes no more.
/// Action: request the help and the version, of the program and of a command.
/// Must hold: exit code 1 naming the place.
#[test]
fn help_that_cannot_be_written_is_an_error() {
    let bench = Bench::new(PROGRAM);
    for words in ["--help", "--version", "help ride", "basin -h"] {
        let run = bench.shell(&format!("\"$0\" {words} > /dev/full"));
        run.rejected_naming(&["standard output", "No space left"]);
        assert_eq!(bench.run(words).code, Some(0), "{words}");
    }
}

/// Situation: a disk that is full after half a kilobyte.
/// Action: write a document over an older one, and one to standard output.
/// Must hold: exit code 1 naming the place; the older file unchanged, nothing beside it.
#[test]
fn a_full_disk_leaves_the_older_file() {
    let bench = Bench::new(PROGRAM);
    bench.write("old.json", "older result");
    let full = "trap '' XFSZ; ulimit -f 1; \"$0\" ride --speed 4 --time-limit 0.1 -q";
    bench.shell(&format!("{full} --json old.json")).rejected_naming(&["old.json", "large"]);
    assert_eq!((bench.files(), bench.read("old.json").as_str()), (vec!["old.json".into()], "older result"));
    let run = bench.shell(&format!("({full} --json) > out.json"));
    run.rejected_naming(&["standard output", "large"]);
}

/// Situation: a folder that is removed while a result is computed for it; one that takes no file; a full file system.
/// Action: write the result.
/// Must hold: the error names the file and the missing folder, or "No space left", with no file left.
#[test]
fn a_lost_place_is_named() {
    let bench = Bench::new(PROGRAM);
    std::fs::create_dir(bench.path("there")).unwrap();
    let output = Output::create(&bench.path("there/ride.json")).unwrap();
    std::fs::remove_dir(bench.path("there")).unwrap();
    let error = output.finish(b"{}").unwrap_err().to_string();
    for words in ["can't write ", "there/ride.json: there is no folder ", "/there"] {
        assert!(error.contains(words), "{words}: {error}");
    }
    let run = bench.run("ride --speed 4 -q --csv /proc/ride.csv");
    run.rejected_naming(&["can't write /proc/ride.csv: no file can be made in /proc"]);
    let Some(_disk) = SmallDisk::mounted(bench.path("disk"), 16 * 1024) else {
        eprintln!("skipped: no right to mount a small file system");
        return;
    };
    for option in ["--csv", "--frames", "--netcdf", "--mcap", "--svg"] {
        let run = bench.run(&format!("ride --speed 4 -q {option} disk/ride"));
        run.rejected_naming(&["can't write disk/ride", "No space left"]);
        assert_eq!(std::fs::read_dir(bench.path("disk")).unwrap().count(), 0, "{option}");
    }
}

/// Situation: a ride with its frames and its table requested.
/// Action: run it, once with the frames on standard output.
/// Must hold: complete frames, one for each line of the table after those of the warm start; the same bytes, and no
/// text among them.
#[test]
fn frames_are_as_many_as_lines_of_the_table() {
    let bench = Bench::new(PROGRAM);
    bench.run("ride --speed 4 --steer-rate 2 --csv o.csv --frames o.frames");
    let frames = std::fs::read(bench.path("o.frames")).unwrap();
    let (whole, rest) = (frames.len() / FRAME_BYTES, frames.len() % FRAME_BYTES);
    let lines = bench.read("o.csv").lines().count() - 3;
    assert!(rest == 0 && whole > lines && whole < lines + 100, "{whole} {rest} {lines}");
    let output = bench.command("ride --speed 4 --steer-rate 2 --frames -").output().unwrap();
    assert!(output.stdout == frames);
}

/// Situation: quiet, documents on standard output, and neither.
/// Action: run a command.
/// Must hold: text only where no document goes; nothing on standard error.
#[test]
fn text_and_documents_do_not_mix() {
    let bench = Bench::new(PROGRAM);
    for line in COMMANDS {
        let talk = bench.run(line);
        assert!(talk.code == Some(0) && talk.stdout.lines().count() >= 2, "{talk:?}");
        let quiet = bench.run(&format!("{line} -q"));
        assert_eq!((talk.stderr.as_str(), quiet.stderr.as_str(), quiet.stdout.as_str()), ("", "", ""));
        assert!(bench.json(line)["schema"] == 1);
    }
}

/// Situation: a product ride whose clock jumps and whose gyro is lost, causes of which the numbers are far apart.
/// Action: read its table like a program that has doubles only.
/// Must hold: the bits of `causes` are lost to it, those of the two halves are not.
#[test]
fn causes_survive_a_reader_of_doubles() {
    let bench = Bench::new(PROGRAM);
    let faults = "--fault clock:jump=0.02@300ms --fault gyro:missing@301ms";
    let table = bench
        .run(&format!("ride --speed 4 --steer-rate 1 --preset product --time-limit 0.4 {faults} --csv -"))
        .stdout;
    let mut rows = table.lines().skip(2);
    let names: Vec<&str> = rows.next().expect("names").split(',').collect();
    let place = |name| names.iter().position(|n| *n == name).expect("a column");
    let (whole, low, high) = (place("causes"), place("causes_low"), place("causes_high"));
    let mut lost = 0;
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let double = |i: usize| cells[i].parse::<f64>().expect("a number") as u64;
        let causes: u64 = cells[whole].parse().expect("a whole number");
        assert_eq!(double(high) << 32 | double(low), causes);
        lost += u32::from(double(whole) != causes);
    }
    assert!((50..150).contains(&lost), "{lost}");
}
