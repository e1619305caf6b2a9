//! Settings of the disturbance: one ride, the search of a basin, of a plane.

use super::{PLAIN, Setting};
use crate::ride::Start;
use crate::scenario::search::Speeds;
use crate::scenario::{Scenario, TextError, speeds, text};

/// The search of a basin.
pub const SEARCH: &[Setting] = &[
    Setting {
        name: "speeds",
        key: "search.speeds",
        value: "A:B:STEP",
        help: "Forward speeds in m/s: A:B:STEP, B included, or one [default: 0:10:0.1; 2:7.5:0.1 with a rider]",
        set: |s, text| {
            speeds::parse(text)?;
            s.search.speeds = Some(Speeds::Range(text.into()));
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "axis",
        key: "search.axis",
        value: "AXIS",
        help: "The rate that is disturbed at t = 0",
        default: Some("steer-rate"),
        words: &[("steer-rate", "The steer rate"), ("roll-rate", "The roll rate")],
        hyphen: false,
        set: |s, text| {
            s.search.axis = text::word(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "max-rate",
        key: "search.max_rate",
        value: "RAD/S",
        help: "Largest disturbance tried, in rad/s",
        default: Some("30"),
        set: |s, text| {
            s.search.max_rate = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "scan-step",
        key: "search.scan_step",
        value: "RAD/S",
        help: "Step of the scan, in rad/s; narrower islands or gaps can be missed",
        default: Some("0.25"),
        set: |s, text| {
            s.search.scan_step = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "tolerance",
        key: "search.tolerance",
        value: "RAD/S",
        help: "Accuracy of the borders, in rad/s",
        default: Some("0.01"),
        set: |s, text| {
            s.search.tolerance = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "search",
        key: "search.method",
        value: "METHOD",
        help: "How the rides are simulated. fast: long steps find the borders, and exact rides confirm them, if only \
               controller, constant delays and rider act (docs/performance.md); plain: every ride exact and to its end",
        default: Some("fast"),
        words: &[("fast", "Long steps, confirmed by exact rides"), ("plain", "Every ride exact")],
        set: |s, text| {
            s.search.method = text::word(text)?;
            Ok(())
        },
        ..PLAIN
    },
];

/// Further speeds of a basin.
pub const ADAPTIVE: &[Setting] = &[Setting {
    name: "adaptive-speeds",
    key: "search.adaptive_speeds",
    value: "TOLERANCE",
    help: "Add speeds between the given ones where the outline bends or jumps by more than TOLERANCE times the largest height [without a value: 0.01]",
    alone: Some("0.01"),
    hyphen: false,
    set: |s, text| {
        s.search.adaptive_speeds = Some(text::number(text)?);
        Ok(())
    },
    ..PLAIN
}];

/// The numbers of drawn bicycles and of drawn riders.
pub const UNCERTAIN: &[Setting] = &[BICYCLE_DRAWS, RIDER_DRAWS];

const BICYCLE_DRAWS: Setting = Setting {
    name: "uncertain",
    key: "uncertain",
    value: "N",
    help: "Also compute the basins of N bicycles drawn from the uncertainties of the bicycle's parameters, 2 to 10000, as a band from the 5 % to the 95 % quantile of their heights; --seed changes the draws",
    set: |s, text| {
        let count = text::whole(text).ok().filter(|count| DRAWS.contains(count));
        s.uncertain = Some(count.ok_or_else(|| TextError::Draws(text.into()))?);
        Ok(())
    },
    ..PLAIN
};

const RIDER_DRAWS: Setting = Setting {
    name: "rider-draws",
    key: "rider_draws",
    value: "N",
    help: "Also compute the basins of N riders drawn from the covariances of the rider's gains, 2 to 10000, or from the sets in its groups if there are none, as a band from the 5 % to the 95 % quantile of their heights; --seed changes the draws",
    set: |s, text| {
        let count = text::whole(text).ok().filter(|count| DRAWS.contains(count));
        s.rider_draws = Some(count.ok_or_else(|| TextError::Draws(text.into()))?);
        Ok(())
    },
    ..PLAIN
};

/// Allowed numbers of drawn bicycles or riders.
pub(in crate::scenario) const DRAWS: std::ops::RangeInclusive<u32> = 2..=10_000;

/// The disturbance of one ride.
pub const START: &[Setting] = &[
    Setting {
        name: "speed",
        key: "start.speed_m_s",
        value: "M/S",
        help: "Forward speed at the start, in m/s; below 0 only with --law none: backwards, as with a steered rear wheel",
        required: true,
        set: |s, text| {
            start(s).speed_m_s = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "steer-rate",
        key: "start.steer_rate_rad_s",
        value: "RAD/S",
        help: "Steer rate at the start, in rad/s, right positive",
        default: Some("0"),
        set: |s, text| {
            start(s).steer_rate_rad_s = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "roll-rate",
        key: "start.roll_rate_rad_s",
        value: "RAD/S",
        help: "Roll rate at the start, in rad/s, right positive",
        default: Some("0"),
        set: |s, text| {
            start(s).roll_rate_rad_s = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
];

/// The initial state; its speed is unknown (NaN) until it is set.
fn start(scenario: &mut Scenario) -> &mut Start {
    scenario.start.get_or_insert(Start { speed_m_s: f64::NAN, ..Start::default() })
}

/// The search of a plane.
pub const PLANE: &[Setting] = &[
    Setting {
        name: "speed",
        key: "plane.speed",
        value: "M/S",
        help: "Forward speed, in m/s",
        required: true,
        set: |s, text| {
            s.plane.get_or_insert_default().speed = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "rays",
        key: "plane.rays",
        value: "N",
        help: "Number of directions over half a turn, 2 to 10000; the other half is the mirror image",
        default: Some("60"),
        hyphen: false,
        set: |s, text| {
            s.plane.get_or_insert_default().rays = text::whole(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "max-steer-rate",
        key: "plane.max_steer_rate",
        value: "RAD/S",
        help: "Largest steer rate tried, in rad/s",
        default: Some("20"),
        set: |s, text| {
            s.plane.get_or_insert_default().max_steer_rate = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "max-roll-rate",
        key: "plane.max_roll_rate",
        value: "RAD/S",
        help: "Largest roll rate tried, in rad/s",
        default: Some("4"),
        set: |s, text| {
            s.plane.get_or_insert_default().max_roll_rate = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "points",
        key: "plane.points",
        value: "N",
        help: "Rides of the scan along each ray; an island or gap narrower than their distance can be missed",
        default: Some("80"),
        hyphen: false,
        set: |s, text| {
            s.plane.get_or_insert_default().points = text::whole(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "ray-tolerance",
        key: "plane.tolerance",
        value: "PART",
        help: "Accuracy of borders, as a fraction of a ray",
        default: Some("0.0005"),
        set: |s, text| {
            s.plane.get_or_insert_default().tolerance = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "ray-search",
        key: "plane.method",
        value: "METHOD",
        help: "How the rides are simulated. fast: long steps find the borders, and exact rides confirm them, if only \
               controller, constant delays and rider act (docs/performance.md); plain: every ride exact and to its end",
        default: Some("fast"),
        words: &[("fast", "Long steps, confirmed by exact rides"), ("plain", "Every ride exact")],
        set: |s, text| {
            s.plane.get_or_insert_default().method = text::word(text)?;
            Ok(())
        },
        ..PLAIN
    },
];
