//! A motor's rotor behind its gear: it only adds to the steer's inertia.

use proptest::prop_assert;
use sim_host::bicycle::{FullState, Geometry, Motion, Torques};
use std::cell::Cell;
use tests::draws::{runner, situations};

/// Situation: any state under any torques, a rotor of 0.02346 kg m^2 on the steer.
/// Action: compute the accelerations.
/// Must hold: they are those of the bicycle without a rotor whose steer torque is less by the rotor's inertia times
/// the steer acceleration, with three speeds and with six; and the rotor has an effect.
#[test]
fn a_rotor_takes_its_part_of_the_steer_torque() {
    const ROTOR_KG_M2: f64 = 0.02346;
    let (worst, largest) = (Cell::new(0.0_f64), Cell::new(0.0_f64));
    runner(500)
        .run(&situations(45_f64.to_radians()), |d| {
            let b = Geometry { rotor_kg_m2: ROTOR_KG_M2, ..d.geometry };
            let motion = Motion::new(&b, &d.state);
            let with = motion.accelerations(&b, &d.torques);
            let part = Torques { steer: d.torques.steer - ROTOR_KG_M2 * with.steer, ..d.torques };
            let bare = motion.accelerations(&d.geometry, &part);
            let full = FullState::new(&motion, &d.state).rate(&b, &d.torques).unwrap().speeds;
            let size = 1.0 + with.steer.abs() + with.roll.abs() + with.rear_wheel.abs();
            let pairs = [
                (with.roll, bare.roll),
                (with.steer, bare.steer),
                (with.rear_wheel, bare.rear_wheel),
                (with.roll, full[0]),
                (with.steer, full[3]),
                (with.rear_wheel, full[4]),
            ];
            let off = pairs.iter().map(|(a, b)| (a - b).abs() / size).fold(0.0, f64::max);
            worst.set(worst.get().max(off));
            let without = motion.accelerations(&d.geometry, &d.torques);
            largest.set(largest.get().max((without.steer - with.steer).abs() / size));
            prop_assert!(off < 1e-12, "{}: {off:e}", d.name);
            Ok(())
        })
        .unwrap();
    println!("worst {:.1e}, the rotor's part up to {:.2}", worst.get(), largest.get());
    assert!((0.01..1.0).contains(&largest.get()));
}
