//! Text widths, paths and dashes, in pixels.

/// Approximate width of a text in the fonts used.
pub(super) fn text_width(text: &str, size: u32) -> f64 {
    let width = |c: char| match c {
        ' ' | '.' | ',' | ':' | 'i' | 'j' | 'l' => 0.31,
        '(' | ')' | '[' | ']' | '/' | '-' | 'f' | 't' | 'r' => 0.4,
        'c' | 'k' | 's' | 'v' | 'x' | 'y' | 'z' => 0.58,
        'm' | 'w' | 'M' | 'W' => 0.95,
        c if c.is_uppercase() => 0.7,
        _ => 0.63,
    };
    f64::from(size) * text.chars().map(width).sum::<f64>()
}

/// A closed path as SVG writes it, to hundredths of a pixel.
pub(super) fn path(corners: &[(f64, f64)]) -> String {
    let points: Vec<String> = corners.iter().map(|(x, y)| format!("{x:.2} {y:.2}")).collect();
    format!("M {} Z", points.join(" L "))
}

/// Pieces of `on` pixels with gaps of `off` along a line.
pub(super) fn dashes(points: &[(f64, f64)], on: f64, off: f64) -> Vec<Vec<(f64, f64)>> {
    let mut pieces = Vec::new();
    let mut piece: Vec<(f64, f64)> = points.first().copied().into_iter().collect();
    let (mut drawing, mut left) = (true, on);
    for w in points.windows(2) {
        let ((mut x, mut y), (x1, y1)) = (w[0], w[1]);
        loop {
            let rest = libm::hypot(x1 - x, y1 - y);
            if rest <= left {
                left -= rest;
                if drawing {
                    piece.push((x1, y1));
                }
                break;
            }
            (x, y) = (x + (x1 - x) * left / rest, y + (y1 - y) * left / rest);
            if drawing {
                piece.push((x, y));
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![(x, y)];
            }
            drawing = !drawing;
            left = if drawing { on } else { off };
        }
    }
    pieces.push(piece);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_go_round_corners() {
        let pieces = dashes(&[(0.0, 0.0), (5.0, 0.0), (5.0, 6.0)], 6.0, 2.0);
        assert_eq!(pieces, [vec![(0.0, 0.0), (5.0, 0.0), (5.0, 1.0)], vec![(5.0, 3.0), (5.0, 6.0)]]);
    }
}
