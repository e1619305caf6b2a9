//! The tables of `docs/delay.md`, computed again.

use control::Law;
use control::estimate::{EstimateConfig, Source};
use rayon::prelude::*;
use sim_host::bicycle::Geometry;
use sim_host::bicycle::onboard::estimator_parameters;
use sim_host::ride::Start;
use sim_host::rider::{Fit, Outside, Rider, catalogue};
use tests::late::{Late, PredictedMotion};
use tests::model::LinearBicycle;
use tests::rides::shipped;

const LAW: Law = Law::H { cut: false };
/// Largest disturbance \[rad/s\].
const MOST: f64 = 12.0;

/// One line of a table.
struct Line {
    label: String,
    bicycle: &'static str,
    rider: bool,
    sensors_ms: usize,
    actuator_s: f64,
    ahead: PredictedMotion,
    noise: Option<u64>,
}

impl Line {
    fn new(sensors_ms: usize, ahead: PredictedMotion) -> Self {
        let label = format!("{sensors_ms} ms");
        Self { label, bicycle: "rigid_jason", rider: false, sensors_ms, actuator_s: 0.0, ahead, noise: None }
    }

    fn late<'a>(&self, bicycle: &'a Geometry, rider: Option<&'a Rider>) -> Late<'a> {
        // The controller's geometry is that of the thesis bicycle, whatever it rides on.
        let assumed = Geometry::new(&shipped("rigid_jason").parameters);
        let estimate = EstimateConfig { roll_rate: Source::Estimate, ..estimator_parameters(&assumed) };
        Late {
            bicycle,
            rider,
            law: &LAW,
            sensors_ms: self.sensors_ms,
            actuator_s: self.actuator_s,
            estimate,
            ahead: self.ahead,
            noise: self.noise,
            seconds: 6.0,
        }
    }
}

fn smart() -> Rider {
    let table = catalogue::load("smart").unwrap_or_else(|e| panic!("{e}"));
    table.rider(Fit::Mean, Outside::Extrapolate, None).unwrap_or_else(|e| panic!("{e}"))
}

/// The heights of every line at every speed, as a table of the document.
fn heights(lines: &[Line], speeds: &[f64]) -> (String, Vec<Vec<f64>>) {
    let smart = smart();
    let cells: Vec<(usize, f64)> =
        (0..lines.len()).flat_map(|i| speeds.iter().map(move |&v| (i, v))).collect();
    let found: Vec<f64> = cells
        .par_iter()
        .map(|&(i, v)| {
            let b = Geometry::new(&shipped(lines[i].bicycle).parameters);
            lines[i].late(&b, lines[i].rider.then_some(&smart)).height(v, MOST)
        })
        .collect();
    let rows: Vec<Vec<f64>> = found.chunks(speeds.len()).map(<[f64]>::to_vec).collect();
    let mut table = String::from("| delay | compensation |");
    speeds.iter().for_each(|v| table += &format!(" {v} m/s |"));
    table += "\n| --- | --- |";
    speeds.iter().for_each(|_| table += " --- |");
    for (line, row) in lines.iter().zip(&rows) {
        let how = match line.ahead {
            PredictedMotion::Off => "none".to_owned(),
            PredictedMotion::Lead(s) => format!("lead {:.0} ms", s * 1e3),
            PredictedMotion::Model(_, s) => format!("model {:.0} ms", s * 1e3),
        };
        table += &format!("\n| {} | {how} |", line.label);
        row.iter().for_each(|h| table += &format!(" {h:.1} |"));
    }
    (table, rows)
}

/// The document's table of that name must be this one.
fn documented(name: &str, table: &str) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/delay.md");
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{path}: {e}"));
    let start = format!("<!-- {name} -->\n");
    let found = text.split_once(&start).and_then(|(_, rest)| rest.split_once("\n<!-- end -->"));
    let (found, _) = found.unwrap_or_else(|| panic!("docs/delay.md has no table `{name}`"));
    assert!(found == table, "docs/delay.md, `{name}`, must be\n{table}\nbut is\n{found}");
}

fn model() -> LinearBicycle {
    LinearBicycle::new(&shipped("rigid_jason").parameters)
}

/// Without compensation, with a lead, with the model.
fn compensations(delay_s: f64) -> [PredictedMotion; 3] {
    [PredictedMotion::Off, PredictedMotion::Lead(delay_s), PredictedMotion::Model(model(), delay_s)]
}

