//! A rider's switch whose contact is loose, during a ride and after a fault.

use control::Mode;
use sim_host::plant::{Fault, Plant};
use sim_host::ride::{Conditions, Start, TracePoint, traced};
use tests::fault_reactions::{product, smart};

const KNOCK: Start = Start { speed_m_s: 4.0, steer_rate_rad_s: 1.0, roll_rate_rad_s: 0.0 };

/// Six seconds of the smart old rider with these faults.
fn ridden(faults: &[&str]) -> Vec<TracePoint> {
    let faults: Vec<Fault> = faults.iter().map(|fault| fault.parse().expect("a fault")).collect();
    let plant = Plant { faults, ..Plant::default() };
    traced(&Conditions { time_limit_s: 6.0, ..smart(product(), plant) }, KNOCK).1
}

fn drives(p: &TracePoint) -> bool {
    p.mode == Mode::Engaged as u8 || p.mode == Mode::Limp as u8
}

/// Situation: engaged; the gyro fails for 40 ms, so that torque ends.
/// Action: the held switch opens by itself: twice for 12 ms, for 1 ms ten times a second, for 0.3 s, for 0.44 s.
/// Must hold: no torque from the fault on.
#[test]
fn a_loose_contact_never_engages_after_a_fault() {
    let openings: [Vec<String>; 4] = [
        vec!["engage:value=0@600ms..612ms".into(), "engage:value=0@1600ms..1612ms".into()],
        (0..50).map(|k| format!("engage:value=0@{}ms..{}ms", 500 + 100 * k, 501 + 100 * k)).collect(),
        (0..5).map(|k| format!("engage:value=0@{}ms..{}ms", 500 + 1000 * k, 800 + 1000 * k)).collect(),
        (0..4).map(|k| format!("engage:value=0@{}ms..{}ms", 500 + 1200 * k, 940 + 1200 * k)).collect(),
    ];
    for opening in openings {
        let faults: Vec<&str> =
            std::iter::once("gyro:missing@300ms..340ms").chain(opening.iter().map(String::as_str)).collect();
        let trace = ridden(&faults);
        let (before, after): (Vec<_>, Vec<_>) = trace.iter().partition(|p| p.t < 0.3);
        assert!(before.iter().copied().all(drives), "{opening:?}");
        let again = after.iter().find(|p| p.t > 0.35 && (drives(p) || p.torque != 0.0));
        assert!(again.is_none(), "{opening:?}: at {} s", again.map_or(0.0, |p| p.t));
    }
}

/// Situation: the same fault.
/// Action: the rider releases the switch for 1.5 s and presses it again.
/// Must hold: standby, then engaged with the press, and to the end.
#[test]
fn a_deliberate_press_engages_after_a_fault() {
    let trace = ridden(&["gyro:missing@300ms..340ms", "engage:value=0@1s..2500ms"]);
    let engaged = trace.iter().position(|p| p.t > 0.35 && drives(p)).expect("engages");
    assert!((2.499..=2.503).contains(&trace[engaged].t), "{} s", trace[engaged].t);
    assert!(trace[engaged - 1].mode == Mode::Standby as u8 && trace[engaged..].iter().all(drives));
}
