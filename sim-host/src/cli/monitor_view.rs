//! Display of `sim-host monitor`: a panel on a terminal, lines elsewhere.

use super::Failure;
use super::outputs::print;
use crate::board::causes::named;
use console::{Term, truncate_str};
use control::{Causes, Mode};
use std::time::{Duration, Instant};

/// Shortest time between two updates of the panel.
const DRAWN_EVERY: Duration = Duration::from_millis(100);

/// Destination of the values.
pub(super) enum View {
    /// None: standard output is used for something else.
    None,
    /// A panel that is redrawn.
    Panel { term: Term, rows: usize, drawn: Option<Instant>, title: String },
    /// A line per second, and one for every change of mode, causes, drive or missed deadlines.
    Lines { last: Option<Seen>, second: f64 },
}

/// What a line is printed for, when it changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seen {
    /// Mode of the controller.
    pub(super) mode: Mode,
    /// Causes that prevent or reduce torque, or are reported.
    pub(super) causes: Causes,
    /// Whether the motor accepts torque.
    pub(super) driven: bool,
    /// Missed deadlines.
    pub(super) late: u32,
}

impl View {
    /// A panel if standard output is a terminal.
    pub(super) fn new(title: String) -> Result<Self, Failure> {
        let term = Term::stdout();
        if term.is_term() {
            return Ok(View::Panel { term, rows: 0, drawn: None, title });
        }
        print(&format!("{title}\n"))?;
        Ok(View::Lines { last: None, second: f64::NEG_INFINITY })
    }

    /// Prints a text that stays on the screen.
    pub(super) fn say(&mut self, text: &str) -> Result<(), Failure> {
        match self {
            View::None => Ok(()),
            View::Lines { .. } => print(&format!("{}\n", text.trim_end())),
            View::Panel { term, rows, drawn, .. } => {
                term.clear_last_lines(std::mem::take(rows))?;
                *drawn = None;
                Ok(term.write_line(text.trim_end())?)
            }
        }
    }

    /// Processes the state at `t` \[s\]; `line` is it as text.
    pub(super) fn step(&mut self, t: f64, seen: Seen, line: impl FnOnce() -> String) -> Result<(), Failure> {
        let View::Lines { last, second } = self else { return Ok(()) };
        let before = last.replace(seen);
        if before == Some(seen) && t.floor() == *second {
            return Ok(());
        }
        *second = t.floor();
        let new = Causes(seen.causes.0 & !before.map_or(Causes::NONE, |before| before.causes).0);
        let meanings = named(new)
            .into_iter()
            .map(|cause| format!("  {} {}: {} ({})\n", cause.code, cause.name, cause.meaning, cause.page));
        print(&format!("{}\n{}", line(), meanings.collect::<String>()))
    }

    /// Redraws the panel, the lines of `content` below the title; to be called periodically.
    pub(super) fn draw(&mut self, content: impl FnOnce() -> Vec<String>) -> Result<(), Failure> {
        let View::Panel { term, rows, drawn, title } = self else { return Ok(()) };
        if drawn.is_some_and(|drawn| drawn.elapsed() < DRAWN_EVERY) {
            return Ok(());
        }
        *drawn = Some(Instant::now());
        let panel = [vec![title.clone()], content()].concat();
        let width = usize::from(term.size().1);
        term.clear_last_lines(*rows)?;
        *rows = panel.len();
        panel.iter().try_for_each(|line| term.write_line(&truncate_str(line, width, "")))?;
        Ok(())
    }
}
