//! Results in other people's programs: Python, Octave, R.

use std::ffi::OsStr;
use std::process::{Command, Stdio};
use tests::cli::{Bench, Run, repository};
use tests::python;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// A code block of a page and the output printed below it.
struct Block {
    language: String,
    code: String,
    output: String,
}

/// The fenced blocks of `docs/data.md`: the commands of the first, and the others with the output that follows them.
fn page() -> (Vec<String>, Vec<Block>) {
    let text = std::fs::read_to_string(repository("docs/data.md")).expect("the page");
    let mut fences =
        text.split("```").skip(1).step_by(2).map(|block| block.split_once('\n').expect("a language"));
    let ("sh", commands) = fences.next().expect("the commands") else { panic!("the commands come first") };
    let commands = commands.lines().map(|line| line.trim_start_matches("sim-host ").to_owned()).collect();
    let mut blocks = Vec::new();
    while let Some((language, code)) = fences.next() {
        let ("text", output) = fences.next().expect("an output") else { panic!("no output below {code}") };
        blocks.push(Block { language: language.into(), code: code.into(), output: output.into() });
    }
    (commands, blocks)
}

/// A folder with the files of the page.
fn results(commands: &[String]) -> Bench {
    let bench = Bench::new(PROGRAM);
    for command in commands {
        let run = bench.run(&format!("{command} -q"));
        assert_eq!(run.code, Some(0), "{command}: {}", run.stderr);
    }
    bench
}

/// Lines that are not empty, without blanks at their ends.
fn lines(text: &str) -> Vec<&str> {
    text.lines().map(str::trim_end).filter(|line| !line.is_empty()).collect()
}

/// An interpreter that reads a file of the language.
struct Interpreter {
    language: &'static str,
    program: std::path::PathBuf,
    arguments: &'static [&'static str],
}

impl Interpreter {
    fn run(&self, bench: &Bench, code: &str) -> Run {
        bench.write("block", code);
        let mut command = Command::new(&self.program);
        command
            .args(self.arguments)
            .arg(bench.path("block"))
            .current_dir(bench.path("."))
            .stdin(Stdio::null());
        command.output().unwrap_or_else(|e| panic!("{}: {e}", self.program.display())).into()
    }
}

