//! Riders drawn from what is known of measured gains.

use super::{DrawError, RiderTable, Row};
use crate::num::RandomStream;
use nalgebra::DVector;

/// What drawn sets of gains come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Drawing {
    /// Each set from the normal distribution of its covariance, the sets independent of each other.
    Posterior,
    /// As many sets of each group as it has, with replacement.
    Bootstrap,
}

/// First random-number stream of drawn riders, beyond those of drawn bicycles.
const PURPOSE: u64 = 1 << 33;

impl RiderTable {
    /// What riders can be drawn from: covariances, if every row has one, otherwise the sets of each group, if every
    /// group has several.
    ///
    /// # Errors
    /// Neither; names the first row without a covariance.
    pub fn drawing(&self) -> Result<Drawing, DrawError> {
        let Some((i, row)) = self.rows.iter().enumerate().find(|(_, row)| row.covariance.is_none()) else {
            return Ok(Drawing::Posterior);
        };
        match self.groups().find(|group| group.len() < 2) {
            None => Ok(Drawing::Bootstrap),
            Some(alone) => Err(DrawError {
                rider: self.name.clone(),
                row: i + 1,
                speed_m_s: row.speed_m_s,
                alone_m_s: alone[0].speed_m_s,
            }),
        }
    }

    /// Table `i` of those drawn with `seed`. It has no regression of its own, as that belongs to the sets as
    /// measured.
    pub fn drawn(&self, drawing: Drawing, seed: u64, i: u64) -> Self {
        let mut random = RandomStream::new(seed, [0.0; 3], PURPOSE + i);
        let rows = match drawing {
            Drawing::Posterior => self.rows.iter().map(|row| self.posterior(row, &mut random)).collect(),
            Drawing::Bootstrap => self.groups().flat_map(|group| resampled(group, &mut random)).collect(),
        };
        Self { rows, regression: None, ..self.clone() }
    }

    fn posterior(&self, row: &Row, random: &mut RandomStream) -> Row {
        let mut drawn = row.clone();
        if let Some(covariance) = &row.covariance {
            let normal = DVector::from_fn(self.columns.len(), |_, _| random.normal());
            drawn.gains = covariance.draw(&row.gains, &self.columns, &normal);
        }
        drawn
    }
}

/// As many rows as the group has, each any of them, sorted by speed.
fn resampled(group: &[Row], random: &mut RandomStream) -> Vec<Row> {
    let mut rows: Vec<Row> = group.iter().map(|_| group[random.below(group.len())].clone()).collect();
    rows.sort_by(|a, b| a.speed_m_s.total_cmp(&b.speed_m_s));
    rows
}
