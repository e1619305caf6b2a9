//! Basins ridden on boards.

use sim_host::basin::{Basin, Method, Search, basin, basin_by};
use sim_host::pil::compare::same_basin;
use sim_host::pil::{BoardError, Controller, Lockstep};
use sim_host::ride::{Conditions, RemoteError, rides_on};
use std::sync::Mutex;
use tests::basins::{H, assisted, search};
use tests::fake_board::FakeBoard;

/// A basin on boards that are made on demand.
pub(crate) fn on_boards<B: Lockstep + Send>(
    conditions: &Conditions,
    search: &Search,
    board: impl Fn() -> Result<B, BoardError> + Sync,
) -> Result<Basin, RemoteError> {
    let idle = Mutex::new(Vec::new());
    let ride = |starts: &[_]| -> Result<_, RemoteError> {
        let one = idle.lock().unwrap().pop();
        let mut one = one.map_or_else(|| board().map(|board| Controller::new(board, &[], 0)), Ok)?;
        let done = rides_on(conditions, starts, &mut one)?;
        idle.lock().unwrap().push(one);
        Ok(done)
    };
    basin_by(conditions, search, ride, |_| (), || false)
}

/// Law h, two seconds, three speeds.
pub(crate) fn coarse() -> (Conditions, Search) {
    let conditions = Conditions { time_limit_s: 2.0, ..assisted(H) };
    (
        conditions,
        Search { scan_step: 2.0, tolerance: 0.2, method: Method::Plain, ..search(&[2.0, 4.0, 7.0], 16.0) },
    )
}

/// Situation: a coarse basin of law h, with borders inside the range.
/// Action: ride it on fake boards, and in this program.
/// Must hold: every border, island, outcome and number of rides has the same bits; it is a basin and not all of the
/// range.
#[test]
fn a_basin_on_fake_boards_has_the_same_bits() {
    let (conditions, search) = coarse();
    let there = on_boards(&conditions, &search, || Ok(FakeBoard::default())).unwrap();
    let here = basin(&conditions, &search, |_| (), || false).unwrap();
    same_basin(&here, &there).unwrap();
    assert_eq!(there.columns.len(), 3);
    assert!(there.columns.iter().any(|c| !c.capped && c.upper > 2.0), "{:?}", there.columns);
}

/// Situation: the same basin.
/// Action: change a border by its last bit, an outcome, the number of rides; add a speed.
/// Must hold: the comparison fails, naming speed and quantity.
#[test]
fn the_comparison_of_basins_finds_every_bit() {
    let (conditions, search) = coarse();
    let here = basin(&conditions, &search, |_| (), || false).unwrap();
    let rejected = |named: &[&str], change: &dyn Fn(&mut Basin)| {
        let mut there = here.clone();
        change(&mut there);
        let error = same_basin(&here, &there).expect_err("a difference").0;
        assert!(named.iter().all(|word| error.contains(word)), "{error}");
    };
    let bump = |x: f64| f64::from_bits(x.to_bits() ^ 1);
    rejected(&["upper border", "4 m/s"], &|b| b.columns[1].upper = bump(b.columns[1].upper));
    rejected(&["2 rad/s", "7 m/s"], &|b| {
        b.columns[2].scan[0].outcome =
            sim_host::ride::Outcome::Fallen { time_s: 1.0, by: sim_host::ride::FallCause::Roll };
    });
    rejected(&["work", "2 m/s"], &|b| b.columns[0].work.rides += 1);
    rejected(&["3 m/s"], &|b| b.columns[0].speed = 3.0);
    let mut fewer = here.clone();
    fewer.columns.pop();
    assert_eq!(same_basin(&here, &fewer), Ok(()));
}

/// Situation: a board that cannot be started; one that ends in its hundredth exchange.
/// Action: a basin on them.
/// Must hold: the board's error, no basin.
#[test]
fn a_lost_board_ends_the_basin_with_its_error() {
    struct Dying(FakeBoard);
    impl Lockstep for Dying {
        fn last(&self) -> link::lockstep::FromBoard<'_> {
            self.0.last()
        }
        fn exchange(&mut self, to: &link::lockstep::ToBoard<'_>) -> Result<(), BoardError> {
            if self.0.last().time_ms == 100 {
                Err(BoardError::NoChunk("gone".into()))
            } else {
                self.0.exchange(to)
            }
        }
    }
    let (conditions, search) = coarse();
    let why = on_boards(&conditions, &search, || Ok(Dying(FakeBoard::default()))).expect_err("it dies").0;
    assert!(why.to_string().contains("gone"), "{why}");
    let absent = || -> Result<FakeBoard, _> { Err(BoardError::NoImage("no/such/image".into())) };
    let why = on_boards(&conditions, &search, absent).expect_err("it is not there").0;
    assert!(
        why.to_string().contains("no/such/image") && why.to_string().contains("cargo xtask firmware"),
        "{why}"
    );
}
