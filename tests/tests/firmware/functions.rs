//! Instructions of single functions, the product's and micromath's.

use xtask::{image, instructions};

/// The rows of the table in docs/motor.md, and the functions of `qemu-instructions` whose instructions they state.
const ROWS: [(&str, [&str; 2]); 5] = [
    ("rounding of the values on CAN", ["rounding, today", "rounding, micromath"]),
    ("logarithm of the thermistor", ["logarithm, today", "logarithm, micromath"]),
    ("sine and cosine of the rotor's angle", ["sine and cosine, today", "sine and cosine, micromath"]),
    ("length of a vector, circle limits", ["root, today", "root, micromath"]),
    ("the same with two steps of Newton", ["root, today", "root, micromath and two steps of Newton"]),
];

/// Tolerance of the page's numbers, as in docs/images.md, or one instruction.
const TOLERANCE: f64 = 0.03;

/// Situation: each function that docs/motor.md compares with micromath's, on the chip of QEMU.
/// Action: count the instructions of a thousand calls.
/// Must hold: the page has the same numbers, and the product's function needs less than half of the other.
#[test]
fn the_instructions_of_micromath_are_as_documented() {
    if !image::ready() {
        return;
    }
    image::build("board-qemu").expect("QEMU's images build");
    let functions = instructions::functions().unwrap();
    let mean = |name: &str| functions.iter().find(|f| f.name == name).expect(name).mean;
    let page = std::fs::read_to_string(image::root().join("docs/motor.md")).unwrap();
    let stale: Vec<String> = ROWS
        .iter()
        .filter_map(|(row, names)| {
            let line = page.lines().find(|line| line.starts_with(&format!("| {row} |"))).expect(row);
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let documented = [3, 5].map(|cell: usize| cells[cell].parse().unwrap_or(f64::NAN));
            let fresh = names.map(|name| f64::from(mean(name)));
            let same = documented
                .iter()
                .zip(fresh)
                .all(|(documented, fresh)| (documented - fresh).abs() <= (TOLERANCE * fresh).max(1.0));
            (!same).then(|| format!("{row}: {fresh:?}, docs/motor.md has {documented:?}"))
        })
        .collect();
    assert_eq!(stale, [""; 0]);
    assert!(2 * mean("rounding, micromath") < mean("rounding, today"));
}
