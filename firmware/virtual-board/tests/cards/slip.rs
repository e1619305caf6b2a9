//! The magnet of the motor's encoder slips while the bicycle rides on the virtual board.

use crate::bed::product;
use crate::boards::log_has;
use control::{Plan, SensorFrame};
use sim_host::ride::{Remote, RemoteError, Start, Stepped, traced_on};
use virtual_board::Options;
use virtual_board::bicycle::OnBicycle;
use virtual_board::bicycle::rides::{Preset, on_board};

/// Half an electrical turn of the example's 8 pole pairs \[turns of the motor\], and the time it takes \[s\].
const SLIP_TURNS: f64 = 1.0 / 16.0;
const SLIP_S: f64 = 0.1;

/// A board whose encoder slips from the knock on.
struct Slipping {
    board: OnBicycle,
    step_s: f64,
    /// Time of the knock \[ms after power-on\].
    knock_ms: Option<f64>,
    slipped_turns: f64,
}

impl Remote for Slipping {
    fn begin(&mut self, plan: &Plan, start: &Start) -> Result<(), RemoteError> {
        self.board.begin(plan, start)
    }

    fn disturb(&mut self) {
        self.board.disturb();
        self.knock_ms = self.board.bench().map(|bench| bench.now_ms());
    }

    fn step(&mut self, frame: &SensorFrame) -> Result<Stepped, RemoteError> {
        if let (Some(bench), Some(_)) = (self.board.bench(), self.knock_ms) {
            let by = (SLIP_TURNS * self.step_s / SLIP_S).min(SLIP_TURNS - self.slipped_turns);
            self.slipped_turns += by;
            bench.with(move |board| board.chip.wiring.power.encoder_zero_turns += by);
        }
        self.board.step(frame)
    }
}

/// Situation: the product with the smart rider at 3 m/s, engaged; a knock of 2 rad/s confirms the encoder's angle.
/// Action: from the knock on the encoder slips by half an electrical turn, in 0.1 s.
/// Must hold: the bridge is closed at the knock, and permanently open within 0.1 s, not before the slip is a fifth of
/// a turn; motor fault 24 or 19 in the log; the rider rides on.
#[test]
fn a_magnet_that_slips_opens_the_bridge() {
    let Some(image) = product() else { return };
    let start = Start { speed_m_s: 3.0, steer_rate_rad_s: 2.0, roll_rate_rad_s: 0.0 };
    let conditions = on_board(Preset::Product, Some("smart"), 0.2).expect("shipped");
    let board = OnBicycle::new(image, Options::default(), &conditions);
    let mut slipping = Slipping { board, step_s: conditions.step_s, knock_ms: None, slipped_turns: 0.0 };
    let (ride, _) = traced_on(&conditions, start, &mut slipping).expect("the board rides to the end");
    let knock_ms = slipping.knock_ms.expect("a knock");
    let bench = slipping.board.bench().expect("still powered");
    let changes = bench.with(|board| board.chip.wiring.main_output.clone());
    let [.., (closed_ns, true), (opened_ns, false)] = changes[..] else { panic!("{changes:?}") };
    let open_ms = opened_ns as f64 * 1e-6 - knock_ms;
    println!("open {open_ms:.1} ms after the slip began");
    assert!(closed_ns as f64 * 1e-6 < knock_ms, "{changes:?}, knock at {knock_ms} ms");
    assert!((0.2 * SLIP_S * 1e3..100.0).contains(&open_ms), "{open_ms} ms");
    let log = ["motor fault 24", "motor fault 19"].map(|text| log_has(bench, knock_ms, text));
    assert!(log.contains(&true), "{:#?}", bench.log());
    assert!(!ride.fell(), "{:?}", ride.end);
}
