//! Sweeps that several processes compute in one folder: cells shared, lost processes replaced, the same bytes.
#![cfg(target_os = "linux")]

use serde_json::{Value, json};
use sim_host::sweep::{Claim, Worker, sha256};
use std::collections::BTreeMap;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, SystemTime};
use tests::cli::{Bench, Run, SmallDisk, repository};
use tests::json_schema::violations;
use tests::wait::{until_done, until_used};

use super::sweep::{files, must};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
/// Forty cells of three columns, with one thread.
const FORTY: &str = "sweep --over torque-limit=0.5:20/log20 --over law=h,f --speeds 4:5:0.5 --max-rate 10 \
                     --scan-step 1 --tolerance 0.5 --time-limit 1 --threads 1 -q";
/// One cell of eighty columns.
const EIGHTY: &str =
    "sweep --over law=h --speeds 3:6.95:0.05 --max-rate 10 --scan-step 0.5 --tolerance 0.05 --threads 1 -q";
/// One cell of 400 columns.
const ONE_CELL: &str = "sweep --over law=h --speeds 3:6.99:0.01 --max-rate 10 --scan-step 0.5 --tolerance 0.05 \
                        --threads 1 -q";

fn spawn(bench: &Bench, line: &str) -> Child {
    let mut command = bench.command(line);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

fn send(signal: &str, child: &Child) {
    let kill = Command::new("sh").args(["-c", &format!("kill -{signal} {}", child.id())]).status();
    assert!(kill.expect("sh runs").success());
}

fn ended(child: Child) -> Run {
    child.wait_with_output().expect("the program ends").into()
}

/// Names of the files in a folder of the sweep, without hidden ones; empty if there is no such folder.
fn names(bench: &Bench, folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(bench.path(folder)).into_iter().flatten();
    let names = entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned());
    names.filter(|name| !name.starts_with('.')).collect()
}

/// The files of a finished sweep; temporary ones of a killed process may remain for a while.
fn finished(bench: &Bench, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let mut all = files(&bench.path(folder));
    all.retain(|name, _| !name.rsplit('/').next().is_some_and(|name| name.starts_with('.')));
    assert!(
        all.contains_key("sweep.json") && !bench.path(folder).join("claims").exists(),
        "{:?}",
        all.keys()
    );
    all
}

/// A process stopped (SIGSTOP) while it computes a cell, at least one cell being stored.
fn stopped(bench: &Bench, line: &str, folder: &str) -> Child {
    let mut child = spawn(bench, line);
    until_done(&mut child, "a claim", |child| {
        let begun = || !names(bench, &format!("{folder}/units")).is_empty();
        if !begun() {
            return None;
        }
        send("STOP", child);
        let claims = names(bench, &format!("{folder}/claims"));
        let stored = names(bench, &format!("{folder}/units"));
        if claims.len() == 1 && !stored.contains(&claims[0]) {
            return Some(());
        }
        send("CONT", child);
        None
    });
    child
}

fn status(bench: &Bench, folder: &str) -> Value {
    let run = bench.run(&format!("sweep --status {folder} --json"));
    assert_eq!(run.code, Some(0), "{run:?}");
    serde_json::from_str(&run.stdout).expect("a document")
}

fn count(status: &Value, state: &str) -> usize {
    status[state].as_array().expect("cells").len()
}

/// Writes a claim as the program would.
fn write_claim(bench: &Bench, folder: &str, claim: &Claim) {
    let bytes = serde_json::to_vec(claim).expect("a claim");
    let sealed = json!({"sha256": sha256(&bytes), "unit": claim});
    std::fs::create_dir_all(bench.path(folder).join("claims")).expect("a folder");
    bench.write(&format!("{folder}/claims/{}.json", claim.id), sealed.to_string());
}

fn read_claim(bench: &Bench, folder: &str, name: &str) -> Claim {
    let sealed: Value =
        serde_json::from_str(&bench.read(&format!("{folder}/claims/{name}"))).expect("a claim");
    serde_json::from_value(sealed["unit"].clone()).expect("a claim")
}

