//! From a recording and its map to the samples of each sensor.

use super::leap::leaps;
use super::map::{Map, Mapped, Signal, Source, axes_of, quantity_of};
use super::plausible::plausible;
use super::samples::{Sample, Samples, Track};
use super::unit::Quantity;
use crate::plant::Sensor;
use crate::recording::{Column, Group, Recording, Remark};

/// A row is left out if its time is this far ahead of its neighbours' \[s\].
const LEAP_S: f64 = 1.0;

/// Applies a map to a recording whose ages are counted in periods of `period_s`.
///
/// # Errors
/// Time, gyro or wheel speed missing; a sensor of the map recorded in part only.
pub fn samples(recording: &Recording, map: &Map, period_s: f64) -> Result<Samples, Remark> {
    let mut all = Samples { remarks: recording.remarks.clone(), ..Samples::default() };
    for Mapped { sensor, signal } in map.sensors() {
        all.absent.extend(absent(recording, sensor, signal));
        match find(recording, sensor, signal)? {
            None => {}
            Some(Found { axes, .. }) if axes.iter().any(Axis::is_blank) => {
                let names: Vec<_> = signal.columns.iter().map(ToString::to_string).collect();
                all.absent.push(format!("{} (no value in {})", sensor.name(), names.join(", ")));
            }
            Some(Found { group, axes, made_up }) => {
                let track = take(group, map, sensor, signal, &axes, made_up, period_s, &mut all)?;
                if let Some(track) = track {
                    plausible(&track, &mut all.remarks);
                    all.tracks.push(track);
                }
            }
        }
    }
    let has = |sensor| all.track(sensor).is_some();
    let lacks = if !has(Sensor::Gyro) {
        Some(Sensor::Gyro)
    } else if !has(Sensor::FrontWheel) && !has(Sensor::RearWheel) {
        Some(Sensor::RearWheel)
    } else {
        None
    };
    if let Some(sensor) = lacks {
        return Err(unusable(&all, sensor).unwrap_or_else(|| missing(recording, map, sensor)));
    }
    if let Some(switch) = &map.engage {
        let Some((group, column)) = column(recording, &switch.column) else {
            return Err(Remark::of_column(
                Some(&switch.column),
                "no such column; the map assigns it to the switch".into(),
            ));
        };
        let times = times(group, map, None)?;
        let on = |(t_s, value): (f64, &f64)| (t_s, *value != 0.0);
        all.engage = times.into_iter().zip(&column.values).filter(|(_, v)| !v.is_nan()).map(on).collect();
    }
    for (signal, quantity, to) in [
        (&map.reference.roll, Quantity::Angle, &mut all.roll_rad),
        (&map.reference.torque, Quantity::Torque, &mut all.torque_nm),
        (&map.reference.distance, Quantity::Length, &mut all.distance_m),
    ] {
        if let Some(signal) = signal
            && let [Source::Column(name)] = signal.columns.as_slice()
            && let Some((group, column)) = column(recording, name)
        {
            let factor = quantity.factor(signal.unit.as_deref()).unwrap_or(1.0);
            let value = |value: &f64| factor * (signal.scale * value + signal.offset);
            let times = times(group, map, signal.time.as_deref())?;
            *to =
                times.into_iter().zip(column.values.iter().map(value)).filter(|(_, v)| !v.is_nan()).collect();
        }
    }
    Ok(all)
}

/// The columns of a sensor that the recording lacks.
fn absent(recording: &Recording, sensor: Sensor, signal: &Signal) -> Option<String> {
    let lacks =
        |source: &&Source| matches!(source, Source::Column(name) if column(recording, name).is_none());
    let names: Vec<_> = signal.columns.iter().filter(lacks).map(ToString::to_string).collect();
    (!names.is_empty()).then(|| format!("{} ({})", sensor.name(), names.join(", ")))
}

/// Why a recorded sensor has no samples: the first remark about it.
fn unusable(all: &Samples, sensor: Sensor) -> Option<Remark> {
    let name = sensor.name();
    let few = || {
        let mut noted = all.remarks.iter().map(|remark| &remark.what);
        noted.find(|what| what.starts_with(&format!("{name}: ")) && what.contains("usable sample"))
    };
    let blank = all.absent.iter().find(|what| what.starts_with(&format!("{name} (no value")));
    let reason = blank.or_else(few)?;
    let first = all.remarks.iter().find(|noted| noted.line.is_some());
    let first = first.map_or(String::new(), |noted| format!("; {noted}"));
    Some(Remark::of_column(None, format!("{reason}{first}")))
}

/// The error for a missing sensor without which there is no replay.
fn missing(recording: &Recording, map: &Map, sensor: Sensor) -> Remark {
    let wanted = map.sensors().find(|mapped| mapped.sensor == sensor);
    let wanted = wanted.map_or("none".into(), |mapped| {
        let names: Vec<_> = mapped.signal.columns.iter().map(ToString::to_string).collect();
        names.join(", ")
    });
    let there: Vec<_> =
        recording.groups.iter().flat_map(|group| &group.columns).map(|column| column.name.as_str()).collect();
    let name = if sensor == Sensor::Gyro { "gyro" } else { "wheel speed" };
    Remark::of_column(
        None,
        format!("no {name}: the map names {wanted}; the recording has the columns {}", there.join(", ")),
    )
}

