//! The fast search: quick rides scan and narrow, and exact rides confirm every border.
//!
//! The disturbances are those of the plain search, so a confirmed border has the same bits. A border that is not confirmed
//! is narrowed by exact rides, first within the bracket of the last round; a scan that an exact ride contradicts is done
//! again, plainly.

use super::ends::Ends;
use super::plain::{narrow, plain};
use super::scan::{Border, Edge, SECTIONS, column, edges, fell, rates};
use super::{Column, ScanPoint, Search, Work};
use crate::ride::{Conditions, Foreseen, Outcome, Quick, QuickRide, Ride, Start, rides};
use std::convert::Infallible;

/// Distance from a border up to which the scan's rides are ridden again in finer steps, in tolerances: there a ride is most
/// sensitive.
const NEAR: f64 = 5.0;

/// Time up to which a ride is exact that does not fall, and of which only the end is uncertain \[s\].
const OPEN_S: f64 = 1.0;

/// A line of disturbances during the search.
struct Line<'a, L> {
    start: &'a L,
    scan: Vec<ScanPoint>,
    /// The quick rides of the narrowing.
    narrowed: Vec<ScanPoint>,
    /// The edges of the scan.
    wide: Vec<Edge>,
    /// The same, narrowed by quick rides.
    edges: Vec<Edge>,
    /// The same, before each round of narrowing.
    brackets: Vec<Vec<Edge>>,
    /// The disturbances of the scan from which a ride does not fall, while only an exact one decides whether it recovers.
    open: Vec<f64>,
    /// Whether an exact ride contradicts the scan.
    contradicted: bool,
    work: Work,
}

/// A search and its rides.
struct Task<'a> {
    conditions: &'a Conditions,
    search: &'a Search,
    quick: Quick<'a>,
    /// The quick rides that narrow a border.
    fine: Quick<'a>,
}

/// The basins along some lines of disturbances.
pub(super) fn columns<L: Fn(f64) -> Start>(
    conditions: &Conditions,
    quick: Quick,
    search: &Search,
    lines: &[L],
) -> Vec<Column> {
    let task = Task::new(conditions, quick, search);
    let rates = rates(search);
    let mut lines: Vec<Line<L>> = lines.iter().map(Line::new).collect();
    let wanted: Vec<(usize, f64)> =
        (0..lines.len()).flat_map(|line| rates.iter().map(move |&rate| (line, rate))).collect();
    let outcomes = task.outcomes(&task.quick, &mut lines, &wanted);
    for (line, outcomes) in lines.iter_mut().zip(outcomes.chunks(rates.len())) {
        line.scanned(&rates, outcomes);
    }
    task.confirmed(lines)
}

/// The basins along some lines without islands: each scan ends soon after its first fall.
pub(super) fn borders<L: Fn(f64) -> Start>(
    conditions: &Conditions,
    quick: Quick,
    search: &Search,
    lines: &[L],
) -> Vec<Column> {
    let task = Task::new(conditions, quick, search);
    let rates = rates(search);
    let mut lines: Vec<Line<L>> = lines.iter().map(Line::new).collect();
    let mut scans: Vec<Vec<Option<Outcome>>> = vec![Vec::new(); lines.len()];
    for group in rates.chunks(SECTIONS) {
        let on: Vec<usize> =
            (0..lines.len()).filter(|&i| !scans[i].iter().any(|outcome| falls(*outcome))).collect();
        let wanted: Vec<(usize, f64)> =
            on.iter().flat_map(|&line| group.iter().map(move |&rate| (line, rate))).collect();
        let done = task.outcomes(&task.quick, &mut lines, &wanted);
        for (line, done) in on.into_iter().zip(done.chunks(group.len())) {
            scans[line].extend(done);
        }
    }
    for (line, scan) in lines.iter_mut().zip(&scans) {
        line.scanned(&rates, scan);
        line.wide.truncate(1);
        line.edges.truncate(1);
        line.brackets.truncate(1);
    }
    let only = |column| Column { islands: Vec::new(), ..column };
    task.confirmed(lines).into_iter().map(only).collect()
}

impl<'a, L: Fn(f64) -> Start> Line<'a, L> {
    fn new(start: &'a L) -> Self {
        Self {
            start,
            scan: Vec::new(),
            narrowed: Vec::new(),
            wide: Vec::new(),
            edges: Vec::new(),
            brackets: Vec::new(),
            open: Vec::new(),
            contradicted: false,
            work: Work::default(),
        }
    }