/// A claim by a process of another machine, last renewed `ago` before now.
fn foreign(id: &str, ago: Duration) -> Claim {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).expect("a time").as_secs();
    let worker = Worker {
        host: "elsewhere".into(),
        pid: 7,
        job: Some("12_3".into()),
        processes: None,
        ..Worker::this()
    };
    Claim {
        id: id.into(),
        worker: Some(worker),
        since_unix_s: now - 1000,
        renewed_unix_s: now - ago.as_secs(),
        stale_after_s: 120,
        attempt: 1,
        error: None,
        columns: Vec::new(),
    }
}

/// Situation: an empty folder.
/// Action: start four processes on it at once, without and with shards; the same with one process in another folder.
/// Must hold: each ends with exit code 0 and a complete sweep; no cell is claimed any longer; the same bytes.
#[test]
fn processes_on_one_folder_share_the_cells() {
    let bench = Bench::new(PROGRAM);
    must(&bench, &format!("{FORTY} --out one"));
    let one = finished(&bench, "one");
    assert_eq!(one.keys().filter(|name| name.starts_with("units/")).count(), 40);
    for (folder, shards) in [("free", false), ("shards", true)] {
        let line = |i: usize| match shards {
            true => format!("{FORTY} --out {folder} --shard {i}/4"),
            false => format!("{FORTY} --out {folder}"),
        };
        let children: Vec<Child> = (1..=4).map(|i| spawn(&bench, &line(i))).collect();
        for child in children {
            let run = ended(child);
            assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{folder}");
        }
        assert!(finished(&bench, folder) == one, "{folder}");
    }
}

/// Situation: a process is killed while it computes a cell.
/// Action: ask for the state; start another process.
/// Must hold: the cell is stale, by the killed process; the other takes it over at once and ends with the bytes of one
/// process alone.
#[test]
fn a_killed_process_is_replaced() {
    let bench = Bench::new(PROGRAM);
    let mut child = stopped(&bench, &format!("{FORTY} --out s"), "s");
    let running = status(&bench, "s");
    child.kill().unwrap();
    child.wait().unwrap();
    let lost = status(&bench, "s");
    assert_eq!((count(&running, "running"), count(&running, "stale")), (1, 0), "{running}");
    assert_eq!((count(&lost, "running"), count(&lost, "stale")), (0, 1), "{lost}");
    assert_eq!(lost["stale"][0]["worker"]["pid"], child.id());
    assert_eq!((&lost["done"], &lost["free"]), (&running["done"], &running["free"]));
    assert!(lost["remaining_s"].is_null());
    must(&bench, &format!("{FORTY} --out s"));
    must(&bench, &format!("{FORTY} --out one"));
    assert!(finished(&bench, "s") == finished(&bench, "one"));
}

/// Situation: a process is stopped while it computes a cell, and its claim is lost.
/// Action: another process computes the whole sweep; then the first goes on.
/// Must hold: both end with exit code 0; the same bytes as one process alone.
#[test]
fn a_cell_computed_twice_does_no_harm() {
    let bench = Bench::new(PROGRAM);
    let child = stopped(&bench, &format!("{FORTY} --out s"), "s");
    let claim = format!("s/claims/{}", names(&bench, "s/claims")[0]);
    bench.write(&claim, "{}");
    must(&bench, &format!("{FORTY} --out s"));
    let by_other = finished(&bench, "s");
    send("CONT", &child);
    let run = ended(child);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    must(&bench, &format!("{FORTY} --out one"));
    assert!(finished(&bench, "s") == by_other && by_other == finished(&bench, "one"));
}

