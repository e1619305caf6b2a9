//! `docs/cli.md` and `docs/replay.md` are true: their examples run and give the documented output, every option is in
//! it.

use tests::cli::{Bench, repository};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

fn document() -> String {
    page("cli.md")
}

fn page(name: &str) -> String {
    std::fs::read_to_string(repository("docs").join(name)).unwrap()
}

/// The fenced blocks in `language`.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    text.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap().to_owned()).collect()
}

/// Whether `output` matches `expected`, in which `...` matches anything.
fn matches(expected: &str, mut output: &str) -> bool {
    let mut parts = expected.split("...\n");
    let (first, rest) = (parts.next().unwrap_or_default(), parts.collect::<Vec<_>>());
    let Some(after) = output.strip_prefix(first) else { return false };
    output = after;
    for part in &rest {
        let Some(at) = output.find(part) else { return false };
        output = &output[at + part.len()..];
    }
    output.is_empty() || rest.last().is_some_and(|last| last.is_empty())
}

/// Situation: the examples with their output in the documents.
/// Action: run them in the repository's folder.
/// Must hold: the output is the documented one, except for the parts left out there.
#[test]
fn documented_examples_have_the_documented_output() {
    let (bench, mut examples) = (Bench::new(PROGRAM), 0);
    for block in [document(), page("replay.md")].iter().flat_map(|page| blocks(page, "console")) {
        for example in block.split("$ sim-host ").skip(1) {
            let (line, expected) = example.split_once('\n').unwrap();
            let run = bench.command(line).current_dir(repository("")).output().unwrap();
            let output = String::from_utf8([run.stdout, run.stderr].concat()).unwrap();
            assert!(matches(expected, &output), "$ sim-host {line}\n{output}");
            examples += 1;
        }
    }
    assert!(examples >= 8);
}

/// Situation: the other examples.
/// Action: give their options with `--help` after them.
/// Must hold: none is unknown.
#[test]
fn documented_commands_have_known_options() {
    let bench = Bench::new(PROGRAM);
    for block in blocks(&document(), "sh") {
        for line in block.lines().filter_map(|l| l.strip_prefix("sim-host ")) {
            let texts = line.split(" > ").next().unwrap();
            let run = bench.run(&format!("{texts} --help"));
            assert_eq!(run.code, Some(0), "{line}: {}", run.stderr);
        }
    }
}

/// Situation: the options in every command's help.
/// Action: find them in the document.
/// Must hold: all are there; a default of a text or number is in the option's line.
#[test]
fn every_option_is_documented_with_its_default() {
    let (bench, document) = (Bench::new(PROGRAM), document());
    for command in [
        "basin",
        "ride",
        "replay",
        "eigen",
        "bicycle show",
        "bicycle check",
        "bicycle accel",
        "rider show",
        "rider check",
        "basin compare",
        "basin plane",
        "sweep",
        "sweep merge",
        "thesis",
        "study",
        "design",
        "identify weave",
        "identify sensor",
    ] {
        let help = bench.run(&format!("{command} --help")).stdout;
        let mut option = "";
        for line in help.lines().map(str::trim) {
            if let Some(at) = line.find("--").filter(|&at| at == 0 || line.starts_with('-')) {
                option = line[at..].split([' ', '[']).next().unwrap();
                let documented = option == "--help" || document.contains(&format!("`{option}"));
                assert!(documented || document.contains(&format!(" {option}")), "{command} {option}");
            } else if let Some(default) = line.strip_prefix("[default: ").and_then(|d| d.strip_suffix(']')) {
                let mut rows = document.lines().filter(|l| l.starts_with(&format!("| `{option}")));
                // Several commands have an option of that name, each with a row.
                let output = rows.any(|row| row.contains(default));
                assert!(output || command == "eigen", "{command} {option}: {default}");
            }
        }
    }
}
