//! The host's side of the lockstep, over a board in this process.

use control::{ActiveLimits, Mode};
use link::lockstep::{FromBoard, ToBoard};
use sim_host::pil::compare::same_ride;
use sim_host::pil::{BoardError, Controller, Lockstep};
use sim_host::ride::{Conditions, Remote, Start};
use tests::basins::{H, assisted, configured};
use tests::fake_board::FakeBoard;
use tests::pil::{FALL, KNOCK, Ridden, link_faults, product, ridden, varied};
use tests::tape::Taped;

fn fresh() -> Controller<FakeBoard> {
    Controller::new(FakeBoard::default(), &[], 0)
}

/// Situation: rides with exact and with noisy sensors, with faults, with a rider, one that falls.
/// Action: ride them on the fake board, all on the same one.
/// Must hold: every frame, command, authority, instant and the end have the bits of the ride in this program; every ride
/// engages.
#[test]
fn a_ride_on_the_fake_board_has_the_same_bits() {
    let mut controller = fresh();
    for (name, conditions, start) in varied() {
        let Ridden { ride, trace, steps } = ridden(&conditions, start, &mut controller).unwrap();
        same_ride(&conditions, &steps, &ride, &trace).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(steps.len() > trace.len() && trace.len() > 80, "{name}: {} steps", steps.len());
        assert!(!name.starts_with("law") || ride.fell() == name.contains("fall"), "{name}");
        assert!(steps.iter().any(|(_, s)| s.command.mode == Mode::Engaged), "{name} never engages");
    }
    assert_eq!(controller.tally().missed + controller.tally().restarts + controller.tally().affected, 0);
}

/// Situation: a recorded ride.
/// Action: change one value of it: the last bit of a torque, a limit, an authority, a sample's age, an instant's roll
/// by its last bit, the sign of a zero, the outcome; leave out the last step.
/// Must hold: the comparison fails for each, and names the step or the quantity.
#[test]
fn the_comparison_finds_every_bit() {
    let conditions = product();
    let right = ridden(&conditions, KNOCK, &mut fresh()).unwrap();
    let difference = |change: &dyn Fn(&mut Ridden)| {
        let mut wrong = right.clone();
        change(&mut wrong);
        same_ride(&conditions, &wrong.steps, &wrong.ride, &wrong.trace).map_err(|e| e.0)
    };
    assert_eq!(difference(&|_| ()), Ok(()));
    let bump = |x: f32| f32::from_bits(x.to_bits() ^ 1);
    let rejected = |named: &str, change: &dyn Fn(&mut Ridden)| {
        let error = difference(change).expect_err(named);
        assert!(error.contains(named), "no `{named}` in: {error}");
    };
    rejected("the command of control step 700", &|r| {
        r.steps[700].1.command.torque_nm = bump(r.steps[700].1.command.torque_nm);
    });
    rejected("the command of control step 9", &|r| r.steps[9].1.command.limits = ActiveLimits(1));
    rejected("the authority of control step 650", &|r| {
        r.steps[650].1.authority = bump(r.steps[650].1.authority);
    });
    rejected("the frame of control step 3", &|r| r.steps[3].0.gyro_rad_s.age_ticks += 1);
    rejected("the number of control steps", &|r| r.steps.truncate(600));
    rejected("the motion at 0.1 s", &|r| r.trace[100].roll = f64::from_bits(r.trace[100].roll.to_bits() ^ 1));
    rejected("the motion at 0 s", &|r| r.trace[0].roll = -r.trace[0].roll);
    rejected("the number of instants", &|r| r.trace.truncate(600));
    rejected("the ride's end", &|r| r.ride.steps += 1);
}

/// Situation: the same ride twice on one board, and on a fresh one.
/// Action: record all chunks.
/// Must hold: sensors and commands have the same bits each time; two fresh boards send the same bytes, and the fake
/// one's chunks are as many as the steps.
#[test]
fn a_ride_after_another_is_as_on_a_fresh_board() {
    let conditions = product();
    let tape = || Controller::new(Taped::new(FakeBoard::default()), &[], 0);
    let (mut used, mut new) = (tape(), tape());
    ridden(&conditions, FALL, &mut used).unwrap();
    let [again, first] = [&mut used, &mut new].map(|c| ridden(&conditions, KNOCK, c).unwrap());
    assert!(again.bits() == first.bits());
    assert!(again.ride == first.ride);
    let mut other = tape();
    ridden(&conditions, KNOCK, &mut other).unwrap();
    assert!(other.board.chunks == new.board.chunks);
    assert_eq!(new.board.chunks.len(), 2 * first.steps.len() + 1);
}

