//! No input makes control, motor or link panic on the chip: their code contains no panic path.

use xtask::image;

/// Situation: an image with every public function of `control`, `motor` and, except for the store, `link`, whose
/// panic handler needs a symbol that does not exist.
/// Action: link it as it is, and with one `unwrap` added.
/// Must hold: the first links, so the linker found no path to the handler; the second does not, for exactly that
/// symbol.
#[test]
fn there_is_no_panic_path() {
    if !image::ready() {
        return;
    }
    let as_it_is = image::link_no_panic(false).unwrap();
    assert_eq!(as_it_is.status, Some(0), "{}", as_it_is.stderr);
    let with_unwrap = image::link_no_panic(true).unwrap();
    assert_ne!(with_unwrap.status, Some(0), "an unwrap was not detected");
    let undefined: Vec<_> = with_unwrap.stderr.lines().filter(|l| l.contains("undefined symbol")).collect();
    assert!(undefined.len() == 1 && undefined[0].contains("there_is_a_panic_path"), "{}", with_unwrap.stderr);
}
