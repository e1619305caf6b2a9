//! Noise with a memory: an autoregression of first order over stamps at any distance.
//!
//! What a fit leaves is not white: floor, frame and fork shake for longer than a sample. Taken for white it gives
//! intervals that are too narrow by half and more. The correlation of two samples is taken as exp(-distance/memory), and the
//! memory is chosen by the restricted likelihood, which counts what the fit itself took away (Patterson and Thompson 1971);
//! the ordinary likelihood takes short records for whiter than they are.

use nalgebra::DMatrix;

/// The noise of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation \[rad/s\].
    pub deviation_rad_s: f64,
    /// Memory: the time after which the correlation is 1/e \[s\]; 0 is white.
    pub memory_s: f64,
}

/// Steps of the search over the memory, from a fifth of a sample to half the window.
const MEMORIES: usize = 24;

/// The middle distance between neighbours \[s\].
pub fn period(times: &[f64]) -> f64 {
    let mut distances: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied().unwrap_or(f64::NAN)
}

impl Noise {
    /// Correlation of each sample with the one before.
    fn correlations(&self, times: &[f64]) -> Vec<f64> {
        let of = |w: &[f64]| if self.memory_s > 0.0 { (-(w[1] - w[0]) / self.memory_s).exp() } else { 0.0 };
        times.windows(2).map(of).collect()
    }

    /// Makes white noise of deviation 1 of this noise, in every column.
    pub fn whiten(&self, times: &[f64], columns: &mut DMatrix<f64>) {
        let correlations = self.correlations(times);
        for mut column in columns.column_iter_mut() {
            for i in (1..column.len()).rev() {
                let r = correlations[i - 1];
                column[i] = (column[i] - r * column[i - 1]) / (1.0 - r * r).sqrt();
            }
            column /= self.deviation_rad_s;
        }
    }

    /// How many independent samples the window is worth.
    pub fn independent(&self, times: &[f64]) -> f64 {
        let r = if self.memory_s > 0.0 { (-period(times) / self.memory_s).exp() } else { 0.0 };
        times.len() as f64 * (1.0 - r) / (1.0 + r)
    }

    /// The noise of most restricted likelihood in `rates` \[rad/s\] that hold any mixture of `columns` besides.
    pub fn of_rest(times: &[f64], rates: &[f64], columns: &DMatrix<f64>) -> Self {
        let (n, p) = (times.len(), columns.ncols());
        let mut all = columns.clone().resize_horizontally(p + 1, 0.0);
        // The scale of a column means nothing; one that is zero would make the matrix singular.
        all.column_iter_mut().take(p).for_each(|mut c| c /= c.norm().max(1e-9));
        all.column_mut(p).copy_from_slice(rates);
        let judged = |memory_s: f64| {
            let unit = Self { deviation_rad_s: 1.0, memory_s };
            let mut white = all.clone();
            unit.whiten(times, &mut white);
            let r = white.qr().r();
            let left = r[(p, p)].powi(2).max(f64::MIN_POSITIVE);
            let taken: f64 = (0..p).map(|i| 2.0 * r[(i, i)].abs().max(1e-12).ln()).sum();
            let memory: f64 = unit.correlations(times).iter().map(|r| (1.0 - r * r).ln()).sum();
            let freedom = n.saturating_sub(p).max(1) as f64;
            (freedom * left.ln() + taken + memory, (left / freedom).sqrt())
        };
        let (from, to) = (0.2 * period(times), 0.5 * (times[n - 1] - times[0]));
        let at = |i: f64| from * (to / from).powf(i / (MEMORIES - 1) as f64);
        let cost = |i: f64| judged(at(i)).0;
        let best =
            (0..MEMORIES).map(|i| i as f64).min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(0.0);
        let place = golden((best - 1.0).max(0.0), (best + 1.0).min((MEMORIES - 1) as f64), cost);
        Self { memory_s: at(place), deviation_rad_s: judged(at(place)).1 }
    }
}

/// Where between two places a function with one valley is least, to a hundredth.
fn golden(mut a: f64, mut b: f64, f: impl Fn(f64) -> f64) -> f64 {
    const PART: f64 = 0.618_033_988_749_895;
    let (mut x, mut y) = (b - PART * (b - a), a + PART * (b - a));
    let (mut fx, mut fy) = (f(x), f(y));
    while b - a > 0.01 {
        if fx < fy {
            (b, y, fy) = (y, x, fx);
            x = b - PART * (b - a);
            fx = f(x);
        } else {
            (a, x, fx) = (x, y, fy);
            y = a + PART * (b - a);
            fy = f(y);
        }
    }
    0.5 * (a + b)
}
