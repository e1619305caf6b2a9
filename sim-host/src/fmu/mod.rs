//! FMUs of the controller, the bicycle and the rider: `docs/fmi.md`. The crate `fmi` has their variables and the dynamic
//! library; here are the model of a scenario, the model description and the archive.

mod archive;
mod description;
mod library;
mod part;
mod unit;

pub use archive::archive;
pub use description::Version;
pub use library::{LibraryError, library};
pub use part::{Part, PartError, model, with_speed};

use crate::report::tool::Tool;
use crate::scenario::Scenario;
use serde::Serialize;

/// The file `resources/model.json`: what the library reads, with the program and the scenario that it comes from.
#[derive(Serialize)]
struct ModelFile<'a> {
    tool: Tool,
    scenario: &'a Scenario,
    model: &'a fmi::Setup,
    /// [`fmi::Table::fingerprint`].
    variables: u32,
}
