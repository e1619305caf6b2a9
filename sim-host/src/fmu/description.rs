//! `modelDescription.xml` from a model's table of variables.

use super::unit::{self, Unit};
use crate::report::tool::Tool;
use fmi::{Kind, Role, Table, Variable};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::io;

/// Version of the interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Version {
    /// FMI 2.0.
    #[cfg_attr(feature = "cli", value(name = "2"))]
    Two,
    /// FMI 3.0.
    #[cfg_attr(feature = "cli", value(name = "3"))]
    Three,
}

/// What a model description has beside the variables.
#[derive(Clone, Copy, Debug)]
pub(super) struct About<'a> {
    /// Name of the model.
    pub(super) name: &'a str,
    /// Name of the library's file without its ending.
    pub(super) identifier: &'a str,
    /// Instantiation token.
    pub(super) token: &'a str,
    /// Time step of the model \[s\].
    pub(super) step_s: f64,
    /// Duration of a ride \[s\].
    pub(super) stop_s: f64,
}

type Xml = Writer<Vec<u8>>;

/// The model description of a model with these variables.
///
/// # Errors
/// Never, as it is written to memory.
pub(super) fn xml(version: Version, about: About, table: &Table) -> io::Result<Vec<u8>> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let (number, token) = match version {
        Version::Two => ("2.0", "guid"),
        Version::Three => ("3.0", "instantiationToken"),
    };
    let Tool { name, version: of_tool, commit } = Tool::this();
    let tool = format!("{name} {of_tool} commit {commit}");
    let root = [
        ("fmiVersion", number),
        ("modelName", about.name),
        (token, about.token),
        ("generationTool", tool.as_str()),
        ("variableNamingConvention", "flat"),
    ];
    xml.create_element("fmiModelDescription").with_attributes(root).write_inner_content(|xml| {
        co_simulation(xml, version, about)?;
        xml.create_element("UnitDefinitions").write_inner_content(|xml| {
            used_units(table).into_iter().try_for_each(|unit| unit_definition(xml, unit))
        })?;
        type_definitions(xml, version, table)?;
        xml.create_element("LogCategories").write_inner_content(|xml| {
            let categories = [
                ("logStatusError", "refused calls"),
                ("logStatusWarning", "doubts"),
                ("logEvents", "events such as a fall"),
            ];
            categories.into_iter().try_for_each(|(name, meaning)| {
                let category = [("name", name), ("description", meaning)];
                xml.create_element("Category").with_attributes(category).write_empty().map(drop)
            })
        })?;
        let [stop, step] = [about.stop_s, about.step_s].map(|s| s.to_string());
        let experiment = [("startTime", "0"), ("stopTime", stop.as_str()), ("stepSize", step.as_str())];
        xml.create_element("DefaultExperiment").with_attributes(experiment).write_empty()?;
        xml.create_element("ModelVariables").write_inner_content(|xml| {
            table.variables().iter().enumerate().try_for_each(|(i, v)| variable(xml, version, i, v))
        })?;
        xml.create_element("ModelStructure")
            .write_inner_content(|xml| structure(xml, version, table))
            .map(drop)
    })?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

fn co_simulation(xml: &mut Xml, version: Version, about: About) -> io::Result<()> {
    let step = about.step_s.to_string();
    let mut element = xml
        .create_element("CoSimulation")
        .with_attribute(("modelIdentifier", about.identifier))
        .with_attribute(("canHandleVariableCommunicationStepSize", "false"));
    element = match version {
        Version::Two => element.with_attributes([
            ("canNotUseMemoryManagementFunctions", "true"),
            ("canGetAndSetFMUstate", "true"),
            ("canSerializeFMUstate", "true"),
        ]),
        Version::Three => element.with_attributes([
            ("canGetAndSetFMUState", "true"),
            ("canSerializeFMUState", "true"),
            ("fixedInternalStepSize", step.as_str()),
        ]),
    };
    element.write_empty().map(drop)
}

fn used_units(table: &Table) -> Vec<&'static Unit> {
    let mut used: Vec<&Unit> =
        table.variables().iter().filter_map(|variable| unit::of(variable.unit)).collect();
    used.sort_by_key(|unit| unit.name);
    used.dedup_by_key(|unit| unit.name);
    used
}

fn unit_definition(xml: &mut Xml, unit: &Unit) -> io::Result<()> {
    let element = xml.create_element("Unit").with_attribute(("name", unit.name));
    element
        .write_inner_content(|xml| {
            let base = unit.base.iter().map(|(name, exponent)| (*name, exponent.to_string()));
            let factor = unit.factor.map(|factor| ("factor", factor.to_owned()));
            let all: Vec<(&str, String)> = base.chain(factor).collect();
            let attributes = all.iter().map(|(name, value)| (*name, value.as_str()));
            xml.create_element("BaseUnit").with_attributes(attributes).write_empty().map(drop)
        })
        .map(drop)
}

