//! Flight cards: the dependencies between crates and between top modules, their figure and their tables.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;
use xtask::architecture::check::{self, Edge, Found};
use xtask::architecture::graph::{Graph, parse};
use xtask::architecture::imports::{first_names, paths, re_exports};
use xtask::architecture::layout::{Area, layout};
use xtask::architecture::{declared, differences, files};
use xtask::image::root;

/// Situation: the sources of this repository and `docs/architecture.toml`.
/// Action: compare every import and every `Cargo.toml` with the declared dependencies.
/// Must hold: no import that is not declared, none declared that does not occur.
#[test]
fn sources_have_the_declared_dependencies() {
    let lines = differences(root(), &declared(root()).unwrap()).unwrap();
    assert!(lines.is_empty(), "compare with docs/architecture.toml:\n{}", lines.join("\n"));
}

/// Situation: the files in version control, if this is a clone.
/// Action: list those at the top level, and the largest.
/// Must hold: only the known files are at the top level: no package or result that a command left there. None has more than
/// 1 MB, but there are some of 100 kB.
#[test]
fn nothing_else_is_in_version_control() {
    let listed =
        Command::new("git").args(["ls-tree", "-r", "-l", "--full-tree", "HEAD"]).current_dir(root()).output();
    let Some(listed) = listed.ok().filter(|listed| listed.status.success()) else {
        println!("skipped: not a clone, or no git");
        return;
    };
    let listed = String::from_utf8(listed.stdout).unwrap();
    let files: Vec<(u64, &str)> = listed
        .lines()
        .map(|line| {
            let (of, path) = line.split_once('\t').unwrap();
            (of.split_whitespace().last().unwrap().parse().unwrap(), path)
        })
        .collect();
    let top: Vec<&str> = files.iter().map(|(_, path)| *path).filter(|path| !path.contains('/')).collect();
    let known = [
        ".gitignore",
        "CHANGELOG.md",
        "CONTRIBUTING.md",
        "Cargo.lock",
        "Cargo.toml",
        "LICENSE-APACHE",
        "LICENSE-MIT",
        "README.md",
        "memory.x",
        "rustfmt.toml",
    ];
    assert_eq!(top, known);
    let (size, path) = files.iter().max().unwrap();
    assert!((100_000..1_000_000).contains(size), "{path} has {size} bytes");
}

/// Situation: the committed figure and page.
/// Action: make both from `docs/architecture.toml`.
/// Must hold: the same bytes.
#[test]
fn figure_and_tables_are_up_to_date() {
    for (path, text) in files(root(), &declared(root()).unwrap()).unwrap() {
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(committed == text, "{}: run `cargo xtask architecture`", path.display());
    }
}

/// The number of parts of a graph that no dependency joins.
fn parts(graph: &Graph) -> usize {
    let mut first: BTreeMap<&str, &str> = graph.nodes.keys().map(|name| (&**name, &**name)).collect();
    for _ in 0..graph.nodes.len() {
        for (name, node) in &graph.nodes {
            for used in &node.uses {
                let least = first[&**name].min(first[&**used]);
                first.extend([(&**name, least), (&**used, least)]);
            }
        }
    }
    first.into_values().collect::<BTreeSet<_>>().len()
}

