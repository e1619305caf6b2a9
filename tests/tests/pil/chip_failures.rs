//! Failures of the chip during a ride, and their effect on the ride.

use super::image::started;
use sim_host::pil::{Controller, Lockstep};
use sim_host::ride::Conditions;
use tests::pil::{KNOCK, Ridden, product, ridden};
use xtask::image;

/// Situation: a product ride, engaged.
/// Action: at 1 s of the chip's time its control task never ends, it panics, or its supply fails.
/// Must hold: until then the bits of an undisturbed ride; the motor holds the command for at most 5 ms, then gives
/// none to the end, as the restarted chip has the stored configuration, without a polarity check; the bicycle falls,
/// which it does not otherwise; the chip restarted once, after a hung task by the watchdog, else within milliseconds.
#[test]
fn a_chip_that_fails_gives_no_torque() {
    if !image::ready() {
        return;
    }
    let conditions = Conditions { time_limit_s: 1.5, ..product() };
    let plain = ridden(&conditions, KNOCK, &mut Controller::new(started(&[]), &[], 0)).unwrap();
    assert!(!plain.ride.fell(), "{:?}", plain.ride);
    for (fault, missed) in [("control-spin", 50..250), ("panic", 0..60), ("brown-out", 0..200)] {
        let chip = started(&[&format!("fault={fault}"), "at_ms=1000"]);
        let begin_ms = chip.last().time_ms;
        let mut controller = Controller::new(chip, &[], 0);
        let Ridden { ride, steps, .. } = ridden(&conditions, KNOCK, &mut controller).unwrap();
        let (tally, output) = (controller.tally(), controller.board.output());
        println!("{fault}: {tally:?}, {output}");
        let at = (1000 - begin_ms) as usize;
        let torque = |k: usize| steps[k].1.command.torque_nm;
        let same = steps.iter().zip(&plain.steps).take_while(|(a, b)| a == b).count();
        assert!((at - 2..at + 3).contains(&same), "{fault}: alike for {same} steps, {at} expected");
        assert!(torque(at - 2) != 0.0);
        assert!((at + 7..steps.len()).all(|k| torque(k) == 0.0), "{fault}");
        assert_eq!(tally.restarts, 1, "{fault}");
        assert!(missed.contains(&tally.missed), "{fault}: {} missed", tally.missed);
        let fall_s = ride.outcome.time_to_fall_s().expect("falls without torque");
        assert!((0.6..0.9).contains(&fall_s), "{fault}: {ride:?}");
    }
}
