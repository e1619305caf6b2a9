//! What is noticed of a fault in a ride, and how soon.

use control::{Cause, Causes};
use sim_host::plant::{Fault, Plant};
use sim_host::ride::{Conditions, Start, TracePoint, traced};
use std::fmt::{self, Display};

/// The first causes that tell of a fault.
#[derive(Clone, Debug, PartialEq)]
pub struct First {
    /// The causes of that instant.
    pub causes: Vec<Cause>,
    /// Time from the fault's beginning \[s\].
    pub after_s: f64,
    /// Largest roll angle from the fault's beginning up to then \[rad\].
    pub roll_rad: f64,
}

impl Display for First {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let codes: Vec<String> = self.causes.iter().map(|c| c.code().to_string()).collect();
        write!(f, "{}: {:.2} s", codes.join(" "), self.after_s)
    }
}

/// A ride in which something broke.
#[derive(Clone, Debug)]
pub struct Noticed {
    /// What is noticed first, if anything is.
    pub first: Option<First>,
    /// Whether the bicycle falls.
    pub fell: bool,
    /// The ride.
    pub trace: Vec<TracePoint>,
}

/// Causes up to this one say that something is broken; those after it how the bicycle moves and what the rider does.
pub const LAST_FAULT: Cause = Cause::GuardEndStop;

/// The causes that tell of a fault.
pub fn of_the_fault(p: &TracePoint) -> Vec<Cause> {
    Causes(p.causes).iter().filter(|cause| cause.code() <= LAST_FAULT.code()).collect()
}

/// Rides from `start` with one thing broken; `conditions` makes the ride through a plant.
///
/// # Panics
/// When the text is no fault.
pub fn noticed(fault: &str, start: Start, conditions: impl FnOnce(Plant) -> Conditions) -> Noticed {
    let fault: Fault = fault.parse().unwrap_or_else(|e| panic!("{fault}: {e}"));
    let from_s = fault.from_s;
    let (ride, trace) = traced(&conditions(Plant { faults: vec![fault], ..Plant::default() }), start);
    // A bicycle that lies down may say anything.
    let up = trace.iter().position(|p| p.roll.abs() > 1.0).unwrap_or(trace.len());
    let first = trace[..up].iter().position(|p| !of_the_fault(p).is_empty()).map(|at| First {
        causes: of_the_fault(&trace[at]),
        after_s: trace[at].t - from_s,
        roll_rad: trace[..=at].iter().filter(|p| p.t > from_s).map(|p| p.roll.abs()).fold(0.0, f64::max),
    });
    Noticed { first, fell: ride.fell(), trace }
}

/// The rows of the table of a page behind the comment `<!-- name -->`, without its two lines of heading.
///
/// # Panics
/// When the page has none.
pub fn rows_of<'a>(page: &'a str, name: &str) -> Vec<&'a str> {
    let found = page.split_once(&format!("<!-- {name} -->\n"));
    let found = found.and_then(|(_, rest)| rest.split_once("\n<!-- end -->"));
    let (found, _) = found.unwrap_or_else(|| panic!("the page has no table {name}"));
    found.lines().skip(2).collect()
}
