//! The ride in a lane: its time, fall, amplitudes and outcome.

use super::SENSITIVE_S;
use super::forecast::{Forecast, Now};
use crate::bicycle::{FullState, State};
use crate::ride::event::{fallen, largest_angles, time_of_fall};
use crate::ride::{Conditions, FallCause, Outcome, Ride};

/// One ride in its lane.
#[derive(Clone)]
pub(super) struct Lane {
    /// Index of the ride's start.
    pub(super) index: usize,
    /// Time since the disturbance \[s\].
    pub(super) t: f64,
    /// Steps taken.
    pub(super) steps: u32,
    /// Largest roll and steer \[rad\].
    peak: [f64; 2],
    /// Largest roll and steer in the last second \[rad\].
    late: [f64; 2],
    /// Time at which the roll first passed [`crate::ride::LaidFlat::roll_rad`] \[s\].
    flat_s: Option<f64>,
    /// Time at which the motion first left the neighbourhood of a singular configuration \[s\].
    pub(super) passed_s: Option<f64>,
    /// Six-speed state near singular configurations.
    pub(super) full: Option<FullState>,
    /// Earliest time of the next forecast \[s\].
    forecast_s: f64,
    /// Whether it continues an exact ride that has settled.
    pub(super) continues: bool,
}

impl Lane {
    pub(super) fn new(index: usize) -> Self {
        Self {
            index,
            t: 0.0,
            steps: 0,
            peak: [0.0; 2],
            late: [0.0; 2],
            flat_s: None,
            passed_s: None,
            full: None,
            forecast_s: 0.0,
            continues: false,
        }
    }

    /// Continues an exact ride.
    pub(super) fn continuing(index: usize, ride: &Ride) -> Self {
        let peak = [ride.effort.peak_roll_rad, ride.effort.peak_steer_rad];
        Self { t: ride.end.t, peak, continues: true, ..Self::new(index) }
    }

    /// The same after this number of steps.
    pub(super) fn with_steps(self, steps: u32) -> Self {
        Self { steps, ..self }
    }

    /// Whether errors had long to grow after a singular configuration.
    pub(super) fn sensitive(&self) -> bool {
        self.passed_s.is_some_and(|passed_s| self.t - passed_s > SENSITIVE_S)
    }

    /// Whether the time limit is reached without a fall.
    pub(super) fn over(&self, conditions: &Conditions) -> bool {
        self.t >= conditions.time_limit_s - 1e-9
    }

    /// Records a step of `h` seconds; the outcome if the ride has ended, or `Some(None)` if it is not decided by the factor
    /// `clear`.
    pub(super) fn book(
        &mut self,
        conditions: &Conditions,
        clear: f64,
        (before, after): (&State<f64>, &State<f64>),
        h: f64,
    ) -> Option<Option<Outcome>> {
        if fallen(&conditions.fall, after) {
            let (tau, by) = time_of_fall(&conditions.fall, (before, after), h);
            let time_s = self.t + tau;
            // A fall shortly before the limit can be after it in the exact ride.
            let decided = clear * time_s < conditions.time_limit_s;
            return Some(decided.then_some(Outcome::Fallen { time_s, by }));
        }
        self.t += h;
        let angles = [after.roll.abs(), after.steer.abs()];
        // The exact ride's last second begins with the end of its first control period.
        let since_s = self.t - (conditions.time_limit_s - 1.0 + conditions.step_s);
        self.peak = larger(self.peak, largest_angles((before, after), h, 0.0));
        if since_s >= 0.0 {
            let from = (1.0 - since_s / h).max(0.0);
            self.late = larger(self.late, largest_angles((before, after), h, from));
        }
        let over = self.over(conditions);
        if let Some(flat) = conditions.fall.flat {
            let beyond = angles[0] > flat.roll_rad;
            if beyond && self.flat_s.is_none() {
                // The exact ride counts from the end of the control period in which the angle is passed.
                let part = (flat.roll_rad - before.roll.abs()) / (angles[0] - before.roll.abs());
                let passed = self.t - h * (1.0 - part.clamp(0.0, 1.0));
                self.flat_s = Some((passed / conditions.step_s).ceil() * conditions.step_s);
            }
            if let Some(since) = self.flat_s {
                let by = FallCause::LaidFlat;
                if self.t >= since + flat.lasting_s {
                    return Some(Some(Outcome::Fallen { time_s: since + flat.lasting_s, by }));
                }
                if over && !beyond {
                    return Some(Some(Outcome::Fallen { time_s: conditions.time_limit_s, by }));
                }
            }
        }
        over.then(|| Outcome::of_amplitudes(conditions.recovered_below, self.late, self.peak, clear))
    }

    /// The outcome by the linear model, if the motion is small and the model decides.
    pub(super) fn decide_early(
        &mut self,
        conditions: &Conditions,
        forecast: &Option<Forecast>,
        now: &Now,
    ) -> Option<Outcome> {
        let forecast = forecast.as_ref()?;
        if self.t < self.forecast_s || self.flat_s.is_some() || !forecast.covers(now) {
            return None;
        }
        self.forecast_s = self.t + Forecast::INTERVAL_S;
        let (late, peak) = forecast.amplitudes(now, conditions.time_limit_s - now.t_s)?;
        let (late, peak) = (larger(self.late, late), larger(self.peak, peak));
        forecast.outcome(conditions.recovered_below, late, peak)
    }
}

/// The larger of each.
fn larger(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].max(b[1])]
}