/// A column by its name, alone or preceded by its group's.
pub(super) fn column<'a>(recording: &'a Recording, name: &str) -> Option<(&'a Group, &'a Column)> {
    let of = |group: &'a Group, name: &str| group.columns.iter().find(|column| column.name == name);
    let plain = recording.groups.iter().find_map(|group| Some((group, of(group, name)?)));
    plain.or_else(|| {
        let (group, name) = name.split_once('.')?;
        let group = recording.groups.iter().find(|one| one.name == group)?;
        Some((group, of(group, name)?))
    })
}

/// Source of a sensor's axis.
enum Axis<'a> {
    Column(&'a Column),
    Constant(f64),
}

impl Axis<'_> {
    /// Whether it is a column without any value.
    fn is_blank(&self) -> bool {
        matches!(self, Self::Column(column) if column.values.iter().all(|value| value.is_nan()))
    }
}

struct Found<'a> {
    group: &'a Group,
    axes: Vec<Axis<'a>>,
    made_up: [bool; 3],
}

/// Substitute value of an axis that was not recorded \[SI\].
fn stand_in(sensor: Sensor, axis: usize) -> f64 {
    const GRAVITY: f64 = -9.81;
    if sensor == Sensor::Accel && axis == 2 { GRAVITY } else { 0.0 }
}

/// The columns of a sensor; `None` if none is recorded. Of gyro and accelerometer only the axis needed for roll is
/// required.
fn find<'a>(recording: &'a Recording, sensor: Sensor, signal: &Signal) -> Result<Option<Found<'a>>, Remark> {
    let mut group: Option<&Group> = None;
    let (mut axes, mut made_up, mut absent) = (Vec::new(), [false; 3], Vec::new());
    for (place, source) in signal.columns.iter().enumerate() {
        match source {
            Source::Constant(value) => {
                axes.push(Axis::Constant(*value));
                made_up[place] = true;
            }
            Source::Column(name) => match column(recording, name) {
                Some((at, found)) => {
                    if group.is_some_and(|group| !std::ptr::eq(group, at)) {
                        let what = "is in another message than the sensor's other axes".to_owned();
                        return Err(Remark::of_column(Some(name), what));
                    }
                    group = Some(at);
                    axes.push(Axis::Column(found));
                }
                None => {
                    absent.push((place, name.as_str()));
                    axes.push(Axis::Constant(f64::NAN));
                }
            },
        }
    }
    let Some(group) = group else { return Ok(None) };
    // The bicycle's x axis of a gyro and y axis of an accelerometer, as the recording's own axis.
    let needed = match sensor {
        Sensor::Gyro => Some(signal.turns()[0].0),
        Sensor::Accel => Some(signal.turns()[1].0),
        _ => None,
    };
    for (place, name) in absent {
        if needed.is_none() || needed == Some(place) {
            let what = format!("no such column; the map assigns it to {}", sensor.name());
            return Err(Remark::of_column(Some(name), what));
        }
        let to = signal.turns().iter().position(|(from, _)| *from == place).unwrap_or(place);
        let factor = quantity_of(sensor).factor(signal.unit.as_deref()).unwrap_or(1.0);
        let (_, sign) = signal.turns()[to];
        axes[place] = Axis::Constant((stand_in(sensor, to) * sign / factor - signal.offset) / signal.scale);
        made_up[to] = true;
    }
    Ok(Some(Found { group, axes, made_up }))
}

/// Time of each row of a group \[s\]; NaN where the row has none.
pub(super) fn times(group: &Group, map: &Map, own: Option<&str>) -> Result<Vec<f64>, Remark> {
    let time = map.time.as_ref();
    let factor = Quantity::Time.factor(time.and_then(|time| time.unit.as_deref())).unwrap_or(1.0);
    let named = |name: &str| {
        let found = group.columns.iter().find(|column| column.name == name);
        let values = |column: &Column| column.values.iter().map(|value| value * factor).collect();
        found.map(values).ok_or_else(|| {
            Remark::of_column(Some(name), "no such column; the map assigns it to the time".into())
        })
    };
    match (
        own,
        &group.times_s,
        time.and_then(|time| time.column.as_deref()),
        time.and_then(|time| time.rate_hz),
    ) {
        (Some(own), ..) => named(own),
        (None, Some(times_s), ..) => Ok(times_s.clone()),
        (None, None, Some(column), _) => named(column),
        (None, None, None, Some(rate_hz)) => {
            let rows = group.columns.first().map_or(0, |column| column.values.len());
            Ok((0..rows).map(|row| row as f64 / rate_hz).collect())
        }
        (None, None, None, None) => {
            Err(Remark::of_column(None, "neither the map nor the recording defines the time".into()))
        }
    }
}

