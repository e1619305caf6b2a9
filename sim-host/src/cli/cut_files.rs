//! Files that may have been cut: what they lost at their end is a default, and nothing in them says so.

use std::path::Path;

/// A doubt for each file among `names` whose last line has no end. A file's name may stand in a name's parts: `NAME+FILE`,
/// `FILE,KEY=VALUE`, `SENSOR:model=FILE`.
pub(super) fn doubts<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    names
        .into_iter()
        .flat_map(|name| {
            [name].into_iter().chain(name.split(['+', ',', '=']).filter(move |part| *part != name))
        })
        .filter(|name| Path::new(name).is_file())
        .filter(|name| std::fs::read(name).is_ok_and(|bytes| bytes.last().is_some_and(|last| *last != b'\n')))
        .map(|name| {
            format!("{name}: its last line has no end; if the file was cut, what is missing has its default")
        })
        .collect()
}
