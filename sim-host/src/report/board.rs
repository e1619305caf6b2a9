//! The JSON documents of `param list` and `faults`.

use super::resolved::ResolvedLaw;
use super::tool::{SCHEMA, Tool};
use crate::board::BoardName;
use crate::board::fault::Fault;
use crate::board::parameter::Parameter;
use crate::board::reception::Reception;
use crate::board::settings::Settings;
use link::parameter_list::Kind;
use schemars::JsonSchema;
use serde::Serialize;

/// `param list`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ParametersDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The board; null for the flashed configuration (`--defaults`).
    pub board: Option<BoardName>,
    /// Its law.
    pub law: ResolvedLaw,
    /// Its parameters, in its order.
    pub parameters: Vec<ListedParameter>,
}

impl ParametersDocument {
    /// The document of `board` with the given `parameters` only.
    pub fn new(board: Option<BoardName>, settings: &Settings, parameters: &[&Parameter]) -> Self {
        Self {
            schema: SCHEMA,
            tool: Tool::this(),
            board,
            law: ResolvedLaw::new(&settings.law.to_string(), &settings.law),
            parameters: parameters.iter().map(|one| ListedParameter::new(one)).collect(),
        }
    }
}

/// A parameter of a board. Values are text in the form of `--set`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ListedParameter {
    /// Its name.
    pub key: String,
    /// Its value.
    pub value: String,
    /// Its value after a reset.
    pub default: String,
    /// Its unit; empty for a plain number.
    pub unit: &'static str,
    /// Smallest allowed value; null for a choice of names.
    pub min: Option<f32>,
    /// Largest allowed value; null for a choice of names.
    pub max: Option<f32>,
    /// The allowed names; empty for a plain number.
    pub words: Vec<String>,
}

impl ListedParameter {
    fn new(one: &Parameter) -> Self {
        let numbers = !matches!(one.kind, Kind::Switch | Kind::Choice);
        Self {
            key: one.key.clone(),
            value: one.text(one.value),
            default: one.text(one.default),
            unit: one.unit,
            min: numbers.then_some(one.min),
            max: numbers.then_some(one.max),
            words: one.words().into_iter().map(String::from).collect(),
        }
    }
}

/// `faults`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct FaultsDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The board; null for a recording.
    pub board: Option<BoardName>,
    /// The stored fault records, newest first; for a recording, those in it, in its order.
    pub faults: Vec<Fault>,
    /// Counts of the recording's frames; null for a board.
    pub recording: Option<Reception>,
}
