//! Reduces curves to the number of points that a figure can show.

/// A curve's first, least, greatest and last value in each `bin` of its x, so that no peak is lost.
pub(in crate::report) fn thinned(points: impl Iterator<Item = (f64, f64)>, bin: f64) -> Vec<(f64, f64)> {
    let data: Vec<_> = points.filter(|(_, y)| y.is_finite()).collect();
    let mut kept = Vec::new();
    for part in data.chunk_by(|a, b| (a.0 / bin).floor() == (b.0 / bin).floor()) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let mut of_part: Vec<(f64, f64)> =
            [part.first(), part.iter().min_by(by_value), part.iter().max_by(by_value), part.last()]
                .into_iter()
                .flatten()
                .copied()
                .collect();
        of_part.sort_by(|a, b| a.0.total_cmp(&b.0));
        of_part.dedup();
        kept.extend(of_part);
    }
    kept
}
