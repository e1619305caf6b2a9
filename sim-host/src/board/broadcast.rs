//! State of a board from its frames on CAN, put together to one row per broadcast.

use control::Causes;
use link::can::{Frame, Message, Motion, PERIOD_MS, State};
use schemars::JsonSchema;
use serde::Serialize;

/// One broadcast: three frames. Values are in the bicycle's own axes and signs, before validation; empty where a frame was
/// missing or the board does not know the value. Columns that the link's table has too have the same names.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BroadcastRow {
    /// Time since the first frame, by the receiver's clock \[s\].
    pub t: f64,
    /// Lowest byte of the number of control steps.
    pub steps_low: Option<u8>,
    /// Whether the motor accepts torque.
    pub driven: Option<bool>,
    /// Mode of the controller, as the number of [`control::Mode`].
    pub mode: Option<u8>,
    /// Causes that prevented or reduced torque, as bits of [`control::Causes`].
    pub causes: Option<u64>,
    /// Limits that changed the torque, as bits of [`control::ActiveLimits`].
    pub limits: Option<u16>,
    /// The steer torque the assist commanded, positive to the right \[N m\].
    pub torque: Option<f32>,
    /// Whether the rider's switch requests assist.
    pub engage: Option<bool>,
    /// Fraction of the torque that is permitted, 0 to 1.
    pub authority: Option<f32>,
    /// Rate about the forward axis, positive to the right \[rad/s\].
    pub measured_roll_rate: Option<f32>,
    /// Steer angle, positive to the right \[rad\].
    pub measured_steer: Option<f32>,
    /// Rear wheel's forward speed \[m/s\].
    pub measured_rear_speed: Option<f32>,
    /// The torque that the drive reports, positive to the right \[N m\].
    pub measured_motor_torque: Option<f32>,
    /// Next action of the polarity check, as the number of [`control::sensors::polarity::PolarityStep`].
    pub polarity: Option<u8>,
    /// The lower half of `causes`, which has more bits than a double holds exactly.
    pub causes_low: Option<u32>,
    /// The upper half of `causes`.
    pub causes_high: Option<u32>,
}

/// The frames of one broadcast, as far as they arrived.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Broadcast {
    /// Time of its first frame since the first of all, by the receiver's clock \[s\].
    pub t: f64,
    /// The state frame.
    pub state: Option<State>,
    /// The motion frame.
    pub motion: Option<Motion>,
    /// The causes frame.
    pub causes: Option<Causes>,
    /// Jump of the receiver's clock ahead, just before it or between two of its frames \[s\]; `None` if there was none.
    pub clock_jump_s: Option<f64>,
}

/// Frames received, and what was wrong with them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BroadcastCounts {
    /// Frames of the board that were decoded.
    pub frames: u64,
    /// Frames of the board that did not arrive, by the times of the others and [`PERIOD_MS`], without the time of
    /// [`Self::clock_jumps`].
    pub missing: u64,
    /// Frames with the board's identifiers and another length than 8 bytes.
    pub wrong_length: u64,
    /// Frames with the board's identifiers whose mode or polarity step this program does not know.
    pub unknown: u64,
    /// Frames with other identifiers.
    pub other: u64,
    /// Broadcasts in which the count of control steps stood still: control had stopped.
    pub stopped: u64,
    /// Times that were before that of the previous frame.
    pub time_backs: u64,
    /// Steps of the receiver's clock ahead, as when a logger gets its date: more than [`JUMP_S`] between two broadcasts
    /// between which the board's control steps are those of one period. One real gap in 64 looks the same, as the count has eight bits.
    pub clock_jumps: u64,
}

/// State from the frames so far.
#[derive(Clone, Debug, Default)]
pub struct BroadcastMonitor {
    /// The counts.
    pub counts: BroadcastCounts,
    /// The newest whole or partial broadcast that has ended.
    pub newest: Option<Broadcast>,
    /// Time of the first frame, by the receiver's clock \[s\].
    pub start_s: Option<f64>,
    /// Time of the last frame \[s\].
    last_s: f64,
    open: Option<Broadcast>,
    /// Control steps between the last two broadcasts without a gap.
    steps_each: Option<u8>,
}

/// Time between two broadcasts \[s\].
const PERIOD_S: f64 = PERIOD_MS as f64 / 1e3;
/// Shortest time without a broadcast that may be a jump of the clock \[s\]: fifty periods.
pub const JUMP_S: f64 = 1.0;

impl BroadcastMonitor {
    /// Processes a data frame that arrived at `time_s`; returns the broadcasts that are thereby complete or over.
    pub fn take(&mut self, time_s: f64, identifier: Option<u16>, data: &[u8]) -> Vec<Broadcast> {
        let Some(identifier) = identifier.filter(|id| (link::can::STATE..=link::can::CAUSES).contains(id))
        else {
            self.counts.other += 1;
            return Vec::new();
        };
        let Ok(bytes) = data.try_into() else {
            self.counts.wrong_length += 1;
            return Vec::new();
        };
        let Some(message) = Message::of(&Frame { identifier, bytes }) else {
            self.counts.unknown += 1;
            return Vec::new();
        };
        let start_s = *self.start_s.get_or_insert(time_s);
        if self.counts.frames > 0 && time_s < self.last_s {
            self.counts.time_backs += 1;
        }
        self.counts.frames += 1;
        self.last_s = time_s;
        // A double has steps of 0.24 us in seconds since 1970.
        let t = ((time_s - start_s) * 1e6).round() / 1e6;
        // A frame of the same kind, or one that is late by half a period, belongs to the next broadcast.
        let over = self.open.filter(|open| open.has(&message) || (t - open.t).abs() > PERIOD_S / 2.0);
        let mut done: Vec<Broadcast> = over.into_iter().collect();
        let mut open =
            self.open.filter(|_| over.is_none()).unwrap_or(Broadcast { t, ..Broadcast::default() });
        open.add(message);
        self.open = Some(open);
        if open.is_whole() {
            done.extend(self.open.take());
        }
        done.iter_mut().for_each(|broadcast| self.count(broadcast, broadcast.absent()));
        done
    }