/// One type for each variable that is a choice, with its name.
fn type_definitions(xml: &mut Xml, version: Version, table: &Table) -> io::Result<()> {
    let choices: Vec<(&str, &[&str])> = table.variables().iter().filter_map(choice).collect();
    if choices.is_empty() {
        return Ok(());
    }
    let items = |xml: &mut Xml, names: &[&str]| {
        names.iter().enumerate().try_for_each(|(number, name)| {
            let number = number.to_string();
            xml.create_element("Item")
                .with_attributes([("name", *name), ("value", number.as_str())])
                .write_empty()
                .map(drop)
        })
    };
    xml.create_element("TypeDefinitions")
        .write_inner_content(|xml| {
            choices.iter().try_for_each(|(name, names)| {
                let name = ("name", format!("{name}_choice"));
                let name = (name.0, name.1.as_str());
                match version {
                    Version::Two => {
                        xml.create_element("SimpleType").with_attribute(name).write_inner_content(|xml| {
                            xml.create_element("Enumeration")
                                .write_inner_content(|xml| items(xml, names))
                                .map(drop)
                        })
                    }
                    Version::Three => xml
                        .create_element("EnumerationType")
                        .with_attribute(name)
                        .write_inner_content(|xml| items(xml, names)),
                }
                .map(drop)
            })
        })
        .map(drop)
}

/// Name and choices of a variable that is a choice.
fn choice(variable: &Variable) -> Option<(&str, &[&str])> {
    match variable.kind {
        Kind::Choice(names) => Some((variable.name.as_str(), names)),
        _ => None,
    }
}

fn variable(xml: &mut Xml, version: Version, index: usize, v: &Variable) -> io::Result<()> {
    let reference = index.to_string();
    let mut outer = vec![("name", v.name.clone()), ("valueReference", reference)];
    if !v.about.is_empty() {
        outer.push(("description", v.about.clone()));
    }
    let (causality, variability) = match (v.role, v.kind) {
        (Role::Time, _) => ("independent", "continuous"),
        (Role::Constant, _) => ("local", "constant"),
        (Role::Parameter, _) => ("parameter", "fixed"),
        (Role::Input, Kind::Real) => ("input", "continuous"),
        (Role::Input, _) => ("input", "discrete"),
        (Role::Output, Kind::Real) => ("output", "continuous"),
        (Role::Output, _) => ("output", "discrete"),
    };
    outer.extend([("causality", causality.into()), ("variability", variability.into())]);
    let mut inner = Vec::new();
    if let Some((name, _)) = choice(v) {
        inner.push(("declaredType", format!("{name}_choice")));
    }
    if let Some(unit) = unit::of(v.unit) {
        inner.push(("unit", unit.name.into()));
    }
    if let Some([min, max]) = v.range {
        inner.extend([("min", min.to_string()), ("max", max.to_string())]);
    }
    if matches!(v.role, Role::Constant | Role::Parameter | Role::Input) {
        let start = if v.kind == Kind::Boolean { (v.start == 1.0).to_string() } else { v.start.to_string() };
        inner.push(("start", start));
    }
    fn borrowed<'a>(all: &'a [(&'static str, String)]) -> impl Iterator<Item = (&'a str, &'a str)> {
        all.iter().map(|(name, value)| (*name, value.as_str()))
    }
    match version {
        Version::Two => {
            let kind = match v.kind {
                Kind::Real => "Real",
                Kind::Integer => "Integer",
                Kind::Boolean => "Boolean",
                Kind::Choice(_) => "Enumeration",
            };
            let element = xml.create_element("ScalarVariable").with_attributes(borrowed(&outer));
            element.write_inner_content(|xml| {
                xml.create_element(kind).with_attributes(borrowed(&inner)).write_empty().map(drop)
            })
        }
        Version::Three => {
            let kind = match v.kind {
                Kind::Real => "Float64",
                Kind::Integer => "Int32",
                Kind::Boolean => "Boolean",
                Kind::Choice(_) => "Enumeration",
            };
            let element = xml.create_element(kind);
            element.with_attributes(borrowed(&outer)).with_attributes(borrowed(&inner)).write_empty()
        }
    }
    .map(drop)
}

/// The outputs. Most change in steps only and do not depend on the inputs of the same instant.
fn structure(xml: &mut Xml, version: Version, table: &Table) -> io::Result<()> {
    let outputs = || table.of(Role::Output);
    let inputs = |first: usize| {
        let all: Vec<String> = table.of(Role::Input).map(|i| (i + first).to_string()).collect();
        all.join(" ")
    };
    let dependencies = |output: usize, first| match table.variables()[output].direct {
        true => inputs(first),
        false => String::new(),
    };
    match version {
        Version::Two => {
            let unknowns = |xml: &mut Xml| {
                outputs().try_for_each(|i| {
                    let index = (i + 1).to_string();
                    let dependencies = dependencies(i, 1);
                    let unknown = [("index", index.as_str()), ("dependencies", dependencies.as_str())];
                    xml.create_element("Unknown").with_attributes(unknown).write_empty().map(drop)
                })
            };
            xml.create_element("Outputs").write_inner_content(unknowns)?;
            xml.create_element("InitialUnknowns").write_inner_content(|xml| {
                outputs().try_for_each(|i| {
                    let index = (i + 1).to_string();
                    xml.create_element("Unknown")
                        .with_attribute(("index", index.as_str()))
                        .write_empty()
                        .map(drop)
                })
            })?;
        }
        Version::Three => {
            for i in outputs() {
                let reference = i.to_string();
                let dependencies = dependencies(i, 0);
                let output =
                    [("valueReference", reference.as_str()), ("dependencies", dependencies.as_str())];
                xml.create_element("Output").with_attributes(output).write_empty()?;
            }
            for i in outputs() {
                let reference = i.to_string();
                xml.create_element("InitialUnknown")
                    .with_attribute(("valueReference", reference.as_str()))
                    .write_empty()?;
            }
        }
    }
    Ok(())
}
