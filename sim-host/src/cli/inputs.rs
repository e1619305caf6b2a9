//! Checks of the files that a command reads: none is written over, none is read twice.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The options whose value is a file to write.
const OUTPUTS: [&str; 12] = [
    "--csv",
    "--frames",
    "--json",
    "--law-file",
    "--mcap",
    "--netcdf",
    "--out",
    "--png",
    "--record",
    "--report",
    "--svg",
    "--toml",
];

/// Checks the words of a command line: no existing file may be the value of an output option and another word, too.
///
/// # Errors
/// The option and the file.
pub(super) fn refuse_overwriting(words: impl Iterator<Item = OsString>) -> Result<(), String> {
    let (mut outputs, mut inputs): (Vec<(String, PathBuf)>, Vec<PathBuf>) = Default::default();
    let mut option: Option<String> = None;
    for word in words {
        let text = word.to_string_lossy();
        let output = |name: &str| OUTPUTS.contains(&name).then(|| name.to_owned());
        match (text.strip_prefix('-'), text.split_once('=')) {
            (Some(_), Some((name, value))) => match output(name) {
                Some(name) => outputs.push((name, value.into())),
                None => inputs.push(value.into()),
            },
            (Some(_), None) => option = output(&text),
            (None, _) => match option.take() {
                Some(name) => outputs.push((name, word.into())),
                None => inputs.push(word.into()),
            },
        }
    }
    let inputs: Vec<FileIdentity> = inputs.iter().filter_map(|input| file(input)).collect();
    let both = |(_, path): &&(String, PathBuf)| file(path).is_some_and(|path| inputs.contains(&path));
    match outputs.iter().find(both) {
        Some((name, path)) => Err(format!("{name} {}: the command reads this file, too", path.display())),
        None => Ok(()),
    }
}

/// Rejects a file given twice, which would count as a repeat in perfect agreement.
pub(super) fn once(files: &[PathBuf]) -> Result<(), String> {
    let mut seen = BTreeSet::new();
    match files.iter().find(|file| !seen.insert(file.canonicalize().unwrap_or_else(|_| (*file).clone()))) {
        Some(twice) => Err(format!("{} is given twice", twice.display())),
        None => Ok(()),
    }
}

/// What two paths of one file have in common: device and inode, which hard links share.
#[cfg(unix)]
type FileIdentity = (u64, u64);
/// What two paths of one file have in common.
#[cfg(not(unix))]
type FileIdentity = PathBuf;

#[cfg(unix)]
fn identity(path: &Path) -> Option<FileIdentity> {
    use std::os::unix::fs::MetadataExt;
    path.metadata().ok().filter(|file| file.is_file()).map(|file| (file.dev(), file.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path) -> Option<FileIdentity> {
    path.canonicalize().ok().filter(|path| path.is_file())
}

/// The existing file of a path, or of a path with the name of one of its entries (`FILE#NAME`).
fn file(path: &Path) -> Option<FileIdentity> {
    identity(path).or_else(|| identity(Path::new(path.to_str()?.rsplit_once('#')?.0)))
}

#[cfg(test)]
mod tests {
    use super::refuse_overwriting;

    fn refused(line: &str) -> Option<String> {
        refuse_overwriting(line.split(' ').map(Into::into)).err()
    }

    #[test]
    #[cfg(unix)]
    fn a_hard_link_is_the_same_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let [file, link] = ["file.csv", "link.csv"].map(|name| folder.path().join(name));
        std::fs::write(&file, "t\n").expect("written");
        std::fs::hard_link(&file, &link).expect("linked");
        let line = |output: &str| format!("replay {} --csv {output}", file.display());
        assert!(refused(&line(&link.display().to_string())).is_some_and(|why| why.contains("link.csv")));
        assert_eq!(refused(&line(&folder.path().join("other.csv").display().to_string())), None);
    }

    #[test]
    fn a_file_is_read_or_written() {
        let path = "src/cli/inputs.rs";
        assert!(refused(&format!("identify {path} --json {path}")).is_some_and(|why| why.contains("--json")));
        assert!(refused(&format!("basin --rider={path} --out=src/../{path}")).is_some());
        assert!(refused(&format!("basin --bicycle {path}#name --svg {path}")).is_some());
        assert!(refused(&format!("ride --scenario {path} --netcdf {path}")).is_some());
        assert!(refused(&format!("monitor --can {path} --mcap {path}")).is_some());
        assert_eq!(refused(&format!("identify {path} --json --csv new.csv")), None);
        assert_eq!(refused(&format!("identify {path} --json new.json")), None);
        assert_eq!(
            refused(&format!("basin --json {path} --csv {path}")),
            None,
            "two outputs in one place are refused elsewhere"
        );
        assert_eq!(refused("sweep src --out src"), None, "folders");
    }
}
