//! Runner of the chores.
fn main() {}
