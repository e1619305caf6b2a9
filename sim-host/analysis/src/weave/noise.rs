//! Correlated noise: white noise plus a first-order autoregression, at irregular sample times.
//!
//! The residual of a fit is not white: floor, frame and fork vibrate for longer than a sample. Taking it for
//! white gives intervals too narrow by half and more. The correlation of two samples is share * exp(-distance
//! / memory); the rest of the variance is white. Both parameters maximise the restricted likelihood, which
//! accounts for the degrees of freedom of the fit (Patterson and Thompson 1971). The ordinary likelihood
//! estimates short records as whiter than they are. Without the white part the memory would be too short and
//! the slow part too small.

use nalgebra::DMatrix;

/// Noise of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation \[rad/s\].
    pub deviation_rad_s: f64,
    /// Time in which the correlation of the slow part falls to 1/e \[s\].
    pub memory_s: f64,
    /// Share of the slow part in the variance.
    pub share: f64,
}

/// Grid points of the memory, from a fifth of a sample to half the window.
const MEMORIES: usize = 16;
/// Grid points of the share.
const SHARES: [f64; 9] = [0.0, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0];

/// Median distance of neighbouring samples \[s\].
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

    /// Whitens every column to deviation 1: the innovations of the Kalman filter for the slow part. Returns
    /// the sum of the logarithms of their variances before scaling, in units of the noise's variance.
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

    /// Number of independent samples to which the window is equivalent.
    pub fn independent(&self, times: &[f64]) -> f64 {
        let r = self.correlation(period(times));
        times.len() as f64 / (1.0 - self.share + self.share * (1.0 + r) / (1.0 - r))
    }

    /// The noise with the largest restricted likelihood for `rates` \[rad/s\], given any linear combination
    /// of `columns`.
    pub fn of_rest(times: &[f64], rates: &[f64], columns: &DMatrix<f64>) -> Self {
        let (n, p) = (times.len(), columns.ncols());
        let mut all = columns.clone().resize_horizontally(p + 1, 0.0);
        // The scale of a column is arbitrary; a zero column would make the matrix singular.
        all.column_iter_mut().take(p).for_each(|mut c| c /= c.norm().max(1e-9));
        all.column_mut(p).copy_from_slice(rates);
        let freedom = n.saturating_sub(p).max(1) as f64;
        let evaluated = |memory_s: f64, share: f64| {
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
        let pairs = memories.flat_map(|memory| SHARES.map(|share| evaluated(memory, share)));
        let best = pairs.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(Self::white(f64::NAN), |(_, noise)| noise)
    }
}
