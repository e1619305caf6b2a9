//! Flight cards of the workspace: the tests themselves are the files in `tests/tests/`.
