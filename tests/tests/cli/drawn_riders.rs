//! Basins of riders drawn from uncertain gains, `--rider-draws`.

use serde_json::{Value, json};
use tests::cli::Bench;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// Situation: the young rider, whose sets have no covariances; the same with one; a table with sets alone.
/// Action: the basin with drawn riders, twice and with another seed.
/// Must hold: a band that contains the median in document, table, figure and text, from the groups or from the covariance;
/// the same with the same seed; the table with sets alone is rejected, naming the row; so are draws without a rider.
#[test]
fn drawn_riders_are_a_band_around_the_basin() {
    let bench = Bench::new(PROGRAM);
    let quick = "--speeds 3:4:1 --scan-step 1 --tolerance 0.05 --time-limit 2";
    let run = bench.run(&format!(
        "basin {quick} --rider young --rider-draws 12 --gains spline --json a.json --csv a.csv --svg a.svg"
    ));
    assert!(run.code == Some(0), "{run:?}");
    for said in ["area of 12 drawn riders: 5 % ", "(bootstrap)", "drawn rider is linearly unstable"] {
        assert!(run.stdout.contains(said), "{said}: {}", run.stdout);
    }
    let first: Value = serde_json::from_str(&bench.read("a.json")).unwrap();
    let band = &first["rider_draws"];
    assert_eq!((&band["drawn_from"], &band["draws"]), (&json!("bootstrap"), &json!(12)));
    assert_eq!((&band["unstable"], &first["uncertain"]), (&json!([0, 0]), &Value::Null));
    for (i, speed) in band["upper"].as_array().unwrap().iter().enumerate() {
        let [low, middle, high] = [0, 1, 2].map(|q| speed[q].as_f64().unwrap());
        let measured = first["height"]["upper"][i].as_f64().unwrap();
        assert!(low < middle && middle < high && high - low < measured, "{speed}");
        assert!(low - 0.3 < measured && measured < high + 0.3, "{measured} {speed}");
    }
    assert!(bench.read("a.csv").contains("border-95%"));
    assert!(bench.read("a.svg").contains("5 % to 95 % of 12 drawn riders"));
    let draws = |options: &str| bench.json(&format!("basin {quick} {options}"))["rider_draws"].clone();
    let young = "--rider young --rider-draws 12 --gains spline";
    assert_eq!(draws(&format!("{young} --threads 1"))["heights"], band["heights"]);
    assert_ne!(draws(&format!("{young} --seed 2"))["heights"], band["heights"]);

    // Its run 252, with a standard error of the roll rate's gain alone: 4 of 47.87 N m s/rad.
    let one = "schema = 1\ndelay_ms = 30\n\
               columns = ['speed_m_s', 'K_phi_p', 'K_phi_d', 'K_delta_i', 'K_delta_d', 'K_delta_dd']\n\
               rows = [[4.3, 65.52, 47.87, 321.43, -5.82, -0.28]]\n";
    let zero = "[0,0,0,0,0]";
    bench.write("one.toml", format!("{one}covariances = [[{zero},[0,16,0,0,0],{zero},{zero},{zero}]]\n"));
    let posterior = draws("--rider one.toml --rider-draws 6");
    assert_eq!((&posterior["drawn_from"], &posterior["draws"]), (&json!("posterior"), &json!(6)));
    let mut heights: Vec<f64> =
        posterior["heights"].as_array().unwrap().iter().map(|h| h[1].as_f64().unwrap()).collect();
    heights.sort_by(f64::total_cmp);
    assert!(heights[0] > 0.5 && heights[5] - heights[0] > 0.1 && heights[5] < 12.0, "{heights:?}");
    bench.write("alone.toml", one);
    bench.run("basin --speeds 4 --rider alone.toml --rider-draws 6").rejected_naming(&[
        "--rider-draws",
        "alone.toml",
        "row 1",
        "4.3 m/s",
        "covariances",
    ]);
    bench.run("basin --speeds 4 --rider-draws 6").rejected_naming(&["rider-draws", "no rider"]);
    let both =
        "basin --speeds 4 --bicycle data/bicycles/Rigid+Jason --rider young --rider-draws 6 --uncertain 6";
    bench.run(both).rejected_naming(&["rider-draws", "uncertain"]);
    assert_eq!(bench.run("basin --speeds 4 --rider young --rider-draws 1").code, Some(2));
}
