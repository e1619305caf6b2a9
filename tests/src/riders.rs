//! Riders shared by the tests.

use sim_host::rider::{Gains, Neuromuscular, Outside, Rider, Schedule};

/// A rider with every gain in use, scheduled over speed, who balances the thesis bicycle between 3 and 6 m/s: near
/// the published 60 ms riders, but made for these tests.
pub fn thorough(delay_s: f64) -> Rider {
    let points = vec![
        (3.0, Gains([-8.0, -0.5, 7.0, 4.2, 12.0, 3.0, 1.3, -0.09, -0.6, -0.10])),
        (4.5, Gains([-16.0, -0.3, 7.0, 4.9, 44.0, 2.0, 3.6, -0.11, -0.9, -0.12])),
        (6.0, Gains([-12.0, -0.2, 5.0, 3.4, 62.0, 2.5, 3.6, -0.05, -0.7, -0.05])),
    ];
    let schedule = Schedule::new(points, Outside::Extrapolate).unwrap_or_else(|e| panic!("{e}"));
    Rider { schedule, delay_s, neuromuscular: Neuromuscular::SHOULDERS }
}
