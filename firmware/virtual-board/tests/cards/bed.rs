//! Shared by the tests: images, boards, the engineer's end of the serial line.

use link::frame::MAX_FRAME;
use link::message::Message;
use link::{Decoder, Received};
use std::path::PathBuf;
use virtual_board::wiring::Wiring;
use virtual_board::{Bench, Options};

/// The product's image; `None` where the target or the tools are missing, which has been reported.
pub(crate) fn product() -> Option<PathBuf> {
    built("board-vesc6")
}

/// One of the board's images.
pub(crate) fn built(name: &str) -> Option<PathBuf> {
    if !xtask::image::ready() {
        return None;
    }
    xtask::image::build("board-vesc6").expect("the board's images build");
    Some(xtask::image::path(name))
}

/// A powered board with the usual options.
pub(crate) fn board(image: &std::path::Path) -> Bench {
    Bench::power_on(image, Options::default(), Wiring::new()).expect("the board starts")
}

/// A request as bytes.
pub(crate) fn request(message: &Message<'_>, sequence: u16) -> Vec<u8> {
    let mut bytes = [0; MAX_FRAME];
    let used = message.encode(sequence, &mut bytes).expect("a request fits");
    bytes[..used].to_vec()
}

/// Decodes the board's bytes at the engineer's end.
#[derive(Default)]
pub(crate) struct Listener(Decoder);

impl Listener {
    /// Calls `each` with the number and the message of every frame in the bytes.
    pub(crate) fn take(&mut self, mut bytes: &[u8], mut each: impl FnMut(u16, &Message<'_>)) {
        while !bytes.is_empty() {
            if let Some(Received::Frame(frame)) = self.0.take(&mut bytes)
                && let Ok(message) = Message::decode(&frame)
            {
                each(frame.sequence, &message);
            }
        }
    }

    /// Number of damaged frames.
    pub(crate) fn damaged(&self) -> u32 {
        let dropped = self.0.dropped();
        dropped.garbled + dropped.too_long + dropped.bad_crc
    }
}

/// The number in `name=number` of the newest log line that contains it.
pub(crate) fn newest<T: std::str::FromStr>(bench: &Bench, name: &str) -> Option<T> {
    bench.log().iter().rev().find_map(|line| xtask::instructions::field(&line.text, name))
}
