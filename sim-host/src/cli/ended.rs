//! How a command ends.

/// Error of a command.
pub(super) type Failure = Box<dyn std::error::Error>;

/// Options that do not fit each other or their input, found after parsing: exit code 2, as for all wrong usage.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct UsageError(pub(super) String);

/// How a command without an error ended.
pub(super) enum Ended {
    /// Complete.
    Done,
    /// Interrupted with Ctrl-C; finished results are written.
    Interrupted,
    /// Part of the input was unreadable, as reported.
    Partly,
}

/// Whether the error is that of a closed pipe.
pub(super) fn is_broken_pipe(e: &(dyn std::error::Error + 'static)) -> bool {
    let pipe = |e: &std::io::Error| e.kind() == std::io::ErrorKind::BrokenPipe;
    std::iter::successors(Some(e), |e| e.source()).any(|e| e.downcast_ref().is_some_and(pipe))
}
