//! Many parameters set at once: all of them or none, and honestly told where that could not be kept.

use super::client::{Client, ClientError};
use super::settings::{Setting, Settings};
use link::rejection::RejectReason;

/// Only the check itself sets it.
const CHECKED: &str = "calibration.polarity_checked";

/// What was set, as read back.
pub struct Tuned {
    /// What the board has now.
    pub now: Settings,
    /// The keys that were set.
    pub set: Vec<String>,
    /// The keys that are not as they were wanted.
    pub differing: Vec<String>,
}

/// Why not all was set.
#[derive(Debug, thiserror::Error)]
#[error("{error}; {outcome}")]
pub struct TuneError {
    /// What went wrong.
    error: ClientError,
    /// What is set now and what is not.
    outcome: String,
}

/// Where setting stopped.
struct Stop {
    error: ClientError,
    /// What is not set; of the first it may not be known.
    waiting: Vec<Setting>,
}

/// Sets what of `wanted` the board does not have yet, and reads all back. What a board refuses for its value makes it
/// put back all that was set before.
///
/// That a polarity check was passed is never set; where it is wanted and not so, it is told as differing.
///
/// # Errors
/// A refusal, or a line that failed, and what is set now.
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

/// What of `wanted` is otherwise. The calibration comes last: to change it takes back a passed polarity check, which
/// can't be put back.
fn missing(now: &Settings, wanted: &[Setting]) -> Vec<Setting> {
    let by_check = Setting::Value { key: CHECKED.into(), value: Some(1.0) };
    let mut missing: Vec<_> =
        wanted.iter().filter(|one| !now.has(one) && **one != by_check).cloned().collect();
    missing.sort_by_key(|one| one.key().starts_with("calibration."));
    missing
}

/// Sets all that waits, in as many rounds as get it further: a value may have to wait for another that it must fit.
fn converge(client: &mut Client, mut waiting: Vec<Setting>, set: &mut Vec<Setting>) -> Result<(), Stop> {
    while !waiting.is_empty() {
        let (before, mut refusal) = (waiting.len(), None);
        let mut rest = std::mem::take(&mut waiting).into_iter();
        while let Some(setting) = rest.next() {
            match setting.apply(client) {
                Ok(()) => set.push(setting),
                Err(
                    error @ ClientError::Refused {
                        why: RejectReason::OutOfRange | RejectReason::GroupOff,
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

/// After a line that failed: what is set and what is not, by reading back where that can be done.
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

/// After a refusal: everything as it was.
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
            left if left.is_empty() => "nothing is set, what was is put back".to_owned(),
            left => format!("what was set is put back, but for {}", list(&left)),
        },
        Err(second) => format!("set: {}; it can't be put back: {second}", list(set)),
    };
    TuneError { error, outcome }
}

fn list(settings: &[Setting]) -> String {
    if settings.is_empty() {
        return "nothing".into();
    }
    settings.iter().map(Setting::key).collect::<Vec<_>>().join(", ")
}
