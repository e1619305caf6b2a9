//! The tables of `docs/architecture.md`, one for each graph.

use super::graph::{Graph, Node};
use crate::Result;
use crate::document::with_table;
use std::collections::BTreeSet;

/// `page` with the table of each graph replaced. Fails if a graph has no place for its table.
pub fn with_tables(page: &str, graphs: &[Graph]) -> Result<String> {
    graphs.iter().try_fold(page.to_owned(), |page, graph| with_table(&page, &graph.name, &table(graph)?))
}

/// Rows from the highest layer to the lowest, by name in each.
fn table(graph: &Graph) -> Result<String> {
    let layers = graph.layers()?;
    let mut rows: Vec<_> =
        graph.nodes.iter().map(|(name, node)| (layers[name.as_str()], name, node)).collect();
    rows.sort_by_key(|(layer, name, _)| (std::cmp::Reverse(*layer), *name));
    let kind = if graph.source.is_some() { "module" } else { "crate" };
    let rows: String = rows
        .into_iter()
        .map(|(_, name, node)| format!("| `{name}` | {} | {} |\n", node.purpose, uses(node)))
        .collect();
    Ok(format!("| {kind} | contents | uses |\n| --- | --- | --- |\n{rows}"))
}

fn uses(node: &Node) -> String {
    let listed = |names: &BTreeSet<String>| {
        names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
    };
    match (node.uses.is_empty(), node.test_uses.is_empty()) {
        (_, true) => listed(&node.uses),
        (true, false) => format!("in tests {}", listed(&node.test_uses)),
        (false, false) => format!("{}; in tests {}", listed(&node.uses), listed(&node.test_uses)),
    }
}
