//! Effect of each fault on the height of the basin. The table is that of docs/safety.md.

use rayon::prelude::*;
use sim_host::basin::{Axis, Method, Search, border};
use sim_host::plant::{Fault, Plant};
use sim_host::ride::{Assist, Conditions, Ride, rides};
use tests::fault_reactions::{FAULT_REACTIONS, product, smart};
use tests::sets::every;

/// The table's speeds \[m/s\].
const SPEEDS: [f64; 5] = [2.0, 3.0, 4.3, 6.0, 7.3];
/// Tolerance of a stated height, as a part of the height without assist: 0.5 % of rounding, the rest for the
/// tolerance of the border's search.
const WITHIN: f64 = 0.02;
/// Below this a reason is stated \[%\].
const LEAST: f64 = 90.0;

/// A row of the table: faults with the same heights.
struct Row {
    faults: Vec<&'static str>,
    /// Heights in % of that without assist at [`SPEEDS`]; the fault beginning at its own time, and with the
    /// disturbance.
    heights: [Vec<f64>; 2],
    reason: &'static str,
}

fn section() -> &'static str {
    let mut sections = include_str!("../../../docs/safety.md").split("\n## ");
    sections.find_map(|s| s.strip_prefix("What a fault costs\n")).expect("the section")
}

/// The rows of the section, in its order.
fn rows() -> Vec<Row> {
    let rows = section().lines().filter(|line| line.starts_with("| `"));
    rows.map(|line| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let [faults, later, at_once, reason] = cells[..] else { panic!("four cells: {line}") };
        let numbers = |cell: &str| -> Vec<f64> {
            let numbers: Vec<f64> = cell.split_whitespace().filter_map(|n| n.parse().ok()).collect();
            assert_eq!(numbers.len(), SPEEDS.len(), "{line}");
            numbers
        };
        Row {
            faults: faults.split(", ").map(|fault| fault.trim_matches('`')).collect(),
            heights: [numbers(later), numbers(at_once)],
            reason,
        }
    })
    .collect()
}

/// The product with a fault, or without any; rides of 4 s.
fn faulty(fault: Option<Fault>) -> Conditions {
    let plant = Plant { faults: fault.into_iter().collect(), ..Plant::default() };
    Conditions { time_limit_s: 4.0, ..smart(product(), plant) }
}

/// The height \[rad/s\].
fn height(conditions: &Conditions, speed: f64) -> f64 {
    let axis = Axis::SteerRate;
    let search = Search {
        speeds: vec![speed],
        axis,
        max_rate: 20.0,
        scan_step: 0.25,
        tolerance: 0.02,
        method: Method::Fast,
        efforts: false,
    };
    border(conditions, &search, speed).upper
}

/// Whether the height is `stated`, to `within`: of six rides evenly up to it none falls, one just beyond does.
fn is(stated: f64, within: f64, conditions: &Conditions, speed: f64) -> bool {
    let below = (1..=6).map(|i| (stated - within) * f64::from(i) / 6.0);
    let starts: Vec<_> =
        below.chain([stated + within]).map(|rate| Axis::SteerRate.start(speed, rate)).collect();
    let fell: Vec<bool> = rides(conditions, &starts).iter().map(Ride::fell).collect();
    fell == [false, false, false, false, false, false, true]
}

/// Situation: the smart old rider with the flashed configuration, and one fault or none.
/// Action: find the largest blow to the handlebar without a fall, as a part of that without assist.
/// Must hold: it is that of the table, from a few rides about it, by default for every sixth fault; every fault of
/// the fault tests is in the table; below 90 % a reason is stated, above none.
#[test]
fn heights_with_faults_are_as_documented() {
    let rows = rows();
    let row_of = |name: &str| {
        let mut found = rows.iter().filter(|row| row.faults.contains(&name));
        (found.next(), found.next().is_some())
    };
    let unassisted = Conditions { assist: Assist::None, ..faulty(None) };
    let bases: Vec<f64> = SPEEDS.par_iter().map(|speed| height(&unassisted, *speed)).collect();
    let listed = bases.iter().map(|base| format!("{base:.1}")).collect::<Vec<_>>().join(", ");
    assert!(section().contains(&format!("{listed} rad/s")), "without assist: {listed} rad/s");
    let mut names = vec!["none"];
    names.extend(FAULT_REACTIONS.iter().map(|reaction| reaction.0));
    let ridden: Vec<_> = every(6, &names).collect();
    let mut wrong: Vec<String> = ridden
        .par_iter()
        .filter_map(|name| {
            let (row, _) = row_of(name);
            let reaction = FAULT_REACTIONS.iter().find(|reaction| reaction.0 == **name);
            let conditions =
                [None, Some(0.0)].map(|from_s| faulty(reaction.map(|reaction| reaction.fault(from_s))));
            let right = row.is_some_and(|row| {
                conditions.iter().zip(&row.heights).all(|(conditions, stated)| {
                    let mut cells = SPEEDS.iter().zip(stated).zip(&bases);
                    cells.all(|((speed, percent), base)| {
                        is(1e-2 * percent * base, WITHIN * base, conditions, *speed)
                    })
                })
            });
            if right {
                return None;
            }
            let found = conditions.map(|conditions| {
                let percent = |(speed, base): (&f64, &f64)| {
                    format!("{:.0}", 100.0 * height(&conditions, *speed) / base)
                };
                SPEEDS.iter().zip(&bases).map(percent).collect::<Vec<_>>().join(" ")
            });
            Some(format!("| `{name}` | {} | {} | |", found[0], found[1]))
        })
        .collect();
    for name in &names {
        match row_of(name) {
            (Some(_), false) => {}
            (None, _) => wrong.push(format!("`{name}` has no row")),
            (_, true) => wrong.push(format!("`{name}` has two rows")),
        }
    }
    for row in &rows {
        let costs = row.heights.iter().flatten().any(|percent| *percent < LEAST);
        if costs == row.reason.is_empty() {
            wrong.push(format!("{:?}: a reason belongs below {LEAST} % and only there", row.faults));
        }
        for fault in row.faults.iter().filter(|fault| !names.contains(fault)) {
            wrong.push(format!("`{fault}` is no fault of the tests"));
        }
    }
    assert!(wrong.is_empty(), "docs/safety.md should have:\n{}", wrong.join("\n"));
}
