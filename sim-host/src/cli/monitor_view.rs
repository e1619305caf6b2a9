//! Display of `sim-host monitor`: a panel on a terminal, lines elsewhere.

use super::Failure;
use super::outputs::print;
use crate::board::causes::{limits, named};
use crate::board::monitor::Monitor;
use console::{Term, truncate_str};
use control::sensors::polarity::PolarityStep;
use control::{Cause, Causes, Sample};
use link::telemetry::Telemetry;
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
    Lines { last: Option<Telemetry>, second: f64 },
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

    /// Processes a control step.
    pub(super) fn step(&mut self, monitor: &Monitor, damaged: u32) -> Result<(), Failure> {
        let (View::Lines { last, second }, Some(now)) = (self, monitor.newest) else { return Ok(()) };
        let what = |step: &Telemetry| (step.command.mode, step.command.causes, step.driven, step.late);
        let changed = last.as_ref().map(what) != Some(what(&now));
        let before = last.replace(now).map_or(Causes::NONE, |step| step.command.causes);
        if !changed && monitor.t.floor() == *second {
            return Ok(());
        }
        *second = monitor.t.floor();
        let new = Causes(now.command.causes.0 & !before.0);
        let meanings = named(new)
            .into_iter()
            .map(|cause| format!("  {} {}: {} ({})\n", cause.code, cause.name, cause.meaning, cause.page));
        print(&format!("{}\n{}", line(monitor, &now, damaged), meanings.collect::<String>()))
    }

    /// Redraws the panel; to be called periodically.
    pub(super) fn draw(&mut self, monitor: &Monitor, damaged: u32) -> Result<(), Failure> {
        let View::Panel { term, rows, drawn, title } = self else { return Ok(()) };
        if drawn.is_some_and(|drawn| drawn.elapsed() < DRAWN_EVERY) {
            return Ok(());
        }
        *drawn = Some(Instant::now());
        let panel = panel(title, monitor, damaged);
        let width = usize::from(term.size().1);
        term.clear_last_lines(*rows)?;
        *rows = panel.len();
        panel.iter().try_for_each(|line| term.write_line(&truncate_str(line, width, "")))?;
        Ok(())
    }
}

fn number(sample: &Sample) -> String {
    if sample.age_ticks == control::sensors::frame::MISSING {
        "-".into()
    } else {
        format!("{:.2}", sample.value)
    }
}

fn roll_rate(step: &Telemetry) -> String {
    let gyro = step.frame.gyro_rad_s;
    number(&Sample { value: gyro.value[0], age_ticks: gyro.age_ticks })
}

fn counts(monitor: &Monitor, damaged: u32) -> String {
    let Monitor { frames, missing, unknown, restarts, clock_backs, .. } = monitor;
    let back = if *clock_backs > 0 { format!(", clock back {clock_backs} times") } else { String::new() };
    let unknown = if *unknown > 0 { format!("{unknown} not understood, ") } else { String::new() };
    format!("{frames} frames, {missing} missing, {damaged} damaged, {unknown}{restarts} restarts{back}")
}

/// Counts of received frames, in a line at the end.
pub(super) fn summary(monitor: &Monitor, damaged: u32) -> String {
    format!("{}; the board's clock at {:.3} s\n", counts(monitor, damaged), monitor.t)
}

fn line(monitor: &Monitor, step: &Telemetry, damaged: u32) -> String {
    let Telemetry { late, driven, frame, command, .. } = step;
    let causes: Vec<_> =
        named(command.causes).into_iter().map(|cause| format!("{} {}", cause.code, cause.name)).collect();
    let set = |words: String| if words.is_empty() { "none".to_owned() } else { words };
    format!(
        "{:.3} s {}{}, torque {:.2} N m, gain {:.2} N m s/rad, roll rate {} rad/s, speed front {} rear {} m/s, limits {}, causes {}, late {late}, missing {}, damaged {damaged}",
        monitor.t,
        command.mode.name(),
        if *driven { "" } else { " (motor off)" },
        command.torque_nm,
        command.gain_nm_s_rad,
        roll_rate(step),
        number(&frame.front_wheel_m_s),
        number(&frame.rear_wheel_m_s),
        set(limits(command.limits).join(" + ")),
        set(causes.join(" + ")),
        monitor.missing,
    )
}

/// Next action of the polarity check (docs/safety.md), motor off.
fn todo(polarity: u8) -> &'static str {
    match PolarityStep::numbered(polarity) {
        Some(PolarityStep::Lean) => "polarity: lean the bicycle to the right",
        Some(PolarityStep::Steer) => "polarity: turn the handlebar to the right",
        Some(PolarityStep::Push) => "polarity: push the bicycle forward",
        Some(PolarityStep::Passed) => "polarity: passed",
        Some(PolarityStep::Wrong) => "polarity: a sign is wrong",
        None => "polarity: unknown step",
    }
}

fn panel(title: &str, monitor: &Monitor, damaged: u32) -> Vec<String> {
    let mut lines = vec![title.to_owned()];
    if let Some(step) = &monitor.newest {
        let Telemetry { steps, late, driven, frame, command, .. } = step;
        let switch = |on: bool| if on { "on" } else { "off" };
        lines.extend([
            format!("{:10.3} s  step {steps}, {late} late", monitor.t),
            format!(
                "mode       {}, motor {}, switch {}",
                command.mode.name(),
                switch(*driven),
                switch(frame.engage)
            ),
            format!(
                "torque     {:8.2} N m     gain {:8.2} N m s/rad",
                command.torque_nm, command.gain_nm_s_rad
            ),
            format!(
                "roll rate  {:>8} rad/s   rider {:>8} N m   motor {:>8} N m",
                roll_rate(step),
                number(&frame.rider_torque_nm),
                number(&frame.motor_torque_nm)
            ),
            format!(
                "speed      {:>8} front   {:>8} rear, m/s",
                number(&frame.front_wheel_m_s),
                number(&frame.rear_wheel_m_s)
            ),
            format!(
                "steer      {:>8} rad     {:>8} rad/s",
                number(&frame.steer_rad),
                number(&frame.steer_rate_rad_s)
            ),
            format!("limits     {}", limits(command.limits).join(", ")),
        ]);
        if command.causes.has(Cause::PolarityUnchecked) || command.causes.has(Cause::PolarityWrong) {
            lines.push(format!("check      {}; torque shown {:.2} N m", todo(step.polarity), step.shown_nm));
        }
        lines.extend(named(command.causes).iter().map(|cause| {
            format!("cause {:4} {}: {} ({})", cause.code, cause.name, cause.meaning, cause.page)
        }));
    }
    lines.push(counts(monitor, damaged));
    lines
}
