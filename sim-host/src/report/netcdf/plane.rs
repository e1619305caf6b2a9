//! NetCDF file of `basin plane`.

use super::basin::numbered;
use super::variable::{border_flags, scan_outcomes};
use super::{File, Variable};
use crate::basin::{Plane, Ray};
use crate::report::tool::Tool;
use crate::ride::FallCause;

/// The file of the computed rays of a plane: borders over `ray`, outcomes over `ray` and `part` (0 is the undisturbed ride, 1
/// the ray's end), and the closed outline over `point`.
pub fn plane(title: &str, attributes: Vec<(&'static str, String)>, plane: &Plane) -> File {
    let rays = &plane.rays;
    let over_rays = |of: fn(&Ray) -> f64| rays.iter().map(of).collect::<Vec<_>>();
    let scan = || rays.iter().flat_map(|ray| &ray.column.scan);
    let parts = rays.first().map_or(Vec::new(), |ray| ray.column.scan.iter().map(|p| p.rate).collect());
    let outline = plane.outline();
    let (ray, map, point) = (&["ray"], &["ray", "part"], &["point"]);
    let mut variables = vec![
        Variable::numbers(("ray", "1", "number of the ray, by its angle"), ray, numbered(rays.len())),
        Variable::numbers(("part", "1", "part of the ray from the undisturbed ride"), &["part"], parts),
        Variable::numbers(
            ("ray_steer_rate", "rad s-1", "steer rate at the end of the ray, to the right"),
            ray,
            over_rays(|r| r.steer_rate),
        ),
        Variable::numbers(
            ("ray_roll_rate", "rad s-1", "roll rate at the end of the ray, to the right"),
            ray,
            over_rays(|r| r.roll_rate),
        ),
        Variable::numbers(
            ("border", "1", "largest part of the ray not to fall"),
            ray,
            over_rays(|r| r.column.upper),
        ),
    ];
    let falls = rays.iter().map(|r| r.column.beyond.map(FallCause::name));
    variables.extend(border_flags("border", ray, rays.iter().map(|r| r.column.capped), falls));
    variables.extend(scan_outcomes(map, scan()));
    variables.extend([
        Variable::numbers(("point", "1", "number of the outline's point"), point, numbered(outline.len())),
        Variable::numbers(
            ("outline_steer_rate", "rad s-1", "steer rate of the closed outline"),
            point,
            outline.iter().map(|p| p.0).collect(),
        ),
        Variable::numbers(
            ("outline_roll_rate", "rad s-1", "roll rate of the closed outline"),
            point,
            outline.iter().map(|p| p.1).collect(),
        ),
    ]);
    File { title: title.into(), tool: Tool::this(), attributes, variables }
}
