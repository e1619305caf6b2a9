//! The chip's revision.

use devices::silicon::has_prefetch;

/// Situation: revision A, with its own identifier and the wrong one that it reports; the later revisions. Must hold:
/// prefetch on all but revision A.
#[test]
fn only_revision_a_has_no_prefetch() {
    assert!(!has_prefetch(0x413, 0x1000) && !has_prefetch(0x411, 0x2000));
    // Z, 1, 2 and Y, 5 and 6.
    assert!([0x1001, 0x1003, 0x1007, 0x100f, 0x101f].iter().all(|revision| has_prefetch(0x413, *revision)));
}
