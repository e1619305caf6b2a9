//! Operations of a right-hand side.

use sim_host::bicycle::{Geometry, Motion, State, Torques};
use tests::count::{Counted, Operations};
use tests::rides::shipped;
use xtask::peak::OPERATIONS;

/// Operations of generated C code for the same model (PyDy, pull request 122).
const GENERATED: u32 = 1909;

/// Situation: a bicycle in a turn, with a steer torque. Action: count the operations of pose, velocities and accelerations.
/// Must hold: the counts of docs/performance.md, and the same accelerations as without counting.
#[test]
fn a_right_hand_side_has_fewer_operations_than_generated_code() {
    let b = Geometry::new(&shipped("rigid_jason").parameters);
    let values = [0.2, -0.1, 0.5, -1.5, -12.0, 0.001];
    let state = |[roll, steer, roll_rate, steer_rate, rear_wheel_rate, pitch]: [Counted; 6]| State {
        roll,
        steer,
        roll_rate,
        steer_rate,
        rear_wheel_rate,
        pitch,
    };
    let torques = Torques { roll: Counted(0.0), steer: Counted(2.0) };
    let (counted, operations) = Operations::of(|| {
        let state = state(values.map(Counted));
        Motion::new(&b, &state).accelerations(&b, &torques)
    });
    println!("{operations:?}, {} in all", operations.total());
    let [roll, steer, roll_rate, steer_rate, rear_wheel_rate, pitch] = values;
    let plain = State { roll, steer, roll_rate, steer_rate, rear_wheel_rate, pitch };
    let plain = Motion::new(&b, &plain).accelerations(&b, &Torques { roll: 0.0, steer: 2.0 });
    assert_eq!([counted.roll.0, counted.steer.0], [plain.roll, plain.steer]);
    assert_eq!((operations.quotients, operations.roots, operations.angles), (9, 3, 3));
    assert_eq!(operations.total(), OPERATIONS);
    let page = include_str!("../../../docs/performance.md");
    let text = format!(
        "A right-hand side has {} operations: {} sums, {} products,",
        group(operations.total()),
        operations.sums,
        operations.products
    );
    assert!(page.contains(&text), "docs/performance.md lacks: {text}");
    assert!((500..GENERATED / 5 * 3).contains(&operations.total()));
}

/// "1,093" of 1093.
fn group(number: u32) -> String {
    format!("{},{:03}", number / 1000, number % 1000)
}