/// The usable samples of rows, in rising order of time.
#[derive(Default)]
struct Rising {
    samples: Vec<Sample>,
    /// Row of each sample.
    rows: Vec<usize>,
    /// Rows far ahead of their neighbours, each with its time \[s\].
    ahead: Vec<(usize, f64)>,
    /// Number of rows without a later time than the sample before.
    back: u64,
    /// The first of these: its row, and the times of the sample before and its own \[s\].
    first_back: Option<(usize, f64, f64)>,
}

/// Selects the samples of rows in rising order of time. With `repeats_s` a sample that is less than this later than the last one
/// is the same, read again.
fn rising(of_rows: impl Iterator<Item = Sample>, repeats_s: Option<f64>) -> Rising {
    let Rising { mut samples, mut rows, mut ahead, mut back, mut first_back } = Rising::default();
    let usable =
        |(_, sample): &(usize, Sample)| sample.t_s.is_finite() && !sample.value.iter().any(|x| x.is_nan());
    for (row, sample) in of_rows.enumerate().filter(usable) {
        let t_s = sample.t_s;
        match samples.last() {
            // The same sample again, some periods older.
            Some(last) if repeats_s.is_some_and(|repeats_s| t_s < last.t_s + repeats_s) => {}
            // One row far ahead of its neighbours: its time is wrong, not theirs.
            Some(last)
                if t_s < last.t_s - LEAP_S && samples.iter().nth_back(1).is_none_or(|b| b.t_s < t_s) =>
            {
                ahead.push((rows.pop().unwrap_or(row), last.t_s));
                samples.pop();
                rows.push(row);
                samples.push(sample);
            }
            Some(last) if t_s <= last.t_s => {
                back += 1;
                first_back.get_or_insert((row, last.t_s, t_s));
            }
            _ => {
                rows.push(row);
                samples.push(sample);
            }
        }
    }
    Rising { samples, rows, ahead, back, first_back }
}

/// Reads a sensor's samples; unusable ones are left out with a remark. `None` if no row has a sample.
#[allow(clippy::too_many_arguments, reason = "one call; each is a different thing")]
fn take(
    group: &Group,
    map: &Map,
    sensor: Sensor,
    signal: &Signal,
    axes: &[Axis<'_>],
    made_up: [bool; 3],
    period_s: f64,
    all: &mut Samples,
) -> Result<Option<Track>, Remark> {
    let factor = quantity_of(sensor).factor(signal.unit.as_deref()).unwrap_or(1.0);
    let times = times(group, map, signal.time.as_deref())?;
    let of_age = |name: &String| {
        let found = group.columns.iter().find(|column| column.name == *name);
        found.ok_or_else(|| {
            Remark::of_column(Some(name), "no such column; the map assigns it to an age".into())
        })
    };
    let ages = signal.age.as_ref().map(of_age).transpose()?;
    let turns = signal.turns();
    let line_of = |row: usize| group.lines.get(row).copied();
    let at = |row: usize| {
        let cell = |axis: &Axis<'_>| match axis {
            Axis::Column(column) => column.values[row],
            Axis::Constant(value) => *value,
        };
        let mut own = [0.0; 3];
        for (own, axis) in own.iter_mut().zip(axes) {
            *own = factor * (signal.scale * cell(axis) + signal.offset);
        }
        let value = if axes_of(sensor) == 3 { turns.map(|(from, sign)| sign * own[from]) } else { own };
        let age_s = ages.map_or(0.0, |ages| ages.values[row] * period_s);
        Sample { t_s: times[row] - age_s + signal.late_s, value }
    };
    let repeats_s = ages.map(|_| 0.5 * period_s);
    let Rising { samples, rows, ahead, back, first_back } = rising((0..times.len()).map(at), repeats_s);
    let mut say = |line, what: String| {
        // Sensors of one row share this remark.
        let same = all.remarks.iter_mut().find(|noted| noted.line == line && noted.what.ends_with(&what));
        match same {
            Some(noted) => noted.what.insert_str(0, &format!("{}, ", sensor.name())),
            None => {
                let what = format!("{}: {what}", sensor.name());
                all.remarks.push(Remark { line, column: None, what });
            }
        }
    };
    for (row, t_s) in ahead {
        say(line_of(row), format!("time {t_s} s is ahead of the rows before and after it; row left out"));
    }
    let times: Vec<f64> = samples.iter().map(|sample| sample.t_s).collect();
    let leaps = leaps(&times, |at| line_of(rows[at]));
    leaps.iter().for_each(|leap| say(leap.line, leap.to_string()));
    if let Some((row, from, to)) = first_back {
        let verb = if from == to { "stands at" } else { "goes back from" };
        let to = if from == to { String::new() } else { format!(" to {to}") };
        let what = format!("time {verb} {from} s{to}; {back} rows without a later time left out");
        say(line_of(row), what);
    }
    all.leaps.extend(leaps);
    if samples.len() < 2 {
        let plural = if samples.len() == 1 { "" } else { "s" };
        let what =
            format!("{}: {} usable sample{plural}; at least 2 are needed", sensor.name(), samples.len());
        all.remarks.push(Remark::of_column(None, what));
        return Ok(None);
    }
    Ok(Some(Track { sensor, samples, made_up }))
}
