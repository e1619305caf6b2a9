//! Tests of figures with data of any shape: complete SVG with the expected words, and a PNG.

use super::*;
use crate::basin::{Axis, Basin, Column, Island, ScanPoint, Work};
use crate::eigen::{CriticalSpeeds, Mode};
use crate::ride::{FallCause, Outcome, TracePoint};
use nalgebra::Complex;

fn column(speed: f64, upper: f64, islands: &[Island]) -> Column {
    let outcome = |rate| match rate {
        r if r > upper => Outcome::Fallen { time_s: r / 4.0, by: FallCause::Roll },
        r if r < 2.0 => Outcome::Recovered,
        _ => Outcome::Undecided,
    };
    let scan = (1..=8).map(f64::from).map(|rate| ScanPoint { rate, outcome: outcome(rate) }).collect();
    let (islands, work) = (islands.to_vec(), Work::default());
    Column {
        speed,
        upper,
        capped: upper >= 8.0,
        islands,
        scan,
        outcome: None,
        border: None,
        beyond: None,
        work,
    }
}

fn basin_of(uppers: &[f64]) -> Basin {
    Basin { columns: uppers.iter().enumerate().map(|(i, &u)| column(i as f64, u, &[])).collect() }
}

fn figure<'a>(series: &'a [(&'a str, &'a Basin)]) -> BasinFigure<'a> {
    BasinFigure {
        title: "a < b",
        series,
        self_stable: Some((1.0, 2.5)),
        axis: Axis::SteerRate,
        cap: 8.0,
        band: None,
    }
}

/// The SVG; checks that all elements are closed and all numbers finite.
fn svg(picture: &Picture) -> String {
    let svg = picture.svg();
    let mut open: Vec<&str> = Vec::new();
    for tag in svg.split('<').skip(1).map(|t| t.split_once('>').expect("a tag ends").0) {
        let name = tag.split_whitespace().next().unwrap_or_default();
        match name.strip_prefix('/') {
            Some(closed) => assert_eq!(open.pop(), Some(closed)),
            None if tag.ends_with('/') || tag.starts_with('!') => {}
            None => open.push(name),
        }
    }
    assert!(open.is_empty(), "{open:?}");
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    assert_eq!(&picture.png().expect("a PNG")[1..4], b"PNG");
    svg
}

#[test]
fn a_basin_says_what_its_signs_mean() {
    let island = Island { from: 5.0, to: 6.0 };
    let columns = vec![column(0.0, 3.0, &[island]), column(1.0, 8.0, &[])];
    let basin = Basin { columns };
    let text = svg(&super::basin(&figure(&[("law", &basin)])));
    for texts in [
        "a &lt; b",
        "Forward speed v [m/s]",
        "Initial steer rate [rad/s]",
        "Time to fall [s]",
        "basin of attraction: law",
        "still upright at the time limit",
        "above a rate that falls",
        "no fall up to the largest rate tried",
        "self-stable, 1.00–2.50 m/s",
    ] {
        assert!(text.contains(texts), "{texts}");
    }
}

#[test]
fn basins_of_any_shape_are_drawn() {
    for uppers in [&[][..], &[3.0], &[0.0, 0.0, 0.0], &[8.0, 8.0], &[0.0, 8.0, 0.0, 2.0]] {
        let basin = basin_of(uppers);
        svg(&super::basin(&figure(&[("", &basin)])));
        let several = svg(&super::basin(&figure(&[("one", &basin), ("two", &basin)])));
        assert!(several.contains(">one<") && several.contains(">two<"));
    }
    svg(&super::basin(&BasinFigure { axis: Axis::RollRate, self_stable: None, ..figure(&[]) }));
}

#[test]
fn rides_of_any_length_are_drawn() {
    let point = |i: usize| TracePoint {
        t: 1e-3 * i as f64,
        roll: 0.1,
        steer: -0.2,
        pitch: 0.0,
        roll_rate: 0.3,
        steer_rate: 0.4,
        yaw_rate: 0.0,
        rear_wheel_rate: -10.0,
        rear_speed: 4.0,
        front_speed: 4.1,
        measured_roll_rate: 0.3,
        measured_speed: 4.1,
        torque: if i == 700 { f64::NAN } else { 0.0 },
        rider_torque: 0.1,
        motor_torque: 0.5,
        mode: 4,
        causes: 0,
        causes_low: 0,
        causes_high: 0,
        frame: control::SensorFrame::missing(),
        limits: control::ActiveLimits::RATE.0,
    };
    for n in [0, 1, 2, 1500] {
        let trace: Vec<_> = (0..n).map(point).collect();
        let draw = |outcome| svg(&ride(&RideFigure { title: "", trace: &trace, outcome }));
        let text = draw(Outcome::Fallen { time_s: 1.5, by: FallCause::Steer });
        for texts in
            ["Angle [deg]", "Rate [rad/s]", "Speed [m/s]", "Torque [N m]", "Time [s]", "falls at 1.500 s"]
        {
            assert!(text.contains(texts), "{texts}");
        }
        assert_eq!(n > 0, text.contains("limit: rate of change"));
        assert!(draw(Outcome::Undecided).contains("undecided"));
    }
}

#[test]
fn modes_of_any_number_are_drawn() {
    let at = |re, im| Some(Complex::new(re, im));
    let mode = |name: &str, roots| Mode { name: name.into(), roots };
    let all = [
        mode(
            "weave",
            vec![vec![at(1.0, 0.0), at(0.5, 3.0), at(-1.5, 3.0)], vec![at(0.5, 0.0), at(0.5, -3.0), None]],
        ),
        mode("capsize", vec![vec![at(-1.0, 0.0); 3]]),
        mode("rider 1", vec![vec![at(-99.0, 5.0); 3]]),
    ];
    let speeds = [0.0, 1.0, 2.0];
    let critical = CriticalSpeeds { v_d: Some(0.5), v_w: Some(0.6), v_c: Some(50.0) };
    for n in 0..=3 {
        let cut = |root: &Vec<_>| root[..n].to_vec();
        let modes: Vec<Mode> = all.iter().map(|m| mode(&m.name, m.roots.iter().map(cut).collect())).collect();
        for stable in [&[][..], &[(1.2, 20.0)]] {
            let figure = EigenFigure { title: "", speeds: &speeds[..n], modes: &modes, stable, critical };
            let text = svg(&eigen(&figure));
            assert!(text.contains("Re λ [1/s]") && text.contains("Im λ [rad/s]"));
            assert!(!text.contains("50.00") && !text.contains("rider 1"));
            assert_eq!(n > 0, text.contains(">weave<"));
            assert_eq!((n == 3 || n == 0) && !stable.is_empty(), text.contains("stable straight ride"));
        }
    }
}
