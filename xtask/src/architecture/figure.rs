//! The figure: one panel for each graph, as SVG.

use super::graph::Graph;
use super::layout::{BOX_HEIGHT, Layout, layout};
use crate::Result;
use std::fmt::Write;

/// Width up to which panels are beside each other \[px\].
const WIDTH: f64 = 900.0;
/// Distance between panels and to the edge \[px\].
const MARGIN: f64 = 24.0;
/// Height of a panel's heading \[px\].
const HEADING: f64 = 34.0;

/// The SVG of all graphs. Drawn on a light ground, so that it is readable on any page.
pub fn svg(graphs: &[Graph]) -> Result<String> {
    let mut body = String::new();
    let (mut x, mut y, mut row, mut width) = (MARGIN, MARGIN, 0.0, 0.0_f64);
    for graph in graphs {
        let panel = layout(graph)?;
        if x > MARGIN && x + panel.width + MARGIN > WIDTH {
            (x, y, row) = (MARGIN, y + row + MARGIN, 0.0);
        }
        let heading = match graph.source {
            Some(_) => format!("modules of {}", graph.name),
            None => graph.name.clone(),
        };
        draw(&mut body, &heading, &panel, (x, y));
        x += panel.width + 2.0 * MARGIN;
        row = f64::max(row, HEADING + panel.height);
        width = width.max(x - MARGIN);
    }
    let height = y + row + MARGIN;
    Ok(format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="DejaVu Sans, Verdana, Arial, sans-serif" font-size="13">
<defs><marker id="head" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" markerUnits="userSpaceOnUse" orient="auto"><path d="M0 0L8 4L0 8z" fill="#56606b"/></marker></defs>
<rect width="{width}" height="{height}" rx="8" fill="#ffffff"/>
{body}</svg>
"##
    ))
}

fn draw(body: &mut String, heading: &str, panel: &Layout, (x, y): (f64, f64)) {
    let _ = writeln!(body, r##"<g transform="translate({x} {y})">"##);
    let _ =
        writeln!(body, r##"<text y="14" font-size="16" font-weight="bold" fill="#1f2933">{heading}</text>"##);
    let _ = writeln!(body, r##"<g transform="translate(0 {HEADING})">"##);
    for edge in &panel.edges {
        let _ = writeln!(
            body,
            r##"<path d="{}" fill="none" stroke="#56606b" marker-end="url(#head)"/>"##,
            curve(edge)
        );
    }
    for (name, area) in &panel.boxes {
        let (x, y, width) = (area.x, area.y, area.width);
        let (middle, base) = (x + width / 2.0, y + BOX_HEIGHT / 2.0 + 4.5);
        let _ = writeln!(
            body,
            r##"<rect x="{x}" y="{y}" width="{width}" height="{BOX_HEIGHT}" rx="5" fill="#e6eef7" stroke="#34567a"/><text x="{middle}" y="{base}" text-anchor="middle" fill="#1f2933">{name}</text>"##
        );
    }
    body.push_str("</g>\n</g>\n");
}

/// Vertical where the line passes a layer, an S between two layers.
fn curve(points: &[(f64, f64)]) -> String {
    let mut path = format!("M{} {}", points[0].0, points[0].1);
    for (at, pair) in points.windows(2).enumerate() {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        let middle = (y0 + y1) / 2.0;
        let _ = match at % 2 {
            0 => write!(path, "C{x0} {middle} {x1} {middle} {x1} {y1}"),
            _ => write!(path, "L{x1} {y1}"),
        };
    }
    path
}
