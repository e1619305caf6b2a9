//! Sets many parameters at once: all or none. If that fails, the error lists what is set.

use super::client::{Client, ClientError};
use super::settings::{Setting, Settings};
use link::rejection::RejectReason;

/// Only the polarity check itself sets this parameter.
const CHECKED: &str = "calibration.polarity_checked";

/// What was set, from reading back.
pub struct Tuned {
    /// The board's settings now.
    pub now: Settings,
    /// The keys that were set.
    pub set: Vec<String>,
    /// The keys whose value differs from the requested one.
    pub differing: Vec<String>,
}

/// Why not everything was set.
#[derive(Debug, thiserror::Error)]
#[error("{error}; {outcome}")]
pub struct TuneError {
    /// The error.
    error: ClientError,
    /// What is set now and what is not.
    outcome: String,
}

/// State when setting stopped.
struct Stop {
    error: ClientError,
    /// Settings that are not set; the state of the first may be unknown.
    waiting: Vec<Setting>,
}

/// Sets the `wanted` settings that differ on the board, and reads all back. If the board rejects a value, all that was
/// set before is restored.
///
/// A passed polarity check is never set; if it is wanted and not passed, its key is listed as differing.
///
/// # Errors
/// A rejected value or a failed line, with what is set now.
pub fn tune(client: &mut Client, before: &Settings, wanted: &[Setting]) -> Result<Tuned, TuneError> {
    let mut set = Vec::new();
    converge(client, missing(before, wanted), &mut set).map_err(|stop| match stop.error.leaves_doubt() {
        true => interrupted(client, stop, &set),
        false => put_back(client, before, stop.error, &set),
    })?;
    let now = Settings::read(client)
        .map_err(|error| TuneError { error, outcome: format!("set: {}; not read back", list(&set)) })?;
    let differing = wanted.iter().filter(|one| !now.has(one)).map(|one| one.key().to_owned()).collect();
    Ok(Tuned { now, set: set.iter().map(|one| one.key().to_owned()).collect(), differing })
}

/// The `wanted` settings that differ. The calibration comes last: a change of it clears a passed polarity check, which
/// cannot be restored.
fn missing(now: &Settings, wanted: &[Setting]) -> Vec<Setting> {
    let by_check = Setting::Value { key: CHECKED.into(), value: Some(1.0) };
    let mut missing: Vec<_> =
        wanted.iter().filter(|one| !now.has(one) && **one != by_check).cloned().collect();
    missing.sort_by_key(|one| one.key().starts_with("calibration."));
    missing
}

/// Sets all waiting settings, in rounds as long as one succeeds: a value may depend on another that is set later.
fn converge(client: &mut Client, mut waiting: Vec<Setting>, set: &mut Vec<Setting>) -> Result<(), Stop> {
    while !waiting.is_empty() {
        let (before, mut refusal) = (waiting.len(), None);
        let mut rest = std::mem::take(&mut waiting).into_iter();
        while let Some(setting) = rest.next() {
            match setting.apply(client) {
                Ok(()) => set.push(setting),
                Err(
                    error @ ClientError::Refused {
                        reason: RejectReason::OutOfRange | RejectReason::GroupOff,
                        ..
                    },
                ) => {
                    refusal.get_or_insert(error);
                    waiting.push(setting);
                }
                Err(error) => {
                    let waiting = std::iter::once(setting).chain(waiting).chain(rest).collect();
                    return Err(Stop { error, waiting });
                }
            }
        }
        if let Some(error) = refusal.filter(|_| waiting.len() == before) {
            return Err(Stop { error, waiting });
        }
    }
    Ok(())
}

/// After a failed line: reads back, if possible, what is set and what is not.
fn interrupted(client: &mut Client, Stop { error, waiting }: Stop, set: &[Setting]) -> TuneError {
    let outcome = match Settings::read(client) {
        Ok(now) => {
            let (set, unset): (Vec<_>, _) = set.iter().chain(&waiting).cloned().partition(|one| now.has(one));
            format!("read back: set: {}; not set: {}", list(&set), list(&unset))
        }
        Err(second) => format!(
            "set: {}; not known: {}; not set: {}; it can't be read back: {second}",
            list(set),
            list(&waiting[..1]),
            list(&waiting[1..])
        ),
    };
    TuneError { error, outcome }
}

/// After a rejected value: restores everything.
fn put_back(client: &mut Client, before: &Settings, error: ClientError, set: &[Setting]) -> TuneError {
    if set.is_empty() {
        return TuneError { error, outcome: "nothing is set".into() };
    }
    let mut back = || {
        let now = Settings::read(client)?;
        converge(client, missing(&now, &before.all()), &mut Vec::new()).map_err(|stop| stop.error)?;
        Settings::read(client)
    };
    let outcome = match back() {
        Ok(now) => match before.all().into_iter().filter(|one| !now.has(one)).collect::<Vec<_>>() {
            left if left.is_empty() => "nothing is set: the previous values are restored".to_owned(),
            left => format!("the previous values are restored, except {}", list(&left)),
        },
        Err(second) => format!("set: {}; the previous values can't be restored: {second}", list(set)),
    };
    TuneError { error, outcome }
}

fn list(settings: &[Setting]) -> String {
    if settings.is_empty() {
        return "nothing".into();
    }
    settings.iter().map(Setting::key).collect::<Vec<_>>().join(", ")
}
