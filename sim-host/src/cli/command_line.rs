//! The command line as a user would type it.

use std::env::args_os;

/// The arguments of this process, quoted for a shell, after the program's name.
pub(super) fn command_line() -> String {
    let arguments: Vec<String> = args_os().skip(1).map(|a| a.to_string_lossy().into_owned()).collect();
    let quoted = arguments.iter().map(|a| shlex::try_quote(a).map_or(a.as_str().into(), |quoted| quoted));
    ["sim-host".into()].into_iter().chain(quoted).collect::<Vec<_>>().join(" ")
}
