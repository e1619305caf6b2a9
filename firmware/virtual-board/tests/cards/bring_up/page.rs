//! The checks of docs/hardware.md: its lines with an arrow.

/// A line of the page: an action, and what must then be shown.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Check {
    /// Number of its step.
    pub(super) step: u32,
    /// The action.
    pub(super) action: String,
    /// What must be shown, as of [`super::pattern`].
    pub(super) shows: Vec<String>,
}

/// The checks, in the order of the page.
///
/// # Panics
/// If the page has none, or one without an expected text.
pub(super) fn checks() -> Vec<Check> {
    let page = include_str!("../../../../../docs/hardware.md");
    let start = page.find("## Bring-up").expect("the section");
    let section = page[start..].split("\n## ").next().unwrap_or_default();
    let checks = read(section);
    assert!(!checks.is_empty(), "docs/hardware.md has no checks");
    for check in &checks {
        assert!(
            !check.shows.is_empty(),
            "docs/hardware.md, step {}: {} -> nothing",
            check.step,
            check.action
        );
    }
    checks
}

fn read(section: &str) -> Vec<Check> {
    let (mut step, mut items) = (0, Vec::<(u32, String)>::new());
    let mut inside = false;
    for line in section.lines() {
        let text = line.trim();
        let number = line.split_once(". ").and_then(|(number, _)| number.parse().ok());
        inside &= number.is_none() && !text.is_empty();
        step = number.unwrap_or(step);
        if let Some(item) = text.strip_prefix("- ") {
            items.push((step, item.to_owned()));
            inside = true;
        } else if let (true, Some((_, item))) = (inside, items.last_mut()) {
            item.push(' ');
            item.push_str(text);
        }
    }
    let check = |(step, item): (u32, String)| {
        let (action, shown) = item.split_once(" -> ")?;
        let shows = shown.split('`').skip(1).step_by(2).map(str::to_owned).collect();
        Some(Check { step, action: action.to_owned(), shows })
    };
    items.into_iter().filter_map(check).collect()
}

/// Situation: a list with prose, a hint and checks over one and two lines.
/// Action: read it.
/// Must hold: only the checks, each with its step.
#[test]
fn checks_are_the_items_with_an_arrow() {
    let section = "1. **One.** Prose\n   - Do it -> `a=1`, `b=2`\n   - a hint: `c`\n2. **Two.** Prose -> no item\n   - Do\n     that -> `d ...\n     e`\n";
    let check = |step, action: &str, shows: &[&str]| Check {
        step,
        action: action.into(),
        shows: shows.iter().map(|text| (*text).into()).collect(),
    };
    let expected = [check(1, "Do it", &["a=1", "b=2"]), check(2, "Do that", &["d ... e"])];
    assert_eq!(read(section), expected);
}
