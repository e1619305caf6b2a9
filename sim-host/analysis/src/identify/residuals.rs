//! What a fit leaves unexplained: residuals over time.

use super::pipeline::Identified;

impl Identified {
    /// Each measured signal less the selected fit's response and the drift \[rad or rad/s\]; NaN for samples that are not
    /// fitted.
    pub fn residuals(&self) -> Vec<Vec<f64>> {
        let problem = &self.problem;
        let response = self.response();
        if response.len() < problem.record.len() {
            return vec![vec![f64::NAN; problem.record.len()]; problem.record.measured.len()];
        }
        problem.objective_of(&problem.model, self.fit(), &|_| true).differences(&response)
    }
}
