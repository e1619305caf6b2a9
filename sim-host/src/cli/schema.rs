//! `sim-host schema`: the JSON schema of each document.

use super::ended::{Ended, Failure};
use super::outputs::print;
use crate::design::document::DesignDocument;
use crate::report::board::{FaultsDocument, ParametersDocument};
use crate::report::closed_loop::LoopDocument;
use crate::report::compare::CompareDocument;
use crate::report::document::{BasinDocument, CheckDocument, EigenDocument, RideDocument};
use crate::report::identify::{IdentifyDocument, IdentifyManyDocument};
use crate::report::perturbation::PerturbationDocument;
use crate::report::plane::PlaneDocument;
use crate::report::replay::{ReplayDocument, ReplaysDocument};
use crate::report::rider::RiderDocument;
use crate::report::sensor::SensorDocument;
use crate::report::weave::WeaveDocument;
use crate::scenario::Scenario;
use crate::sweep::document::SweepDocument;
use crate::sweep::status::StatusDocument;
use crate::thesis::document::ThesisDocument;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde_json::Value;

/// Name of a document, and the function that makes its schema.
type Document = (&'static str, fn() -> Schema);

/// The documents by their commands' names.
const DOCUMENTS: [Document; 22] = [
    ("basin", of::<BasinDocument>),
    ("ride", of::<RideDocument>),
    (SCENARIO, of_scenario),
    ("replay", of::<ReplayDocument>),
    ("replay-many", of::<ReplaysDocument>),
    ("eigen", of::<EigenDocument>),
    ("bicycle-check", of::<CheckDocument>),
    ("rider-show", of::<RiderDocument>),
    ("thesis", of::<ThesisDocument>),
    ("basin-compare", of::<CompareDocument>),
    ("basin-plane", of::<PlaneDocument>),
    ("sweep", of::<SweepDocument>),
    ("sweep-status", of::<StatusDocument>),
    ("design", of::<DesignDocument>),
    ("param-list", of::<ParametersDocument>),
    ("faults", of::<FaultsDocument>),
    ("identify", of::<IdentifyDocument>),
    ("identify-many", of::<IdentifyManyDocument>),
    ("identify-weave", of::<WeaveDocument>),
    ("identify-sensor", of::<SensorDocument>),
    ("identify-loop", of::<LoopDocument>),
    ("record", of::<PerturbationDocument>),
];

/// The document that is input: a key that is not in its schema is an error.
const SCENARIO: &str = "scenario";

/// Allows more keys everywhere: documents may grow.
fn open(schema: &mut Value) {
    match schema {
        Value::Object(entries) => {
            entries.retain(|key, value| !(key == "additionalProperties" && *value == Value::Bool(false)));
            entries.values_mut().for_each(open);
        }
        Value::Array(items) => items.iter_mut().for_each(open),
        _ => {}
    }
}

/// Names of the documents, for the argument.
pub(super) fn names() -> [&'static str; DOCUMENTS.len()] {
    DOCUMENTS.map(|(name, _)| name)
}

/// The schema of a scenario, which is read: keys with a default are not required.
fn of_scenario() -> Schema {
    SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<Scenario>()
}

/// The schema of a document.
fn of<D: JsonSchema>() -> Schema {
    // Schema of serialised output: a nullable value is still required.
    SchemaSettings::draft2020_12().for_serialize().into_generator().into_root_schema_for::<D>()
}

/// Prints the schema of a document.
pub(super) fn run(document: &str) -> Result<Ended, Failure> {
    let (_, schema) = DOCUMENTS.iter().find(|(name, _)| *name == document).ok_or("no such document")?;
    let mut schema = serde_json::to_value(schema())?;
    if document != SCENARIO {
        open(&mut schema);
    }
    // The descriptions are doc comments, whose brackets are escaped.
    let text = serde_json::to_string_pretty(&schema)?.replace(r"\\[", "[").replace(r"\\]", "]");
    print(&(text + "\n"))?;
    Ok(Ended::Done)
}
