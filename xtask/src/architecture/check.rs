//! Compares the dependencies found in the sources with the declared ones.

use super::graph::{Graph, Node};
use std::collections::{BTreeMap, BTreeSet};

/// What the sources contain.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// Names of the nodes.
    pub nodes: BTreeSet<String>,
    /// The dependencies, each occurrence.
    pub edges: Vec<Edge>,
    /// What cannot be checked, with file and line.
    pub unclear: Vec<String>,
}

/// One occurrence of a dependency.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// The node that imports.
    pub from: String,
    /// The node that is imported.
    pub to: String,
    /// Whether a crate's tests only import it.
    pub test_only: bool,
    /// File, relative to the repository, and line: `path:12`.
    pub place: String,
}

/// Every difference, a line each: imports that are not declared, with file and line; declared ones that do not occur;
/// nodes that exist on one side only.
pub fn differences(graph: &Graph, found: &Found) -> Vec<String> {
    let name = &graph.name;
    let declared: BTreeSet<String> = graph.nodes.keys().cloned().collect();
    let missing = found.nodes.difference(&declared).map(|node| {
        let uses = found.edges.iter().filter(|edge| edge.from == *node && !edge.test_only);
        let uses: Vec<&str> =
            uses.map(|edge| edge.to.as_str()).collect::<BTreeSet<_>>().into_iter().collect();
        format!("{name}: `{node}` is not declared; uses = {uses:?}")
    });
    let extra = declared
        .difference(&found.nodes)
        .map(|node| format!("{name}: `{node}` is declared and does not exist"));
    let forbidden = found
        .edges
        .iter()
        .filter(|edge| {
            graph.nodes.get(&edge.from).is_some_and(|node| !uses(node, edge.test_only).contains(&edge.to))
        })
        .map(|edge| {
            format!("{}: {} -> {} is not declared{}", edge.place, edge.from, edge.to, suffix(edge.test_only))
        });
    let mut occurring: BTreeMap<(&str, bool), BTreeSet<&str>> = BTreeMap::new();
    for edge in &found.edges {
        occurring.entry((&edge.from, edge.test_only)).or_default().insert(&edge.to);
    }
    let unused = graph.nodes.iter().flat_map(|(from, node)| {
        let occurring = &occurring;
        [false, true].into_iter().flat_map(move |test_only| {
            let absent = uses(node, test_only).iter().filter(move |to| {
                !occurring.get(&(from.as_str(), test_only)).is_some_and(|found| found.contains(to.as_str()))
            });
            absent.map(move |to| {
                format!("{name}: {from} -> {to} is declared{} and does not occur", suffix(test_only))
            })
        })
    });
    missing.chain(extra).chain(forbidden).chain(unused).chain(found.unclear.iter().cloned()).collect()
}

fn uses(node: &Node, test_only: bool) -> &BTreeSet<String> {
    if test_only { &node.test_uses } else { &node.uses }
}

fn suffix(test_only: bool) -> &'static str {
    if test_only { " for tests" } else { "" }
}