/// Situation: a product ride.
/// Action: the fake board's chip is reset at 1.5 s of its time and back 120 ms later.
/// Must hold: the ride continues to its end; for 5 ms the motor holds the command, then it gives none; the restarted
/// controller, with the stored configuration, receives the sensors and stays off without a polarity check; 120 steps
/// are missed.
#[test]
fn a_chip_that_restarts_gives_no_torque() {
    let conditions = Conditions { time_limit_s: 1.5, ..product() };
    let undisturbed = ridden(&conditions, KNOCK, &mut fresh()).unwrap();
    let reset_at_ms = 1100;
    let mut board = FakeBoard::default();
    board.reset_at_ms = Some((reset_at_ms, 120));
    let mut controller = Controller::new(board, &[], 0);
    let Ridden { ride, trace, steps } = ridden(&conditions, KNOCK, &mut controller).unwrap();
    let tally = controller.tally();
    assert_eq!((tally.restarts, tally.missed), (1, 119));
    // The board had done one step before the ride began.
    let at = reset_at_ms as usize - 1;
    let torque = |k: usize| steps[k].1.command.torque_nm;
    assert!(torque(at - 1) != 0.0);
    assert_eq!(steps[..at].to_vec(), undisturbed.steps[..at].to_vec());
    for k in at..at + 5 {
        assert_eq!(steps[k].1, steps[at - 1].1, "step {k} holds the command");
    }
    assert!((at + 5..steps.len()).all(|k| torque(k) == 0.0));
    let last = steps.last().unwrap().1.command;
    // The bicycle falls without torque, and tumbles.
    assert!(!last.mode.drives() && last.causes.has(control::Cause::PolarityUnchecked), "{last:?}");
    assert!(!last.causes.has(control::Cause::GyroLost), "the frames are those of the steps: {last:?}");
    assert!(steps.len() > at + 500, "the ride goes on: {} steps", steps.len());
    let error = same_ride(&conditions, &steps, &ride, &trace).expect_err("another ride");
    assert!(error.0.contains(&format!("control step {at}:")), "{error}");
}

/// Situation: a product ride.
/// Action: the board is delayed by 3 ms at 1.1 s of its time, then makes up for its steps.
/// Must hold: the motor holds the command for the 3 steps that are missed; the numbers of frames still match those of
/// steps.
#[test]
fn the_motor_holds_the_command_of_a_delayed_board() {
    let conditions = Conditions { time_limit_s: 1.5, ..product() };
    let mut board = FakeBoard::default();
    board.held_up_at_ms = Some((1100, 3));
    let mut controller = Controller::new(board, &[], 0);
    let Ridden { steps, .. } = ridden(&conditions, KNOCK, &mut controller).unwrap();
    assert_eq!((controller.tally().missed, controller.tally().restarts), (3, 0));
    for k in 1099..1102 {
        assert_eq!(steps[k].1, steps[1098].1, "step {k}");
    }
    assert!(steps[1102].1.command.torque_nm != steps[1098].1.command.torque_nm);
    assert!(steps[steps.len() - 1].1.command.mode == Mode::Engaged);
}

/// A board with its own answer to each exchange.
struct Odd(FakeBoard, fn(&mut FakeBoard, &ToBoard<'_>) -> Result<(), BoardError>);

impl Lockstep for Odd {
    fn last(&self) -> FromBoard<'_> {
        self.0.last()
    }
    fn exchange(&mut self, to: &ToBoard<'_>) -> Result<(), BoardError> {
        (self.1)(&mut self.0, to)
    }
}

/// Situation: boards that violate the lockstep: one that never accepts the reset, one that accepts no frame, one
/// whose time stands still, one that ends.
/// Action: ride.
/// Must hold: each ends the ride with an error that names the violation, and nothing else.
#[test]
fn a_board_that_violates_the_lockstep_ends_the_ride() {
    let error = |exchange| {
        let mut controller = Controller::new(Odd(FakeBoard::default(), exchange), &[], 0);
        ridden(&assisted(H), KNOCK, &mut controller).expect_err("an error").0
    };
    let deaf = error(|board, _| board.exchange(&ToBoard { sensors: &[], line: &[] }));
    assert!(
        deaf.to_string().contains("control step 0") && deaf.to_string().contains("reset was not answered"),
        "{deaf}"
    );
    let forgetful = error(|board, to| {
        let again = board.last().time_ms > 40;
        board.exchange(&ToBoard { sensors: if again { &[] } else { to.sensors }, line: &[] })
    });
    assert!(
        forgetful.to_string().contains("control step 40") && forgetful.to_string().contains("frame 39"),
        "{forgetful}"
    );
    let still = error(|board, to| if board.last().time_ms < 9 { board.exchange(to) } else { Ok(()) });
    assert!(still.to_string().contains("from 9 ms to 9 ms"), "{still}");
    let ended = error(|_, _| Err(BoardError::NoChunk("so it is".into())));
    assert!(ended.to_string().contains("so it is"), "{ended}");
}

/// Situation: a configuration for 500 Hz.
/// Action: begin a ride.
/// Must hold: rejected, naming the parameter, its value and the available rate.
#[test]
fn another_rate_is_rejected() {
    let config = control::Config { rate_hz: 500.0, ..control::Config::thesis(H) };
    let conditions = configured(config);
    let sim_host::ride::Assist::Firmware(plan) = &conditions.assist else { unreachable!() };
    let why = fresh().begin(plan, &Start::default()).expect_err("refused").0;
    assert!(["rate_hz", "500", "1000"].iter().all(|word| why.to_string().contains(word)), "{why}");
}

/// Situation: a ride of 70 s, longer than the range of the frames' numbers.
/// Action: ride, with a frame lost at each wrap.
/// Must hold: no number is wrong.
#[test]
fn the_numbers_of_frames_wrap() {
    let conditions = Conditions { time_limit_s: 70.0, ..assisted(H) };
    let still = Start { speed_m_s: 5.0, ..Start::default() };
    let plain = ridden(&conditions, still, &mut fresh()).unwrap();
    same_ride(&conditions, &plain.steps, &plain.ride, &plain.trace).unwrap();
    assert_eq!(plain.trace.len(), 70_000);
    let faults = link_faults(&["sensors:drop@65.4s..65.6s"]);
    let mut controller = Controller::new(FakeBoard::default(), &faults, 0);
    let lost = ridden(&conditions, still, &mut controller).unwrap();
    assert_eq!((lost.trace.len(), controller.tally().affected), (70_000, 200));
}
