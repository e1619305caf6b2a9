//! Share of a large set that is run: a part by default, all of it with `STEER_ASSIST_SLOW` set, as `cargo xtask test
//! --all` does and continuous integration does each night.

/// Whether all of it is run.
pub fn whole() -> bool {
    std::env::var_os("STEER_ASSIST_SLOW").is_some()
}

/// The first of the set and every `nth` after it; all of it when [`whole`].
pub fn every<T>(nth: usize, set: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
    set.into_iter().step_by(if whole() { 1 } else { nth })
}
