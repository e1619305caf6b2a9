//! The dependencies between the crates of the workspace, from their `Cargo.toml`.

use super::check::{Edge, Found};
use super::imports::first_names;
use super::sources::{read, rust_files};
use crate::Result;
use std::collections::BTreeSet;
use std::path::Path;
use toml::{Table, Value};

/// A package of the workspace.
struct Package {
    name: String,
    folder: String,
    text: String,
    manifest: Table,
}

/// The workspace's packages and their dependencies on each other. A dependency whose name no source of the package
/// contains is reported as unclear.
pub fn found(root: &Path) -> Result<Found> {
    let packages = packages(root)?;
    let nodes: BTreeSet<String> = packages.iter().map(|package| package.name.clone()).collect();
    let mut found = Found { nodes, ..Found::default() };
    for package in &packages {
        let named = names_in_sources(root, package, &packages)?;
        for (to, test_only) in dependencies(&package.manifest).filter(|(name, _)| found.nodes.contains(name))
        {
            let line = package.text.lines().position(|line| line.starts_with(&format!("{to} ")));
            let place = format!("{}/Cargo.toml:{}", package.folder, line.map_or(0, |line| line + 1));
            if !named.contains(&to.replace('-', "_")) {
                found.unclear.push(format!("{place}: no source of `{}` uses `{to}`", package.name));
            }
            found.edges.push(Edge { from: package.name.clone(), to, test_only, place });
        }
    }
    Ok(found)
}

fn packages(root: &Path) -> Result<Vec<Package>> {
    let workspace =
        table(&read(&root.join("Cargo.toml"))?).map_err(|error| format!("Cargo.toml: {error}"))?;
    let Some(Value::Array(members)) = workspace.get("workspace").and_then(|table| table.get("members"))
    else {
        return Err("Cargo.toml: no workspace.members".into());
    };
    members
        .iter()
        .filter_map(Value::as_str)
        .map(|folder| {
            let text = read(&root.join(folder).join("Cargo.toml"))?;
            let manifest = table(&text).map_err(|error| format!("{folder}/Cargo.toml: {error}"))?;
            let name =
                manifest.get("package").and_then(|package| package.get("name")).and_then(Value::as_str);
            let name = name.ok_or_else(|| format!("{folder}/Cargo.toml: no package.name"))?.to_owned();
            Ok(Package { name, folder: folder.to_owned(), text, manifest })
        })
        .collect()
}

fn table(text: &str) -> Result<Table> {
    text.parse().map_err(|error: toml::de::Error| error.to_string())
}

/// Names of the dependencies, also of those for one target, and whether tests only use them.
fn dependencies(manifest: &Table) -> impl Iterator<Item = (String, bool)> {
    let targets = manifest.get("target").and_then(Value::as_table).into_iter().flat_map(Table::values);
    let tables = std::iter::once(manifest).chain(targets.filter_map(Value::as_table));
    let sections = tables.flat_map(|table| {
        [("dependencies", false), ("build-dependencies", false), ("dev-dependencies", true)]
            .into_iter()
            .filter_map(|(section, test_only)| Some((table.get(section)?.as_table()?, test_only)))
    });
    sections.flat_map(|(section, test_only)| section.keys().map(move |name| (name.clone(), test_only)))
}

/// The first names of all paths in a package's sources; folders of other packages inside its own are left out.
fn names_in_sources(root: &Path, package: &Package, packages: &[Package]) -> Result<BTreeSet<String>> {
    let folder = root.join(&package.folder);
    let inside: Vec<_> = packages
        .iter()
        .map(|other| root.join(&other.folder))
        .filter(|other| other.starts_with(&folder) && *other != folder)
        .collect();
    let mut names = BTreeSet::new();
    for file in rust_files(&folder)?.iter().filter(|file| !inside.iter().any(|other| file.starts_with(other)))
    {
        names.extend(first_names(&read(file)?).map_err(|error| format!("{}: {error}", file.display()))?);
    }
    Ok(names)
}
