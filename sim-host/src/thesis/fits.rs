//! Measured gains as functions of speed: appendices F, G, H and J.2 to J.4, Figures 3.1 and 3.3.

use super::cyclist::{Cyclist, Print, fit_name, fit_named};
use super::draw::SPEED;
use super::item::{Figure, Item, Value};
use super::study::Study;
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};
use crate::rider::{Fit, KEYS, RiderTable, Schedule};

/// Line styles of the fits.
pub(super) const LINES: [Line; 3] = [Line::Solid, Line::Dashed, Line::Dotted];
/// Range of speeds of the riders' basins \[m/s\].
const RIDDEN: [f64; 2] = [2.0, 7.5];
/// The units of [`KEYS`].
const UNITS: [&str; 10] = [
    "N m/rad",
    "N m/(s rad)",
    "N m s/rad",
    "N m s²/rad",
    "N m/rad",
    "N m/(s rad)",
    "N m s/rad",
    "N m s²/rad",
    "N m/rad",
    "N/m",
];

/// "K_φp" of "K_phi_p".
fn symbol(key: &str) -> String {
    key.replace("phi_", "φ").replace("delta_", "δ")
}

/// Other prints of the gains that the coefficients can belong to.
const OTHER_PRINTS: [(&str, Print, &str); 4] = [
    ("best sets by the printed VAFs", Print::HighestVaf, "young"),
    ("run 191 at 6.0 m/s, as in Table G.4", Print::Run191, "smart"),
    ("with run 249, K_phi_d = 7.98", Print::Run249ByH4, "smart"),
    ("with run 249 as in Table G.4, K_phi_d = 2.98", Print::Run249ByG4, "smart"),
];

/// The other prints of a rider's gains.
fn other_prints(table: &str) -> impl Iterator<Item = (&'static str, Print)> {
    OTHER_PRINTS.into_iter().filter(move |(.., of)| *of == table).map(|(name, print, _)| (name, print))
}

/// R^2 of one gain, or the mean of all of them.
fn determination(cyclist: Cyclist, schedule: &Schedule, row: &str) -> Option<f64> {
    let table = cyclist.table();
    let all = table.r_squared(schedule);
    match KEYS.iter().position(|key| *key == row) {
        Some(i) => all[i],
        None => {
            let measured: Option<Vec<f64>> = table.columns.iter().map(|&i| all[i]).collect();
            measured.map(|r| r.iter().sum::<f64>() / r.len() as f64)
        }
    }
}

/// A table of coefficients of determination: of the least-squares line and the two interpolations.
fn coefficients(item: &str, rider: fn(Fit) -> Cyclist) -> Item {
    let values = Item::compare(item, |cell| {
        let Some(fit) = fit_named(&cell.column) else { return Value::new(cell, None) };
        let row = cell.row.clone();
        let of = |print: Print| {
            let cyclist = rider(fit).by(print);
            determination(cyclist, &cyclist.schedule(), &row)
        };
        let mut value = Value::new(cell, of(Print::LeastSquares));
        if fit == Fit::Regression {
            let printed = rider(fit);
            let by_rows = determination(printed, &printed.schedule(), &row);
            value = value.tried("of the printed lines", by_rows.unwrap_or(f64::NAN));
        }
        for (name, print) in other_prints(rider(fit).table) {
            value = value.tried(name, of(print).unwrap_or(f64::NAN));
        }
        value
    });
    Item { values, ..Item::default() }
}

/// A regression's slopes and intercepts, by least squares over the printed sets.
fn regression(item: &str, rider: Cyclist) -> Item {
    let values = Item::compare(item, |cell| {
        let part = |table: &RiderTable| {
            let line = table.least_squares();
            let gains = if cell.column == "slope" { line.slope } else { line.intercept };
            gains.get(&cell.row)
        };
        let tried: Vec<_> = other_prints(rider.table)
            .filter(|(_, print)| *print != Print::HighestVaf)
            .map(|(name, print)| (name, part(&rider.by(print).table()).unwrap_or(f64::NAN)))
            .collect();
        let exact = part(&rider.table());
        tried.into_iter().fold(Value::new(cell, exact), |value, (name, x)| value.tried(name, x))
    });
    let note = "Computed by least squares over the printed sets, whose gains are rounded.";
    Item { values, notes: vec![note.into()], ..Item::default() }
}

/// Table F.1.
pub(super) fn table_f_1(_: &Study) -> Item {
    coefficients("table-F.1", Cyclist::young)
}

/// Table G.2.
pub(super) fn table_g_2(_: &Study) -> Item {
    coefficients("table-G.2", Cyclist::smart)
}

/// Table H.1.
pub(super) fn table_h_1(_: &Study) -> Item {
    coefficients("table-H.1", Cyclist::six)
}

