//! The simulator's program, run as by a user, in a folder of its own.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// The program in a fresh folder.
pub struct Bench {
    program: &'static str,
    folder: TempDir,
}

/// Result of a run.
#[derive(Debug)]
pub struct Run {
    /// Exit code; none after a signal.
    pub code: Option<i32>,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Bench {
    /// A fresh folder for `program`, which a test gets from `env!("CARGO_BIN_EXE_sim-host-under-test")`.
    pub fn new(program: &'static str) -> Self {
        Self { program, folder: TempDir::new().expect("a temporary folder") }
    }

    /// A file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).expect("the folder can be written to");
    }

    /// Reads a text file.
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// The names of all files, including hidden ones.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).expect("the folder is there");
        let mut names: Vec<_> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The program with the arguments of `line`, in the folder; standard input is empty.
    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(self.program);
        command
            .args(shlex::split(line).expect("quotation marks are closed"))
            .current_dir(self.folder.path())
            .stdin(Stdio::null());
        command
    }

    /// A line for `sh`, in which `"$0"` is the program; quoted, as its folder can have blanks.
    pub fn shell(&self, line: &str) -> Run {
        let mut command = Command::new("sh");
        command.args(["-c", line, self.program]).current_dir(self.folder.path()).stdin(Stdio::null());
        command.output().expect("sh runs").into()
    }

    /// Runs the program with the arguments of `line`.
    pub fn run(&self, line: &str) -> Run {
        self.command(line).output().expect("the program runs").into()
    }

    /// The document a command that must succeed writes to standard output.
    pub fn json(&self, line: &str) -> Value {
        let run = self.run(&format!("{line} --json"));
        assert_eq!(run.code, Some(0), "{line}: {}", run.stderr);
        serde_json::from_str(&run.stdout).unwrap_or_else(|e| panic!("{line}: {e}"))
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        Self { code: output.status.code(), stdout: text(&output.stdout), stderr: text(&output.stderr) }
    }
}

impl Run {
    /// Checks that the run was rejected, exit code 1, in one paragraph that names every one of `named`.
    pub fn rejected_naming(&self, named: &[&str]) {
        assert_eq!(self.code, Some(1), "{self:?}");
        assert_eq!(self.stdout, "");
        let message = self.stderr.strip_prefix("error: ").unwrap_or_else(|| panic!("{self:?}"));
        assert!(message.len() < 1500 && !message.contains("\n\n"), "{message}");
        for word in named {
            assert!(message.contains(word), "no `{word}` in: {message}");
        }
    }
}

/// A small file system on a folder, unmounted when dropped.
pub struct SmallDisk(PathBuf);

impl SmallDisk {
    /// Mounts one of `bytes` bytes on a new folder; `None` without the right to, as for anyone but root.
    pub fn mounted(folder: PathBuf, bytes: usize) -> Option<Self> {
        std::fs::create_dir_all(&folder).expect("a folder");
        let size = format!("size={bytes}");
        let mount = Command::new("mount").args(["-t", "tmpfs", "-o", &size, "tmpfs"]).arg(&folder).output();
        mount.is_ok_and(|run| run.status.success()).then_some(Self(folder))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

/// A file of the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace").join(path)
}

/// A path as one argument of a command line, whatever the folder's name.
pub fn word(path: &Path) -> String {
    let text = path.to_str().expect("a path in UTF-8");
    shlex::try_quote(text).expect("no zero byte in a path").into_owned()
}

/// A flat parameter file: the benchmark bicycle with the line of `key` replaced.
pub fn bicycle_with(key: &str, line: &str) -> String {
    let text = std::fs::read_to_string(repository("data/bicycles/example.toml")).expect("the example");
    let start = format!("{key} = ");
    assert!(text.lines().any(|l| l.starts_with(&start)), "{key}");
    let lines = text.lines().map(|l| if l.starts_with(&start) { line } else { l });
    lines.collect::<Vec<_>>().join("\n")
}
