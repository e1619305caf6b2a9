//! Warns of files that may have been truncated: entries lost at the end get their defaults without an error.

use std::path::Path;

/// A warning for each file among `names` whose last line has no line end.
pub fn warnings<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    names
        .filter(|name| Path::new(name).is_file())
        .filter(|name| std::fs::read(name).is_ok_and(|bytes| bytes.last().is_some_and(|last| *last != b'\n')))
        .map(|name| {
            format!("{name}: its last line has no end; if the file was cut, what is missing has its default")
        })
        .collect()
}
