//! The file of published values itself.

use tests::published;

#[test]
fn every_published_value_has_a_source_and_a_reason_for_its_tolerance() {
    assert!(published::names().len() >= 8);
    for name in published::names() {
        let entry = published::entry(&name);
        assert!(entry.text("source").len() > 10 && entry.text("reason").len() > 10, "{name}");
        // Only values read off a figure or found by bisection are compared more coarsely.
        let coarse = ["figure", "bisection"].iter().any(|word| entry.text("reason").contains(word));
        let most = if coarse { 0.5 } else { 0.01 };
        assert!(entry.tolerance() > 0.0 && entry.tolerance() <= most, "{name}");
    }
}
