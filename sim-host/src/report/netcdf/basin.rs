//! NetCDF file of `basin`.

use super::variable::{border_flags, effort_numbers, scan_outcomes};
use super::{File, Variable, fall_flags};
use crate::basin::{Axis, Basin, Column, Drawn, QUANTILES, ScanPoint};
use crate::report::tool::Tool;
use crate::ride::FallCause;

/// The file of the computed speeds of a basin: heights over `speed`, outcomes over `speed` and the disturbance `rate`; with
/// draws their heights over `draw`.
pub fn basin(
    title: &str,
    attributes: Vec<(&'static str, String)>,
    axis: Axis,
    basin: &Basin,
    drawn: Option<&Drawn>,
) -> File {
    let columns = &basin.columns;
    let over_speed = |of: fn(&Column) -> f64| columns.iter().map(of).collect::<Vec<_>>();
    let scan = || columns.iter().flat_map(|c| &c.scan);
    let rates = columns.first().map_or(Vec::new(), |c| c.scan.iter().map(|p| p.rate).collect());
    let disturbed = match axis {
        Axis::SteerRate => "steer rate added by the disturbance, to the right",
        Axis::RollRate => "roll rate added by the disturbance, to the right",
    };
    let speed = &["speed"];
    let map = &["speed", "rate"];
    let mut variables = vec![
        Variable::numbers(("speed", "m s-1", "forward speed"), speed, over_speed(|c| c.speed)),
        Variable::numbers(("rate", "rad s-1", disturbed), &["rate"], rates),
        Variable::numbers(
            ("height", "rad s-1", "largest disturbance not to fall"),
            speed,
            over_speed(|c| c.upper),
        ),
    ];
    let falls = columns.iter().map(|c| c.beyond.map(FallCause::name));
    variables.extend(border_flags("height", speed, columns.iter().map(|c| c.capped), falls));
    variables.extend(scan_outcomes(map, scan()));
    variables.push(Variable::new(
        ("fall", "reason for which each ride of the scan counts as fallen"),
        map,
        fall_flags(scan().map(|ScanPoint { outcome, .. }| outcome.fall().map(FallCause::name))),
    ));
    variables.extend(effort_numbers(speed, columns.iter().map(|c| c.border.map(|ride| ride.effort))));
    variables.extend(islands(columns));
    variables.extend(drawn.map_or(Vec::new(), draws));
    File { title: title.into(), tool: Tool::this(), attributes, variables }
}

/// Intervals beyond the first fall that do not fall either; nothing without one, as a dimension has at least one value.
fn islands(columns: &[Column]) -> Vec<Variable> {
    let all: Vec<_> =
        columns.iter().flat_map(|c| c.islands.iter().map(|i| (c.speed, i.from, i.to))).collect();
    if all.is_empty() {
        return Vec::new();
    }
    let over = &["island"];
    vec![
        Variable::numbers(("island", "1", "number of the island"), over, numbered(all.len())),
        Variable::numbers(
            ("island_speed", "m s-1", "forward speed"),
            over,
            all.iter().map(|i| i.0).collect(),
        ),
        Variable::numbers(
            ("island_from", "rad s-1", "smallest disturbance"),
            over,
            all.iter().map(|i| i.1).collect(),
        ),
        Variable::numbers(
            ("island_to", "rad s-1", "largest disturbance"),
            over,
            all.iter().map(|i| i.2).collect(),
        ),
    ]
}

/// The heights of drawn bicycles or riders, and their quantiles.
fn draws(drawn: &Drawn) -> Vec<Variable> {
    let heights = drawn.basins.iter().flat_map(|basin| basin.columns.iter().map(|c| c.upper)).collect();
    vec![
        Variable::numbers(("draw", "1", "number of the draw"), &["draw"], numbered(drawn.basins.len())),
        Variable::numbers(("drawn_height", "rad s-1", "height of each draw"), &["draw", "speed"], heights),
        Variable::numbers(("quantile", "1", "part of the draws below"), &["quantile"], QUANTILES.to_vec()),
        Variable::numbers(
            ("height_quantile", "rad s-1", "quantiles of the heights of the draws"),
            &["speed", "quantile"],
            drawn.heights().concat(),
        ),
    ]
}

/// 1 to `count`.
pub(super) fn numbered(count: usize) -> Vec<f64> {
    (1..=count).map(|i| i as f64).collect()
}
