//! Patterns of log lines, as written in docs/hardware.md.
//!
//! Text is literal, `...` matches anything. Braces hold a number: `{-0.05 to 0.05}` in this range, `{140 to 160
//! more}` greater by that than in the previous line of this kind, `{within 0.02 of before}` within that of it.

/// A part of a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part<'p> {
    Text(&'p str),
    Anything,
    Number(Expected),
}

/// Requirement on a number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Expected {
    Between(f64, f64),
    More(f64, f64),
    Near(f64),
}

/// The pattern's parts; `None` where braces hold nothing valid.
fn parts(mut pattern: &str) -> Option<Vec<Part<'_>>> {
    let mut parts = Vec::new();
    while !pattern.is_empty() {
        let (part, rest) = if let Some(rest) = pattern.strip_prefix("...") {
            (Part::Anything, rest)
        } else if let Some((inside, rest)) = pattern.strip_prefix('{').and_then(|p| p.split_once('}')) {
            (Part::Number(expected(inside)?), rest)
        } else {
            let ends = ["...", "{"].iter().filter_map(|end| pattern.find(end));
            let (text, rest) = pattern.split_at(ends.min().unwrap_or(pattern.len()));
            (Part::Text(text), rest)
        };
        parts.push(part);
        pattern = rest;
    }
    Some(parts)
}

fn expected(inside: &str) -> Option<Expected> {
    if let Some(near) = inside.strip_prefix("within ").and_then(|rest| rest.strip_suffix(" of before")) {
        return near.parse().ok().map(Expected::Near);
    }
    let (range, more) = inside.strip_suffix(" more").map_or((inside, false), |range| (range, true));
    let (least, most) = range.split_once(" to ").unwrap_or((range, range));
    let (least, most) = (least.parse().ok()?, most.parse().ok()?);
    Some(if more { Expected::More(least, most) } else { Expected::Between(least, most) })
}

/// The numbers of a line that has the pattern's text, whatever their values.
fn numbers(parts: &[Part<'_>], line: &str) -> Option<Vec<f64>> {
    let (mut rest, mut found, mut anywhere) = (line, Vec::new(), true);
    for part in parts {
        match part {
            Part::Anything => anywhere = true,
            Part::Text(text) if anywhere => {
                rest = rest.split_once(text)?.1;
                anywhere = false;
            }
            Part::Text(text) => rest = rest.strip_prefix(text)?,
            Part::Number(_) => {
                let end = rest.find(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c)));
                let (number, after) = rest.split_at(end.unwrap_or(rest.len()));
                found.push(number.parse().ok()?);
                (rest, anywhere) = (after, false);
            }
        }
    }
    Some(found)
}

/// A line of the log or another instrument.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    /// Its text.
    pub(super) text: String,
    /// Whether it came after the last action.
    pub(super) new: bool,
}

/// Whether the newest line of the pattern's kind, which is that of its text up to the first `=` or number, is new and
/// matches.
///
/// # Panics
/// If the pattern is invalid.
pub(super) fn is_shown(pattern: &str, newest_first: &[Line]) -> bool {
    let parts = parts(pattern).unwrap_or_else(|| panic!("docs/hardware.md: braces of `{pattern}`"));
    let Some(Part::Text(first)) = parts.first() else {
        panic!("docs/hardware.md: `{pattern}` does not begin with text")
    };
    let kind = first.find('=').map_or(*first, |end| &first[..=end]);
    let mut lines = newest_first.iter().filter(|line| line.text.contains(kind));
    let now = lines.next().filter(|line| line.new).and_then(|line| numbers(&parts, &line.text));
    let Some(now) = now else { return false };
    let before = lines.next().and_then(|line| numbers(&parts, &line.text));
    let expected = parts
        .iter()
        .filter_map(|part| if let Part::Number(expected) = part { Some(*expected) } else { None });
    expected.zip(now).enumerate().all(|(place, (expected, now))| {
        let before = before.as_ref().map(|numbers| numbers[place]);
        match (expected, before) {
            (Expected::Between(least, most), _) => (least..=most).contains(&now),
            (Expected::More(least, most), Some(before)) => (least..=most).contains(&(now - before)),
            (Expected::Near(most), Some(before)) => (now - before).abs() <= most,
            (Expected::More(..) | Expected::Near(_), None) => false,
        }
    })
}

/// Situation: two lines of one kind and one of another, and a line from before the action.
/// Action: search for patterns.
/// Must hold: text, ranges, rises and distances are checked on the newest line of the kind only, at both ends of
/// their ranges; a line from before matches nothing.
#[test]
fn patterns_are_matched_on_the_newest_line() {
    let line = |new, text: &str| Line { text: text.into(), new };
    let lines = [
        line(true, "steps=3000 late=0 motor=able"),
        line(true, "calls=9 late=1 v=-2.5"),
        line(false, "steps=2000 late=0 motor=not ready"),
        line(false, "start 1"),
    ];
    let shown = |pattern: &str| is_shown(pattern, &lines);
    for yes in [
        "motor=able",
        "steps=... motor=able",
        "steps={1000 more} late=0",
        "steps={999 to 1000 more}",
        "steps={3000} late={0 to 1}",
        "calls=... v={-2.5 to 0}",
        "steps={within 1000 of before}",
    ] {
        assert!(shown(yes), "{yes}");
    }
    for no in [
        "motor=not ready",
        "steps={1001 to 2000 more}",
        "steps={2000}",
        "steps={3000}late",
        "v={-2.4 to 0}",
        "v={1 more}",
        "steps={within 999 of before}",
        "volts=",
        "start 1",
    ] {
        assert!(!shown(no), "{no}");
    }
}
