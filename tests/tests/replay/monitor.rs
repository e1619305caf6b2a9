//! A board's telemetry, replayed.

use super::{PROGRAM, product};
use control::{State, step};
use link::message::Message;
use link::telemetry::Telemetry;
use sim_host::replay::frames;
use tests::cli::Bench;
use tests::link_board::LinkBoard;

/// Situation: a board rides a simulated ride with a gyro of 100 Hz and wheels of 50 Hz, and sends each step over its
/// link.
/// Action: write it with `monitor --csv`, replay the table unchanged, and write the frames.
/// Must hold: they are the frames that the board received, ages and the switch included, except the clock's zero; so
/// the commands are the same.
#[test]
fn the_monitors_table_is_replayed_as_it_is() {
    let bench = Bench::new(PROGRAM);
    let ride = bench.run(
        "ride --preset product --speed 4 --steer-rate 1 --time-limit 2 -q --frames ride.frames \
         --sensor gyro:every=10ms --sensor front-wheel:every=20ms --sensor rear-wheel:every=20ms",
    );
    assert_eq!(ride.code, Some(0), "{}", ride.stderr);
    let received = frames(&std::fs::read(bench.path("ride.frames")).unwrap()).unwrap();
    let (plan, mut state, mut board) = (product(), State::default(), LinkBoard::default());
    let (mut bytes, mut steps) = (Vec::new(), 0);
    for (_, frame) in &received {
        let command = step(&plan, &mut state, frame);
        steps += 1;
        let telemetry = Telemetry {
            steps,
            late: 0,
            driven: true,
            frame: *frame,
            command,
            slopes: state.slopes(),
            polarity: 0,
            polarity_torque_nm: 0.0,
        };
        bytes.extend(board.unsolicited(&Message::Telemetry(telemetry)));
    }
    bench.write("ride.link", bytes);
    let monitor = bench.run("monitor --file ride.link --csv ride.csv");
    assert_eq!(monitor.code, Some(0), "{}", monitor.stderr);

    // The map is found by the columns.
    let replay = bench.run("replay ride.csv --frames again.frames -q");
    assert_eq!(replay.code, Some(0), "{}", replay.stderr);
    let again = frames(&std::fs::read(bench.path("again.frames")).unwrap()).unwrap();
    assert!(again.len() > 2000 && received.len() - again.len() < 3, "{} of {}", again.len(), received.len());
    let skipped = received.len() - again.len();
    for (place, ((_, ours), (_, theirs))) in again.iter().zip(&received[skipped..]).enumerate() {
        let mut ours = *ours;
        ours.now_us = theirs.now_us;
        // A zero may lose its sign.
        assert_eq!(ours, *theirs, "{place}");
    }
    let oldest = again.iter().map(|(_, frame)| frame.gyro_rad_s.age_ticks).filter(|age| *age < 1000).max();
    assert_eq!(oldest, Some(9));
    let named = bench.json("replay ride.csv --map monitor");
    assert_eq!(named["remarks"], serde_json::json!([]));
    // The board has no sensor of the rider's torque; its table is accepted nevertheless.
    let absent = serde_json::json!(["rider-torque (no value in `measured_rider_torque`)"]);
    assert_eq!(named["absent"], absent);
    assert_eq!(bench.run("replay ride.csv --strict -q").code, Some(0));
    assert!(named["engaged_s"].as_f64().unwrap() > 1.5);
}
