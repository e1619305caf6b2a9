//! Cubic smoothing spline through measured values, as the posterior mean of an integrated Wiener process (Wahba 1978,
//! J. R. Stat. Soc. B 40, 364; Wood 2017, Generalized Additive Models, section 5.3 and 6.2).
//!
//! `value = f(x) + error`, where the errors have variances `scale / weight`, and `f` is a straight line plus a process
//! whose second derivative is white noise of intensity `scale * roughness`. The posterior mean is the natural cubic
//! spline that minimises `sum weight (value - f)^2 + integral f''^2 / roughness`. The roughness has the largest
//! restricted likelihood (REML). With it the scale and the posterior variance follow.

use nalgebra::{DMatrix, DVector};

/// Roughnesses tried, relative to the reciprocal of the largest eigenvalue of the process: from a line in practice to
/// close to an interpolation.
const ROUGHNESS: [f64; 2] = [1e-4, 1e8];
/// Tried per decade before the refinement.
const PER_DECADE: usize = 10;
/// Smallest decrease of -2 log likelihood for which a rougher curve is chosen instead of a line.
const WORTH: f64 = 1e-9;

/// A measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where it is measured.
    pub x: f64,
    /// The value.
    pub value: f64,
    /// Variance of its error, up to the common scale; positive.
    pub variance: f64,
}

/// Whether the variances of the points are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variances {
    /// Known: a scale below one is taken for chance, so that errors are not smaller than the known ones.
    Known,
    /// Relative: the scale follows from the residuals.
    Relative,
}

/// A smoothing spline: natural, so straight beyond the outermost points.
#[derive(Clone, Debug)]
pub struct Spline {
    /// Smallest and largest place.
    ends: [f64; 2],
    /// Distinct places, scaled to 0 to 1.
    places: Vec<f64>,
    /// Relative roughness; 0 for a line.
    roughness: f64,
    /// Parameters of the line: one for a constant, otherwise value at 0 and slope.
    line: DVector<f64>,
    /// Weights of the process at each place.
    weights: DVector<f64>,
    /// Inverse covariance of the values at the places, up to the scale.
    precision: DMatrix<f64>,
    /// Covariance of the line's parameters up to the scale.
    line_covariance: DMatrix<f64>,
    /// Variance of a measured value of variance one; `None` without degrees of freedom for it.
    scale: Option<f64>,
    /// Effective degrees of freedom: 1 for a constant, 2 for a line, up to the number of places.
    pub degrees_of_freedom: f64,
}

impl Spline {
    /// The spline through `points`, at least one. A line if the points are on two places or if a curve is no more
    /// likely; a constant if on one.
    pub fn new(points: &[Point], variances: Variances) -> Self {
        let (ends, merged, within) = merge(points);
        let places: Vec<f64> = merged.iter().map(|p| scaled(ends, p.x)).collect();
        let n = merged.len();
        let values = DVector::from_iterator(n, merged.iter().map(|p| p.value));
        let noise = DVector::from_iterator(n, merged.iter().map(|p| p.variance));
        let basis = DMatrix::from_fn(n, n.min(2), |i, j| places[i].powi(j as i32));
        let process = DMatrix::from_fn(n, n, |i, j| kernel(places[i], places[j]));

        let free = points.len() - basis.ncols();
        let spectrum = Spectrum::new(&basis, &process, &values, &noise, within);
        let roughness = if free > 1 { spectrum.roughness(free) } else { 0.0 };
        let residual = if free > 0 { Some(spectrum.residual(roughness) / free as f64) } else { None };
        let scale = match (variances, residual) {
            (Variances::Known, scale) => Some(scale.unwrap_or(1.0).max(1.0)),
            (Variances::Relative, scale) => scale,
        };

        let precision = inverse(DMatrix::from_diagonal(&noise) + roughness * process);
        let line_covariance = inverse(basis.transpose() * &precision * &basis);
        let line = &line_covariance * (basis.transpose() * &precision * &values);
        let weights = &precision * (&values - &basis * &line);
        let degrees_of_freedom = basis.ncols() as f64 + spectrum.freedom(roughness);
        Self { ends, places, roughness, line, weights, precision, line_covariance, scale, degrees_of_freedom }
    }

    /// The value at `x`.
    pub fn at(&self, x: f64) -> f64 {
        let place = scaled(self.ends, x);
        self.basis(place).dot(&self.line) + self.process(place).dot(&self.weights)
    }

    /// Standard error of the value at `x`, between the outermost points: root of the posterior variance. `None`
    /// without degrees of freedom for the scale of relative variances.
    pub fn standard_error(&self, x: f64) -> Option<f64> {
        let place = scaled(self.ends, x);
        let process = self.process(place);
        let solved = &self.precision * &process;
        let on_line =
            DMatrix::from_fn(self.places.len(), self.line.len(), |i, j| self.places[i].powi(j as i32));
        let rest = self.basis(place) - on_line.transpose() * &solved;
        let prior = self.roughness * kernel(place, place);
        let variance = prior - process.dot(&solved) + rest.dot(&(&self.line_covariance * &rest));
        Some((self.scale? * variance.max(0.0)).sqrt())
    }

    fn basis(&self, place: f64) -> DVector<f64> {
        DVector::from_fn(self.line.len(), |j, _| place.powi(j as i32))
    }

