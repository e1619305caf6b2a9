//! Databases.

use super::file;
use sim_host::recording::bits::{Order, Place, signed};
use sim_host::recording::database::{Database, is_gap};
use sim_host::recording::frames::Id;

fn database(messages: &str) -> Result<Database, String> {
    let text = format!("VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_: A\n\n{messages}");
    Database::parse(text.as_bytes()).map_err(|error| error.to_string())
}

fn values(database: &Database, id: u32, data: &[u8]) -> Vec<f64> {
    database.message(Id { number: id, extended: false }).unwrap().1.values(data).collect()
}

/// Situation: positions of signals, worked out by hand; the last bit in the last byte of CAN FD.
/// Action: extract them from bytes.
/// Must hold: the bits in the order of each; none from a frame that ends before them.
#[test]
fn bits_are_taken_in_both_orders() {
    let data = [0b1010_0101, 0b0011_1100, 0xff, 0x00];
    for (start, bits, order, number, bytes) in [
        (0, 8, Order::Little, 0xa5, 1),
        (4, 8, Order::Little, 0xca, 2),
        (7, 8, Order::Big, 0xa5, 1),
        (3, 8, Order::Big, 0x53, 2),
        (0, 2, Order::Big, 0b10, 2),
        // 3 bits of byte 1, 8 of byte 2, 2 of byte 3.
        (10, 13, Order::Big, 0b1_0011_1111_1100, 4),
        (31, 1, Order::Little, 0, 4),
    ] {
        let place = Place { start, bits, order };
        assert_eq!(place.bytes(), bytes, "{place:?}");
        assert_eq!(place.of(&data[..bytes - 1]), None, "{place:?}");
        assert_eq!(place.of(&data), Some(number), "{place:?}");
    }
    let mut long = [0; 64];
    long[63] = 0x80;
    assert_eq!(Place { start: 448, bits: 64, order: Order::Little }.of(&long), Some(1 << 63));
    assert_eq!(
        (signed(0x7ff, 12), signed(0x800, 12), signed(u64::MAX, 64), signed(1, 1)),
        (2047, -2048, -1, -1)
    );
}

/// Situation: texts of value tables.
/// Action: check whether they mean that there is no value.
/// Must hold: those of the documentation do, in any case and with anything between; states of a device do not.
#[test]
fn texts_that_mean_no_value() {
    for texts in [
        "SNA",
        "Not known",
        "not_available",
        "NotAvailable",
        "Signal not available",
        "signal_not_available",
        "N/A",
        "Value Unknown",
        "INVALID",
        "invalid value",
        "No data",
        "not-valid",
    ] {
        assert!(is_gap(texts), "{texts}");
    }
    for texts in [
        "",
        "off",
        "error",
        "Brake assist not available",
        "available",
        "known",
        "not",
        "signal",
        "SNAP",
        "nan",
    ] {
        assert!(!is_gap(texts), "{texts}");
    }
}

/// Situation: a signal of one bit, one of two, one with sign whose table has the bits as a number without sign.
/// Action: decode bits that the table calls no value, and others.
/// Must hold: NaN for those, but for the one bit; numbers for all others, named or not.
#[test]
fn values_that_are_not_available_are_nan() {
    let database = Database::parse(&std::fs::read(file("odd.dbc")).unwrap()).unwrap();
    let got = values(&database, 262, &[0x00, 0x80, 0xff, 0x0c, 0xff, 0xff, 0x0f, 0]);
    assert!(
        got[0].is_nan() && got[1].is_nan() && got[3].is_nan() && got[4].is_nan() && got[5].is_nan(),
        "{got:?}"
    );
    assert_eq!(got[2], 0.0);
    let got = values(&database, 262, &[0x01, 0x80, 0xfd, 0x08, 0xfe, 0xff, 0x0e, 0]);
    assert_eq!(got, [-327.67, 253.0, 0.0, 2.0, -2.0, 14.0]);
}

