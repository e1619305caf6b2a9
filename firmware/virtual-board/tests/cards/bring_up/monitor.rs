//! `sim-host monitor` and `sim-host param` at the other end of the serial line, as one line.

use crate::bed::Listener;
use control::sensors::polarity::PolarityStep;
use link::message::Message;
use link::telemetry::Telemetry;

/// The board's last messages.
#[derive(Default)]
pub(super) struct Monitor {
    listener: Listener,
    newest: Option<Telemetry>,
    /// The parameters that were set, or the rejections.
    answers: Vec<String>,
}

impl Monitor {
    pub(super) fn take(&mut self, bytes: &[u8]) {
        let Self { listener, newest, answers } = self;
        listener.take(bytes, |_, message| match message {
            Message::Telemetry(telemetry) => *newest = Some(*telemetry),
            Message::Value { key, value } => answers.push(format!("{key}={}", value.unwrap_or(f32::NAN))),
            Message::Rejected(refusal) => answers.push(refusal.to_string()),
            _ => (),
        });
    }

    pub(super) fn line(&self) -> String {
        let Some(Telemetry { command, polarity, frame, .. }) = self.newest else {
            return "monitor: nothing".into();
        };
        let causes: Vec<u8> = command.causes.iter().map(|cause| cause.code()).collect();
        format!(
            "monitor: mode={} torque={:.3} steer_rate={:.3} causes={causes:?} {} {}",
            command.mode.name(),
            command.torque_nm,
            frame.steer_rate_rad_s.value,
            polarity_text(polarity),
            self.answers.join(" ")
        )
    }
}

/// The text of `sim-host monitor` for the next polarity step.
fn polarity_text(next: u8) -> &'static str {
    match next {
        n if n == PolarityStep::Lean as u8 => "polarity: lean the bicycle to the right",
        n if n == PolarityStep::Steer as u8 => "polarity: turn the handlebar to the right",
        n if n == PolarityStep::Push as u8 => "polarity: push the bicycle forward",
        n if n == PolarityStep::Passed as u8 => "polarity: passed",
        _ => "polarity: a sign is wrong",
    }
}