/// Eq. F.2.
pub(super) fn equation_f_2(_: &Study) -> Item {
    regression("equation-F.2", Cyclist::young(Fit::Regression))
}

/// Eq. G.2.
pub(super) fn equation_g_2(_: &Study) -> Item {
    regression("equation-G.2", Cyclist::smart(Fit::Regression))
}

/// Eq. H.1.
pub(super) fn equation_h_1(_: &Study) -> Item {
    let mut item = regression("equation-H.1", Cyclist::six(Fit::Regression));
    let note = "The intercept of K_delta_d is printed -0.06181. The sets give -0.62, so a zero too many is printed; \
                the basin says the same (Table H.2).";
    item.notes.push(note.into());
    item
}

/// Eq. J.5.
pub(super) fn equation_j_5(_: &Study) -> Item {
    regression("equation-J.5", Cyclist::undelayed(Fit::Regression, 0))
}

/// A panel for one gain.
fn panel(key: usize, series: Vec<Series>) -> Plot {
    Plot {
        x: Axis::new(SPEED).over(1.5, 8.0),
        y: Axis::new(&format!("{} [{}]", symbol(KEYS[key]), UNITS[key])),
        series,
        verticals: RIDDEN.to_vec(),
        ..Plot::default()
    }
}

/// The measured values of one gain.
fn measured(name: &str, look: Look, table: &RiderTable, key: usize) -> Series {
    Series::new(name, look, table.rows.iter().map(|r| (r.speed_m_s, r.gains.0[key])).collect())
}

/// The gains over speed: measured sets and the three fits.
fn gains(name: &str, title: &str, rider: fn(Fit) -> Cyclist) -> Item {
    let table = rider(Fit::Mean).table();
    let schedules = Fit::THESIS.map(|fit| rider(fit).schedule());
    let line = |i: usize, key: usize| {
        // An interpolation bends only at its points.
        let points = schedules[i].points().iter().map(|p| p.0);
        let mut speeds: Vec<f64> = RIDDEN.into_iter().chain(points).collect();
        speeds.sort_by(f64::total_cmp);
        let on = |&v: &f64| (v, schedules[i].at(v).0[key]);
        Series::new(fit_name(Fit::THESIS[i]), Look::line(i, LINES[i]), speeds.iter().map(on).collect())
    };
    let plot = |&key: &usize| {
        let sets = measured("measured", Look::marks(4, Marker::Dot), &table, key);
        panel(key, [sets].into_iter().chain((0..3).map(|i| line(i, key))).collect())
    };
    let plots = table.columns.iter().map(plot).collect();
    let chart = Chart { title: title.into(), columns: 2, plots, shaded: String::new() };
    let caption = format!(
        "{title}: measured sets, linear regression as printed (LR), and straight lines through the means (LI mean) \
         and the best sets (LI highest VAF) of every group of speeds. Positive gains turn the handlebar to the right \
         for a motion to the right. Basins are searched between the vertical lines."
    );
    Item { figures: vec![Figure::of_chart(name, &caption, &chart)], ..Item::default() }
}

/// Figure 3.1.
pub(super) fn figure_3_1(_: &Study) -> Item {
    gains("figure-3.1", "Gains of the young cyclist", Cyclist::young)
}

/// Figure 3.3.
pub(super) fn figure_3_3(_: &Study) -> Item {
    gains("figure-3.3", "Gains of the smart, old cyclist", Cyclist::smart)
}

/// Figure H.2.
pub(super) fn figure_h_2(_: &Study) -> Item {
    gains("figure-H.2", "Six gains of the smart, old cyclist", Cyclist::six)
}

/// Figure J.2.
pub(super) fn figure_j_2(_: &Study) -> Item {
    gains("figure-J.2", "Gains of the undelayed cyclist", |fit| Cyclist::undelayed(fit, 0))
}

/// Figure H.1: the measured six and seven gains.
pub(super) fn figure_h_1(_: &Study) -> Item {
    let (seven, six) = (Cyclist::smart(Fit::Mean).table(), Cyclist::six(Fit::Mean).table());
    let plot = |&key: &usize| {
        let mut series = vec![measured("seven gains", Look::marks(1, Marker::Square), &seven, key)];
        if six.columns.contains(&key) {
            series.push(measured("six gains", Look::marks(0, Marker::Dot), &six, key));
        }
        panel(key, series)
    };
    let plots = seven.columns.iter().map(plot).collect();
    let title = "Six and seven gains of the smart, old cyclist".to_owned();
    let chart = Chart { title, columns: 2, plots, shaded: String::new() };
    let caption = "Measured gains of the smart, old cyclist, with and without a gain on the roll angle.";
    Item { figures: vec![Figure::of_chart("figure-H.1", caption, &chart)], ..Item::default() }
}
