//! The numbers in `docs/link.md` are those of the program.

use crate::messages::all;
use control::law::{LAW_NAMES, LAWS};
use control::{Config, Plan};
use link::frame::{MAX_FRAME, MAX_PAYLOAD, VERSION};
use link::parameter_list::each_but_law;
use link::record::{LAYOUT, MAX_ENTRIES, RECORD_BYTES, encode};
use link::report::{FAULT_BYTES, FAULT_TEXT_BYTES};
use link::store::MIN_PAGE;

const PAGE: &str = include_str!("../../../../docs/link.md");

/// Situation: the page that describes every byte.
/// Action: look for each size, count and number there.
/// Must hold: all are there with the program's values, and every message has its row.
#[test]
fn the_page_has_the_programs_numbers() {
    let text = PAGE.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut parameters = 0;
    each_but_law(&mut Config::product(), |parameter| {
        parameters += 1;
        parameter.value
    });
    let record = encode(&Config::product(), 1, None, &mut [0; RECORD_BYTES]).expect("room");
    // A record and its number, each with a header and padded to words, in a sector but for its two marks.
    let stores = (16 * 1024 - 8) / ((8 + (1 + record).next_multiple_of(4)) + (8 + 8));
    let telemetry =
        all().iter().find(|message| message.kind() == 0xa0).and_then(|m| m.encode(0, &mut [0; MAX_FRAME]));
    let telemetry = telemetry.expect("telemetry");
    for line in [
        format!("| 0 | version | {VERSION};"),
        format!("up to {MAX_PAYLOAD} bytes"),
        format!("the payload; {MAX_FRAME} at most, {telemetry} for telemetry"),
        format!("{} telemetry frames a second fill the line", 11_520 / telemetry),
        format!("takes {:.0} % of it", 100.0 * 50.0 * telemetry as f64 / 11_520.0),
        format!("fault record is at most {FAULT_BYTES} bytes, its text {FAULT_TEXT_BYTES}"),
        format!("configuration is {} bytes", size_of::<Config>()),
        format!("a `Plan` ({} included)", size_of::<Plan>()),
        format!("u8 layout ({LAYOUT})"),
        format!("of {MIN_PAGE} bytes or more each"),
        format!("today's {parameters} parameters and a law without a table is {record} bytes"),
        format!("its place in `{}`", LAW_NAMES.join(" ")),
        format!("takes {stores} stores before"),
        format!("room for {MAX_ENTRIES} parameters"),
    ] {
        assert!(text.contains(&line), "docs/link.md does not contain: {line}");
    }
    for spec in LAWS.iter().filter_map(|spec| spec.parameter) {
        assert!(
            text.contains(&format!("`law.{}`", spec.name)),
            "docs/link.md does not contain law.{}",
            spec.name
        );
    }
    for message in all() {
        let name = format!("{message:?}");
        let name = name.split(|c: char| !c.is_alphanumeric()).next().expect("a name");
        let row = format!("| {:02x} | `{name}` |", message.kind());
        assert!(PAGE.contains(&row), "docs/link.md has no row {row}");
    }
}
