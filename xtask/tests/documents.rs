//! Flight cards: documents for contributors name files that exist.

use xtask::image::root;

/// Situation: CONTRIBUTING.md and docs/architecture.md. Action: look for each path in backticks, with a known first folder and
/// without placeholders. Must hold: it exists; CONTRIBUTING.md has at least 30.
#[test]
fn named_files_exist() {
    for (page, least) in [("CONTRIBUTING.md", 30), ("docs/architecture.md", 0)] {
        let text = std::fs::read_to_string(root().join(page)).unwrap();
        let code = text.split('`').skip(1).step_by(2);
        let folders = ["control/", "firmware/", "sim-host/", "tests/", "xtask/", "docs/", "data/"];
        let paths: Vec<&str> = code
            .filter(|code| folders.iter().any(|folder| code.starts_with(folder)))
            .filter(|path| !path.contains(|c: char| c.is_ascii_uppercase() || c == '*' || c == ' '))
            .collect();
        let missing: Vec<_> = paths.iter().filter(|path| !root().join(path).exists()).collect();
        assert!(missing.is_empty(), "{page}: {missing:?}");
        assert!((least..200).contains(&paths.len()), "{page}: {} paths", paths.len());
    }
}
