//! Dependencies of the crates, and of the top modules inside `sim-host` and `control`: compares them with those that
//! `docs/architecture.toml` allows, and writes the figure and the tables of `docs/architecture.md`.

pub mod check;
pub mod figure;
pub mod graph;
pub mod imports;
pub mod layout;
pub mod manifests;
pub mod page;
pub mod sources;

use crate::Result;
use graph::Graph;
use sources::read;
use std::path::{Path, PathBuf};

/// The allowed dependencies, below the root of the repository.
const DATA: &str = "docs/architecture.toml";
/// The document with the figure and the tables.
const PAGE: &str = "docs/architecture.md";
/// The figure.
const FIGURE: &str = "docs/img/architecture.svg";

/// The graphs declared in the repository at `root`.
pub fn declared(root: &Path) -> Result<Vec<Graph>> {
    graph::parse(&read(&root.join(DATA))?).map_err(|error| format!("{DATA}: {error}"))
}

/// Every difference between the declared graphs and the sources at `root`, a line of text each.
pub fn differences(root: &Path, graphs: &[Graph]) -> Result<Vec<String>> {
    let mut lines = Vec::new();
    for graph in graphs {
        let found = match &graph.source {
            Some(folder) => sources::found(root, folder)?,
            None => manifests::found(root)?,
        };
        lines.extend(check::differences(graph, &found));
    }
    Ok(lines)
}

/// Path and text of each file that is made from the declared graphs.
pub fn files(root: &Path, graphs: &[Graph]) -> Result<[(PathBuf, String); 2]> {
    let page =
        page::with_tables(&read(&root.join(PAGE))?, graphs).map_err(|error| format!("{PAGE}: {error}"))?;
    Ok([(root.join(FIGURE), figure::svg(graphs)?), (root.join(PAGE), page)])
}

/// `cargo xtask architecture`: writes the figure and the tables, then fails if the sources have other dependencies.
pub fn architecture(root: &Path) -> Result<()> {
    let graphs = declared(root)?;
    let lines = differences(root, &graphs)?;
    if !lines.is_empty() {
        return Err(format!("the dependencies differ from {DATA}:\n  {}", lines.join("\n  ")));
    }
    for (path, text) in files(root, &graphs)? {
        std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
        println!("{}", path.display());
    }
    Ok(())
}