    /// Prior covariance of the process at a place and at the points' places, up to the scale.
    fn process(&self, place: f64) -> DVector<f64> {
        DVector::from_fn(self.places.len(), |i, _| self.roughness * kernel(self.places[i], place))
    }
}

/// Covariance of the twice integrated white noise at two places; zero below 0, where it begins.
fn kernel(a: f64, b: f64) -> f64 {
    let (low, high) = (a.min(b).max(0.0), a.max(b));
    low * low * (3.0 * high - low) / 6.0
}

/// Inverse of a positive definite matrix.
fn inverse(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let eigen = matrix.symmetric_eigen();
    let scaled = DMatrix::from_diagonal(&eigen.eigenvalues.map(|d| 1.0 / d));
    &eigen.eigenvectors * scaled * eigen.eigenvectors.transpose()
}

/// A place scaled so that `ends` are 0 and 1.
fn scaled(ends: [f64; 2], x: f64) -> f64 {
    let width = ends[1] - ends[0];
    if width > 0.0 { (x - ends[0]) / width } else { 0.0 }
}

/// The smallest and largest place; a point per place, in order, with weighted mean and variance of those there; the
/// weighted sum of squares about these means.
fn merge(points: &[Point]) -> ([f64; 2], Vec<Point>, f64) {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x));
    let mut within = 0.0;
    let one = |same: &[Point]| {
        let weight: f64 = same.iter().map(|p| 1.0 / p.variance).sum();
        let value = same.iter().map(|p| p.value / p.variance).sum::<f64>() / weight;
        within += same.iter().map(|p| (p.value - value).powi(2) / p.variance).sum::<f64>();
        Point { x: same[0].x, value, variance: 1.0 / weight }
    };
    let merged: Vec<Point> = sorted.chunk_by(|a, b| a.x == b.x).map(one).collect();
    ([merged[0].x, merged[merged.len() - 1].x], merged, within)
}

/// The measured values without their line, along the eigenvectors of the process among weighted values.
struct Spectrum {
    /// Variance of the process along each, for a roughness of one.
    eigenvalues: DVector<f64>,
    /// Square of the values along each.
    squares: DVector<f64>,
    /// Weighted sum of squares between values at the same place.
    within: f64,
    /// Weighted sum of squares of the values.
    total: f64,
    /// Sum of the weights.
    total_weight: f64,
}

impl Spectrum {
    fn new(
        basis: &DMatrix<f64>,
        process: &DMatrix<f64>,
        values: &DVector<f64>,
        noise: &DVector<f64>,
        within: f64,
    ) -> Self {
        let weight = DMatrix::from_diagonal(&noise.map(|v| 1.0 / v.sqrt()));
        let line = (&weight * basis).qr().q();
        let n = values.len();
        let rest = DMatrix::identity(n, n) - &line * line.transpose();
        let eigen = (&rest * &weight * process * &weight * &rest).symmetric_eigen();
        let along = eigen.eigenvectors.transpose() * (&rest * &weight * values);
        Self {
            eigenvalues: eigen.eigenvalues.map(|d| d.max(0.0)),
            squares: along.map(|z| z * z),
            within,
            total: (&weight * values).norm_squared(),
            total_weight: weight.norm_squared(),
        }
    }

    /// Weighted sum of squares that remains, with a penalty for the curve.
    fn residual(&self, roughness: f64) -> f64 {
        let parts = self.squares.iter().zip(&self.eigenvalues);
        self.within + parts.map(|(z, d)| z / (1.0 + roughness * d)).sum::<f64>()
    }

    /// Effective degrees of freedom beyond the line.
    fn freedom(&self, roughness: f64) -> f64 {
        self.eigenvalues.iter().map(|d| roughness * d / (1.0 + roughness * d)).sum()
    }

    /// -2 log of the restricted likelihood with `free` degrees of freedom, with the likeliest scale, but for a constant.
    fn cost(&self, roughness: f64, free: usize) -> f64 {
        let volume: f64 = self.eigenvalues.iter().map(|d| libm::log1p(roughness * d)).sum();
        free as f64 * libm::log(self.residual(roughness)) + volume
    }

    /// The likeliest roughness; 0 if a curve is no more likely than a line.
    fn roughness(&self, free: usize) -> f64 {
        let largest = self.eigenvalues.max();
        // Without values off the line there is nothing to fit; an eigenvalue of rounding is no process.
        if largest <= 1e-12 * self.total_weight || self.squares.sum() <= 1e-24 * self.total {
            return 0.0;
        }
        let [low, high] = ROUGHNESS.map(|r| libm::log(r / largest));
        let steps = (libm::log10(ROUGHNESS[1] / ROUGHNESS[0]) * PER_DECADE as f64).round() as usize;
        let step = (high - low) / steps as f64;
        let cost = |log: f64| self.cost(libm::exp(log), free);
        let tried = (0..=steps).map(|i| low + i as f64 * step);
        let best = tried.min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(low);
        let refined = minimum(&cost, (best - step).max(low), (best + step).min(high));
        if cost(refined) < self.cost(0.0, free) - WORTH { libm::exp(refined) } else { 0.0 }
    }
}

/// Place of the minimum of a function with one minimum, by golden sections to 1e-6.
fn minimum(of: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    while high - low > 1e-6 {
        let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if of(a) < of(b) { high = b } else { low = a }
    }
    f64::midpoint(low, high)
}
