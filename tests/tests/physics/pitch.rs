//! The pitch that keeps the front wheel on the ground.

use proptest::prop_assert;
use sim_host::bicycle::{Motion, State, front_contact_residual};
use std::cell::Cell;
use tests::draws::{runner, situations};

/// A time step predicts the pitch to 1e-4 rad or better; two Newton iterations leave rounding.
#[test]
fn a_guess_off_by_a_ten_thousandth_of_a_radian_comes_out_exact() {
    let worst = Cell::new([0.0_f64; 2]);
    runner(1000)
        .run(&situations(60_f64.to_radians()), |d| {
            for error in [-1e-4, 1e-4] {
                let guess = State { pitch: d.state.pitch + error, ..d.state };
                let pitch = Motion::new(&d.geometry, &guess).pose.attitude.pitch;
                let residual = front_contact_residual(&d.geometry, d.state.roll, d.state.steer, pitch).abs();
                let off = (pitch - d.state.pitch).abs();
                worst.set([worst.get()[0].max(off), worst.get()[1].max(residual)]);
                prop_assert!(off < 1e-14 && residual < 1e-14, "{}: {off:e} rad, {residual:e} m", d.name);
            }
            Ok(())
        })
        .unwrap();
    println!("pitch off by {:.1e} rad, contact by {:.1e} m", worst.get()[0], worst.get()[1]);
}