    /// The disturbances of the scan so near a border that its last ride can end otherwise; with the line's index `i`.
    fn near(&self, i: usize, search: &Search) -> impl Iterator<Item = (usize, f64)> {
        let of_edge = |(wide, edge): (&Edge, &Edge)| {
            [(wide.safe, edge.safe), (wide.fell, edge.fell)]
                .map(|(point, border)| (point, (point - border).abs() <= NEAR * search.tolerance))
        };
        let points = self.wide.iter().zip(&self.edges).flat_map(of_edge);
        points.filter(|&(rate, near)| near && rate > 0.0).map(move |(rate, _)| (i, rate))
    }

    /// Time at which the ride with this disturbance is expected to end \[s\]: that of a quick ride's fall, or the limit.
    fn expected_s(&self, conditions: &Conditions, rate: f64) -> f64 {
        let known = self.narrowed.iter().chain(&self.scan).find(|point| point.rate == rate);
        match known.map(|point| point.outcome) {
            Some(Outcome::Fallen { time_s, .. }) => time_s,
            _ => conditions.time_limit_s,
        }
    }

    /// Time up to which the ride with this disturbance must be exact \[s\]. At the safe end of an edge it is the time of the fall at the
    /// other end, when both have become different motions; of a ride of the scan whose end alone is open [`OPEN_S`]. Infinite are those of
    /// all others, which may fall, and of rides that can be those of the column's border, if its effort is wanted.
    fn exact_s(&self, conditions: &Conditions, search: &Search, rate: f64) -> f64 {
        let beyond_s = self.edges.iter().filter(|edge| edge.safe == rate);
        let beyond_s = beyond_s.map(|edge| self.expected_s(conditions, edge.fell)).reduce(f64::max);
        let last = self.edges.is_empty() && self.scan.last().is_some_and(|point| point.rate == rate);
        // An edge that is narrowed wrongly is shifted up to the end of its wide one.
        let of_border = beyond_s.is_some() || last || self.wide.iter().any(|edge| edge.safe == rate);
        match beyond_s {
            _ if of_border && search.efforts => f64::INFINITY,
            Some(beyond_s) => beyond_s,
            None if self.open.contains(&rate) => OPEN_S,
            None => f64::INFINITY,
        }
    }

    /// Whether the ride of the scan with this disturbance fell.
    fn scanned_fall(&self, rate: f64) -> bool {
        self.scan.iter().any(|point| point.rate == rate && fell(point.outcome))
    }

    /// Replaces an outcome of the scan by that of a better ride.
    fn corrected(&mut self, rate: f64, outcome: Outcome) {
        for point in self.scan.iter_mut().filter(|point| point.rate == rate) {
            self.contradicted |= fell(point.outcome) != fell(outcome);
            point.outcome = outcome;
        }
    }

    /// Stores the outcomes of a scan, in the order of the rates.
    fn scanned(&mut self, rates: &[f64], outcomes: &[Option<Outcome>]) {
        let found = || rates.iter().copied().zip(outcomes.iter().copied());
        self.open = found().filter(|(_, outcome)| outcome.is_none()).map(|(rate, _)| rate).collect();
        self.scan = found()
            .map(|(rate, outcome)| ScanPoint { rate, outcome: outcome.unwrap_or(Outcome::Undecided) })
            .collect();
        self.wide = edges(&self.scan);
        self.edges = self.wide.clone();
        self.brackets = vec![Vec::new(); self.wide.len()];
    }
}

/// Whether a ride with this outcome fell; `None` as in [`outcomes`].
fn falls(outcome: Option<Outcome>) -> bool {
    outcome.is_some_and(fell)
}

impl<'a> Task<'a> {
    fn new(conditions: &'a Conditions, quick: Quick<'a>, search: &'a Search) -> Self {
        let fine = quick.fine();
        Self { conditions, search, quick, fine }
    }

    /// The outcomes of rides, each given by its line and disturbance \[rad/s\]: quick ones, and exact ones where those decide
    /// nothing. `None` of a ride that does not fall, but is too close to the limit between recovered and undecided.
    fn outcomes<L: Fn(f64) -> Start>(
        &self,
        quick: &Quick,
        lines: &mut [Line<L>],
        wanted: &[(usize, f64)],
    ) -> Vec<Option<Outcome>> {
        let starts: Vec<Start> = wanted.iter().map(|&(line, rate)| (lines[line].start)(rate)).collect();
        let done = quick.rides(&starts);
        for (ride, &(line, _)) in done.iter().zip(wanted) {
            lines[line].work.add_steps(ride.steps);
        }
        let unknown = |ride: &QuickRide| ride.outcome.is_none() && !ride.upright;
        let open = done.iter().zip(wanted).filter(|(ride, _)| unknown(ride));
        let mut again = self.exact(lines, &open.map(|(_, at)| *at).collect::<Vec<_>>()).into_iter();
        let decided = |ride: &QuickRide| match unknown(ride) {
            true => again.next().map(|ride| ride.outcome),
            false => ride.outcome,
        };
        done.iter().map(decided).collect()
    }