/// The interpreters on this machine that have the packages of the page; the others are named as skipped.
fn interpreters() -> Vec<Interpreter> {
    let installed = |language, program: &'static str, test: [&str; 2], arguments, packages: &str| {
        let tried = Command::new(program).args(arguments).args(test).stdin(Stdio::null()).output();
        let there = tried.is_ok_and(|run| run.status.success());
        if !there {
            eprintln!("skipped: blocks for {program} (Debian: apt-get install {packages})");
        }
        there.then(|| Interpreter { language, program: program.into(), arguments })
    };
    let octave = ["--eval", "pkg load netcdf"];
    let r = ["-e", "library(ncdf4); library(jsonlite)"];
    [
        python::venv("data").map(|program| Interpreter { language: "python", program, arguments: &[] }),
        installed("matlab", "octave-cli", octave, &["--quiet", "--no-history"], "octave octave-netcdf"),
        installed("r", "Rscript", r, &["--vanilla"], "r-base-core r-cran-ncdf4 r-cran-jsonlite"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Situation: the files that the commands of docs/data.md write.
/// Action: every block of the page in Python, Octave and R.
/// Must hold: each prints what the page shows; the page has blocks for each of the three.
#[test]
fn the_page_on_results_runs_as_printed() {
    let (commands, blocks) = page();
    let bench = results(&commands);
    for language in ["python", "matlab", "r"] {
        let count = blocks.iter().filter(|block| block.language == language).count();
        assert!(count >= 7, "{count} blocks of {language}");
    }
    for interpreter in interpreters() {
        for Block { code, output, .. } in blocks.iter().filter(|b| b.language == interpreter.language) {
            let run = interpreter.run(&bench, code);
            assert_eq!(run.code, Some(0), "{code}\n{}", run.stderr);
            assert_eq!(lines(&run.stdout), lines(output), "{code}\n{}", run.stderr);
        }
    }
}

/// Situation: the files of the page, in both formats of NetCDF.
/// Action: read them by each backend of xarray, by netCDF4, scipy and h5netcdf; check the conventions.
/// Must hold: the same bits in every reader, in tables and documents; texts are texts, nothing is a date or a duration; two
/// readings are equal; no remark on the conventions.
#[test]
fn netcdf_files_open_right_in_every_reader() {
    let Some(python) = python::venv("data") else { return };
    let (mut commands, _) = page();
    let again: Vec<String> =
        commands.iter().filter(|c| c.contains(".nc")).map(|c| c.replace(".nc", ".nc4")).collect();
    commands.extend(again);
    let bench = results(&commands);
    let folder = bench.path(".");
    assert_eq!(python::checked(&python, "netcdf_readers.py", &[folder.as_os_str()]), "same\n");
    let files = ["ride.nc", "basin.nc", "plane.nc", "limits/sweep.nc"].map(|name| bench.path(name));
    python::checked(&python, "netcdf_conventions.py", &files.each_ref().map(|file| file.as_os_str()));
}

/// Situation: a disk of 64 kB (a memory disk, where the machine allows one) with an older result on it.
/// Action: a ride whose NetCDF file, table and document are larger.
/// Must hold: rejected, the file named; the older result unchanged, nothing else left.
#[test]
fn a_full_disk_keeps_the_older_netcdf_file() {
    let bench = Bench::new(PROGRAM);
    std::fs::create_dir(bench.path("disk")).expect("a folder");
    let mount = |arguments: &[&OsStr]| Command::new("mount").args(arguments).output();
    let options = ["-t", "tmpfs", "-o", "size=64k", "none"].map(OsStr::new);
    let disk = bench.path("disk");
    if !mount(&[&options[..], &[disk.as_os_str()]].concat()).is_ok_and(|run| run.status.success()) {
        eprintln!("skipped: no memory disk (needs root)");
        return;
    }
    bench.write("disk/old.nc", "older");
    let runs = ["netcdf", "csv"]
        .map(|kind| bench.run(&format!("ride --speed 4 --steer-rate 1 --{kind} disk/old.nc -q")));
    let (kept, left) = (bench.read("disk/old.nc"), std::fs::read_dir(&disk).expect("the disk").count());
    let gone = Command::new("umount").arg(&disk).status();
    assert!(gone.is_ok_and(|status| status.success()));
    for run in runs {
        run.rejected_naming(&["disk/old.nc", "No space left"]);
    }
    assert_eq!((kept.as_str(), left), ("older", 1));
}

/// Situation: a sweep at a single speed, its torque limits given in falling order.
/// Action: read its document, table and NetCDF file.
/// Must hold: no area (null, an empty cell, NaN), where a 0 would look measured; the coordinate rises, and each height is that of
/// its limit; the column of the axis has numbers and names their unit.
#[test]
fn a_sweep_at_one_speed_has_no_area_and_rising_coordinates() {
    let bench = Bench::new(PROGRAM);
    let line = "sweep --over torque-limit=7,2 --law h --speeds 4 --max-rate 12 --scan-step 2 --tolerance 0.5 --out s";
    let document = bench.json(line);
    let heights: Vec<f64> =
        [0, 1].map(|i| document["cells"][i]["found"][0]["height"].as_f64().expect("a height")).to_vec();
    assert!(heights[0] > heights[1] && heights[1] > 0.0, "{heights:?}");
    assert!(document["cells"][0]["area"].is_null());
    let table = bench.read("s/sweep.csv");
    let rows: Vec<&str> = table.lines().skip(2).collect();
    assert!(rows[0].starts_with("torque_limit_nm,area_rad_m_s2,mean_height_rad_s,"), "{}", rows[0]);
    assert!(rows[1].starts_with("7,,") && rows[2].starts_with("2,,"), "{table}");
    let mut file = netcdf3::FileReader::open(bench.path("s/sweep.nc")).expect("a file");
    assert_eq!(file.read_var_f64("torque_limit").expect("an axis"), [2.0, 7.0]);
    assert_eq!(file.read_var_f64("height").expect("heights"), [heights[1], heights[0]]);
    assert!(file.read_var_f64("area").expect("areas").iter().all(|area| area.is_nan()));
}
