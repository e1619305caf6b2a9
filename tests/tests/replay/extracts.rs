//! Extracts of recordings of real bicycles, `data/recordings`.

use super::{PROGRAM, cause, number};
use serde_json::Value;
use tests::cli::{Bench, repository, word};

fn replay(name: &str, more: &str) -> Value {
    let path = repository("data/recordings").join(name);
    Bench::new(PROGRAM).json(&format!("replay {} --map extract {more}", word(&path)))
}

/// Situation: at 4 m/s a real steer encoder fails at 0.460 s; the bicycle falls onto its outrigger.
/// Action: replay it with the bicycle's geometry.
/// Must hold: engaged before and no fault detected; yaw rate and steer angle disagree (cause 38) at most 0.7 s after,
/// which is a fault.
#[test]
fn a_dead_steer_encoder_is_detected() {
    let document = replay(
        "g1_steer_encoder_dies_4mps.csv",
        "--set cross.wheelbase_m=1.068 --set cross.tilt_rad=0.327 --set estimate.imu.forward_m=0.49 --set estimate.imu.up_m=0.78",
    );
    assert_eq!(document["remarks"], serde_json::json!([]));
    let first_s = number(&cause(&document, 38).expect("detected")["first_s"]);
    assert!((0.5..0.46 + 0.7).contains(&first_s), "{first_s}");
    let alarms: Vec<_> = document["causes"].as_array().unwrap().iter().filter(|c| c["alarms"] != 0).collect();
    assert!(alarms.iter().all(|cause| number(&cause["first_s"]) >= first_s), "{alarms:?}");
    let modes: Vec<_> =
        document["modes"].as_array().unwrap().iter().map(|mode| mode["mode"].as_str().unwrap()).collect();
    assert_eq!(modes[..5], ["initialise", "self-test", "standby", "engaged", "fault"]);
    let peak_nm = number(&document["peak_torque_nm"]);
    assert!((0.5..7.0).contains(&peak_nm), "{peak_nm}");
}

/// Situation: at 1.9 m/s a real steer encoder reads 1.39, -1.75 and 0.04 rad in turn for 0.17 s.
/// Action: replay it.
/// Must hold: limp by the encoder's range (cause 10) at 2.901 s, engaged again within a second; the torque never
/// exceeds 4 N m, and is not zero before.
#[test]
fn spikes_of_a_steer_encoder_give_limp_mode() {
    let document = replay("g2_steer_encoder_spikes_2mps.csv", "");
    let range = cause(&document, 10).expect("out of range");
    assert!((2.881..2.921).contains(&number(&range["first_s"])), "{range}");
    let modes = document["modes"].as_array().unwrap();
    let limp = modes.iter().position(|mode| mode["mode"] == "limp").expect("limp");
    assert!((2.881..2.921).contains(&number(&modes[limp]["from_s"])), "{modes:?}");
    assert_eq!((&modes[limp - 1]["mode"], &modes[limp + 1]["mode"]), (&"engaged".into(), &"engaged".into()));
    assert!((3.0..3.9).contains(&number(&modes[limp + 1]["from_s"])), "{modes:?}");
    let peak_nm = number(&document["peak_torque_nm"]);
    assert!((1.0..4.0).contains(&peak_nm), "{peak_nm}");
    // The log's own law commanded more: the difference is reported.
    assert!(number(&document["torque"]["largest_difference"]) > 8.0);
}
