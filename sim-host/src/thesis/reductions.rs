//! Tables F.3, G.3 and J.1: how much of the response of a run's full set of gains its reduced sets give.

use super::item::{Explanation, Item, Value};
use super::published::{Cell, Printed};
use super::study::Study;
use crate::bicycle::ForcePoint;
use crate::identify::{
    Disturbances, Drift, GAINS, GrayBox, Hold, Measured, PerGain, Problem, Record, Signal,
};
use crate::perturbation::Experiment;
use crate::rider::catalogue::load;
use crate::rider::{RiderTable, Row};
use rayon::prelude::*;

/// Rounding of the printed variance accounted for \[%\].
const ROUNDING: f64 = 0.005;

/// A signal's place in a response.
const STEER: usize = 1;
const ROLL_RATE: usize = 2;

/// A response at each sample: roll \[rad\], steer \[rad\], roll rate \[rad/s\]; `None` if it is unbounded.
type Response = Option<Vec<[f64; 3]>>;

/// The lateral force of an experiment.
fn pushes(experiment: &Experiment) -> Disturbances {
    let samples = experiment.lateral_force().into_iter().map(|force| [force, 0.0]).collect();
    Disturbances { sample_s: experiment.sample_s(), samples, hold: Hold::Zero }
}

fn gains(row: &Row) -> PerGain {
    std::array::from_fn(|i| row.gains.0[i])
}

fn vaf(row: &Row) -> f64 {
    row.vaf.unwrap_or(f64::NAN)
}

/// Variance accounted for, eq. 2.12, of the response `whole` by `part` in one signal, from 1 down.
fn accounted(whole: &Response, part: &Response, signal: usize) -> f64 {
    let Some((whole, part)) = whole.as_ref().zip(part.as_ref()) else { return f64::NAN };
    let rest: f64 = whole.iter().zip(part).map(|(a, b)| (a[signal] - b[signal]).powi(2)).sum();
    1.0 - rest / whole.iter().map(|a| a[signal] * a[signal]).sum::<f64>()
}

/// One run of a table: its full set, and the responses to which reduced ones are compared.
struct Run<'a> {
    model: GrayBox,
    /// Two sequences of pushes.
    pushes: [Disturbances; 2],
    /// The full set, and its response to each.
    full: &'a Row,
    responses: [Response; 2],
    /// The set with the highest printed VAF, and its response to the first.
    best: &'a Row,
    of_best: Response,
}

impl<'a> Run<'a> {
    fn new(study: &Study, table: &RiderTable, rows: &'a [Row]) -> Option<Self> {
        let (full, best) = (rows.first()?, rows.iter().max_by(|a, b| vaf(a).total_cmp(&vaf(b)))?);
        let model = GrayBox {
            bicycle: study.linear,
            force_input: study.linear.lateral_force_input(ForcePoint::SADDLE).into(),
            neuromuscular: table.neuromuscular,
            speed_m_s: full.speed_m_s,
            delay_s: table.delay_s,
        };
        let pushes = [0, 1].map(|seed| pushes(&Experiment { seed, ..Experiment::at(full.speed_m_s) }));
        let responses = pushes.each_ref().map(|pushes| model.response(pushes, &gains(full)));
        let of_best = model.response(&pushes[0], &gains(best));
        Some(Self { model, pushes, full, responses, best, of_best })
    }

    /// What the gains of `row` account for, after they are fitted to the full set's response.
    fn refitted(&self, row: &Row) -> Option<f64> {
        let values: Vec<f64> = self.responses[0].as_ref()?.iter().map(|x| x[STEER]).collect();
        let measured = vec![Measured { signal: Signal::Steer, valid: vec![true; values.len()], values }];
        let record = Record { disturbances: self.pushes[0].clone(), measured };
        let problem = Problem { record, model: self.model, drift: Drift::None, skip_s: 0.0, seed: 0 };
        let gains = gains(row);
        let active: Vec<usize> = (0..GAINS).filter(|i| gains[*i] != 0.0).collect();
        problem.mean_vaf_from(&active, &gains).ok()
    }

    fn value(&self, row: &Row, cell: Cell) -> Value {
        let [once, again] = self.pushes.each_ref().map(|pushes| self.model.response(pushes, &gains(row)));
        let of_full = accounted(&self.responses[0], &once, STEER);
        let exact = vaf(self.full) * of_full;
        let value = Value::new(cell, Some(exact));
        if value.explanation() == Explanation::NotNeeded {
            return value;
        }
        let tried = [
            ("of the full set's response, not of the measured one", 100.0 * of_full),
            ("of the roll rate", vaf(self.full) * accounted(&self.responses[0], &once, ROLL_RATE)),
            ("after other pushes", vaf(self.full) * accounted(&self.responses[1], &again, STEER)),
            ("of the set with the highest VAF", vaf(self.best) * accounted(&self.of_best, &once, STEER)),
            ("zero if it is negative", exact.max(0.0)),
            ("after a fit to these pushes", vaf(self.full) * self.refitted(row).unwrap_or(f64::NAN)),
        ];
        let finite = tried.into_iter().filter(|(_, x)| x.is_finite());
        finite.fold(value, |value, (name, x)| value.tried(name, x))
    }
}

/// The reduced sets of a table, each beside its run's full set.
fn table(study: &Study, name: &str, from: &str) -> Item {
    let Ok(table) = load(name) else { return Item::default() };
    let runs: Vec<&[Row]> = table.groups().collect();
    let of_run = |rows: &&[Row]| -> Vec<Value> {
        let Some(run) = Run::new(study, &table, rows) else { return Vec::new() };
        let value = |(i, row): (usize, &Row)| {
            let cell = Cell {
                row: format!("run {}, set {}", row.run.unwrap_or_default(), i + 1),
                column: "VAF".into(),
                unit: "%".into(),
                printed: row.vaf.map(|value| Printed { value, rounding: ROUNDING }),
                bound: None,
                from: from.into(),
            };
            run.value(row, cell)
        };
        rows.iter().enumerate().skip(1).map(value).collect()
    };
    let values: Vec<Vec<Value>> = runs.par_iter().map(of_run).collect();
    Item { values: values.concat(), notes: vec![NOTE.into()], ..Item::default() }
}

const NOTE: &str = "The measured steer angles are not published. In their place stands the response of the run's first set, which \
                    has all gains, on the linear bicycle with 60 s of pushes by 40 N. Computed is the part of its variance that the \
                    reduced set accounts for, times the first set's printed VAF: as if what that set leaves unexplained were \
                    independent of the rest. The experiment's pushes are not published either, and a reduced set that is the best \
                    one for them is not for these.";

/// Table F.3.
pub(super) fn table_f_3(study: &Study) -> Item {
    table(study, "young-reduction", "Table F.3")
}

/// Table G.3.
pub(super) fn table_g_3(study: &Study) -> Item {
    table(study, "smart-reduction", "Table G.3")
}

/// Table J.1.
pub(super) fn table_j_1(study: &Study) -> Item {
    table(study, "undelayed-reduction", "Table J.1")
}
