//! The tables of docs/virtual-board.md on the bicycle's rides, as far as they come from the simulator alone.

use sim_host::ride::{Conditions, Start, traced};
use virtual_board::bicycle::causes::Cause;
use virtual_board::bicycle::compare::{Difference, torques_nm};
use virtual_board::bicycle::rides::{Preset, simulated};

/// Steer rate of the disturbance \[rad/s\], and duration of the ride after it \[s\], as in `examples/ride.rs`.
const KNOCK_RAD_S: f64 = 1.5;
const COMPARED_S: f64 = 2.0;

/// The torque's peak and root mean square in the simulator \[N m\], in the format of the page.
fn torque(conditions: &Conditions, speed_m_s: f64) -> [String; 2] {
    let start = Start { speed_m_s, steer_rate_rad_s: KNOCK_RAD_S, roll_rate_rad_s: 0.0 };
    let torque = torques_nm(&traced(conditions, start).1, 1);
    let by = Difference::new(&torque, &torque);
    [format!("{:.2}", by.peak_nm), format!("{:.3}", by.rms_nm)]
}

/// The cells of the page's row that begins with this text.
fn row<'a>(page: &'a str, beginning: &str) -> Vec<&'a str> {
    let line =
        page.lines().find(|line| line.starts_with(beginning)).unwrap_or_else(|| panic!("no row {beginning}"));
    line.split('|').map(str::trim).collect()
}

/// Situation: the rides of the page's first two tables.
/// Action: ride them in the simulator, exact and with each part of the board.
/// Must hold: the page has the same torque to its last digit; if it has not, the board's rides beside them are those
/// of another controller, and all three tables must be recorded again.
#[test]
fn the_page_has_the_simulators_rides() {
    let page = std::fs::read_to_string(xtask::image::root().join("docs/virtual-board.md")).expect("the page");
    let mut stale = Vec::new();
    let mut compare = |beginning: &str, documented: [&str; 2], fresh: [String; 2]| {
        if documented != fresh {
            stale.push(format!("{beginning} {documented:?}, here {fresh:?}"));
        }
    };
    for preset in [Preset::H, Preset::Product] {
        for rider in [None, Some("smart")] {
            for speed_m_s in [3.0, 5.0] {
                let beginning = format!("| {} | {} | {speed_m_s} |", preset.name(), rider.unwrap_or("none"));
                let cells = row(&page, &beginning);
                let documented = [6, 7].map(|cell: usize| cells[cell].rsplit(' ').next().unwrap_or_default());
                let conditions = simulated(preset, rider, COMPARED_S).expect("shipped");
                compare(&beginning, documented, torque(&conditions, speed_m_s));
            }
        }
        for cause in Cause::ALL {
            let beginning = format!("| {} | {} |", preset.name(), cause.name());
            let cells = row(&page, &beginning);
            let mut conditions = simulated(preset, None, COMPARED_S).expect("shipped");
            cause.act(&mut conditions, 3.0).expect("shipped");
            compare(&beginning, [cells[3], cells[4]], torque(&conditions, 3.0));
        }
    }
    assert!(stale.is_empty(), "docs/virtual-board.md, record its tables anew:\n{}", stale.join("\n"));
}
