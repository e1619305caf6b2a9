//! A board's state as text, as the link reports it.

use crate::board::causes::{limits, named};
use crate::board::monitor::Monitor;
use crate::counted::counted;
use control::sensors::polarity::PolarityStep;
use control::{ActiveLimits, Cause, Causes, Sample};
use link::telemetry::Telemetry;

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
    let back = counted(*clock_backs, "time", "times");
    let back = if *clock_backs > 0 { format!(", clock back {back}") } else { String::new() };
    let unknown = if *unknown > 0 { format!("{unknown} not understood, ") } else { String::new() };
    let (frames, restarts) = (counted(*frames, "frame", "frames"), counted(*restarts, "restart", "restarts"));
    format!("{frames}, {missing} missing, {damaged} damaged, {unknown}{restarts}{back}")
}

/// Counts of received frames, in a line at the end.
pub(super) fn summary(monitor: &Monitor, damaged: u32) -> String {
    format!("{}; the board's clock at {:.3} s\n", counts(monitor, damaged), monitor.t)
}

/// A set of limits in a line.
pub(super) fn limit_names(set: ActiveLimits) -> String {
    or_none(limits(set).join(" + "))
}

/// A set of causes in a line.
pub(super) fn cause_names(set: Causes) -> String {
    let causes: Vec<_> =
        named(set).into_iter().map(|cause| format!("{} {}", cause.code, cause.name)).collect();
    or_none(causes.join(" + "))
}

/// A set of causes with their meanings, a line each.
pub(super) fn cause_lines(set: Causes) -> impl Iterator<Item = String> {
    named(set)
        .into_iter()
        .map(|cause| format!("cause {:4} {}: {} ({})", cause.code, cause.name, cause.meaning, cause.page))
}

fn or_none(words: String) -> String {
    if words.is_empty() { "none".to_owned() } else { words }
}

/// The state in a line.
pub(super) fn line(monitor: &Monitor, step: &Telemetry, damaged: u32) -> String {
    let Telemetry { late, driven, frame, command, .. } = step;
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
        limit_names(command.limits),
        cause_names(command.causes),
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

/// The state in several lines.
pub(super) fn panel(monitor: &Monitor, damaged: u32) -> Vec<String> {
    let mut lines = Vec::new();
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
            lines.push(format!(
                "check      {}; torque shown {:.2} N m",
                todo(step.polarity),
                step.polarity_torque_nm
            ));
        }
        lines.extend(cause_lines(command.causes));
    }
    lines.push(counts(monitor, damaged));
    lines
}