/// Situation: the law h on the thesis bicycle, sensors 5 to 50 ms late, a slow actuator.
/// Action: search the border without compensation, with a lead, with the linear bicycle.
/// Must hold: the lead regains more than half of the loss, the model hardly more than the lead.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn heights_with_each_compensation() {
    let mut lines = vec![Line::new(0, PredictedMotion::Off)];
    for ms in [5, 10, 20, 30, 50] {
        lines.extend(compensations(ms as f64 * 1e-3).map(|ahead| Line::new(ms, ahead)));
    }
    lines.extend(compensations(0.03).map(|ahead| Line {
        label: "10 ms, actuator 20 ms".to_owned(),
        actuator_s: 0.02,
        ..Line::new(10, ahead)
    }));
    let (table, rows) = heights(&lines, &[2.5, 4.5, 6.5]);
    println!("{table}");
    for three in rows[1..].chunks(3) {
        for (i, prompt) in rows[0].iter().enumerate() {
            let [off, lead, model] = [three[0][i], three[1][i], three[2][i]];
            assert!(lead > 0.5 * (off + prompt) - 0.1 && lead < prompt + 0.3, "{off} {lead} {prompt}");
            assert!(model < lead + 0.5, "{lead} {model}");
        }
    }
    documented("won back", &table);
}

/// Situation: sensors 30 ms late; the lead or the model assumes half or one and a half times that, or another
/// bicycle.
/// Action: search the border.
/// Must hold: each is still better than nothing.
#[test]
fn a_wrong_delay_and_another_bicycle() {
    let assumed_line = |ahead| Line { label: "30 ms".to_owned(), ..Line::new(30, ahead) };
    let mut lines = vec![assumed_line(PredictedMotion::Off)];
    for s in [0.015, 0.045] {
        lines.extend([
            assumed_line(PredictedMotion::Lead(s)),
            assumed_line(PredictedMotion::Model(model(), s)),
        ]);
    }
    let wrong = lines.len();
    for bicycle in ["benchmark", "balanceassistv1_jason", "pista_rider", "browser_jason"] {
        let other =
            |ms, ahead| Line { label: format!("{bicycle}, {ms} ms"), bicycle, ..Line::new(ms, ahead) };
        lines.push(other(0, PredictedMotion::Off));
        lines.extend(compensations(0.03).map(|ahead| other(30, ahead)));
    }
    let (table, rows) = heights(&lines, &[2.5, 4.5, 6.5]);
    println!("{table}");
    for row in &rows[1..wrong] {
        assert!(row.iter().zip(&rows[0]).all(|(with, off)| with > off), "{row:?}");
    }
    for four in rows[wrong..].chunks(4) {
        assert!(four[2].iter().zip(&four[1]).all(|(lead, off)| *lead > off - 0.05), "{four:?}");
    }
    documented("wrong", &table);
}

/// Situation: the smart old rider with the law h.
/// Action: search the border with sensors up to 50 ms late.
/// Must hold: the lead costs the rider nothing.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn with_the_smart_rider() {
    let mut lines = vec![Line { rider: true, ..Line::new(0, PredictedMotion::Off) }];
    for ms in [10, 30, 50] {
        lines.extend(
            compensations(ms as f64 * 1e-3).map(|ahead| Line { rider: true, ..Line::new(ms, ahead) }),
        );
    }
    let (table, rows) = heights(&lines, &[3.0, 4.5, 6.0]);
    println!("{table}");
    for three in rows[1..].chunks(3) {
        assert!(three[1].iter().zip(&three[0]).all(|(lead, off)| *lead > off - 0.1), "{three:?}");
    }
    documented("rider", &table);
}

/// Situation: the noise of a consumer IMU.
/// Action: search the border; ride straight on at 5 m/s and measure the torque caused by the noise.
/// Must hold: the lead is still better.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn with_noise() {
    let mut lines = Vec::new();
    for ms in [10, 30, 50] {
        lines.extend(
            compensations(ms as f64 * 1e-3).map(|ahead| Line { noise: Some(1), ..Line::new(ms, ahead) }),
        );
    }
    let (mut table, rows) = heights(&lines, &[2.5, 4.5, 6.5]);
    let b = Geometry::new(&shipped("rigid_jason").parameters);
    table = table
        .lines()
        .zip(std::iter::once(None).chain(std::iter::once(None)).chain(lines.iter().map(Some)))
        .enumerate()
        .map(|(i, (row, line))| match (i, line) {
            (0, _) => format!("{row} torque N m | its slope N m/s |"),
            (_, Some(line)) => {
                let calm = line.late(&b, None).ride(Start { speed_m_s: 5.0, ..Start::default() });
                format!("{row} {:.2} | {:.0} |", calm.rms_nm, calm.rms_nm_s)
            }
            _ => format!("{row} --- | --- |"),
        })
        .collect::<Vec<_>>()
        .join("\n");
    println!("{table}");
    for three in rows.chunks(3) {
        assert!(three[1].iter().zip(&three[0]).all(|(lead, off)| lead > off), "{three:?}");
    }
    documented("noise", &table);
}
