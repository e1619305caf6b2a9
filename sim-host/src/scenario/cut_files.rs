//! Warns of files that may have been truncated: entries lost at the end get their defaults without an error.

use std::path::Path;

/// A warning for each file among `names` whose last line has no line end.
pub fn warnings<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    names
        .filter(|name| Path::new(name).is_file())
        .filter(|name| {
            crate::input_file::text(Path::new(name))
                .is_ok_and(|text| !text.is_empty() && !text.ends_with('\n'))
        })
        .map(|name| {
            format!("{name}: its last line has no end; if the file was cut, what is missing has its default")
        })
        .collect()
}
