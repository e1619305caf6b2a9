//! Arbitrary bytes on a link, through the fuzz bodies that cargo-fuzz runs too; docs/testing.md.

#[path = "../../../tests/fuzz/bodies.rs"]
mod bodies;

use proptest::collection::vec;
use proptest::prelude::*;
use std::path::Path;

/// Committed corpus of a body, by file name.
fn corpus(body: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/fuzz/corpus").join(body);
    let files = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files: Vec<_> = files.map(|file| file.expect("a file of the corpus").path()).collect();
    files.sort();
    files
        .into_iter()
        .map(|path| (path.display().to_string(), std::fs::read(&path).expect("readable")))
        .collect()
}

/// Situation: the corpus: edge bit patterns, frames of the border ride, records that are complete, damaged, too short
/// and too long.
/// Action: run each file through its body.
/// Must hold: the assertions of the body.
#[test]
fn the_corpus_satisfies_the_invariants() {
    for (name, body) in [
        ("frames", bodies::frames as fn(&[u8])),
        ("configuration", bodies::configuration),
        ("ride", bodies::ride),
    ] {
        let files = corpus(name);
        assert!(files.len() > 3, "{name}: {} files", files.len());
        for (file, bytes) in files {
            println!("{file}: {} bytes", bytes.len());
            body(&bytes);
        }
    }
}

/// Four bytes, often an edge case as f32 or as integer.
fn edge() -> impl Strategy<Value = [u8; 4]> {
    let numbers = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.1,
        100.0,
        1e5,
        1e10,
        -1e10,
        f32::MIN_POSITIVE,
        1e-45,
        f32::MAX,
        f32::MIN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];
    prop_oneof![
        3 => proptest::sample::select(numbers.to_vec()).prop_map(f32::to_le_bytes),
        2 => (-10.0_f32..10.0).prop_map(f32::to_le_bytes),
        1 => any::<[u8; 4]>(),
    ]
}

/// A configuration record in the form of its body, mostly with few patches, so that many are accepted.
fn damaged() -> impl Strategy<Value = Vec<u8>> {
    (any::<u8>(), vec((any::<u16>(), edge()), 0..4)).prop_map(|(choice, patches)| {
        let patches = patches.into_iter().flat_map(|(place, four)| {
            let [low, high] = place.to_le_bytes();
            [low, high].into_iter().chain(four)
        });
        std::iter::once(choice).chain(patches).collect()
    })
}

/// Frames of arbitrary numbers, mostly edge cases.
fn edges(bytes: usize) -> impl Strategy<Value = Vec<u8>> {
    vec(edge(), 0..bytes / 4).prop_map(|fours| fours.into_iter().flatten().collect())
}

proptest! {
    /// Situation: arbitrary bytes as frames.
    /// Action: decode and encode.
    /// Must hold: the assertions of the body.
    #[test]
    fn frames_survive_their_bytes(bytes in vec(any::<u8>(), 0..400)) {
        bodies::frames(&bytes);
    }

    /// Situation: records damaged in a few numbers.
    /// Action: decode, plan, ride.
    /// Must hold: the assertions of the body.
    #[test]
    fn a_configuration_is_rejected_or_rides(bytes in damaged()) {
        bodies::configuration(&bytes);
    }

    /// Situation: an engaged controller, then frames of arbitrary numbers.
    /// Action: step.
    /// Must hold: the assertions of the body.
    #[test]
    fn no_frame_leaves_the_limits(bytes in edges(2_000)) {
        bodies::ride(&bytes);
    }
}
