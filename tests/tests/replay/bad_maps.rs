//! Maps with errors.

use super::{SMALLEST, bench};

/// Situation: maps with one error each.
/// Action: replay a good ride with them.
/// Must hold: rejected, naming map or parameter, key, value and the expected one.
#[test]
fn wrong_maps() {
    let bench = bench(50);
    let steer = |line: &str| format!("{SMALLEST}[steer]\ncolumns = ['steer']\n{line}\n");
    let gyro = |line: &str| SMALLEST.replace("'gz']", &format!("'gz']\n{line}"));
    for (map, named) in [
        (steer("sclae = 2"), &["line 9", "`sclae`", "`scale`"][..]),
        (format!("[speed]\ncolumns = ['rear']\n{SMALLEST}"), &["`speed`", "`rear_wheel`"]),
        (steer("unit = 'degrees'"), &["steer", "unit = \"degrees\"", "rad, deg"]),
        (steer("unit = 'deg/s'"), &["steer", "unit = \"deg/s\"", "rad, deg"]),
        (steer("scale = 1e9"), &["steer", "scale = 1000000000", "1000000"]),
        (steer("scale = 0"), &["steer", "scale = 0"]),
        (steer("offset = nan"), &["steer", "offset = NaN"]),
        (steer("late_s = -1"), &["steer", "late_s = -1", "0 to 1"]),
        (steer("axes = ['x', 'y', 'z']"), &["steer", "axes", "three axes"]),
        (gyro("axes = ['y', 'x', 'z']"), &["gyro", "axes", "mirror"]),
        (gyro("axes = ['x', 'x', 'z']"), &["gyro", "axes", "twice"]),
        (gyro("axes = ['x', 'up', 'z']"), &["gyro", "axes", "`up`", "-z"]),
        (SMALLEST.replace(", 'gz'", ""), &["gyro", "columns", "2", "3"]),
        (SMALLEST.replace("'t'", "'t'\nrate_hz = 200"), &["time", "column", "rate_hz"]),
        (SMALLEST.replace("column = 't'", "rate_hz = 0"), &["time", "rate_hz = 0", "0.01 to 100000"]),
        (SMALLEST.replace("'t'", "'t'\nunit = 'min'"), &["time", "unit = \"min\"", "s, ms, us, ns"]),
        ("gyro = 3".into(), &["line 1", "gyro"]),
    ] {
        bench.write("my.toml", map);
        let named: Vec<&str> = named.iter().copied().chain(["my.toml"]).collect();
        bench.run("replay ride.csv --map my.toml").rejected_naming(&named);
    }
    for (line, named) in [
        ("'cross.wheelbase_m' = 99", &["cross.wheelbase_m = 99", "0.1 to 5"][..]),
        ("'cross.wheelbase_m' = 'long'", &["cross.wheelbase_m = long"]),
        ("'cross.yaw_slope' = 'maybe'", &["cross.yaw_slope = maybe"]),
    ] {
        bench.write("my.toml", format!("{SMALLEST}[parameters]\n{line}\n"));
        bench.run("replay ride.csv --map my.toml").rejected_naming(named);
    }
    // The message lists all parameters.
    bench.write("my.toml", format!("{SMALLEST}[parameters]\n'cross.nope' = 1\n"));
    let run = bench.run("replay ride.csv --map my.toml");
    assert!(run.code == Some(1) && run.stderr.contains("no parameter cross.nope"), "{run:?}");
    bench.run("replay ride.csv --map absent.toml").rejected_naming(&["absent.toml", "extract", "monitor"]);
}

/// Situation: maps that name a missing column: for time, age, switch, a sensor's own time, the required axis.
/// Action: replay.
/// Must hold: rejected with the column's name and its use.
#[test]
fn columns_that_are_not_there() {
    let bench = bench(50);
    for (map, named) in [
        (SMALLEST.replace("'t'", "'T'"), ["T", "to the time"]),
        (format!("{SMALLEST}time = 'nope'\n"), ["nope", "to the time"]),
        (format!("{SMALLEST}age = 'nope'\n"), ["nope", "to an age"]),
        (format!("{SMALLEST}[engage]\ncolumn = 'nope'\n"), ["nope", "to the switch"]),
        (SMALLEST.replace("'gx'", "'wx'"), ["wx", "to gyro"]),
        (SMALLEST.replace("[time]\ncolumn = 't'\n", ""), ["neither the map nor the recording", "time"]),
    ] {
        bench.write("my.toml", map);
        bench.run("replay ride.csv --map my.toml").rejected_naming(&named);
    }
}

/// Situation: a map that names a column of an optional sensor, with a letter wrong.
/// Action: replay.
/// Must hold: it runs without the sensor, and the column's name is reported.
#[test]
fn a_sensor_whose_column_is_not_there() {
    let bench = bench(400);
    bench.write("my.toml", format!("{SMALLEST}[steer]\ncolumns = ['stear']\n"));
    let document = bench.json("replay ride.csv --map my.toml");
    assert_eq!(document["absent"], serde_json::json!(["steer (`stear`)"]));
}
