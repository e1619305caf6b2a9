//! Generators of limits and sequences of calls, and a reference of the limits: directly from their definitions, in f64,
//! with the complete history.

use control::safety::guard::slack;
use control::safety::limiter::TorqueRequest;
use control::safety::limits::*;
use proptest::collection::vec;
use proptest::option::of;
use proptest::prelude::*;

/// No torque requested, no sensor valid, at 5 m/s, one millisecond after the last call.
pub(crate) fn plain() -> TorqueRequest {
    TorqueRequest {
        wanted_nm: 0.0,
        authority: 1.0,
        limp: false,
        speed_low_m_s: 5.0,
        speed_high_m_s: 5.0,
        steer_rad: None,
        steer_rate_rad_s: None,
        rider_torque_nm: None,
        elapsed_us: 1000,
    }
}

/// A request of only a torque and a speed.
pub(crate) fn at_speed(wanted_nm: f32, speed: f32) -> TorqueRequest {
    TorqueRequest { wanted_nm, speed_low_m_s: speed, speed_high_m_s: speed, ..plain() }
}

/// The mirror image of a request.
pub(crate) fn mirrored(request: &TorqueRequest) -> TorqueRequest {
    TorqueRequest {
        wanted_nm: -request.wanted_nm,
        steer_rad: request.steer_rad.map(|x| -x),
        steer_rate_rad_s: request.steer_rate_rad_s.map(|x| -x),
        rider_torque_nm: request.rider_torque_nm.map(|x| -x),
        ..*request
    }
}

/// Arbitrary valid limits, and a call rate \[Hz\].
pub(crate) fn tables() -> impl Strategy<Value = (Limits, f32)> {
    let cap = (vec(0.1_f32..5.0, CAP_POINTS), vec(0.0_f32..50.0, CAP_POINTS)).prop_map(|(gaps, torques)| {
        let mut cap = SpeedCap::default();
        let mut speed = 0.0;
        for (i, (gap, torque)) in gaps.into_iter().zip(torques).enumerate() {
            speed += gap + 1e-3;
            (cap.speed_m_s[i], cap.torque_nm[i]) = (speed, torque);
        }
        cap
    });
    let taper = (0.0_f32..4.0, 0.101_f32..5.0)
        .prop_map(|(zero_m_s, width)| Taper { zero_m_s, full_m_s: zero_m_s + width });
    let rider_torque_limit = (0.0_f32..10.0, 0.1_f32..20.0)
        .prop_map(|(allowance_nm, multiplier)| RiderTorque { allowance_nm, multiplier });
    let rider_motion_limit =
        (0.05_f32..10.0, 0_u16..300, 1_u16..300).prop_map(|(steer_rate_rad_s, after_ms, fade_ms)| {
            RiderMotion { steer_rate_rad_s, after_ms, fade_ms }
        });
    let window = (10_u16..600, 0.1_f32..20.0).prop_map(|(ms, nm)| Window { ms, nm });
    let stop = (0.0_f32..1.5, 0.011_f32..1.5)
        .prop_map(|(soft_rad, width)| EndStop { soft_rad, hard_rad: soft_rad + width });
    let rate = || of((0.0_f32..5.0).prop_map(|exponent| 10_f32.powf(exponent)));
    let numbers = (of(0.1_f32..50.0), rate(), rate(), any::<bool>(), of(0.0_f32..1.0));
    let groups = (of(cap), of(taper), of(rider_torque_limit), of(rider_motion_limit), of(window), of(stop));
    (numbers, groups, 100.0_f32..10_000.0).prop_map(|(numbers, groups, rate_hz)| {
        let (max_torque_nm, rise_nm_s, fall_nm_s, same, limp_fraction) = numbers;
        let (speed_cap, taper, rider_torque, rider_motion, window, end_stop) = groups;
        let rider_torque = rider_torque.filter(|_| max_torque_nm.is_some());
        let fall_nm_s = if same { rise_nm_s } else { fall_nm_s };
        let table = Limits {
            max_torque_nm,
            speed_cap,
            taper,
            rise_nm_s,
            fall_nm_s,
            rider_torque,
            rider_motion,
            window,
            end_stop,
            limp_fraction,
        };
        assert_eq!(table.validate(), Ok(()));
        (table, rate_hz)
    })
}

fn wild() -> impl Strategy<Value = f32> {
    prop_oneof![any::<u32>().prop_map(f32::from_bits), Just(f32::NAN), Just(f32::INFINITY)]
}

/// A value that is sometimes missing and mostly within `bound`.
fn sensor(bound: f32) -> impl Strategy<Value = Option<f32>> {
    prop_oneof![
        8 => (-bound..bound).prop_map(Some),
        2 => Just(None),
        1 => wild().prop_map(Some),
    ]
}

