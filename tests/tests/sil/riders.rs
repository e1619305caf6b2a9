//! Basins of riders and of both disturbances at once.

use rayon::prelude::*;
use sim_host::basin::{Axis, PlaneSearch, Search, border, column, plane};
use sim_host::ride::{Conditions, Start, rides};
use sim_host::rider::{Fit, Outside, Rider, catalogue};
use tests::basins::{H, alone, assisted, ideal, search};
use tests::published::entry;
use tests::sets::every;

fn rider(name: &str, fit: Fit, delay_s: Option<f64>) -> Rider {
    let table = catalogue::load(name).unwrap_or_else(|e| panic!("{e}"));
    table.rider(fit, Outside::Extrapolate, delay_s).unwrap_or_else(|e| panic!("{e}"))
}

/// The same with run 186 at the speed of the independent program.
fn as_independent(name: &str, fit: Fit, delay_s: Option<f64>) -> Rider {
    let mut table = catalogue::load(name).unwrap_or_else(|e| panic!("{e}"));
    for row in table.rows.iter_mut().filter(|row| name == "young" && row.run == Some(186)) {
        row.speed_m_s = entry("rider_basins").number("run_186_speed");
    }
    table.rider(fit, Outside::Extrapolate, delay_s).unwrap_or_else(|e| panic!("{e}"))
}

fn ridden(assist: Conditions, rider: Rider) -> Conditions {
    Conditions { rider: Some(rider), ..assist }
}

/// Situation: the riders of Tables 3.1 and 3.2. Action: find area and mean height from 2 to 7.5 m/s.
/// They must be an independent program's; what is printed is printed beside them. By default the first and the last.
#[test]
fn areas_of_riders() {
    let published = entry("rider_basins");
    let riders = [("young", "young", None), ("naive", "young", Some(0.06)), ("smart", "smart", None)];
    let fitted = riders.into_iter().flat_map(|rider| Fit::ALL.map(|fit| (rider, fit)));
    for ((key, name, delay), fit) in every(8, fitted) {
        let conditions = ridden(alone(), as_independent(name, fit, delay));
        let speeds: Vec<f64> = (0..=55).map(|i| 2.0 + 0.1 * f64::from(i)).collect();
        let heights: Vec<f64> =
            speeds.par_iter().map(|&v| border(&conditions, &search(&[v], 15.0), v).upper).collect();
        let area: f64 = heights.windows(2).map(|w| 0.05 * (w[0] + w[1])).sum();
        let mean = heights.iter().sum::<f64>() / 56.0;
        let [area_printed, mean_printed, area_wanted, mean_wanted] =
            published.row(&format!("{key}_{}", fit.name()));
        println!(
            "{key} {}: area {area:.2}, independent {area_wanted}, printed {area_printed}; \
             mean {mean:.2}, {mean_wanted}, {mean_printed}",
            fit.name()
        );
        assert!((area - area_wanted).abs() < published.number("area_tolerance"), "{area}");
        assert!((mean - mean_wanted).abs() < published.number("mean_tolerance"), "{mean}");
        assert!(area > area_printed && area < area_printed + 2.0, "the printed grid loses up to 2");
    }
}

/// Situation: the smart rider at 3 m/s.
/// Action: add h.
/// Must hold: the basin grows to between two and five times, and is near the same with the flashed assist.
#[test]
fn the_assist_helps_the_rider() {
    let height =
        |assist| border(&ridden(assist, rider("smart", Fit::Mean, None)), &search(&[3.0], 20.0), 3.0).upper;
    let (alone, flashed, continuous) = (height(alone()), height(assisted(H)), height(ideal(H)));
    println!("alone {alone:.3}, flashed {flashed:.3}, continuous {continuous:.3}");
    assert!((2.0..5.0).contains(&(flashed / alone)));
    assert!((flashed - continuous).abs() < 0.1);
}

/// Situation: the search that ends soon after the first fall.
/// Action: compare with the complete one.
/// Must hold: the border is the same to the bit.
#[test]
fn a_border_is_that_of_the_complete_column() {
    let conditions = ridden(alone(), rider("young", Fit::Best, None));
    for v in [2.0, 4.3, 7.0] {
        let (whole, short) =
            (column(&conditions, &search(&[v], 20.0), v), border(&conditions, &search(&[v], 20.0), v));
        assert_eq!((whole.upper, whole.border), (short.upper, short.border));
        assert!(short.work.rides < whole.work.rides);
    }
}

/// Situation: both rates disturbed at 4.3 m/s.
/// Action: search the plane.
/// Must hold: on the axes it is the two one-dimensional basins; its outline is a closed border; its mirror image is
/// itself.
#[test]
fn the_plane_contains_both_axes() {
    let conditions = ridden(assisted(H), rider("smart", Fit::Mean, None));
    let expected = PlaneSearch {
        speed: 4.3,
        rays: 8,
        max_steer_rate: 20.0,
        max_roll_rate: 4.0,
        points: 40,
        tolerance: 0.0005,
        ..PlaneSearch::default()
    };
    let found = plane(&conditions, &expected, |_| (), || false).expect("a plane");
    let outline = found.outline();
    assert_eq!(outline.len(), 16);
    let steer = column(&conditions, &search(&[4.3], 20.0), 4.3).upper;
    let roll = column(&conditions, &Search { axis: Axis::RollRate, ..search(&[4.3], 4.0) }, 4.3).upper;
    assert!((outline[0].0 - steer).abs() < 0.03, "{:?} {steer}", outline[0]);
    assert!((outline[4].1 - roll).abs() < 0.02, "{:?} {roll}", outline[4]);
    let at = |s: f64, &(steer, roll): &(f64, f64)| Start {
        speed_m_s: 4.3,
        steer_rate_rad_s: s * steer,
        roll_rate_rad_s: s * roll,
    };
    for point in &outline {
        let pair = rides(&conditions, &[at(1.0, point), at(1.01, point)]);
        assert!(!pair[0].fell() && pair[1].fell(), "{point:?}");
    }
    let area = found.area();
    println!("area {area:.2} rad^2/s^2");
    // Between the rhombus through the axes and a rectangle around all.
    assert!(area > 2.0 * steer * roll && area < 6.0 * steer * roll, "{area}");
}
