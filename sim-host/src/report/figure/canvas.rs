//! Draws in pixels, y downwards, into a scene of the crate kuva, which becomes SVG or PNG.

use super::colour::INK;
use super::picture::Picture;
use super::shape::{dashes, path, text_width};
use kuva::plot::FillPattern;
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor, TextSpan};

const FONTS: &str = "DejaVu Sans, Verdana, Arial, sans-serif";

/// A rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Area {
    pub(super) fn right(&self) -> f64 {
        self.x + self.width
    }
    pub(super) fn bottom(&self) -> f64 {
        self.y + self.height
    }
}

/// Line pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Dash {
    Solid,
    Dashed,
    Dotted,
}

/// Style of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub(super) color: &'static str,
    pub(super) width: f64,
    pub(super) dash: Dash,
}

impl Stroke {
    pub(super) const fn solid(color: &'static str, width: f64) -> Self {
        Self { color, width, dash: Dash::Solid }
    }
    pub(super) const fn dashed(color: &'static str, width: f64) -> Self {
        Self { color, width, dash: Dash::Dashed }
    }
}

/// The drawing of a figure.
pub(super) struct Canvas {
    scene: Scene,
    clips: usize,
}

impl Canvas {
    pub(super) fn new(width: f64, height: f64) -> Self {
        let mut scene = Scene::new(width.round(), height.round());
        scene.font_family = Some(FONTS.into());
        scene.text_color = Some(INK.into());
        scene.defs.push(FillPattern::DiagonalForward.svg_def().into());
        Self { scene, clips: 0 }
    }

    pub(super) fn finish(self) -> Picture {
        Picture { scene: self.scene }
    }

    pub(super) fn text(&mut self, (x, y): (f64, f64), size: u32, anchor: TextAnchor, content: &str) {
        self.add_text((x, y), size, anchor, content, None);
    }

    /// Text that reads upwards.
    pub(super) fn text_upwards(&mut self, (x, y): (f64, f64), size: u32, content: &str) {
        self.add_text((x, y), size, TextAnchor::Middle, content, Some(-90.0));
    }

    fn add_text(
        &mut self,
        at: (f64, f64),
        size: u32,
        anchor: TextAnchor,
        content: &str,
        rotate: Option<f64>,
    ) {
        // kuva reads a dollar sign as the start of a formula.
        let content = content.replace('$', "\\$");
        let (x, y) = at;
        self.scene.add(Primitive::Text { x, y, content, size, anchor, rotate, bold: false, color: None });
    }

    /// A symbol with an index and the text after it, left-aligned.
    pub(super) fn indexed(
        &mut self,
        (x, y): (f64, f64),
        size: u32,
        (symbol, index): (&str, &str),
        rest: &str,
    ) {
        let small = size * 3 / 4;
        let after = x + text_width(symbol, size);
        self.text((x, y), size, TextAnchor::Start, symbol);
        self.text((after, y + 4.0), small, TextAnchor::Start, index);
        self.text((after + text_width(index, small), y), size, TextAnchor::Start, rest);
    }

    /// A left-aligned title, as large as fits into `width`.
    pub(super) fn title(&mut self, (x, y): (f64, f64), width: f64, content: &str) {
        // Bold letters are a sixth wider.
        let size = (width / (1.17 * text_width(content, 1))).min(15.0) as u32;
        let span = TextSpan { bold: true, ..TextSpan::plain(content) };
        self.scene.add(Primitive::RichText {
            x,
            y,
            spans: vec![span],
            size: size.max(7),
            anchor: TextAnchor::Start,
            color: None,
        });
    }

    /// A line through `points`. Dashes are cut here, since kuva's PNG restarts them at every point.
    pub(super) fn line(&mut self, points: &[(f64, f64)], stroke: Stroke) {
        let pieces = match stroke.dash {
            Dash::Solid => vec![points.to_vec()],
            Dash::Dashed => dashes(points, 6.0, 3.5),
            Dash::Dotted => dashes(points, 1.8, 2.8),
        };
        for points in pieces.into_iter().filter(|p| p.len() > 1) {
            self.scene.add(Primitive::PolyLine {
                points,
                stroke: stroke.color.into(),
                stroke_width: stroke.width,
                stroke_dasharray: None,
            });
        }
    }

    pub(super) fn rect(&mut self, area: Area, fill: impl Into<Color>, opacity: f64) {
        let Area { x, y, width, height } = area;
        let (fill, opacity) = (fill.into(), Some(opacity));
        self.scene.add(Primitive::Rect {
            x,
            y,
            width,
            height,
            fill,
            stroke: None,
            stroke_width: None,
            opacity,
        });
    }

    /// Thin diagonals over a polygon; kuva offers black ones only.
    pub(super) fn hatch(&mut self, corners: &[(f64, f64)]) {
        let pattern = format!("url(#{})", FillPattern::DiagonalForward.id());
        self.fill(corners, Color::Css(pattern.into()), None);
    }

    pub(super) fn polygon(&mut self, corners: &[(f64, f64)], color: &str, opacity: f64) {
        self.fill(corners, color.into(), Some(opacity));
    }

    fn fill(&mut self, corners: &[(f64, f64)], fill: Color, opacity: Option<f64>) {
        self.scene.add(Primitive::Path(Box::new(PathData {
            d: path(corners),
            fill: Some(fill),
            stroke: Color::None,
            stroke_width: 0.0,
            opacity,
            stroke_dasharray: None,
        })));
    }

    /// Equal dots.
    pub(super) fn dots(&mut self, centres: &[(f64, f64)], r: f64, fill: &str) {
        let (cx, cy) = centres.iter().copied().unzip();
        let fill = fill.into();
        self.scene.add(Primitive::CircleBatch {
            cx,
            cy,
            r,
            fill,
            fill_opacity: None,
            stroke: None,
            stroke_width: None,
        });
    }

    /// Draws with clipping to `area`.
    pub(super) fn clipped(&mut self, area: Area, draw: impl FnOnce(&mut Canvas)) {
        let Area { x, y, width, height } = area;
        self.clips += 1;
        let id = format!("clip{}", self.clips);
        // kuva's SVG requires the definition; its PNG uses the numbers.
        self.scene.defs.push(format!(
            "<clipPath id=\"{id}\"><rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/></clipPath>"
        ));
        self.scene.add(Primitive::ClipStart { x, y, width, height, id });
        draw(self);
        self.scene.add(Primitive::ClipEnd);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_text_whatever_it_holds() {
        let mut canvas = Canvas::new(100.0, 50.0);
        canvas.text((5.0, 20.0), 12, TextAnchor::Start, "a < b & $c$");
        canvas.title((5.0, 40.0), 90.0, "");
        let picture = canvas.finish();
        let svg = picture.svg();
        assert!(svg.contains(">a &lt; b &amp; $c$</text>"), "{svg}");
        assert!(svg.starts_with("<svg viewBox=\"0 0 100 50\" "));
        assert_eq!(&picture.png().unwrap()[1..4], b"PNG");
    }
}
