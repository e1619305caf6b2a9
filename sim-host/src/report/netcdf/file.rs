//! Writes variables as a NetCDF file, in the classic format or as NetCDF-4.

use super::{Values, Variable};
use crate::report::tool::Tool;
use netcdf_writer::{
    DimensionId, Error, NcAttrValue, NcFileBuilder, NcWriteFormat, NcWriteOptions, VariableId,
};
use serde::Serialize;
use std::path::Path;

/// The edition of the conventions that the files follow.
const CONVENTIONS: &str = "CF-1.11";
/// The equations of motion.
const REFERENCES: &str = "Meijaard, Papadopoulos, Ruina and Schwab 2007, doi:10.1098/rspa.2007.1857";

/// Contents of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct File {
    /// What the file shows.
    pub title: String,
    /// The program that computed the results.
    pub tool: Tool,
    /// Further global attributes: names and texts.
    pub attributes: Vec<(&'static str, String)>,
    /// The variables. Each dimension has a coordinate: a variable of its name whose only dimension it is.
    pub variables: Vec<Variable>,
}

/// The formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// NetCDF-3, which every reader of NetCDF reads; texts are rows of letters.
    Classic,
    /// NetCDF-4, a kind of HDF5; texts are strings.
    NetCdf4,
}

impl Format {
    /// The format of a file of this name: NetCDF-4 if it ends with `.nc4`.
    pub fn of(path: &Path) -> Self {
        match path.extension() {
            Some(ending) if ending == "nc4" => Self::NetCdf4,
            _ => Self::Classic,
        }
    }
}

/// A file that can't be made: a name or a length that the format does not allow.
#[derive(Debug, thiserror::Error)]
#[error("can't write NetCDF: {0}")]
pub struct NetCdfError(#[from] Error);

/// The attributes that tell how results came about: the resolved configuration and the scenario that gives them again.
pub fn provenance(configuration: &impl Serialize, scenario: &impl Serialize) -> Vec<(&'static str, String)> {
    let text = |value: serde_json::Result<String>| value.unwrap_or_default();
    vec![
        ("configuration", text(serde_json::to_string(configuration))),
        ("scenario", text(serde_json::to_string(scenario))),
    ]
}

impl File {
    /// The file's bytes. They contain no time, so that the same results are the same bytes.
    ///
    /// # Errors
    /// A name or a length that the format does not allow.
    pub fn bytes(&self, format: Format) -> Result<Vec<u8>, NetCdfError> {
        let mut file = NcFileBuilder::new();
        let Tool { name, version, commit } = &self.tool;
        let program = format!("{name} {version} commit {commit}");
        let history = format!("computed by {program}");
        let heads = [
            ("Conventions", CONVENTIONS),
            ("title", &self.title),
            ("source", &program),
            ("history", &history),
            ("references", REFERENCES),
        ];
        let others = self.attributes.iter().map(|(name, text)| (*name, text.as_str()));
        for (name, text) in heads.into_iter().chain(others) {
            file.add_attribute(name, NcAttrValue::Chars(text.into()))?;
        }
        let mut dims = Vec::new();
        for variable in self.variables.iter().filter(|v| v.is_coordinate()) {
            dims.push((
                variable.name.as_str(),
                file.add_dimension(&variable.name, variable.values.len() as u64)?,
            ));
        }
        for variable in &self.variables {
            let of = |name: &String| dims.iter().find(|(dim, _)| dim == name).map(|(_, id)| *id);
            let dims: Vec<DimensionId> = variable.dims.iter().filter_map(of).collect();
            add(&mut file, format, variable, &dims)?;
        }
        let format = match format {
            Format::Classic => NcWriteFormat::AutoClassic,
            Format::NetCdf4 => NcWriteFormat::Nc4,
        };
        Ok(file.to_vec(NcWriteOptions { format })?.1)
    }
}

/// Adds a variable with its attributes and values.
fn add(
    file: &mut NcFileBuilder,
    format: Format,
    variable: &Variable,
    dims: &[DimensionId],
) -> Result<(), Error> {
    let name = &variable.name;
    let id = match &variable.values {
        Values::Numbers(units, values) => {
            let id = file.add_variable::<f64>(name, dims)?;
            note(file, id, "units", units)?;
            // Coordinates are never missing, and the conventions allow them no fill value.
            if !variable.is_coordinate() {
                file.set_variable_fill_value(id, f64::NAN)?;
            }
            file.write_variable(id, values)?;
            id
        }
        Values::Flags(meanings, values) => {
            let id = file.add_variable::<i8>(name, dims)?;
            let flags = (0..).take(meanings.len()).collect();
            file.add_variable_attribute(id, "flag_values", NcAttrValue::Bytes(flags))?;
            note(file, id, "flag_meanings", &meanings.join(" "))?;
            file.write_variable(id, &values.iter().map(|v| v.cast_signed()).collect::<Vec<_>>())?;
            id
        }
        Values::Texts(texts) if format == Format::NetCdf4 => {
            let id = file.add_string_variable(name, dims)?;
            file.write_string_variable(id, texts)?;
            id
        }
        Values::Texts(texts) => {
            let longest = texts.iter().map(String::len).max().unwrap_or(1).max(1);
            let letters = file.add_dimension(format!("{name}_length"), longest as u64)?;
            let id = file.add_char_variable(name, &[dims, &[letters]].concat())?;
            note(file, id, "_Encoding", "utf-8")?;
            file.write_char_variable_strings(id, texts)?;
            id
        }
    };
    note(file, id, "long_name", &variable.long_name)
}

/// Adds an attribute of text.
fn note(file: &mut NcFileBuilder, id: VariableId, name: &str, text: &str) -> Result<(), Error> {
    file.add_variable_attribute(id, name, NcAttrValue::Chars(text.into()))
}