/// Situation: the declared graphs, drawn.
/// Action: compare each box with its neighbours, and each line with all boxes.
/// Must hold: boxes of a layer are 16 px apart; every line ends at boxes and passes none. A box has room for its name
/// and at most 30 px more.
#[test]
fn boxes_and_lines_do_not_overlap() {
    for graph in declared(root()).unwrap() {
        let panel = layout(&graph).unwrap();
        let boxes: Vec<_> = panel.boxes.iter().collect();
        for (at, (name, a)) in boxes.iter().enumerate() {
            let room = a.width - 8.0 * name.len() as f64;
            assert!((10.0..=30.0).contains(&room), "{name}: {room}");
            for (other, b) in &boxes[at + 1..] {
                let apart = (b.x - (a.x + a.width)).max(a.x - (b.x + b.width));
                assert!(a.y != b.y || apart >= 15.0, "{name} and {other}: {apart}");
            }
        }
        for line in &panel.edges {
            for (name, area) in &boxes {
                let inside =
                    |x: f64, y: f64| x > area.x && x < area.x + area.width && y > area.y && y < area.y + 28.0;
                assert!(line.iter().all(|&(x, y)| !inside(x, y)), "{name}: {line:?}");
            }
        }
        // A tree at least of each part that arrows join, without the boxes that no arrow joins. Those stand beside another.
        let used = |name: &String| graph.nodes.values().any(|node| node.uses.contains(name));
        let (joined, alone): (Vec<_>, Vec<_>) =
            graph.nodes.iter().partition(|(name, node)| !node.uses.is_empty() || used(name));
        let parts = parts(&graph);
        assert!(panel.edges.len() >= joined.len() - (parts - alone.len()), "{}", graph.name);
        for (name, _) in alone {
            let a = &panel.boxes[name];
            let beside =
                |b: &Area| (15.0..=17.0).contains(&(b.x - (a.x + a.width)).max(a.x - (b.x + b.width)));
            assert!(panel.boxes.values().any(|b| a.y == b.y && beside(b)), "{name}");
        }
    }
}

/// Situation: a source of the module `plant::motor` with imports in every form, in comments, strings and macros.
/// Action: read its paths.
/// Must hold: exactly these, from the root, with their lines.
#[test]
fn imports_of_every_form_are_read() {
    let source = r##"//! [`crate::doc`]
use crate::ride::{self, event::{Event, Fall as Down}, start};
use super::{friction, super::range};
pub(in super::super) use self::own::*;
/* crate::comment */ // crate::line
fn f<'a>(x: &'a crate::num::Lanes) -> bool {
    let text = ("crate::text", r#"crate::raw"#, '\'');
    assert!(matches!(x, crate::num::Lanes { .. }), "{text:?}");
    crate::integrate::step::<crate::basin::Plane>(x)
}
mod tests {
    use super::super::super::rider;
    use super::*;
}
"##;
    let module = ["plant".to_owned(), "motor".to_owned()];
    let found: Vec<String> = paths(source, &module)
        .unwrap()
        .iter()
        .map(|path| format!("{} {}", path.line, path.names.join("::")))
        .collect();
    let expected = [
        "2 ride",
        "2 ride::event::Event",
        "2 ride::event::Fall",
        "2 ride::start",
        "3 plant::friction",
        "3 range",
        "4 plant::motor::own",
        "6 num::Lanes",
        "8 num::Lanes",
        "9 integrate::step",
        "9 basin::Plane",
        "12 rider",
        "13 plant::motor",
    ];
    assert_eq!(found, expected);
}

/// Situation: imports of a crate's root itself: by `*`, by another name, and as a restriction of visibility.
/// Action: read their paths.
/// Must hold: the first two are found, without a name; the restriction is not an import.
#[test]
fn an_import_of_the_root_is_found() {
    let module = ["plant".to_owned()];
    for (source, count) in
        [("use super::*;", 1), ("use crate::{self as all};", 1), ("pub(in crate) fn f() {}", 0)]
    {
        let found = paths(source, &module).unwrap();
        assert_eq!(found.iter().filter(|path| path.names.is_empty()).count(), count, "{source}");
        assert_eq!(found.len(), count, "{source}");
    }
}

/// Situation: a root with re-exports, and a source that names other crates.
/// Action: read the re-exports and the first names.
/// Must hold: each name with its module; only the first name of each path.
#[test]
fn re_exports_and_other_crates_are_read() {
    let root = "pub mod law; pub use law::{Law, table::Table as Gains}; pub use crate::fault::Cause;";
    let expected = [("Law", "law"), ("Gains", "law"), ("Cause", "fault")];
    assert_eq!(
        re_exports(root).unwrap(),
        expected.map(|(name, module)| (name.to_owned(), module.to_owned()))
    );
    let names =
        first_names("use ::link::frame::read; fn f() { control::step(std::mem::take(x), y.z) }").unwrap();
    assert_eq!(names, ["link", "control", "std"]);
}