    /// The last broadcast, if it is incomplete.
    pub fn end(&mut self) -> Option<Broadcast> {
        let mut last = self.open.take()?;
        // Reception may also end in the middle of one.
        self.count(&mut last, 0);
        Some(last)
    }

    /// Counts a broadcast and what is missing before and in it.
    fn count(&mut self, broadcast: &mut Broadcast, absent: u64) {
        let before = self.newest;
        if let Some(before) = before {
            broadcast.clock_jump_s = self.clock_jump(&before, broadcast);
        }
        self.newest = Some(*broadcast);
        // Reception may begin in the middle of a broadcast.
        let Some(before) = before else { return };
        if broadcast.clock_jump_s.is_some() {
            self.counts.clock_jumps += 1;
            // The frames of a broadcast in the middle of which the clock jumped are in two rows.
            let halves = broadcast.completes(&before);
            let counted = if halves { before.absent() } else { 0 };
            let absent = if halves { 0 } else { absent };
            self.counts.missing = self.counts.missing.saturating_add(absent).saturating_sub(counted);
            return;
        }
        let periods = ((broadcast.t - before.t) / PERIOD_S).round().max(1.0) as u64;
        let missing = (periods - 1).saturating_mul(3).saturating_add(absent);
        self.counts.missing = self.counts.missing.saturating_add(missing);
        // After a gap the byte may have the same value by chance.
        let steps = steps_between(&before, broadcast).filter(|_| periods == 1);
        self.steps_each = steps.or(self.steps_each);
        self.counts.stopped += u64::from(steps == Some(0));
    }

    /// The jump of the receiver's clock before a broadcast \[s\]: a long time in which the board took the control steps of
    /// one period, or none if they are two parts of one broadcast.
    fn clock_jump(&self, before: &Broadcast, broadcast: &Broadcast) -> Option<f64> {
        let halves = broadcast.completes(before);
        let ahead_s = broadcast.t - before.t - if halves { 0.0 } else { PERIOD_S };
        // While control is stopped the count can't tell.
        let each = self.steps_each.filter(|each| *each > 0);
        let one_period = each.is_some() && steps_between(before, broadcast) == each;
        (ahead_s > JUMP_S && (halves || one_period)).then_some(ahead_s)
    }
}

/// Control steps from one broadcast to the next, modulo 256; `None` if one has no state.
fn steps_between(before: &Broadcast, broadcast: &Broadcast) -> Option<u8> {
    Some(broadcast.state?.steps.wrapping_sub(before.state?.steps))
}

impl Broadcast {
    /// Whether both are two parts of a whole one, `before` the first.
    fn completes(&self, before: &Self) -> bool {
        let (mine, theirs) = (self.kinds(), before.kinds());
        // The frames of a broadcast come in this order.
        (1..3).any(|k| (0..3).all(|i| theirs[i] == (i < k) && mine[i] == (i >= k)))
    }

    /// Whether there is a state, a motion, and a causes frame.
    fn kinds(&self) -> [bool; 3] {
        [self.state.is_some(), self.motion.is_some(), self.causes.is_some()]
    }

    fn has(&self, message: &Message) -> bool {
        match message {
            Message::State(_) => self.state.is_some(),
            Message::Motion(_) => self.motion.is_some(),
            Message::Causes(_) => self.causes.is_some(),
        }
    }

    fn add(&mut self, message: Message) {
        match message {
            Message::State(state) => self.state = Some(state),
            Message::Motion(motion) => self.motion = Some(motion),
            Message::Causes(causes) => self.causes = Some(causes),
        }
    }

    fn absent(&self) -> u64 {
        self.kinds().map(|present| u64::from(!present)).iter().sum()
    }

    fn is_whole(&self) -> bool {
        self.absent() == 0
    }

    /// The broadcast as a row.
    pub fn row(&self) -> BroadcastRow {
        let Self { t, state, motion, causes, .. } = *self;
        let motion = motion.unwrap_or_default();
        BroadcastRow {
            t,
            steps_low: state.map(|state| state.steps),
            driven: state.map(|state| state.driven),
            mode: state.map(|state| state.mode as u8),
            causes: causes.map(|causes| causes.0),
            limits: state.map(|state| state.limits.0),
            torque: motion.commanded_nm,
            engage: state.map(|state| state.engage),
            authority: state.and_then(|state| state.authority),
            measured_roll_rate: motion.roll_rate_rad_s,
            measured_steer: motion.steer_rad,
            measured_rear_speed: state.and_then(|state| state.speed_m_s),
            measured_motor_torque: motion.measured_nm,
            polarity: state.map(|state| state.polarity as u8),
            causes_low: causes.map(|causes| causes.0 as u32),
            causes_high: causes.map(|causes| (causes.0 >> 32) as u32),
        }
    }
}
