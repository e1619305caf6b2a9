//! Settings of the rider.

use super::{PLAIN, Setting};
use crate::range::time;
use crate::rider::MAX_DELAY_S;
use crate::scenario::text;

/// The rider alone.
pub const RIDERS: &[Setting] = &[RIDER, GAINS, DELAY, GAINS_OUTSIDE];

pub(super) const RIDER: Setting = Setting {
    name: "rider",
    key: "rider.table",
    value: "NAME|FILE",
    help: "Rider: a built-in one (see `rider list`), a table FILE, or none [default: none, a rigid rider, hands off]",
    hyphen: false,
    set: |s, text| {
        s.rider.table = Some(text.into());
        Ok(())
    },
    ..PLAIN
};

pub(super) const GAINS: Setting = Setting {
    name: "gains",
    key: "rider.gains",
    long_name: "fit of the rider's gains",
    value: "GAINS",
    help: "Fit of the rider's gains over speed [default: mean]",
    words: &[
        (
            "regression",
            "One straight line per gain (LR in the thesis): the table's own `regression`, otherwise least squares over all sets",
        ),
        ("mean", "Straight lines through the groups' means, at the mean of their speeds (LI, mean)"),
        ("best", "Straight lines through each group's best set, at that set's speed (LI, HV)"),
        (
            "spline",
            "A smoothing spline per gain through all sets, weighted by their standard errors, if there, or the groups' scatter",
        ),
    ],
    hyphen: false,
    set: |s, text| {
        s.rider.gains = Some(text::word(text)?);
        Ok(())
    },
    ..PLAIN
};

pub(super) const DELAY: Setting = Setting {
    name: "delay",
    key: "rider.delay_s",
    long_name: "neural delay of the rider",
    value: "TIME",
    help: "The rider's neural delay, 0 to 1 s, for example 60ms [default: the table's own]",
    set: |s, text| {
        s.rider.delay_s = Some(time(text, MAX_DELAY_S)?);
        Ok(())
    },
    ..PLAIN
};

pub(super) const GAINS_OUTSIDE: Setting = Setting {
    name: "gains-outside",
    key: "rider.outside",
    long_name: "gains of the rider beyond the measured speeds",
    value: "GAINS_OUTSIDE",
    help: "The rider's gains beyond the measured speeds [default: extrapolate]",
    words: &[
        ("extrapolate", "The outermost straight lines are extrapolated, as published"),
        ("hold", "The outermost gains are held"),
    ],
    hyphen: false,
    set: |s, text| {
        s.rider.outside = Some(text::word(text)?);
        Ok(())
    },
    ..PLAIN
};
