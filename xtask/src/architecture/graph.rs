//! The allowed dependencies as data, and their order in layers.

use crate::Result;
use std::collections::{BTreeMap, BTreeSet};
use toml::{Table, Value};

/// One graph of the file: the crates of the workspace, or the top modules of one crate.
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    /// Name, the heading in the figure.
    pub name: String,
    /// Folder of the sources whose top modules are the nodes; `None`: the nodes are the crates of the workspace.
    pub source: Option<String>,
    /// The nodes by name.
    pub nodes: BTreeMap<String, Node>,
}

/// A crate or a top module.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Node {
    /// What it contains.
    pub purpose: String,
    /// Nodes that it may import, and does.
    pub uses: BTreeSet<String>,
    /// Of a crate: those that only its tests import.
    pub test_uses: BTreeSet<String>,
}

/// Reads the file's text. Errors name the graph, the node and the key.
pub fn parse(text: &str) -> Result<Vec<Graph>> {
    let mut table: Table = text.parse().map_err(|error: toml::de::Error| error.to_string())?;
    let graphs = table.remove("graph").ok_or("no [[graph]]")?;
    no_other_key(&table, "the file")?;
    let Value::Array(graphs) = graphs else { return Err("graph: expected [[graph]]".into()) };
    graphs.into_iter().map(graph).collect()
}

fn graph(value: Value) -> Result<Graph> {
    let Value::Table(mut table) = value else { return Err("graph: expected [[graph]]".into()) };
    let name = string(&mut table, "name")?.ok_or("a [[graph]] without a name")?;
    let source = string(&mut table, "source")?;
    let Some(Value::Table(nodes)) = table.remove("node") else {
        return Err(format!("{name}: no [graph.node.NAME]"));
    };
    no_other_key(&table, &name)?;
    let nodes = nodes
        .into_iter()
        .map(|(key, value)| {
            node(value).map(|node| (key.clone(), node)).map_err(|e| format!("{name}, {key}: {e}"))
        })
        .collect::<Result<_>>()?;
    let graph = Graph { name, source, nodes };
    graph.layers()?;
    Ok(graph)
}

fn node(value: Value) -> Result<Node> {
    let Value::Table(mut table) = value else { return Err("expected a table".into()) };
    let purpose = string(&mut table, "purpose")?.ok_or("no `purpose`")?;
    let (uses, test_uses) = (names(&mut table, "uses")?, names(&mut table, "test_uses")?);
    no_other_key(&table, "the node")?;
    Ok(Node { purpose, uses, test_uses })
}

fn string(table: &mut Table, key: &str) -> Result<Option<String>> {
    match table.remove(key) {
        None => Ok(None),
        Some(Value::String(text)) => Ok(Some(text)),
        Some(other) => Err(format!("{key}: expected a string, not {other:?}")),
    }
}

fn names(table: &mut Table, key: &str) -> Result<BTreeSet<String>> {
    let Some(value) = table.remove(key) else { return Ok(BTreeSet::new()) };
    let Value::Array(values) = value else { return Err(format!("{key}: expected an array of names")) };
    let count = values.len();
    let names: BTreeSet<String> = values
        .into_iter()
        .map(|value| match value {
            Value::String(text) => Ok(text),
            other => Err(format!("{key}: expected a name, not {other:?}")),
        })
        .collect::<Result<_>>()?;
    if names.len() == count { Ok(names) } else { Err(format!("{key}: a name occurs twice")) }
}

fn no_other_key(table: &Table, place: &str) -> Result<()> {
    table.keys().next().map_or(Ok(()), |key| Err(format!("{place}: unknown key `{key}`")))
}

impl Graph {
    /// Layer of each node: 0 if it uses none, else one above the highest that it uses. Fails on an unknown name and on
    /// a circle.
    pub fn layers(&self) -> Result<BTreeMap<&str, usize>> {
        let mut layers = BTreeMap::new();
        while layers.len() < self.nodes.len() {
            let before = layers.len();
            for (name, node) in &self.nodes {
                if let Some(unknown) =
                    node.uses.union(&node.test_uses).find(|used| !self.nodes.contains_key(*used))
                {
                    return Err(format!("{}, {name}: uses the unknown `{unknown}`", self.name));
                }
                let below: Option<Vec<usize>> =
                    node.uses.iter().map(|used| layers.get(used.as_str()).copied()).collect();
                if let Some(below) = below {
                    layers.insert(name.as_str(), below.iter().max().map_or(0, |highest| highest + 1));
                }
            }
            if layers.len() == before {
                let rest = self.nodes.keys().filter(|name| !layers.contains_key(name.as_str()));
                let rest: Vec<&str> = rest.map(String::as_str).collect();
                return Err(format!("{}: a circle among or below {}", self.name, rest.join(", ")));
            }
        }
        Ok(layers)
    }

    /// The dependencies that do not follow from others: without `a -> c` if `a -> b` and `b` reaches `c`.
    pub fn reduced(&self) -> Vec<(&str, &str)> {
        let edges =
            self.nodes.iter().flat_map(|(from, node)| node.uses.iter().map(move |to| (from, node, to)));
        edges
            .filter(|(_, node, to)| !node.uses.iter().any(|other| other != *to && self.reaches(other, to)))
            .map(|(from, _, to)| (from.as_str(), to.as_str()))
            .collect()
    }

    fn reaches(&self, from: &str, to: &str) -> bool {
        from == to || self.nodes[from].uses.iter().any(|used| self.reaches(used, to))
    }
}
