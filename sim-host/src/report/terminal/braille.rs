//! Plots curves in braille characters: two by four dots in each.

use crate::report::figure::scale::ticks;

/// Characters left of the plot: a number and the axis.
pub(super) const MARGIN: usize = 8;
/// The bits of a character's dots, by row and column.
const DOTS: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

/// A plot of curves.
pub(super) struct Chart {
    columns: usize,
    rows: usize,
    x: (f64, f64),
    y: (f64, f64),
    cells: Vec<u8>,
}

impl Chart {
    /// An empty plot, `width` characters wide including its numbers.
    pub(super) fn new(width: usize, rows: usize, x: (f64, f64), y: (f64, f64)) -> Self {
        let columns = width - MARGIN;
        Self { columns, rows, x, y, cells: vec![0; columns * rows] }
    }

    /// Position of a data point, in dots; `None` if it is not finite.
    fn at(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        let across = (x - self.x.0) / (self.x.1 - self.x.0) * (2 * self.columns - 1) as f64;
        let down = (self.y.1 - y) / (self.y.1 - self.y.0) * (4 * self.rows - 1) as f64;
        (across.is_finite() && down.is_finite()).then_some((across, down))
    }

    fn set(&mut self, (across, down): (f64, f64)) {
        let (i, j) = (across.round(), down.round());
        if i >= 0.0 && j >= 0.0 && (i as usize) < 2 * self.columns && (j as usize) < 4 * self.rows {
            let (i, j) = (i as usize, j as usize);
            self.cells[j / 4 * self.columns + i / 2] |= DOTS[j % 4][i % 2];
        }
    }

    /// Draws a dot for each data point in range.
    pub(super) fn dots(&mut self, data: impl IntoIterator<Item = (f64, f64)>) {
        for datum in data {
            if let Some(at) = self.at(datum) {
                self.set(at);
            }
        }
    }

    /// Draws a line through data points.
    pub(super) fn line(&mut self, data: impl IntoIterator<Item = (f64, f64)>) {
        let mut last = None;
        for datum in data {
            let Some(to) = self.at(datum) else { continue };
            let from = last.unwrap_or(to);
            let steps = (to.0 - from.0).abs().max((to.1 - from.1).abs()).ceil().clamp(1.0, 1000.0);
            for k in 0..=steps as usize {
                let s = k as f64 / steps;
                self.set((from.0 + (to.0 - from.0) * s, from.1 + (to.1 - from.1) * s));
            }
            last = Some(to);
        }
    }

    /// The plot with `label` above, and with `x_label` and numbers below if given.
    pub(super) fn text(&self, label: &str, x_label: Option<&str>) -> String {
        let row_of = |y: f64| self.at((self.x.0, y)).map(|at| (at.1 / 4.0) as usize);
        let numbers: Vec<_> = ticks(self.y, self.rows / 2).into_iter().map(|(y, n)| (row_of(y), n)).collect();
        let zero = row_of(0.0).filter(|_| self.y.0 < 0.0 && 0.0 < self.y.1);
        let mut text = format!("{label}\n");
        for (row, cells) in self.cells.chunks(self.columns).enumerate() {
            let number = numbers.iter().find(|(at, _)| *at == Some(row));
            let blank = if zero == Some(row) { '┈' } else { ' ' };
            let line: String = cells.iter().map(|&bits| sign(bits, blank)).collect();
            text += &margin(number.map(|(_, n)| n.as_str()));
            text += line.trim_end();
            text.push('\n');
        }
        if let Some(x_label) = x_label {
            text += &x_axis(self.columns, self.x, x_label);
        }
        text
    }
}

fn sign(bits: u8, blank: char) -> char {
    if bits == 0 { blank } else { char::from_u32(0x2800 + u32::from(bits)).unwrap_or(blank) }
}

/// Text left of a row.
pub(super) fn margin(number: Option<&str>) -> String {
    match number {
        Some(number) => format!("{number:>6} ┤"),
        None => format!("{:>6} │", ""),
    }
}

/// The axis below a plot, its numbers and its label.
pub(super) fn x_axis(columns: usize, x: (f64, f64), label: &str) -> String {
    let mut axis = vec!['─'; columns];
    let mut numbers = vec![' '; MARGIN + columns];
    let mut free = 0;
    for (v, number) in ticks(x, columns / 12) {
        let at = ((v - x.0) / (x.1 - x.0) * (columns - 1) as f64).round() as usize;
        let begin = (MARGIN + at).saturating_sub(number.len() / 2);
        if begin < free || begin + number.len() > numbers.len() {
            continue;
        }
        axis[at] = '┬';
        for (i, digit) in number.chars().enumerate() {
            numbers[begin + i] = digit;
        }
        free = begin + number.len() + 1;
    }
    let axis: String = axis.into_iter().collect();
    let numbers: String = numbers.into_iter().collect();
    format!("{:>6} └{axis}\n{}\n{label:^width$}", "", numbers.trim_end(), width = MARGIN + columns)
        .trim_end()
        .to_string()
        + "\n"
}
