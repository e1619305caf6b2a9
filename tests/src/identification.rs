//! Perturbation records of riders that are known, for their identification.

use sim_host::bicycle::linear::Linear;
use sim_host::bicycle::{ForcePoint, Geometry, Parameters, catalogue};
use sim_host::identify::{
    Disturbances, Drift, GAINS, GrayBox, Hold, Measured, PerGain, Problem, Record, Signal,
};
use sim_host::num::RandomStream;
use sim_host::perturbation::{Experiment, record};
use sim_host::ride::{Assist, Conditions, ScheduleSpeed};
use sim_host::rider::{Neuromuscular, Outside, Rider, RiderTable, Row, Schedule};

/// All gains.
pub const ALL: [usize; GAINS] = [0, 1, 2, 3, 4, 5, 6, 7];

/// The thesis's bicycle.
pub fn bicycle() -> Parameters {
    catalogue::load("rigid_jason").expect("shipped").parameters
}

/// The gray box of a shipped table at a row's speed.
pub fn gray_box(table: &RiderTable, row: &Row) -> GrayBox {
    let linear = Linear::new(&bicycle());
    GrayBox {
        bicycle: linear,
        force_input: linear.lateral_force_input(ForcePoint::SADDLE).into(),
        neuromuscular: Neuromuscular::SHOULDERS,
        speed_m_s: row.speed_m_s,
        delay_s: table.delay_s,
    }
}

/// The gains of a row.
pub fn gains(row: &Row) -> PerGain {
    std::array::from_fn(|i| row.gains.0[i])
}

/// Pulses of 40 N for a quarter of a second to both sides, every three seconds on average, in samples of 1 ms.
pub fn pulses(duration_s: f64, seed: u64) -> Disturbances {
    let mut random = RandomStream::new(seed, [0.0; 3], 1);
    let mut samples = vec![[0.0; 2]; (duration_s * 1e3) as usize];
    let mut start = 2500;
    while start + 250 < samples.len() {
        let force = if random.chance(0.5) { 40.0 } else { -40.0 };
        samples[start..start + 250].iter_mut().for_each(|sample| sample[0] = force);
        start += 2000 + 5 * random.below(400);
    }
    Disturbances { sample_s: 1e-3, samples, hold: Hold::Zero }
}

/// Every fifth sample of a disturbance, with the response of `model` in `signals`, computed at all of them, and white noise of
/// the given standard deviation.
///
/// # Panics
/// If the response is unbounded.
pub fn linear_problem(
    model: GrayBox,
    gains: &PerGain,
    disturbances: &Disturbances,
    signals: &[(Signal, f64)],
) -> Problem {
    let states = model.response(disturbances, gains).expect("a bounded response");
    let count = states.len() / 5;
    let measured = signals.iter().enumerate().map(|(i, (signal, noise))| {
        let mut random = RandomStream::new(7, [0.0; 3], i as u64);
        let place = match signal {
            Signal::Roll => 0,
            Signal::Steer => 1,
            Signal::RollRate => 2,
        };
        let values = (0..count).map(|k| states[5 * k][place] + noise * random.normal()).collect();
        Measured { signal: *signal, values, valid: vec![true; count] }
    });
    let record = Record {
        disturbances: Disturbances {
            sample_s: 5e-3,
            samples: (0..count).map(|k| disturbances.samples[5 * k]).collect(),
            hold: Hold::Zero,
        },
        measured: measured.collect(),
    };
    Problem { record, model, drift: Drift::Offset, skip_s: 0.0, seed: 0 }
}

/// The record of a rider with the constant gains of a row on the nonlinear bicycle; `None` if the rider falls.
pub fn ridden_problem(table: &RiderTable, row: &Row, experiment: &Experiment) -> Option<Problem> {
    let schedule = Schedule::new(vec![(row.speed_m_s, row.gains)], Outside::Hold).ok()?;
    let (delay_s, neuromuscular) = (table.delay_s, table.neuromuscular);
    let conditions = Conditions {
        rider: Some(Rider { schedule, delay_s, neuromuscular }),
        schedule_speed: ScheduleSpeed::Initial,
        ..Conditions::thesis(Geometry::new(&bicycle()), Assist::None)
    };
    let made = record(&conditions, experiment).ok()?.upright().ok()?;
    let values = made.samples.iter().map(|sample| sample.steer_rad).collect();
    let valid = vec![true; made.samples.len()];
    let record = Record {
        disturbances: Disturbances {
            sample_s: experiment.sample_s(),
            samples: made.samples.iter().map(|sample| [sample.lateral_force_n, 0.0]).collect(),
            hold: Hold::Zero,
        },
        measured: vec![Measured { signal: Signal::Steer, values, valid }],
    };
    Some(Problem { record, model: gray_box(table, row), drift: Drift::Offset, skip_s: 0.0, seed: 0 })
}