    /// Rides with the outcomes of exact ones, each given by its line and disturbance \[rad/s\], the wanted efforts included; the longest
    /// begin first, so that short ones fill the lanes at the end.
    fn exact<L: Fn(f64) -> Start>(&self, lines: &mut [Line<L>], wanted: &[(usize, f64)]) -> Vec<Ride> {
        let expected_s = |&(line, rate): &(usize, f64)| lines[line].expected_s(self.conditions, rate);
        let expected_s: Vec<f64> = wanted.iter().map(expected_s).collect();
        let mut order: Vec<usize> = (0..wanted.len()).collect();
        order.sort_by(|&a, &b| expected_s[b].total_cmp(&expected_s[a]));
        let foreseen = |&i: &usize| {
            let (line, rate) = (&lines[wanted[i].0], wanted[i].1);
            let exact_s = line.exact_s(self.conditions, self.search, rate);
            Foreseen { start: (line.start)(rate), lasts_s: expected_s[i], exact_s }
        };
        let done = self.quick.decided(&order.iter().map(foreseen).collect::<Vec<_>>());
        let mut done: Vec<(usize, Ride)> = order.into_iter().zip(done).collect();
        done.sort_by_key(|(i, _)| *i);
        for (i, ride) in &done {
            lines[wanted[*i].0].work.add(std::slice::from_ref(ride));
        }
        done.into_iter().map(|(_, ride)| ride).collect()
    }

    /// Narrows the edges of all lines by quick rides and confirms them by exact ones.
    fn confirmed<L: Fn(f64) -> Start>(&self, mut lines: Vec<Line<L>>) -> Vec<Column> {
        let Self { search, fine, .. } = self;
        loop {
            let mut wanted = Vec::new();
            for (i, line) in lines.iter().enumerate() {
                let wide = line.edges.iter().filter(|edge| !edge.narrow(search.tolerance));
                wanted.extend(wide.flat_map(Edge::sections).map(|rate| (i, rate)));
            }
            if wanted.is_empty() {
                break;
            }
            let outcomes = self.outcomes(fine, &mut lines, &wanted);
            for (&(line, rate), &outcome) in wanted.iter().zip(&outcomes) {
                lines[line].narrowed.extend(outcome.map(|outcome| ScanPoint { rate, outcome }));
            }
            let mut sections = wanted.chunks(SECTIONS).zip(outcomes.chunks(SECTIONS));
            let edges = lines.iter_mut().flat_map(|line| line.edges.iter_mut().zip(&mut line.brackets));
            for (edge, brackets) in edges.filter(|(edge, _)| !edge.narrow(search.tolerance)) {
                let Some((rates, outcomes)) = sections.next() else { break };
                brackets.push(*edge);
                let first = outcomes.iter().position(|outcome| falls(*outcome));
                if let Some(first) = first {
                    edge.fell = rates[first].1;
                }
                if let Some(safe) = first.unwrap_or(SECTIONS).checked_sub(1) {
                    edge.safe = rates[safe].1;
                }
            }
        }
        // Both ends of every edge, and the largest disturbance where none falls.
        let (mut safe, mut fallen) = (Vec::new(), Vec::new());
        for (i, line) in lines.iter().enumerate() {
            safe.extend(line.edges.iter().map(|edge| (i, edge.safe)));
            fallen.extend(line.edges.iter().map(|edge| (i, edge.fell)));
            if line.edges.is_empty() {
                safe.extend(line.scan.last().map(|point| (i, point.rate)));
            }
        }
        let near: Vec<(usize, f64)> =
            lines.iter().enumerate().flat_map(|(i, line)| line.near(i, search)).collect();
        // The points of the scan that only exact rides decide.
        let mut doubtful = Vec::new();
        for (&(line, rate), outcome) in near.iter().zip(self.outcomes(fine, &mut lines, &near)) {
            match outcome.filter(|outcome| lines[line].scanned_fall(rate) == fell(*outcome)) {
                Some(outcome) => lines[line].corrected(rate, outcome),
                None => doubtful.push((line, rate)),
            }
        }
        for (i, line) in lines.iter().enumerate() {
            let known = |rate: &&f64| !doubtful.contains(&(i, **rate));
            doubtful.extend(line.open.iter().filter(known).map(|rate| (i, *rate)).collect::<Vec<_>>());
        }
        // All exact rides at once, so that they fill the lanes.
        let wanted: Vec<(usize, f64)> = safe.iter().chain(&fallen).chain(&doubtful).copied().collect();
        let mut safe_rides = self.exact(&mut lines, &wanted);
        let mut fallen_rides = safe_rides.split_off(safe.len());
        for (&(line, rate), ride) in doubtful.iter().zip(fallen_rides.split_off(fallen.len())) {
            lines[line].corrected(rate, ride.outcome);
        }
        let (mut safe_rides, mut fallen_rides) = (safe_rides.into_iter(), fallen_rides.into_iter());
        // The ends of the edges of each line, and without edges the ride of the largest disturbance.
        let mut ends: Vec<(Vec<Ends>, Option<Ride>)> = Vec::new();
        for line in &lines {
            let of_edge = |edge: &Edge| {
                Some(Ends { edge: *edge, safe: safe_rides.next()?, fell: fallen_rides.next()? })
            };
            let of_edges = line.edges.iter().filter_map(of_edge).collect();
            ends.push((of_edges, if line.edges.is_empty() { safe_rides.next() } else { None }));
        }
        self.shift(&mut lines, &mut ends);
        let finished = |(line, (ends, last)): (Line<L>, (Vec<Ends>, _))| self.finished(line, &ends, last);
        lines.into_iter().zip(ends).map(finished).collect()
    }

