//! Start of the product image: its deadlines and the core's spare time.

use crate::bed::{built, newest, product};
use crate::boards::{press, slow};
use std::path::Path;
use virtual_board::wiring::Wiring;
use virtual_board::{Bench, Options};

/// Worst-case cycles per instruction (docs/virtual-board.md).
const WORST: f64 = 1.6;

fn board(image: &Path, cycles_per_instruction: f64, wiring: Wiring) -> Bench {
    let options = Options { cycles_per_instruction, ..Options::default() };
    Bench::power_on(image, options, wiring).expect("the board starts")
}

/// Situation: the board is powered, only its own components are connected; instructions take the longest assumed
/// time.
/// Action: three seconds.
/// Must hold: no reset; the log begins with the image's name and this start; control does a step each millisecond and
/// none late; the motor's loop is called 20,000 times a second and none late; the core is idle for at least a tenth
/// of the time, and busy for a fifth.
#[test]
fn the_product_image_starts_and_runs() {
    let Some(image) = product() else { return };
    let mut bench = board(&image, WORST, Wiring::new());
    bench.run_ms(2300.0).expect("no gap");
    let (steps, calls): (u32, u32) =
        (newest(&bench, "steps").expect("a line"), newest(&bench, "calls").expect("a line"));
    let (from_ms, busy_from_ms) = (bench.now_ms(), bench.busy_ms());
    bench.run_ms(1000.0).expect("no gap");
    assert_eq!(bench.resets().len(), 0, "{:#?}", bench.log());
    let first = &bench.log()[0].text;
    assert!(first.starts_with("board-vesc6 ") && first.contains("start 1 after power-on"), "{first}");
    let (steps_now, calls_now): (u32, u32) =
        (newest(&bench, "steps").unwrap(), newest(&bench, "calls").unwrap());
    assert!((999..=1001).contains(&(steps_now - steps)), "{steps} to {steps_now}");
    assert!((19_950..=20_050).contains(&(calls_now - calls)), "{calls} to {calls_now}");
    let late: Vec<&str> =
        bench.log().iter().map(|line| line.text.as_str()).filter(|text| text.contains("late=")).collect();
    assert!(late.len() >= 4 && late.iter().all(|text| text.contains(" late=0 ")), "{late:#?}");
    let busy = (bench.busy_ms() - busy_from_ms) / (bench.now_ms() - from_ms);
    assert!((0.2..=0.9).contains(&busy), "busy {:.0} %", 100.0 * busy);
}

/// The core's load, in the columns of the page: the motor's interrupt, mean and longest \[us\], control's longest
/// step from its release \[us\], idle \[%\].
fn load(name: &str, cycles_per_instruction: f64) -> Option<[f64; 4]> {
    let mut bench = board(&built(name)?, cycles_per_instruction, Wiring::new());
    if name.ends_with("align") {
        // The press closes the bridge.
        press(&mut bench);
    }
    bench.run_ms(400.0).expect("no gap");
    bench.with(|board| board.chip.wiring.calls = Default::default());
    let (from_ms, busy_from_ms) = (bench.now_ms(), bench.busy_ms());
    bench.run_ms(900.0).expect("no gap");
    let calls = bench.with(|board| board.chip.wiring.calls);
    let busy = (bench.busy_ms() - busy_from_ms) / (bench.now_ms() - from_ms);
    let control_us = newest::<f64>(&bench, "worst_us").unwrap_or(0.0);
    Some([calls.mean_us(), calls.longest_ns as f64 * 1e-3, control_us, 100.0 * (1.0 - busy)])
}

/// Situation: the product with its bridge open, and the image that aligns with the bridge closed.
/// Action: measure the core's load, at the longest length of an instruction (with `--all` also at the usual one).
/// Must hold: equal to the table of docs/virtual-board.md within 5 %; the motor's interrupt always ends before the
/// top at which its duty cycles count, 42.6 us later.
#[test]
fn the_load_is_as_documented() {
    let page = std::fs::read_to_string(xtask::image::root().join("docs/virtual-board.md"))
        .expect("the page is there");
    let mut missing = Vec::new();
    for (bridge, name) in [("open", "board-vesc6"), ("closed", "board-vesc6-align")] {
        let lengths = if slow() { &[1.3, WORST][..] } else { &[WORST] };
        for &cycles in lengths {
            let Some(measured) = load(name, cycles) else { return };
            let row = page.lines().find_map(|line| line.strip_prefix(&format!("| {bridge} | {cycles} |")));
            let documented: Vec<f64> =
                row.unwrap_or("").split('|').filter_map(|cell| cell.trim().parse().ok()).collect();
            let same = documented.len() == 4
                && documented
                    .iter()
                    .zip(measured)
                    .all(|(documented, measured)| (documented - measured).abs() <= 0.05 * measured.max(1.0));
            if !same {
                let [mean, longest, control, idle] = measured;
                missing.push(format!(
                    "| {bridge} | {cycles} | {mean:.1} | {longest:.1} | {control:.0} | {idle:.0} |"
                ));
            }
            assert!(measured[1] > 5.0 && measured[1] < 42.6, "{bridge}, {cycles}: {measured:?}");
        }
    }
    assert!(missing.is_empty(), "docs/virtual-board.md must say\n{}", missing.join("\n"));
}
