//! `sim-host pil`.

use tests::cli::{Bench, word};
use xtask::image;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
const RIDE: &str = "--preset product --speed 4 --steer-rate 5 --time-limit 1";

/// The image as an option.
fn on_image() -> String {
    format!("--image {}", word(&image::path("qemu-pil")))
}

/// Situation: options for which no board can ride.
/// Action: `pil`.
/// Must hold: rejected, naming the option, the value and the allowed ones.
#[test]
fn options_without_a_board_ride_are_rejected() {
    let bench = Bench::new(PROGRAM);
    for (line, named) in [
        ("pil --speed 4 --law none", vec!["--law"]),
        ("pil --speed 4 --assist ideal", vec!["--assist firmware"]),
        ("pil --speed 4 --set rate_hz=500", vec!["rate_hz = 500", "1000 Hz"]),
        ("pil --speed 40", vec!["--speed", "0 to 30"]),
        ("pil --speed 4 --image no/such/image", vec!["no/such/image", "cargo xtask firmware"]),
        ("pil --speed 4 --inject gyro:drop", vec!["--inject", "gyro:drop", "sensors or motor"]),
        ("pil --speed 4 --json no/such/folder.json", vec!["no/such"]),
        ("pil basin --law none", vec!["--law"]),
        ("pil basin --image no/such/image", vec!["no/such/image"]),
        ("pil basin --speeds 4 --max-rate 1000", vec!["max rate", "100"]),
    ] {
        bench.run(line).rejected_naming(&named);
    }
    for line in ["pil", "pil --speed 4 --compare --inject sensors:drop", "pil --speed 4 --compare --bench"] {
        assert_eq!(bench.run(line).code, Some(2), "{line}");
    }
    assert_eq!(bench.files(), [""; 0]);
}

/// Situation: a product ride with a fault.
/// Action: `pil --compare` and `ride`, each with all outputs.
/// Must hold: exit 0, and the text has the number of equal steps; document, table, figure and frames are the same
/// bytes.
#[test]
fn a_ride_on_the_chip_writes_the_same_files() {
    if !image::ready() {
        return;
    }
    let bench = Bench::new(PROGRAM);
    let outputs = |name: &str| {
        format!(
            "--json {name}.json --csv {name}.csv --svg {name}.svg --frames {name}.frames --fault gyro:stuck@300ms"
        )
    };
    let chip = bench.run(&format!("pil {RIDE} {} --compare {}", on_image(), outputs("chip")));
    assert_eq!(chip.code, Some(0), "{chip:?}");
    assert!(chip.stdout.contains("the same bits as in this program: "), "{}", chip.stdout);
    assert!(chip.stdout.contains("times as fast as in real time"), "{}", chip.stdout);
    let here = bench.run(&format!("ride {RIDE} {}", outputs("here")));
    assert_eq!(here.code, Some(0), "{here:?}");
    for ending in ["json", "csv", "svg", "frames"] {
        let [chip, here] =
            ["chip", "here"].map(|name| std::fs::read(bench.path(&format!("{name}.{ending}"))).unwrap());
        assert!(chip == here && chip.len() > 1000, "{ending}");
    }
}

/// Situation: a link that loses sensors for 50 ms.
/// Action: `pil --inject`.
/// Must hold: exit 0; the text has the number of affected steps; the document differs from the one without.
#[test]
fn a_fault_of_the_link_is_reported() {
    if !image::ready() {
        return;
    }
    let bench = Bench::new(PROGRAM);
    let fault = "--inject sensors:drop@0.2s..0.25s";
    let run = bench.run(&format!("pil {RIDE} {} {fault} --csv lost.csv", on_image()));
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(run.stdout.contains("a link fault acted on 50 control steps"), "{}", run.stdout);
    assert_eq!(bench.run(&format!("ride {RIDE} --csv plain.csv")).code, Some(0));
    assert!(bench.read("lost.csv") != bench.read("plain.csv"));
}

/// Situation: a short ride. Action: `pil --bench`. Must hold: one line with the median; no other output.
#[test]
fn the_speed_is_a_median() {
    if !image::ready() {
        return;
    }
    let run = Bench::new(PROGRAM).run(&format!("pil {RIDE} {} --bench", on_image()));
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(
        run.stdout.starts_with("median of 5 rides: ") && run.stdout.lines().count() == 1,
        "{}",
        run.stdout
    );
}

/// Situation: a coarse basin.
/// Action: `pil basin --compare` on two boards, and `basin`.
/// Must hold: exit 0, and the text reports that it is the same; the tables are the same bytes, with the plain search in their headings.
#[test]
fn a_basin_on_chips_writes_the_same_files() {
    if !image::ready() {
        return;
    }
    let bench = Bench::new(PROGRAM);
    // On boards every ride is exact, as in the plain search; the fast one has times of quick rides far from the border.
    let search = "--speeds 3:5:1 --scan-step 5 --max-rate 10 --tolerance 2 --time-limit 0.5";
    let run = bench.run(&format!("pil basin {search} --threads 2 {} --compare --csv chip.csv", on_image()));
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(run.stdout.contains("the same bits as in this program: 3 speeds"), "{}", run.stdout);
    assert!(run.stdout.contains("boards: "), "{}", run.stdout);
    assert_eq!(bench.run(&format!("basin {search} --search plain --csv here.csv")).code, Some(0));
    assert_eq!(bench.read("chip.csv"), bench.read("here.csv"));
    assert!(bench.read("chip.csv").contains("\"method\":\"plain\""), "{}", bench.read("chip.csv"));
}
