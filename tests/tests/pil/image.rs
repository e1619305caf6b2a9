//! The image `qemu-pil` in the loop.

use super::basins::{coarse, on_boards};
use super::link::{commands_lost_and_late, sensors_lost_and_late};
use control::Mode;
use sim_host::basin::{Search, basin};
use sim_host::pil::compare::{same_basin, same_ride};
use sim_host::pil::qemu::Qemu;
use sim_host::pil::{BoardError, Controller, Lockstep};
use std::path::Path;
use std::time::Duration;
use tests::fake_board::FakeBoard;
use tests::pil::{FALL, KNOCK, Ridden, link_faults, product, ridden, varied};
use tests::tape::Taped;
use tests::wait::LONG;
use xtask::image;

/// The image with these arguments, just started.
pub(crate) fn started(arguments: &[&str]) -> Qemu {
    Qemu::start(&image::path("qemu-pil"), arguments, LONG).unwrap_or_else(|error| panic!("{error}"))
}

/// Situation: rides with exact and with noisy sensors, with faults, with a rider, one that falls.
/// Action: ride them on the chip, all on the same one.
/// Must hold: every frame, command, authority, instant and the end have the bits of the ride in this program; every ride
/// engages; no step is missed.
#[test]
fn a_ride_on_the_chip_has_the_same_bits() {
    if !image::ready() {
        return;
    }
    let mut controller = Controller::new(started(&[]), &[], 0);
    for (name, conditions, start) in varied() {
        let Ridden { ride, trace, steps } = ridden(&conditions, start, &mut controller).unwrap();
        same_ride(&conditions, &steps, &ride, &trace).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(steps.iter().any(|(_, s)| s.command.mode == Mode::Engaged), "{name} never engages");
    }
    let tally = controller.tally();
    assert!(tally.steps > 10_000 && tally.missed + tally.restarts + tally.affected == 0, "{tally:?}");
}

/// Situation: the same ride on a chip that rode before, and on two fresh ones.
/// Action: record all chunks.
/// Must hold: sensors and commands have the same bits each time; the fresh chips send the same bytes, time and line
/// included.
#[test]
fn a_ride_after_another_is_as_on_a_fresh_chip() {
    if !image::ready() {
        return;
    }
    let conditions = product();
    let tape = || Controller::new(Taped::new(started(&[])), &[], 0);
    let (mut used, mut new, mut other) = (tape(), tape(), tape());
    ridden(&conditions, FALL, &mut used).unwrap();
    let [again, first] = [&mut used, &mut new].map(|c| ridden(&conditions, KNOCK, c).unwrap());
    assert!(again.bits() == first.bits());
    assert!(again.ride == first.ride);
    ridden(&conditions, KNOCK, &mut other).unwrap();
    assert!(other.board.chunks == new.board.chunks);
    assert_eq!(new.board.chunks.len(), 2 * first.steps.len() + 1);
}

/// As of [`sensors_lost_and_late`] and [`commands_lost_and_late`], on the chip.
#[test]
fn link_faults_on_the_chip() {
    if !image::ready() {
        return;
    }
    sensors_lost_and_late(|| started(&[]));
    commands_lost_and_late(|| started(&[]));
}

/// Situation: a product ride over a link with several faults at once. Action: ride it on the chip and on the fake board.
/// Must hold: the same bits, step for step.
#[test]
fn the_fake_board_has_the_bits_of_the_chip() {
    if !image::ready() {
        return;
    }
    let faults = link_faults(&[
        "sensors:drop@0.05s..0.06s",
        "sensors:corrupt@0.1s..0.15s",
        "sensors:late=7ms@0.2s..0.3s",
        "sensors:drop@0.25s..0.27s",
        "motor:corrupt@0.4s..0.41s",
        "motor:late=4ms@0.5s",
    ]);
    let conditions = product();
    let chip = ridden(&conditions, KNOCK, &mut Controller::new(started(&[]), &faults, 3)).unwrap();
    let fake = ridden(&conditions, KNOCK, &mut Controller::new(FakeBoard::default(), &faults, 3)).unwrap();
    assert!(chip.bits() == fake.bits());
    assert!(chip.ride == fake.ride);
}

/// Situation: a coarse basin of law h.
/// Action: ride it on chips, one a thread, and in this program.
/// Must hold: every border, island, outcome and number of rides has the same bits.
#[test]
fn a_basin_on_chips_has_the_same_bits() {
    if !image::ready() {
        return;
    }
    let (conditions, search) = coarse();
    let search = Search { speeds: vec![2.0, 4.0], scan_step: 4.0, tolerance: 1.0, ..search };
    let there = on_boards(&conditions, &search, || Qemu::start(&image::path("qemu-pil"), &[], LONG)).unwrap();
    let here = basin(&conditions, &search, |_| (), || false).unwrap();
    same_basin(&here, &there).unwrap();
}

fn failure(name: &str, arguments: &[&str], limit: Duration) -> String {
    Qemu::start(&image::path(name), arguments, limit).expect_err("it is no board in the loop").to_string()
}

/// Situation: an image that prints text to its standard output; one with a shorter timeout than it needs to start;
/// unknown arguments of the image.
/// Action: start them.
/// Must hold: an error with the reason, and the image's last text where it ended.
#[test]
fn an_image_without_the_lockstep_is_rejected() {
    if !image::ready() {
        return;
    }
    let prints = failure("qemu-control", &["seconds=1"], LONG);
    assert!(prints.contains("docs/link.md") && prints.contains("version"), "{prints}");
    let slow = failure("qemu-pil", &[], Duration::from_millis(2));
    assert!(["qemu-pil", "did not answer within 2ms"].iter().all(|word| slow.contains(word)), "{slow}");
    let ends = failure("qemu-pil", &["fault=none-of-them", "at_ms=5"], LONG);
    assert!(["qemu-pil", "ended", "no such fault"].iter().all(|word| ends.contains(word)), "{ends}");
}

/// Situation: no image.
/// Action: start it.
/// Must hold: the error names the file and the command that builds it.
#[test]
fn a_missing_image_is_named() {
    let error = Qemu::start(Path::new("no/such/image"), &[], LONG).expect_err("there is none");
    assert!(matches!(&error, BoardError::NoImage(_)));
    let error = error.to_string();
    assert!(error.contains("no/such/image") && error.contains("cargo xtask firmware"), "{error}");
}

/// Situation: a chip at rest.
/// Action: a hundred empty exchanges.
/// Must hold: a millisecond elapses each time, the chip started once, and each chunk has a command.
#[test]
fn an_exchange_is_a_millisecond() {
    if !image::ready() {
        return;
    }
    let mut chip = started(&[]);
    let begin_ms = chip.last().time_ms;
    for k in 1..=100 {
        chip.exchange(&link::lockstep::ToBoard { sensors: &[], line: &[] }).unwrap();
        let last = chip.last();
        assert_eq!((last.time_ms, last.starts), (begin_ms + k, 1));
        assert!(!last.motor.is_empty());
    }
}
