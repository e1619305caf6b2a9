//! The imports between the top modules of one crate.

use super::check::{Edge, Found};
use super::imports::{self, paths};
use crate::Result;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Top modules of the crate with sources in `folder`, and their imports. The root (`lib.rs`, `main.rs`, `bin/`) may
/// import all and is not a node.
pub fn found(root: &Path, folder: &str) -> Result<Found> {
    let source = root.join(folder);
    let files = rust_files(&source)?;
    let modules: Vec<Vec<String>> =
        files.iter().map(|file| module(file.strip_prefix(&source).unwrap_or(file))).collect();
    let nodes: BTreeSet<String> = modules.iter().filter_map(|module| module.first().cloned()).collect();
    let re_exports: BTreeMap<String, String> = imports::re_exports(&read(&source.join("lib.rs"))?)?
        .into_iter()
        .filter(|(_, to)| nodes.contains(to))
        .collect();
    let mut found = Found { nodes, ..Found::default() };
    for (file, module) in files.iter().zip(&modules) {
        let Some(from) = module.first() else { continue };
        let shown = file.strip_prefix(root).unwrap_or(file).display();
        for path in paths(&read(file)?, module).map_err(|error| format!("{shown}: {error}"))? {
            let place = format!("{shown}:{}", path.line);
            let Some(name) = path.names.first() else {
                found.unclear.push(format!("{place}: an import of the crate's root; name the module"));
                continue;
            };
            let to = if found.nodes.contains(name) { Some(name) } else { re_exports.get(name) };
            if let Some(to) = to.filter(|to| *to != from) {
                found.edges.push(Edge { from: from.clone(), to: to.clone(), test_only: false, place });
            }
        }
    }
    Ok(found)
}

/// Names of the module in a file: `a/b.rs` and `a/b/mod.rs` are `a::b`; the root has none.
fn module(file: &Path) -> Vec<String> {
    let mut names: Vec<String> = file
        .with_extension("")
        .components()
        .map(|part| part.as_os_str().to_string_lossy().into_owned())
        .collect();
    if names.last().is_some_and(|name| name == "mod") {
        names.pop();
    }
    let is_root =
        matches!(names.first().map(String::as_str), Some("bin")) || names == ["lib"] || names == ["main"];
    if is_root { Vec::new() } else { names }
}

/// The files `*.rs` below `folder`, sorted.
pub(super) fn rust_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| format!("{}: {error}", folder.display()))?.path();
        if path.is_dir() {
            files.extend(rust_files(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// The text of a file.
pub(super) fn read(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}
