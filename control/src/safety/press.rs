//! A deliberate press of a switch: open for a whole release time, then closed for a whole press time.
//!
//! A contact that bounces, chatters or hangs on a cable under strain opens and closes too, but not in this pattern.
//! The durations of [`PressConfig::product`] are argued in docs/safety.md.

use crate::param::{ParamSpec, ParamVisitor};

/// Durations of a deliberate press. The default takes one control period of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PressConfig {
    /// The switch must have been open for longer than this, without a break, before a press counts
    /// \[control periods\].
    pub release_ticks: u16,
    /// The switch must then be closed for longer than this, without a break \[control periods\].
    pub press_ticks: u16,
}

impl PressConfig {
    /// At 1 kHz, open for 0.45 s, which is over when the self-test is; the board's debouncing demands 20 ms closed.
    ///
    /// Contacts bounce for 5 to 20 ms (limits in data sheets of toggle, slide and push-button switches); road vibration
    /// from 5 Hz up moves a loose contact for at most 100 ms at a time; a cable that is strained while the handlebar is on
    /// one side of a weave of 1.2 Hz or faster is strained for at most 420 ms.
    pub const fn product() -> Self {
        Self { release_ticks: 450, press_ticks: 0 }
    }

    /// Shows both parameters, as those of `group`.
    pub fn visit_params<V: ParamVisitor>(&mut self, group: &'static str, to: &mut V) {
        to.count(&ParamSpec::new(group, "release_ticks", 0.0, 10_000.0), &mut self.release_ticks);
        to.count(&ParamSpec::new(group, "press_ticks", 0.0, 1000.0), &mut self.press_ticks);
    }
}

/// What the switch says in one control period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Press {
    /// Open, not yet for the release time.
    Opened,
    /// Open for the release time: a press would count.
    Released,
    /// Closed after a whole release, not yet for the press time.
    Pressing,
    /// A deliberate press; each period until it is spent.
    Pressed,
    /// Closed without a whole release before it.
    Held,
}

impl Press {
    /// Whether the switch is closed.
    pub const fn is_closed(self) -> bool {
        matches!(self, Press::Pressing | Press::Pressed | Press::Held)
    }
}

/// For how long the switch was open, and has been closed since. The default was never open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PressState {
    open_ticks: u16,
    closed_ticks: u16,
}

impl PressState {
    /// One control period with the switch closed or open.
    pub fn step(&mut self, config: &PressConfig, closed: bool) -> Press {
        if !closed {
            // An opening ends a press: the release begins anew.
            self.open_ticks = if self.closed_ticks > 0 { 1 } else { self.open_ticks.saturating_add(1) };
            self.closed_ticks = 0;
            return if self.open_ticks > config.release_ticks { Press::Released } else { Press::Opened };
        }
        if self.open_ticks <= config.release_ticks {
            self.spend();
            return Press::Held;
        }
        self.closed_ticks = self.closed_ticks.saturating_add(1);
        if self.closed_ticks > config.press_ticks { Press::Pressed } else { Press::Pressing }
    }

    /// Uses a press up, or a release: the next press counts after a whole release.
    pub fn spend(&mut self) {
        *self = Self::default();
    }
}
