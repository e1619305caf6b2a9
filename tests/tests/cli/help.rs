//! The layout of every command's help.

use tests::cli::Bench;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
/// Characters of the longest line.
const WIDTH: usize = 100;

/// The help of every command and of its subcommands, each with the command.
fn helps(bench: &Bench) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut open = vec![String::new()];
    while let Some(command) = open.pop() {
        let help = bench.run(&format!("{command} --help")).stdout;
        let listed =
            help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
        let names =
            listed.filter(|line| !line.starts_with("   ")).filter_map(|line| line.split_whitespace().next());
        open.extend(names.filter(|name| *name != "help").map(|name| format!("{command} {name}")));
        found.push((command, help));
    }
    found
}

/// Whether a line of text between two other blanks has more of them: not the columns of options, commands and examples.
fn has_a_gap(line: &str) -> bool {
    let text = line.trim();
    let in_columns =
        line.starts_with("  ") && !line.starts_with("          ") || text.starts_with(['-', '<', '[']);
    !in_columns && text.contains("  ")
}

/// Situation: the help of every command and subcommand, more than 30.
/// Action: read it.
/// Must hold: no line but the usage is longer than 100 characters; no run of blanks in a sentence; no line of a paragraph ends before the next word would be beyond the width, as hard-wrapped text does.
#[test]
fn every_help_is_wrapped_once() {
    let helps = helps(&Bench::new(PROGRAM));
    assert!((30..80).contains(&helps.len()), "{}", helps.len());
    for (command, help) in &helps {
        let lines: Vec<&str> = help.lines().collect();
        for line in &lines {
            assert!(line.chars().count() <= WIDTH || line.starts_with("Usage: "), "{command}: {line}");
            assert!(!has_a_gap(line), "{command}: {line}");
        }
        for pair in lines.windows(2) {
            let of_paragraph = |line: &str| line.starts_with(|c: char| !c.is_whitespace());
            let (line, next) = (pair[0], pair[1].split(' ').next().unwrap_or_default());
            let full = line.chars().count() + 1 + next.chars().count() > WIDTH;
            assert!(full || !of_paragraph(line) || !of_paragraph(pair[1]), "{command}: {line} / {next}");
        }
    }
}