fn call() -> impl Strategy<Value = TorqueRequest> {
    let requested = prop_oneof![10 => -60.0_f32..60.0, 10 => -8.0_f32..8.0, 2 => Just(0.0), 1 => wild()];
    let authority = prop_oneof![6 => Just(1.0_f32), 2 => 0.0_f32..1.0, 1 => Just(0.0), 1 => wild()];
    let speed = || prop_oneof![12 => -1.0_f32..12.0, 1 => wild()];
    let elapsed = prop_oneof![6 => Just(1000_u32), 12 => 100_u32..10_000, 1 => Just(0), 1 => any::<u32>()];
    let sensors = (sensor(2.0), sensor(12.0), sensor(15.0));
    (requested, authority, any::<bool>(), (speed(), speed()), sensors, elapsed).prop_map(
        |(wanted_nm, authority, limp, speeds, (steer, rate, rider), elapsed_us)| TorqueRequest {
            wanted_nm,
            authority,
            limp,
            speed_low_m_s: speeds.0,
            speed_high_m_s: speeds.1,
            steer_rad: steer,
            steer_rate_rad_s: rate,
            rider_torque_nm: rider,
            elapsed_us,
        },
    )
}

/// A sequence of calls: periods of one call or many in which all but the time is constant.
pub(crate) fn calls(runs: std::ops::Range<usize>) -> impl Strategy<Value = Vec<TorqueRequest>> {
    let run = (call(), prop_oneof![Just(1_usize), 1_usize..60], any::<bool>());
    vec(run, runs).prop_map(|runs| {
        let mut all: Vec<TorqueRequest> = Vec::new();
        for (request, times, steady) in runs {
            let steady = steady && request.elapsed_us < 20_000;
            all.extend(vec![request; if steady { times } else { 1 }]);
        }
        all
    })
}

/// Reference model of the limits with the complete history.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    table: Limits,
    period_s: f64,
    last: f64,
    against_us: f64,
    /// Torques with the time at which each ended \[us\], the newest last.
    history: Vec<(f64, f64)>,
    now_us: f64,
}

impl Reference {
    /// A torque that has always been zero.
    pub(crate) fn new(table: &Limits, rate_hz: f32) -> Self {
        let period_s = 1.0 / f64::from(rate_hz);
        Self {
            table: *table,
            period_s,
            last: 0.0,
            against_us: 0.0,
            history: vec![(f64::INFINITY, 0.0)],
            now_us: 0.0,
        }
    }

    /// Clears the history.
    pub(crate) fn clear(&mut self) {
        (self.last, self.against_us, self.history) = (0.0, 0.0, vec![(self.now_us, 0.0)]);
    }

    /// Advances the time.
    pub(crate) fn wait(&mut self, request: &TorqueRequest) {
        let elapsed = f64::from(request.elapsed_us);
        self.now_us += elapsed;
        self.history.push((self.now_us, self.last));
        if let Some(r) = self.table.rider_motion {
            let back = request.steer_rate_rad_s.map_or(0.0, |rate| -f64::from(rate) * self.last.signum());
            let against = self.last != 0.0 && back > f64::from(r.steer_rate_rad_s);
            let whole = 1e3 * (f64::from(r.after_ms) + f64::from(r.fade_ms));
            self.against_us = (self.against_us + if against { elapsed } else { -elapsed }).clamp(0.0, whole);
        }
    }

    /// Records the output torque.
    pub(crate) fn output(&mut self, torque: f32) {
        self.last = f64::from(torque);
    }

