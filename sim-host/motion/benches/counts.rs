//! One piece of work, whose instructions `cargo xtask counts` counts. Prints its units of work.

mod work;

use control::{Config, Law};
use motion::ride::{rides, traced};
use std::hint::black_box;
use work::{Controller, WIDTH, bicycle, conditions, right_hand_sides, small_basin, starts, states};

fn main() {
    // Cargo adds `--bench`.
    let name = std::env::args().nth(1).unwrap_or_default();
    // The basin too runs in this thread.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    pool.build_global().expect("the first pool");
    println!("units={}", run(&name));
}

/// Runs a piece of work; the number of its units.
fn run(name: &str) -> usize {
    match name {
        "right-hand-side" => {
            let b = bicycle();
            let states = states(&b, 100 * WIDTH);
            counted(&mut || right_hand_sides(&b, &states));
            states.len() / WIDTH
        }
        "ride-step" => {
            let (conditions, starts) = (conditions(), starts());
            counted(&mut || drop(black_box(rides(&conditions, &starts))));
            conditions.steps() as usize
        }
        "control-step-thesis" => control_steps(Config::thesis(Law::H { cut: false })),
        "control-step-product" => control_steps(Config::product()),
        "ride" => {
            let conditions = conditions();
            counted(&mut || drop(black_box(traced(&conditions, starts()[2]))));
            1
        }
        "basin" => {
            let conditions = conditions();
            counted(&mut || drop(black_box(small_basin(&conditions))));
            1
        }
        other => panic!("no work {other:?}"),
    }
}

fn control_steps(mut config: Config) -> usize {
    config.calibration.polarity_checked = true;
    let mut controller = Controller::new(config, 1000);
    counted(&mut || controller.steps());
    1000
}

/// Callgrind counts while this function runs.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
}