/// Situation: text that is not Rust's. Action: read its paths. Must hold: an error with the line.
#[test]
fn a_damaged_source_is_an_error() {
    let error = paths("fn f() {}\nfn g( {\n", &[]).unwrap_err();
    assert!(error.starts_with("line "), "{error}");
}

const DECLARED: &str = "
[[graph]]
name = 'small'
source = 'src'
[graph.node.low]
purpose = 'numbers'
[graph.node.high]
purpose = 'rides'
uses = ['low']
";

fn small() -> Graph {
    parse(DECLARED).unwrap().remove(0)
}

fn found(nodes: &[&str], edges: &[(&str, &str)]) -> Found {
    let edge = |&(from, to): &(&str, &str)| Edge {
        from: from.into(),
        to: to.into(),
        test_only: false,
        place: "src/a.rs:7".into(),
    };
    Found {
        nodes: nodes.iter().map(|name| (*name).to_owned()).collect(),
        edges: edges.iter().map(edge).collect(),
        unclear: vec![],
    }
}

/// Situation: a small graph; sources that agree, import more, import less, have another module, or lack one.
/// Action: compare.
/// Must hold: agreement gives nothing; each difference one line with its names, an import also with file and line.
#[test]
fn every_difference_is_named() {
    type Case<'a> = (&'a [&'a str], &'a [(&'a str, &'a str)], &'a [&'a str]);
    let cases: [Case; 5] = [
        (&["high", "low"], &[("high", "low"), ("high", "low")], &[]),
        (&["high", "low"], &[("high", "low"), ("low", "high")], &["src/a.rs:7: low -> high is not declared"]),
        (&["high", "low"], &[], &["small: high -> low is declared and does not occur"]),
        (
            &["high", "low", "new"],
            &[("high", "low"), ("new", "low"), ("new", "low")],
            &["small: `new` is not declared; uses = [\"low\"]"],
        ),
        (
            &["low"],
            &[],
            &[
                "small: `high` is declared and does not exist",
                "small: high -> low is declared and does not occur",
            ],
        ),
    ];
    for (nodes, edges, expected) in cases {
        assert_eq!(check::differences(&small(), &found(nodes, edges)), expected);
    }
}

/// Situation: files with a circle, an unknown name, an unknown key, a name twice, a node without a purpose.
/// Action: read them.
/// Must hold: each is rejected, and the error names the place.
#[test]
fn wrong_declarations_are_rejected() {
    for (from, to, word) in [
        ("purpose = 'numbers'", "purpose = 'numbers'\nuses = ['high']", "circle"),
        ("uses = ['low']", "uses = ['lower']", "unknown `lower`"),
        ("uses = ['low']", "use = ['low']", "unknown key `use`"),
        ("uses = ['low']", "uses = ['low', 'low']", "twice"),
        ("purpose = 'rides'", "", "no `purpose`"),
        ("name = 'small'", "", "without a name"),
    ] {
        let error = parse(&DECLARED.replace(from, to)).unwrap_err();
        assert!(error.contains(word), "{word}: {error}");
    }
}

/// Situation: the graphs of this repository.
/// Action: reduce them to the drawn lines.
/// Must hold: what can be reached by drawn lines is what can be reached by all.
#[test]
fn drawn_lines_reach_the_same() {
    fn reached<'a>(edges: &[(&'a str, &'a str)], from: &'a str) -> BTreeSet<&'a str> {
        let next = edges.iter().filter(|(a, _)| *a == from).map(|(_, b)| *b);
        next.flat_map(|to| reached(edges, to).into_iter().chain([to])).collect()
    }
    for graph in declared(root()).unwrap() {
        let all: Vec<(&str, &str)> = graph
            .nodes
            .iter()
            .flat_map(|(from, node)| node.uses.iter().map(move |to| (from.as_str(), to.as_str())))
            .collect();
        let drawn = graph.reduced();
        assert!(drawn.len() < all.len(), "{}", graph.name);
        for name in graph.nodes.keys() {
            assert_eq!(reached(&drawn, name), reached(&all, name), "{name}");
        }
    }
}
