//! Powered boards, and requests to them over the serial line.

use crate::bed::{Listener, request as bytes_of};
use control::safety::press::PressConfig;
use link::message::Message;
use std::path::PathBuf;
use virtual_board::wiring::Wiring;
use virtual_board::{Bench, Options};

/// The image that is flashed for the product, and the one that aligns the encoder.
pub(crate) const PRODUCT: &str = "board-vesc6";
pub(crate) const ALIGN: &str = "board-vesc6-align";

/// Longest time from power-on to the first sample of the switch, with the first start's brown-out reset \[ms\].
pub(crate) const START_MS: u32 = 400;

/// Path to which `cargo xtask firmware` builds an image.
pub(crate) fn image(name: &str) -> PathBuf {
    xtask::image::path(name)
}

/// A board with this image, powered.
pub(crate) fn powered(name: &str, wiring: Wiring) -> Bench {
    Bench::power_on(&image(name), Options::default(), wiring)
        .unwrap_or_else(|error| panic!("{error}; `cargo xtask firmware` builds the images"))
}

/// The board of [`ALIGN`] with the switch held and the bridge just closed.
pub(crate) fn closed(wiring: Wiring) -> Bench {
    let mut bench = powered(ALIGN, wiring);
    close(&mut bench);
    bench
}

/// The rider's switch is opened, closed after it was open for the minimum time, and held.
pub(crate) fn press(bench: &mut Bench) {
    bench.with(|board| board.chip.wiring.analog.switch_closed = false);
    bench.run_ms(f64::from(START_MS + u32::from(PressConfig::product().release_ticks))).unwrap();
    bench.with(|board| board.chip.wiring.analog.switch_closed = true);
}

/// Presses the switch, waits until the bridge is closed, and 20 ms more.
pub(crate) fn close(bench: &mut Bench) {
    press(bench);
    bench.run_until(500.0, "closed bridge", is_closed).unwrap();
    bench.run_ms(20.0).unwrap();
}

pub(crate) fn is_closed(bench: &mut Bench) -> bool {
    bench.with(|board| board.chip.wiring.tim1.main_output())
}

/// Runs until the bridge is open; returns the time from now to its opening \[us\].
pub(crate) fn opens_us(bench: &mut Bench, limit_ms: f64) -> f64 {
    assert!(is_closed(bench), "the bridge is closed");
    let from_ms = bench.now_ms();
    bench.run_until(limit_ms, "open bridge", |bench| !is_closed(bench)).unwrap();
    let opened_ns = bench.with(move |board| {
        let changes = &board.chip.wiring.main_output;
        changes.iter().find(|(at_ns, on)| *at_ns as f64 >= from_ms * 1e6 && !on).map(|(at_ns, _)| *at_ns)
    });
    opened_ns.expect("noted") as f64 * 1e-3 - from_ms * 1e3
}

/// Whether the log contains a text since an instant \[ms\].
pub(crate) fn log_has(bench: &Bench, since_ms: f64, text: &str) -> bool {
    bench.log().iter().any(|line| line.at_us as f64 >= since_ms * 1e3 && line.text.contains(text))
}

/// Waits for a text in the log.
pub(crate) fn wait_for_log(bench: &mut Bench, limit_ms: f64, text: &str) {
    let from_ms = bench.now_ms();
    let heard = bench.run_until(limit_ms, text, |bench| log_has(bench, from_ms, text));
    heard.unwrap_or_else(|error| panic!("{error}; the log: {:#?}", bench.log()));
}

/// Sends a request and waits for an answer that `look` accepts, at most this time \[ms\].
pub(crate) fn query<T>(
    bench: &mut Bench,
    request: &Message<'_>,
    limit_ms: f64,
    mut look: impl FnMut(&Message<'_>) -> Option<T>,
) -> T {
    // Bytes received before belong to an earlier request.
    bench.received();
    bench.send(&bytes_of(request, 7));
    let (mut listener, mut found) = (Listener::default(), None);
    let answered = bench.run_until(limit_ms, "answer on the serial line", |bench| {
        listener.take(&bench.received(), |_, message| found = found.take().or(look(message)));
        found.is_some()
    });
    answered.unwrap_or_else(|error| panic!("{request:?}: {error}"));
    found.expect("answered")
}

/// Whether tests that take minutes are run as well.
pub(crate) fn slow() -> bool {
    std::env::var_os("STEER_ASSIST_SLOW").is_some()
}
