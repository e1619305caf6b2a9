//! Noise with a memory: white noise and a first-order autoregression together, over stamps at any distance.
//!
//! What a fit leaves is not white: floor, frame and fork shake for longer than a sample. Taken for white it gives
//! intervals that are too narrow by half and more. The correlation of two samples at a distance is taken as
//! share * exp(-distance / memory); what is not shared is white. Both are chosen by the restricted likelihood, which counts
//! what the fit itself took away (Patterson and Thompson 1971); the ordinary likelihood takes short records for whiter than
//! they are. Without the white part the memory would come out too short, and the slow part too small.

use nalgebra::DMatrix;

/// The noise of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation \[rad/s\].
    pub deviation_rad_s: f64,
    /// Time after which the slow part's correlation is 1/e \[s\].
    pub memory_s: f64,
    /// The slow part of the variance.
    pub share: f64,
}

/// Steps of the search over the memory, from a fifth of a sample to half the window.
const MEMORIES: usize = 16;
/// The shares tried.
const SHARES: [f64; 9] = [0.0, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0];

/// The middle distance between neighbours \[s\].
pub fn period(times: &[f64]) -> f64 {
    let mut distances: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied().unwrap_or(f64::NAN)
}

impl Noise {
    /// White noise.
    pub fn white(deviation_rad_s: f64) -> Self {
        Self { deviation_rad_s, memory_s: 0.0, share: 0.0 }
    }

    fn correlation(&self, distance_s: f64) -> f64 {
        if self.memory_s > 0.0 { libm::exp(-distance_s / self.memory_s) } else { 0.0 }
    }

    /// Makes white noise of deviation 1 of this noise, in every column: the innovations of the Kalman filter that follows the
    /// slow part. Gives the sum of the logarithms of their variances before, in units of the noise's.
    pub fn whiten(&self, times: &[f64], columns: &mut DMatrix<f64>) -> f64 {
        let mut followed = vec![0.0; columns.ncols()];
        let (mut variance, mut logarithms) = (self.share, 0.0);
        for i in 0..times.len() {
            if i > 0 {
                let r = self.correlation(times[i] - times[i - 1]);
                variance = r * r * variance + self.share * (1.0 - r * r);
                followed.iter_mut().for_each(|slow| *slow *= r);
            }
            let whole = variance + 1.0 - self.share;
            let (gain, scale) = (variance / whole, whole.sqrt() * self.deviation_rad_s);
            for (j, slow) in followed.iter_mut().enumerate() {
                let new = columns[(i, j)] - *slow;
                *slow += gain * new;
                columns[(i, j)] = new / scale;
            }
            variance *= 1.0 - gain;
            logarithms += libm::log(whole);
        }
        logarithms
    }

    /// How many independent samples the window is worth.
    pub fn independent(&self, times: &[f64]) -> f64 {
        let r = self.correlation(period(times));
        times.len() as f64 / (1.0 - self.share + self.share * (1.0 + r) / (1.0 - r))
    }

    /// The noise of most restricted likelihood in `rates` \[rad/s\] that hold any mixture of `columns` besides.
    pub fn of_rest(times: &[f64], rates: &[f64], columns: &DMatrix<f64>) -> Self {
        let (n, p) = (times.len(), columns.ncols());
        let mut all = columns.clone().resize_horizontally(p + 1, 0.0);
        // The scale of a column means nothing; one that is zero would make the matrix singular.
        all.column_iter_mut().take(p).for_each(|mut c| c /= c.norm().max(1e-9));
        all.column_mut(p).copy_from_slice(rates);
        let freedom = n.saturating_sub(p).max(1) as f64;
        let judged = |memory_s: f64, share: f64| {
            let unit = Self { deviation_rad_s: 1.0, memory_s, share };
            let mut white = all.clone();
            let logarithms = unit.whiten(times, &mut white);
            let r = white.qr().r();
            let left = r[(p, p)].powi(2).max(f64::MIN_POSITIVE);
            let taken: f64 = (0..p).map(|i| 2.0 * libm::log(r[(i, i)].abs().max(1e-12))).sum();
            let deviation_rad_s = (left / freedom).sqrt();
            (freedom * libm::log(left) + taken + logarithms, Self { deviation_rad_s, ..unit })
        };
        let (from, to) = (0.2 * period(times), 0.5 * (times[n - 1] - times[0]));
        let memories = (0..MEMORIES).map(|i| from * libm::pow(to / from, i as f64 / (MEMORIES - 1) as f64));
        let pairs = memories.flat_map(|memory| SHARES.map(|share| judged(memory, share)));
        let best = pairs.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(Self::white(f64::NAN), |(_, noise)| noise)
    }
}