/// Situation: unusable parts of a message: signals of more than 64 bits or beyond every frame, pages without or in a
/// cycle of multiplexor signals, a second message of the same identifier.
/// Action: read.
/// Must hold: the rest of the message is read; each unusable signal is named and NaN.
#[test]
fn unusable_signals_are_named() {
    let wide = database("BO_ 1 M: 8 A\n SG_ Wide : 0|65@1+ (1,0) [0|0] \"\" A\n SG_ Out : 511|2@1+ (1,0) [0|0] \"\" A\n SG_ Good : 0|8@1+ (1,0) [0|0] \"\" A\n").unwrap();
    assert_eq!(values(&wide, 1, &[7]), [7.0]);
    assert_eq!(
        wide.messages[0].unused,
        ["signal Wide: 65 bits, not 1 to 64", "signal Out: its bits are in no frame"]
    );
    let paged = database(
        "BO_ 1 M: 8 A\n SG_ Paged m0 : 0|8@1+ (1,0) [0|0] \"\" A\n SG_ Good : 0|8@1+ (1,0) [0|0] \"\" A\n",
    )
    .unwrap();
    let got = values(&paged, 1, &[7]);
    assert!(got[0].is_nan() && got[1] == 7.0, "{got:?}");
    assert_eq!(paged.messages[0].unused, ["signal Paged: it has no multiplexor"]);
    let circle = database(
        "BO_ 1 M: 8 A\n SG_ A1 m0M : 0|8@1+ (1,0) [0|0] \"\" A\n SG_ B1 m0M : 8|8@1+ (1,0) [0|0] \"\" A\n\nSG_MUL_VAL_ 1 A1 B1 0-9;\nSG_MUL_VAL_ 1 B1 A1 0-9;\n",
    )
    .unwrap();
    assert!(values(&circle, 1, &[1, 1]).iter().all(|value| value.is_nan()));
    assert_eq!(circle.messages[0].unused.len(), 2);
    let twice = database("BO_ 1 M: 8 A\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" A\n\nBO_ 1 N: 8 A\n SG_ T : 0|8@1+ (1,0) [0|0] \"\" A\n").unwrap();
    assert_eq!(
        (twice.messages.len(), &twice.messages[0].unused[0][..]),
        (1, "message N has the same identifier")
    );
}

/// Situation: names of more than 32 letters, which Vector's tools cut and store complete in an attribute; two signals
/// of one name.
/// Action: read.
/// Must hold: the complete names; those without the attribute as they are; the second of the same name has its bit
/// appended.
#[test]
fn long_names_are_whole() {
    let long = database(
        "BO_ 1 Cut: 8 A\n SG_ Short : 0|8@1+ (1,0) [0|0] \"\" A\n SG_ Plain : 8|8@1+ (1,0) [0|0] \"\" A\n SG_ Plain : 16|8@1+ (1,0) [0|0] \"\" A\n\n\
         BA_DEF_ SG_ \"SystemSignalLongSymbol\" STRING;\nBA_DEF_ BO_ \"SystemMessageLongSymbol\" STRING;\n\
         BA_DEF_DEF_ \"SystemSignalLongSymbol\" \"\";\nBA_DEF_DEF_ \"SystemMessageLongSymbol\" \"\";\n\
         BA_ \"SystemMessageLongSymbol\" BO_ 1 \"CutAtTheThirtySecondLetterOfItsName\";\n\
         BA_ \"SystemSignalLongSymbol\" SG_ 1 Short \"ShortenedAtTheThirtySecondLetterOfItsName\";\n",
    )
    .unwrap();
    let message = &long.messages[0];
    assert_eq!(message.name, "CutAtTheThirtySecondLetterOfItsName");
    let names: Vec<&str> = message.signals.iter().map(|signal| signal.name.as_str()).collect();
    assert_eq!(names, ["ShortenedAtTheThirtySecondLetterOfItsName", "Plain", "Plain (bit 16)"]);
}

/// Situation: texts that are no database, one without a message, an identifier of more than 11 bits without its mark.
/// Action: read.
/// Must hold: rejected, with the line where there is one, in one line of text.
#[test]
fn texts_that_are_no_database_are_rejected() {
    let wide = database("BO_ 65792 M: 8 A\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" A\n").unwrap_err();
    assert!(wide.starts_with("line 9: its identifier is larger than 2047"), "{wide}");
    assert_eq!(database("").unwrap_err(), "no message (`BO_`) in it");
    let damaged = database("BO_ 1 M: 8 A\n SG_ S : 0|8@1+ (1,0 [0|0] \"\" A\n").unwrap_err();
    assert!(damaged.starts_with("line ") && damaged.contains("is no valid DBC"), "{damaged}");
    for text in ["", "<xml/>", "time,roll\n0,1\n", "\u{0}\u{1}"] {
        let error = Database::parse(text.as_bytes()).unwrap_err().to_string();
        assert!(!error.is_empty() && !error.contains('\n'), "{error}");
    }
    // Signals without a message have an invalid identifier.
    let independent = Database::parse(&std::fs::read(file("odd.dbc")).unwrap()).unwrap();
    let (_, message) = independent.message(Id { number: 0, extended: true }).unwrap();
    assert_eq!((message.name.as_str(), independent.messages.len()), ("ExtendedZero", 10));
}
