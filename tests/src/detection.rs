//! Detection of a fault in a ride, and its time.

use control::{Cause, Causes};
use sim_host::plant::{Fault, Plant};
use sim_host::ride::{Conditions, Start, TracePoint, traced};
use std::fmt::{self, Display};

/// The first causes that report a fault.
#[derive(Clone, Debug, PartialEq)]
pub struct First {
    /// The causes at that instant.
    pub causes: Vec<Cause>,
    /// Time from the fault's beginning \[s\].
    pub after_s: f64,
    /// Largest roll angle from the fault's beginning until then \[rad\].
    pub roll_rad: f64,
}

impl Display for First {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let codes: Vec<String> = self.causes.iter().map(|c| c.code().to_string()).collect();
        write!(f, "{}: {:.2} s", codes.join(" "), self.after_s)
    }
}

/// A ride with a fault.
#[derive(Clone, Debug)]
pub struct Detection {
    /// The first detection, if any.
    pub first: Option<First>,
    /// Whether the bicycle falls.
    pub fell: bool,
    /// The ride.
    pub trace: Vec<TracePoint>,
}

/// Causes up to this one report a fault; those after it the bicycle's motion and the rider's actions.
pub const LAST_FAULT: Cause = Cause::GuardEndStop;

/// The causes that report a fault.
pub fn of_the_fault(p: &TracePoint) -> Vec<Cause> {
    Causes(p.causes).iter().filter(|cause| cause.code() <= LAST_FAULT.code()).collect()
}

/// Rides from `start` with one fault; `conditions` makes the ride through a plant.
///
/// # Panics
/// If the text is no fault.
pub fn detect(fault: &str, start: Start, conditions: impl FnOnce(Plant) -> Conditions) -> Detection {
    let fault: Fault = fault.parse().unwrap_or_else(|e| panic!("{fault}: {e}"));
    let from_s = fault.from_s;
    let (ride, trace) = traced(&conditions(Plant { faults: vec![fault], ..Plant::default() }), start);
    // The causes of a bicycle that lies down do not count.
    let up = trace.iter().position(|p| p.roll.abs() > 1.0).unwrap_or(trace.len());
    let first = trace[..up].iter().position(|p| !of_the_fault(p).is_empty()).map(|at| First {
        causes: of_the_fault(&trace[at]),
        after_s: trace[at].t - from_s,
        roll_rad: trace[..=at].iter().filter(|p| p.t > from_s).map(|p| p.roll.abs()).fold(0.0, f64::max),
    });
    Detection { first, fell: ride.fell(), trace }
}

/// The rows of the table of a page behind the comment `<!-- name -->`, without its two lines of heading.
///
/// # Panics
/// If the page has none.
pub fn rows_of<'a>(page: &'a str, name: &str) -> Vec<&'a str> {
    let found = page.split_once(&format!("<!-- {name} -->\n"));
    let found = found.and_then(|(_, rest)| rest.split_once("\n<!-- end -->"));
    let (found, _) = found.unwrap_or_else(|| panic!("the page has no table {name}"));
    found.lines().skip(2).collect()
}
