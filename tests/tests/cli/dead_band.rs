//! The table of the page on delays: basins and torques with a dead band of the roll rate.

use tests::cli::{Bench, repository};
use tests::detection::rows_of;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
/// Conditions of the three basins of a row.
const BASINS: [&str; 3] = ["--law h", "--preset product", "--preset product --rider smart"];
/// Conditions of the two rides of a row.
const RIDES: [&str; 2] = ["--speed 4 --rider smart", "--speed 5"];

/// Area \[rad m/s^2\] and mean height \[rad/s\] of the basin with a band of `r` rad/s.
fn basin(bench: &Bench, conditions: &str, r: &str) -> [f64; 2] {
    let found =
        bench.json(&format!("basin --speeds 2:7.5:0.5 {conditions} --set dead_band.roll_rate_rad_s={r}"));
    ["area", "mean_height"].map(|key| found[key].as_f64().expect("a number"))
}

/// The torque's rms \[N m\] from 5 s on of a straight ride with a noisy gyro.
fn torque(bench: &Bench, conditions: &str, r: &str) -> f64 {
    let line = format!(
        "ride -q --preset product {conditions} --steer-rate 0.001 --time-limit 30 --sensor gyro:noise=0.02 \
         --sensor accel:noise=0.1 --set dead_band.roll_rate_rad_s={r} --csv ride.csv"
    );
    assert_eq!(bench.run(&line).code, Some(0), "{line}");
    let table = bench.read("ride.csv");
    let mut lines = table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(','));
    let names: Vec<&str> = lines.next().expect("a header").collect();
    let [t, torque] =
        ["t", "torque"].map(|name| names.iter().position(|one| *one == name).expect("a column"));
    let cells = lines.map(|line| line.collect::<Vec<_>>());
    let numbers = cells.map(|cells| [t, torque].map(|place| cells[place].parse::<f64>().expect("a number")));
    let late: Vec<f64> = numbers.filter(|[t, _]| *t >= 5.0).map(|[_, torque]| torque).collect();
    (late.iter().map(|torque| torque * torque).sum::<f64>() / late.len() as f64).sqrt()
}

/// The rows of the page, as cells.
fn rows(page: &str) -> Vec<Vec<&str>> {
    rows_of(page, "dead-band").into_iter().map(cells).collect()
}

fn cells(row: &str) -> Vec<&str> {
    row.trim_matches('|').split('|').map(str::trim).collect()
}

/// Compares the basins of the first `count` conditions with the page; returns their areas by row.
fn compare(count: usize) -> Vec<Vec<f64>> {
    let bench = Bench::new(PROGRAM);
    let page = std::fs::read_to_string(repository("docs/delay.md")).expect("the page");
    let rows = rows(&page);
    let areas = rows.iter().map(|row| {
        let r = if row[0] == "off" { "0" } else { row[0] };
        let of = |i: usize| {
            let [area, height] = basin(&bench, BASINS[i], r);
            let found = [format!("{area:.2}"), format!("{height:.2}")];
            assert_eq!(row[1 + 2 * i..3 + 2 * i], found, "docs/delay.md, dead band {r}, {}", BASINS[i]);
            area
        };
        (0..count).map(of).collect()
    });
    areas.collect()
}

/// Situation: the law h with each dead band of the page, and the product on straight rides with a noisy gyro.
/// Action: search the basins; ride.
/// Must hold: areas, heights and torques are the page's.
#[test]
fn the_page_on_delays_has_the_dead_bands_torques_and_the_basins_of_h() {
    assert_eq!(compare(1).len(), 4);
    let bench = Bench::new(PROGRAM);
    let page = std::fs::read_to_string(repository("docs/delay.md")).expect("the page");
    for row in rows(&page) {
        let r = if row[0] == "off" { "0" } else { row[0] };
        let found = RIDES.map(|conditions| format!("{:.3}", torque(&bench, conditions, r)));
        assert_eq!(row[7..], found, "docs/delay.md, dead band {r}");
    }
}

/// Situation: as above, the product too, without a rider and with one.
/// Action: search the basins.
/// Must hold: areas and heights are the page's, and the losses of area that it states for 0.05 rad/s.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn the_page_on_delays_has_every_basin_of_the_dead_bands() {
    let areas = compare(BASINS.len());
    let [h, product, ridden] = [0, 1, 2].map(|i| 100.0 * (1.0 - areas[2][i] / areas[0][i]));
    let page = std::fs::read_to_string(repository("docs/delay.md")).expect("the page");
    let stated = format!(
        "A band of 0.05 rad/s costs {h:.1} % of the area of `h`, {product:.1} % of the product's and {ridden:.1} % with a rider."
    );
    assert!(page.contains(&stated), "docs/delay.md should have: {stated}");
}
