//! Detects a deliberate press of a switch: open for the release time, then closed for the press time.
//!
//! A contact that bounces or chatters, or a strained cable, also opens and closes, but not in this pattern.
//! docs/safety.md gives the reasons for the durations of [`PressConfig::product`].

use crate::param::{ParamSpec, ParamVisitor};

/// Durations of a deliberate press. The default is one control period each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PressConfig {
    /// Time for which the switch must have been open without interruption before a press counts; must be exceeded
    /// \[control periods\].
    pub release_ticks: u16,
    /// Time for which the switch must then be closed without interruption; must be exceeded \[control periods\].
    pub press_ticks: u16,
}

impl PressConfig {
    /// At 1 kHz: open for 0.45 s, which has passed when the self-test ends; the board's debouncing requires 20 ms
    /// closed.
    ///
    /// Contacts bounce for 5 to 20 ms (data sheet limits of toggle, slide and push-button switches). Road vibration
    /// from 5 Hz upwards moves a loose contact for at most 100 ms at a time. A cable that is strained while the
    /// handlebar is on one side, in a weave of 1.2 Hz or faster, is strained for at most 420 ms.
    pub const fn product() -> Self {
        Self { release_ticks: 450, press_ticks: 0 }
    }

    /// Visits both parameters, in `group`.
    pub fn visit_params<V: ParamVisitor>(&mut self, group: &'static str, to: &mut V) {
        to.count(&ParamSpec::new(group, "release_ticks", 0.0, 10_000.0), &mut self.release_ticks);
        to.count(&ParamSpec::new(group, "press_ticks", 0.0, 1000.0), &mut self.press_ticks);
    }
}

/// State of the switch in one control period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Press {
    /// Open, for less than the release time.
    Opened,
    /// Open for the release time: a press would count.
    Released,
    /// Closed after a full release, for less than the press time.
    Pressing,
    /// A deliberate press, in each period until it is consumed.
    Pressed,
    /// Closed without a full release before it.
    Held,
}

impl Press {
    /// Whether the switch is closed.
    pub const fn is_closed(self) -> bool {
        matches!(self, Press::Pressing | Press::Pressed | Press::Held)
    }
}

/// Time for which the switch was open, and has been closed since. The default is a switch that was never open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct PressState {
    open_ticks: u16,
    closed_ticks: u16,
}

impl PressState {
    /// One control period with the switch closed or open.
    pub fn step(&mut self, config: &PressConfig, closed: bool) -> Press {
        if !closed {
            // Opening ends a press and restarts the release time.
            self.open_ticks = if self.closed_ticks > 0 { 1 } else { self.open_ticks.saturating_add(1) };
            self.closed_ticks = 0;
            return if self.open_ticks > config.release_ticks { Press::Released } else { Press::Opened };
        }
        if self.open_ticks <= config.release_ticks {
            self.consume();
            return Press::Held;
        }
        self.closed_ticks = self.closed_ticks.saturating_add(1);
        if self.closed_ticks > config.press_ticks { Press::Pressed } else { Press::Pressing }
    }

    /// Consumes a press or a release: the next press counts only after a full release.
    pub fn consume(&mut self) {
        *self = Self::default();
    }
}
