//! Choice of the reader for a file, and messages about incomplete files.

use super::{column, file, group, read_with, recorded, remarks, written};

/// Situation: each kind of file under a name of another kind, one of them packed.
/// Action: read.
/// Must hold: the content decides.
#[test]
fn the_content_decides_and_not_the_name() {
    for name in ["ride.log", "ride.asc", "ride.mf4", "ride.long.log"] {
        let recording = written("ride.csv", std::fs::read(file(name)).unwrap(), &["ride.dbc"]).unwrap();
        assert_eq!(column(group(&recording, "Gyro"), "RateX").len(), 20, "{name}");
    }
    let table = written("ride.mf4", "t_s,roll_rad\n0,0.1\n1,0.2\n", &[]).unwrap();
    assert_eq!((table.groups.len(), table.groups[0].columns.len()), (1, 2));
    let dated = written("a.csv", "date time,roll_rad\n2023-06-07 10:00:00,0.1\n", &[]).unwrap();
    assert_eq!(dated.groups[0].columns[0].name, "date time");
}

/// Situation: frames without a database; with one that has none of their messages; with that one beside the right
/// one; a database for a file that has no frames; a database that does not exist or is invalid.
/// Action: read.
/// Must hold: the first two are rejected, with the missing option or both names; the third reports the unused
/// database; the others are rejected with the file at fault.
#[test]
fn databases_that_are_missing_or_unused() {
    let dbc = |name: &str| file(name).display().to_string();
    let error = recorded("ride.log", &[]).unwrap_err().to_string();
    assert_eq!(
        error,
        format!(
            "{}: has 100 frames of CAN; give the database that decodes them with --dbc FILE",
            dbc("ride.log")
        )
    );
    for name in ["ride.asc", "ride.mf4"] {
        assert!(recorded(name, &[]).unwrap_err().to_string().ends_with("with --dbc FILE"), "{name}");
    }
    let error = recorded("ride.log", &["odd.dbc"]).unwrap_err().to_string();
    assert_eq!(
        error,
        format!("{}: has 100 frames of CAN, and none is decoded by {}", dbc("ride.log"), dbc("odd.dbc"))
    );
    let both = recorded("ride.log", &["odd.dbc", "ride.dbc"]).unwrap();
    assert_eq!(remarks(&both), [format!("no frame of it is decoded by {}", dbc("odd.dbc"))]);
    let error = written("a.csv", "t_s,roll_rad\n0,0.1\n", &["ride.dbc"]).unwrap_err();
    assert_eq!(error, format!("a.csv: has no frame of CAN to decode by {}", dbc("ride.dbc")));
    let error = read_with(&file("ride.log"), &[file("none.dbc")]).unwrap_err().to_string();
    assert!(error.starts_with(&format!("can't read {}: ", dbc("none.dbc"))), "{error}");
    let error = read_with(&file("ride.log"), &[file("ride.asc")]).unwrap_err().to_string();
    assert!(error.starts_with(&format!("{}: line 1: is no valid DBC", dbc("ride.asc"))), "{error}");
}

/// Situation: the same message on two buses; a message that two databases have.
/// Action: read.
/// Must hold: a group for each bus, named with it; the first database is used, and this is reported.
#[test]
fn two_buses_and_two_databases() {
    let text = "(1.0) can0 304#9001\n(1.1) can1 304#9101\n(1.2) can0 304#9201\n";
    let recording = written("a.log", text, &["ride.dbc"]).unwrap();
    let names: Vec<&str> = recording.groups.iter().map(|group| group.name.as_str()).collect();
    assert_eq!(names, ["RearWheel (can0)", "RearWheel (can1)"]);
    assert_eq!(recording.groups[0].times_s, Some(vec![1.0, 1.2]));
    assert_eq!(column(&recording.groups[1], "Speed"), [4.01]);
    let twice = written("a.log", "(1.0) can0 304#9001\n", &["ride.dbc", "ride.dbc"]).unwrap();
    assert_eq!(remarks(&twice).len(), 2, "{:?}", remarks(&twice));
    assert_eq!(remarks(&twice)[1], "message RearWheel: two databases have 0x304; the first is used");
}

/// Situation: a binary log that ends within its header, a measurement file of the previous version, one that is cut in its header.
/// Action: read.
/// Must hold: rejected, with a remedy.
#[test]
fn unsupported_kinds_are_rejected() {
    let error = written("a.blf", b"LOGG\x90\0\0\0", &["ride.dbc"]).unwrap_err();
    assert_eq!(error, "a.blf: ends within its header");
    let mut old = b"MDF     3.30    program ".to_vec();
    old.resize(64, 0);
    old[28..30].copy_from_slice(&330_u16.to_le_bytes());
    let error = written("a.mf4", &old, &[]).unwrap_err();
    assert_eq!(error, "a.mf4: is of MDF `3.30`; only MDF 4 is read, convert it");
    let error =
        written("a.mf4", &std::fs::read(file("ride.mf4")).unwrap()[..100], &["ride.dbc"]).unwrap_err();
    assert_eq!(
        error,
        "a.mf4: was cut or is damaged: the file ends within its data, at byte 100, and refers to data up to byte 168"
    );
}
