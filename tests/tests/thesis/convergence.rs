//! Appendices C and D of the thesis: eigenvalues from rides, and the accuracy of integrators.

use sim_host::bicycle::{Geometry, catalogue};
use sim_host::thesis::app_c::{TINY, pencil_at, pencil_error};
use sim_host::thesis::app_d::{RIDES, problems};
use sim_host::thesis::solvers::{Adaptive, RK4, RKF45};
use sim_host::thesis::study::Study;

/// Situation: the uncontrolled thesis bicycle after 1e-6 rad/s and after the thesis's 0.1 rad/s, 0 to 10 m/s.
/// Action: all four eigenvalues by matrix pencil from 1.2 s of the ride.
/// Must hold: after the small disturbance they are the linearised bicycle's to 1e-4 of a second, the fast caster mode
/// included; after the large one the nonlinearity has an effect, but nowhere below rounding.
#[test]
fn all_four_eigenvalues_are_found_from_a_ride() {
    let study = Study::new(true).unwrap();
    let worst = |disturbance: f64| {
        let speeds = (0..=20).map(|i| 0.5 * f64::from(i));
        let error = |v: f64| {
            let found = pencil_at(&study, v, disturbance).unwrap_or_else(|| panic!("{v} m/s"));
            pencil_error(&study, v, &found)
        };
        speeds.map(error).fold(0.0, f64::max)
    };
    let (small, large) = (worst(TINY), worst(0.1));
    println!("worst errors: {small:.1e} 1/s after {TINY} rad/s, {large:.1e} 1/s after 0.1 rad/s");
    assert!(small > 1e-12 && small < 1e-4, "{small}");
    assert!(large > 100.0 * small, "{large}");
}

/// Situation: the four rides of the convergence study on the benchmark bicycle.
/// Action: RK4 in steps of 10 and 5 ms, RKF45 in the same.
/// Must hold: where the ride does not fall the order is four, and five or more; RKF45 is more exact; the reference is
/// far more exact than the tested solvers.
#[test]
fn fixed_steps_converge_at_their_order() {
    let benchmark = Geometry::new(&catalogue::load("benchmark").unwrap().parameters);
    for problem in &problems(&benchmark)[..3] {
        assert_eq!(problem.seconds, 15.0, "{}", problem.name);
        let error = |method, steps| problem.error_of_fixed(&benchmark, method, steps).unwrap();
        let (coarse, fine) = (error(&RK4, 1500), error(&RK4, 3000));
        let order = (coarse / fine).log2();
        println!(
            "{}: RK4 {coarse:.1e} {fine:.1e}, order {order:.2}, floor {:.0e}",
            problem.name, problem.floor
        );
        assert!((3.7..4.6).contains(&order), "{}: {order}", problem.name);
        assert!(error(&RKF45, 750) < error(&RK4, 750), "{}", problem.name);
        assert!(problem.floor > 0.0 && problem.floor < 1e-3 * fine, "{}: {}", problem.name, problem.floor);
    }
}

/// Situation: the fourth ride, which falls.
/// Action: RK4 in steps of 1 ms; adaptive solvers at 1e-8.
/// Must hold: it falls within a second, and is compared just before; no solver aborts; the explicit one is more exact
/// than backward differentiation at the same tolerance.
#[test]
fn the_ride_that_falls_is_compared_before_the_fall() {
    let benchmark = Geometry::new(&catalogue::load("benchmark").unwrap().parameters);
    let problem = &problems(&benchmark)[3];
    assert_eq!(RIDES[3].0, 3.0);
    assert!((0.5..1.0).contains(&problem.seconds), "{}", problem.seconds);
    let rk4 = problem.error_of_fixed(&benchmark, &RK4, (problem.seconds * 1e3) as usize).unwrap();
    let of = |solver| problem.error_of_adaptive(&benchmark, solver, 1e-8).unwrap();
    let (explicit, bdf) = (of(Adaptive::Dopri5), of(Adaptive::Bdf));
    println!("RK4 at 1 ms {rk4:.1e}; at 1e-8: Dormand-Prince 5 {explicit:.1e}, BDF {bdf:.1e}");
    assert!((1e-7..1e-2).contains(&rk4), "{rk4}");
    assert!((1e-9..1e-5).contains(&explicit) && explicit < bdf && bdf < 1e-3, "{explicit} {bdf}");
}