    /// Moves the ends that do not contain their border by one section.
    fn shift<L: Fn(f64) -> Start>(&self, lines: &mut [Line<L>], ends: &mut [(Vec<Ends>, Option<Ride>)]) {
        let (mut wanted, mut moved) = (Vec::new(), Vec::new());
        for (i, ((ends, _), line)) in ends.iter_mut().zip(lines.iter()).enumerate() {
            for (ends, brackets) in ends.iter_mut().zip(&line.brackets) {
                if let Some(rate) = ends.neighbour(brackets, self.search.tolerance) {
                    wanted.push((i, rate));
                    moved.push(ends);
                }
            }
        }
        let done = self.exact(lines, &wanted);
        for ((ends, (_, rate)), ride) in moved.into_iter().zip(wanted).zip(done) {
            *ends = ends.shifted(rate, ride);
        }
    }

    /// The column of a line whose edges have these ends. Without edges, `last` is the ride of the largest disturbance.
    fn finished<L: Fn(f64) -> Start>(&self, mut line: Line<L>, ends: &[Ends], last: Option<Ride>) -> Column {
        let Self { conditions, search, .. } = *self;
        let speed = (line.start)(0.0).speed_m_s;
        if line.contradicted {
            return plain(conditions, search, line.start);
        }
        if line.edges.is_empty() {
            return match last.is_some_and(|ride| ride.fell()) {
                true => plain(conditions, search, line.start),
                false => column(speed, search, line.scan, &[], last, line.work),
            };
        }
        let mut borders = Vec::with_capacity(ends.len());
        for (i, ends) in ends.iter().enumerate() {
            let quick = ends.contain_border().then(|| Border {
                safe: ends.edge.safe,
                ride: (ends.edge.safe != 0.0).then_some(ends.safe),
                beyond: ends.fell.outcome.fall(),
            });
            let mut within = |bracket: Edge| {
                let (start, work) = (line.start, &mut line.work);
                within(search, bracket, |rates| {
                    let done = rides(conditions, &rates.iter().map(|&rate| start(rate)).collect::<Vec<_>>());
                    work.add(&done);
                    done
                })
            };
            let wide = line.wide[i];
            let outer = line.brackets[i].last().copied().unwrap_or(wide);
            let Some(border) = quick.or_else(|| within(outer)).or_else(|| within(wide)) else {
                return plain(conditions, search, line.start);
            };
            borders.push(border);
        }
        column(speed, search, line.scan, &borders, None, line.work)
    }
}

/// The border in a bracket by exact rides; `None` if they contradict it.
fn within(search: &Search, mut bracket: Edge, mut ride: impl FnMut(&[f64]) -> Vec<Ride>) -> Option<Border> {
    let mut rates = vec![bracket.safe];
    if !bracket.narrow(search.tolerance) {
        rates.extend(bracket.sections());
    }
    rates.push(bracket.fell);
    let done = ride(&rates);
    let (safe, beyond) = (done.first()?, done.last()?);
    if safe.fell() || !beyond.fell() {
        return None;
    }
    let first = done.iter().position(Ride::fell)?;
    bracket = Edge { safe: rates[first - 1], fell: rates[first] };
    let at = (bracket.safe != 0.0).then_some(done[first - 1]);
    let mut ride = |rates: &[f64]| Ok::<_, Infallible>(ride(rates));
    let Ok(border) = narrow(&mut ride, bracket, done[first].outcome.fall(), search.tolerance, at);
    Some(border)
}