    /// Excess of the torque over its limits \[N m\], and the part of it that rounding can explain; over the fraction
    /// `part` of the window.
    pub(crate) fn excess(&self, torque: f32, request: &TorqueRequest, part: f64) -> (f64, f64) {
        let rounding = f64::from(slack(torque, self.last as f32));
        let torque = f64::from(torque);
        let size = torque.abs();
        let side = if torque < 0.0 || (torque == 0.0 && self.last < 0.0) { -1.0 } else { 1.0 };
        let previous = self.last * side;
        let elapsed = f64::from(request.elapsed_us) * 1e-6;
        let [rise, fall] =
            [self.table.rise_nm_s, self.table.fall_nm_s].map(|r| r.map_or(f64::INFINITY, f64::from));
        // The time resolution of one microsecond counts in favour of the torque.
        let (least, most) = (elapsed.min(self.period_s), (elapsed + 1e-6).min(self.period_s));
        let cap = self.caps(side, request);
        let back = if fall.is_finite() && previous > 0.0 { previous - fall * least } else { 0.0 };
        let beyond = (size - cap.max(back)).max(0.0) * f64::from(u8::from(size > 0.0));
        let absolute = self.table.max_torque_nm.map_or(0.0, |max| size - f64::from(max));
        let (up, down) = if previous >= 0.0 {
            let down = if fall.is_finite() { previous - fall * most } else { 0.0 };
            (previous + rise * most, down)
        } else {
            let to_zero = if fall.is_finite() { -previous / fall } else { 0.0 };
            let left = most - to_zero;
            (if left > 0.0 { rise * left } else { 0.0 }, 0.0)
        };
        let window = self.table.window.map_or(0.0, |w| {
            let since = self.now_us - part * 1e3 * f64::from(w.ms);
            let recent = self.history.iter().rev().take_while(|(end, _)| *end >= since);
            let start = recent.map(|(_, t)| t * side).fold(f64::INFINITY, f64::min);
            size - start.max(0.0) - f64::from(w.nm)
        });
        let steep = match (rise.is_finite(), fall.is_finite()) {
            (true, true) if previous < 0.0 => 1.0 + rise / fall,
            // Rounding of the time to zero alone decides between any torque on the other side and none.
            (false, true) if previous < 0.0 => {
                let tolerance = f64::from(slack(0.0, self.last as f32)) / fall + 2e-5 * most;
                if (-previous / fall - most).abs() <= tolerance { f64::INFINITY } else { 1.0 }
            }
            _ => 1.0,
        };
        let worst = [beyond, absolute, size - up, down - size, window].into_iter().fold(0.0, f64::max);
        let scale =
            f64::from(self.table.max_torque_nm.unwrap_or(0.0)) + (rise.min(1e5) + fall.min(1e5)) * most;
        (worst, (rounding + 1e-5 * scale) * steep * 3.0)
    }

    /// The largest torque on a side that bicycle, rider and permission allow.
    fn caps(&self, side: f64, request: &TorqueRequest) -> f64 {
        let table = &self.table;
        let max = table.max_torque_nm.map_or(f64::from(f32::MAX), f64::from);
        let fraction = |x: f64| if x > 0.0 { x.min(1.0) } else { 0.0 };
        let finite = |x: Option<f32>| x.filter(|x| x.is_finite()).map(f64::from);
        let mut cap = max * fraction(f64::from(request.authority));
        if let (Some(part), true, Some(max)) = (table.limp_fraction, request.limp, table.max_torque_nm) {
            cap = cap.min(f64::from(part) * f64::from(max));
        }
        let (a, b) = (f64::from(request.speed_low_m_s), f64::from(request.speed_high_m_s));
        let (slow, fast) = if a.is_nan() || b.is_nan() { (-1e9, 1e9) } else { (a.min(b), a.max(b)) };
        if let Some(c) = table.speed_cap {
            let points: Vec<(f64, f64)> =
                c.speed_m_s.iter().zip(&c.torque_nm).map(|(v, t)| (f64::from(*v), f64::from(*t))).collect();
            let at = |v: f64| {
                let after = points.iter().position(|p| v <= p.0);
                match after {
                    Some(0) => points[0].1,
                    None => points[CAP_POINTS - 1].1,
                    Some(i) => {
                        let ((v0, t0), (v1, t1)) = (points[i - 1], points[i]);
                        t0 + (t1 - t0) * (v - v0) / (v1 - v0)
                    }
                }
            };
            let inside = points.iter().filter(|p| slow < p.0 && p.0 < fast).map(|p| p.1);
            cap = inside.chain([at(slow), at(fast)]).fold(cap, f64::min);
        }
        if let Some(t) = table.taper {
            let (zero, full) = (f64::from(t.zero_m_s), f64::from(t.full_m_s));
            cap = cap.min(max * fraction((slow - zero) / (full - zero)));
        }
        if let (Some(r), Some(rider)) = (table.rider_torque, finite(request.rider_torque_nm)) {
            let band = max + (f64::from(r.allowance_nm) + rider * side) * f64::from(r.multiplier);
            cap = cap.min(band.max(0.0));
        }
        if let Some(r) = table.rider_motion {
            let beyond_us = self.against_us - 1e3 * f64::from(r.after_ms);
            cap = cap.min(max * fraction(1.0 - beyond_us / (1e3 * f64::from(r.fade_ms))));
        }
        if let (Some(e), Some(steer)) = (table.end_stop, finite(request.steer_rad)) {
            let (soft, hard) = (f64::from(e.soft_rad), f64::from(e.hard_rad));
            cap = cap.min(max * fraction((hard - steer * side) / (hard - soft)));
        }
        cap
    }
}