/// Situation: a sweep of which half is done; of the other cells one is claimed by a machine that renewed its claim just
/// now, one by a machine that did not for an hour, one ended with an error, one was interrupted.
/// Action: ask for the state, as document and as text; continue, and renew the first claim no more.
/// Must hold: options that the state does not depend on are wrong usage; the document fits its schema; the numbers are those of the files; workers, jobs and the error are named;
/// all cells but the running one are computed, and the process waits for that one; it is taken over when it is stale.
#[test]
fn the_status_tells_the_truth_about_claims() {
    let bench = Bench::new(PROGRAM);
    must(&bench, &format!("{FORTY} --out s --shard 1/2"));
    let stored = names(&bench, "s/units");
    assert_eq!(stored.len(), 20);
    let plan: Value = serde_json::from_str(&bench.read("s/plan.json")).unwrap();
    let missing: Vec<&str> = plan["cells"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .filter(|id| !stored.contains(&format!("{id}.json")))
        .collect();
    let fresh = foreign(missing[0], Duration::ZERO);
    write_claim(&bench, "s", &fresh);
    write_claim(&bench, "s", &foreign(missing[1], Duration::from_secs(3600)));
    let ended_so = |id, error: Option<&str>| Claim {
        worker: None,
        error: error.map(Into::into),
        ..foreign(id, Duration::from_secs(5))
    };
    write_claim(&bench, "s", &ended_so(missing[2], Some("no space")));
    write_claim(&bench, "s", &ended_so(missing[3], None));
    let found = status(&bench, "s");
    let schema = std::fs::read_to_string(repository("docs/schema/sweep-status.json")).unwrap();
    assert_eq!(violations(&serde_json::from_str(&schema).unwrap(), &found), [""; 0]);
    assert_eq!((&found["cells"], &found["done"], &found["free"]), (&json!(40), &json!(20), &json!(17)));
    for (state, id) in [("running", missing[0]), ("stale", missing[1]), ("failed", missing[2])] {
        assert_eq!((count(&found, state), &found[state][0]["id"]), (1, &json!(id)), "{state}: {found}");
    }
    for option in ["--law h", "--speeds 3:4:1", "--threads 1", "--scenario s/plan.json", "--shard 1/2"] {
        let run = bench.run(&format!("sweep --status s {option}"));
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{option}: {run:?}");
        assert!(run.stderr.contains(option.split(' ').next().unwrap()), "{option}: {}", run.stderr);
    }
    let text = must(&bench, "sweep --status s");
    for words in
        ["20 of 40 cells done, 1 running, 1 stale, 1 failed, 17 free", "elsewhere:7 (job 12_3)", "no space"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    let mut child = spawn(&bench, &format!("{FORTY} --out s"));
    let claims = || names(&bench, "s/claims");
    until_done(&mut child, "all but the running cell", |_| {
        (names(&bench, "s/units").len() == 39 && claims().len() == 1).then_some(())
    });
    assert_eq!(claims(), [format!("{}.json", missing[0])]);
    write_claim(&bench, "s", &Claim { renewed_unix_s: fresh.renewed_unix_s - 3600, ..fresh });
    let run = ended(child);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    must(&bench, &format!("{FORTY} --out one"));
    assert!(finished(&bench, "s") == finished(&bench, "one"));
}

/// Situation: a process waits for a cell that another machine computes.
/// Action: SIGTERM.
/// Must hold: exit code 130 soon; the other's claim is unchanged.
#[test]
fn waiting_for_others_can_be_ended() {
    let bench = Bench::new(PROGRAM);
    must(&bench, &format!("{FORTY} --out s --shard 2/2"));
    must(&bench, &format!("{FORTY} --out s"));
    let unit = names(&bench, "s/units").remove(0);
    let id = unit.strip_suffix(".json").unwrap();
    std::fs::remove_file(bench.path("s/units").join(&unit)).unwrap();
    let claim = foreign(id, Duration::ZERO);
    write_claim(&bench, "s", &claim);
    let mut child = spawn(&bench, &format!("{FORTY} --out s"));
    until_used(&mut child, 0.05);
    std::thread::sleep(Duration::from_millis(300));
    send("TERM", &child);
    let run = ended(child);
    assert_eq!(run.code, Some(130), "{run:?}");
    assert!(run.stderr.contains("39 of 40 cells are done and kept"), "{}", run.stderr);
    assert_eq!(read_claim(&bench, "s", &unit), claim);
}

/// Situation: all cells are done but one, which another machine claimed 1000 s ago: with no column finished, with two of three, and
/// with a clock that is 100 s ahead.
/// Action: start a process, without and with -q, until it has told what it does; ask for the state.
/// Must hold: it says that it waits for one cell, by which process, and how long ago the claim was made and renewed, with the time
/// left only if columns are known; nothing with -q; a renewal in the future is told as such by both.
#[test]
fn a_wait_for_others_is_told() {
    let bench = Bench::new(PROGRAM);
    must(&bench, &format!("{FORTY} --out s --shard 2/2"));
    must(&bench, &format!("{FORTY} --out s"));
    let unit = names(&bench, "s/units").remove(0);
    let id = unit.strip_suffix(".json").unwrap();
    let stored: Value = serde_json::from_str(&bench.read(&format!("s/units/{unit}"))).unwrap();
    std::fs::remove_file(bench.path("s/units").join(&unit)).unwrap();
    let column = |speed| {
        serde_json::from_value(json!({"speed": speed, "found": stored["unit"]["found"][0],
        "work": stored["unit"]["work"]}))
    };
    let fresh = || foreign(id, Duration::from_secs(5));
    let columns = || (0..2).map(|i| column(i).expect("a column")).collect();
    let ahead = || Claim { renewed_unix_s: fresh().renewed_unix_s + 105, ..fresh() };
    let talking = FORTY.strip_suffix(" -q").unwrap().to_owned() + " --out s";
    // The first line on standard error.
    let told = |claim: &Claim| {
        write_claim(&bench, "s", claim);
        let file = std::fs::File::create(bench.path("told")).expect("a file");
        let mut child =
            bench.command(&talking).stdout(Stdio::null()).stderr(file).spawn().expect("the program");
        let line = until_done(&mut child, "a message", |_| {
            bench.read("told").split_once('\n').map(|(line, _)| line.to_owned())
        });
        send("TERM", &child);
        ended(child);
        line
    };
    let number = |text: &str, before: &str| -> f64 {
        let rest = text.split(before).nth(1).unwrap_or_else(|| panic!("no `{before}` in: {text}"));
        rest.split(' ').next().and_then(|word| word.parse().ok()).unwrap_or_else(|| panic!("{text}"))
    };
    let known = "waiting for 1 cell of other processes: 1 by elsewhere:7 (job 12_3), claimed ";
    let text = told(&fresh());
    assert!(text.starts_with(known) && text.ends_with(" s ago"), "{text}");
    assert!((1000.0..1100.0).contains(&number(&text, "claimed ")), "{text}");
    assert!((5.0..105.0).contains(&number(&text, "renewed ")), "{text}");
    // 995 s for two columns: less than 498 s for the third.
    let text = told(&Claim { columns: columns(), ..fresh() });
    assert!(text.starts_with(known) && text.ends_with(" s left"), "{text}");
    assert!((390.0..494.0).contains(&number(&text, "; about ")), "{text}");
    let text = told(&ahead());
    assert!(text.contains(" s in the future, the machines' clocks differ"), "{text}");
    write_claim(&bench, "s", &fresh());
    let mut child = spawn(&bench, &format!("{talking} -q"));
    until_used(&mut child, 0.05);
    std::thread::sleep(Duration::from_millis(2500));
    send("TERM", &child);
    assert!(!ended(child).stderr.contains("waiting"));
    write_claim(&bench, "s", &ahead());
    let found = status(&bench, "s");
    assert!((30..=100).contains(&found["running"][0]["ahead_s"].as_u64().unwrap()), "{found}");
    let text = must(&bench, "sweep --status s");
    assert!(text.contains("1 running") && text.contains(" s in the future"), "{text}");
}

/// Situation: one cell of 400 columns.
/// Action: SIGTERM after the first columns; change a kept column; continue.
/// Must hold: exit code 130, the finished columns are kept with the released claim; the changed column appears in the
/// result, so it was not computed again; without the change the bytes are those of one run.
#[test]
fn columns_of_an_interrupted_cell_are_kept() {
    let bench = Bench::new(PROGRAM);
    let mut child = spawn(&bench, &format!("{ONE_CELL} --out s"));
    until_done(&mut child, "a claim", |_| (!names(&bench, "s/claims").is_empty()).then_some(()));
    until_used(&mut child, 0.3);
    send("TERM", &child);
    let run = ended(child);
    assert_eq!(run.code, Some(130), "{run:?}");
    let name = names(&bench, "s/claims").remove(0);
    let claim = read_claim(&bench, "s", &name);
    let kept = claim.columns.len();
    assert!((1..400).contains(&kept), "{kept}");
    assert_eq!((claim.worker.clone(), claim.error.clone()), (None, None));
    let found = status(&bench, "s");
    assert_eq!((&found["done"], &found["free"]), (&json!(0), &json!(1)));
    let mut changed = claim.clone();
    changed.columns[0].found.height = 7.0625;
    for (claim, is_changed) in [(&changed, true), (&claim, false)] {
        let _ = std::fs::remove_dir_all(bench.path("s/units"));
        write_claim(&bench, "s", claim);
        must(&bench, &format!("{ONE_CELL} --out s"));
        let document: Value = serde_json::from_str(&bench.read("s/sweep.json")).unwrap();
        let heights = document["cells"][0]["found"].as_array().unwrap();
        assert_eq!(heights.len(), 400);
        assert_eq!(heights[changed.columns[0].speed]["height"] == 7.0625, is_changed);
    }
    must(&bench, &format!("{ONE_CELL} --out one"));
    assert!(finished(&bench, "s") == finished(&bench, "one"));
}

/// Situation: no file can have the size of a unit, as on a full disk.
/// Action: sweep; ask for the state; sweep again without the limit.
/// Must hold: exit code 1 with the file named and nothing half-written; the cells have failed, with the reason; the second
/// run has the bytes of a sweep that never failed.
#[test]
fn a_full_disk_is_named_and_the_sweep_goes_on_later() {
    let bench = Bench::new(PROGRAM);
    must(&bench, &format!("{FORTY} --out one"));
    let one = finished(&bench, "one");
    let size = |name: &str| one[name].len();
    let unit = one.keys().find(|name| name.starts_with("units/")).unwrap();
    assert!(size("plan.json") < 4096 && size(unit) > 4096, "{} and {} bytes", size("plan.json"), size(unit));
    // In blocks of 512 bytes.
    let run = bench.shell(&format!("trap '' XFSZ; ulimit -f 8; \"$0\" {FORTY} --out s"));
    run.rejected_naming(&["can't write", "s/units/", "File too large"]);
    assert!(!run.stderr.contains(".sim-host-"), "{}", run.stderr);
    assert!(names(&bench, "s/units").is_empty());
    let hidden = files(&bench.path("s")).into_keys().filter(|name| name.contains(".sim-host-")).count();
    assert_eq!(hidden, 0);
    let found = status(&bench, "s");
    assert_eq!((&found["done"], count(&found, "failed")), (&json!(0), 1));
    assert!(found["failed"][0]["error"].as_str().unwrap().contains("File too large"), "{found}");
    must(&bench, &format!("{FORTY} --out s"));
    assert!(finished(&bench, "s") == one);
}

/// Situation: a disk that has space for the plan, the claim and not for a cell, not even for a new claim when the cell is finished.
/// Action: sweep, and fill the disk while the cell is computed; ask for the state; make space and sweep again.
/// Must hold: exit code 1 with the file named and "No space left"; the cell counts as failed with that reason, not as free;
/// then the bytes of a sweep that never failed.
#[test]
fn a_cell_without_space_on_the_disk_is_no_free_cell() {
    let bench = Bench::new(PROGRAM);
    let Some(disk) = SmallDisk::mounted(bench.path("disk"), 256 * 1024) else {
        eprintln!("skipped: no right to mount a small file system");
        return;
    };
    let mut child = spawn(&bench, &format!("{EIGHTY} --out disk/s"));
    until_done(&mut child, "a claim", |_| (!names(&bench, "disk/s/claims").is_empty()).then_some(()));
    let full = std::fs::write(bench.path("disk/filler"), vec![0; 1 << 20]);
    assert_eq!(full.map_err(|e| e.kind()), Err(std::io::ErrorKind::StorageFull));
    let run = ended(child);
    run.rejected_naming(&["can't write disk/s/units/", "No space left"]);
    let found = status(&bench, "disk/s");
    assert_eq!(
        (&found["done"], &found["free"], count(&found, "failed")),
        (&json!(0), &json!(0), 1),
        "{found}"
    );
    assert!(found["failed"][0]["error"].as_str().unwrap().contains("No space left"), "{found}");
    let text = must(&bench, "sweep --status disk/s");
    assert!(text.contains("1 failed, 0 free") && text.contains("No space left"), "{text}");
    std::fs::remove_file(bench.path("disk/filler")).unwrap();
    must(&bench, &format!("{EIGHTY} --out disk/s"));
    must(&bench, &format!("{EIGHTY} --out one"));
    assert!(finished(&bench, "disk/s") == finished(&bench, "one"));
    drop(disk);
}
