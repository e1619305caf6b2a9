//! Reads CAN logs as text (ASC) of Vector's tools and of others that write it, such as python-can and can-utils.
//!
//! `base` defines whether identifiers and bytes are hexadecimal or decimal; `timestamps` whether seconds count from the
//! start of the measurement (`absolute`) or from the previous event (`relative`). Relative times are summed over all
//! events, including those of other kinds. Events other than CAN frames are skipped.

use super::Remark;
use super::frames::{Frames, Id, MOST_BYTES};
use super::remarks::Remarks;

/// Lines at the beginning of a file among which its header is searched.
const HEAD_LINES: usize = 50;

/// Content of an event.
enum Event {
    Data { id: Id, data: ([u8; MOST_BYTES], usize) },
    Remote,
    Error,
    Other,
}

/// Whether a text is an ASC log: one of its first lines is a header line or a frame.
pub fn is_one(text: &str) -> bool {
    let shaped = |line: &str| base_of(line).is_some() || is_date(line) || is_frame(line);
    text.lines().map(str::trim).filter(|line| !line.is_empty()).take(HEAD_LINES).any(shaped)
}

/// Reads a log.
///
/// # Errors
/// No line is a data frame.
pub fn parse(text: &str) -> Result<Frames, Remark> {
    let (mut frames, mut remarks) = (Frames::default(), Remarks::default());
    let (mut radix, mut relative, mut now_s) = (16, false, 0.0);
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let ends_whole = text.ends_with('\n');
    let last = text.lines().count() as u64;
    for (line, number) in text.lines().map(str::trim).zip(1_u64..) {
        if line.is_empty() || line.starts_with("//") {
            continue;
        }
        if let Some(base) = base_of(line) {
            (radix, relative) = base;
            continue;
        }
        let mut damaged = |error: &str| {
            let cut = if number == last && !ends_whole { ", the file ends within it" } else { "" };
            remarks.add("lines that are no event of such a log; left out", Some(number), None, || {
                format!("{error}{cut}; left out")
            });
        };
        let (first, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let Some(stamp_s) = stamp(first) else {
            if !is_header(line) {
                damaged("begins with no time stamp");
            }
            continue;
        };
        now_s = if relative { now_s + stamp_s } else { stamp_s };
        let tokens: Vec<&str> = rest.split_whitespace().collect();
        let event = match tokens.as_slice() {
            ["CANFD", bus, rest @ ..] => flexible(rest, radix).map(|event| (*bus, event)),
            [bus, rest @ ..] if is_number(bus) => classic(rest, radix).map(|event| (*bus, event)),
            [] => Err("ends after its time stamp"),
            _ => Ok(("", Event::Other)),
        };
        match event {
            Ok((bus, Event::Data { id, data: (bytes, length) })) => {
                frames.push(now_s, number, bus, id, &bytes[..length]);
            }
            Ok((_, Event::Remote)) => frames.remote += 1,
            Ok((_, Event::Error)) => frames.errors += 1,
            Ok((_, Event::Other)) => {}
            Err(error) => damaged(error),
        }
    }
    frames.checked(remarks)
}

/// Radix of a header's `base` line, and whether its time stamps are relative.
fn base_of(line: &str) -> Option<(u32, bool)> {
    let tokens: Vec<String> = line.split_whitespace().take(4).map(str::to_ascii_lowercase).collect();
    let tokens: Vec<&str> = tokens.iter().map(String::as_str).collect();
    let radix = match tokens.as_slice() {
        ["base", "hex", ..] => 16,
        ["base", "dec", ..] => 10,
        _ => return None,
    };
    Some((radix, matches!(tokens.as_slice(), [_, _, "timestamps", "relative"])))
}

/// Whether a line is the date at the beginning; a table's header can begin with the same word.
fn is_date(line: &str) -> bool {
    starts(line, "date ") && line.contains(':') && !line.contains([',', ';', '\t'])
}

fn starts(line: &str, with: &str) -> bool {
    line.get(..with.len()).is_some_and(|start| start.eq_ignore_ascii_case(with))
}

/// Whether a line is one without a time stamp.
fn is_header(line: &str) -> bool {
    const WORDS: [&str; 5] = [
        "begin triggerblock",
        "end triggerblock",
        "internal events",
        "no internal events",
        "previous log file",
    ];
    is_date(line) || WORDS.iter().any(|token| starts(line, token))
}

/// Whether a line is a data frame, without any header.
fn is_frame(line: &str) -> bool {
    let tokens: Vec<&str> = line.split_whitespace().collect();
    match tokens.as_slice() {
        [time, "CANFD", _, "Rx" | "Tx", ..] => stamp(time).is_some(),
        [time, bus, _, "Rx" | "Tx", "d" | "r", ..] => stamp(time).is_some() && is_number(bus),
        _ => false,
    }
}

/// A time stamp in seconds: digits, a point, digits.
fn stamp(token: &str) -> Option<f64> {
    let (whole, part) = token.split_once('.')?;
    let digits = is_number(whole.strip_prefix('-').unwrap_or(whole)) && is_number(part);
    digits.then(|| token.parse().ok()).flatten()
}

fn is_number(token: &str) -> bool {
    !token.is_empty() && token.bytes().all(|digit| digit.is_ascii_digit())
}

/// A number in the file's base.
fn number(token: &str, radix: u32) -> Option<u32> {
    let digits = token.chars().all(|digit| digit.is_digit(radix));
    digits.then(|| u32::from_str_radix(token, radix).ok()).flatten()
}

/// An identifier; a trailing `x` marks 29 bits.
fn id_of(token: &str, radix: u32) -> Result<Id, &'static str> {
    let (digits, extended) = match token.strip_suffix(['x', 'X']) {
        Some(digits) => (digits, true),
        None => (token, false),
    };
    let number = number(digits, radix).ok_or("its identifier is no number of the file's base")?;
    Id::new(number, extended).ok_or("its identifier has too many bits")
}

/// An event of a classic bus, from its identifier on: `123 Rx d 4 DE AD BE EF`.
fn classic(tokens: &[&str], radix: u32) -> Result<Event, &'static str> {
    match tokens {
        [token, ..] if token.eq_ignore_ascii_case("ErrorFrame") => Ok(Event::Error),
        [_, "Rx" | "Tx", "r", ..] => Ok(Event::Remote),
        [id, "Rx" | "Tx", "d", rest @ ..] => {
            let id = id_of(id, radix)?;
            let [code, rest @ ..] = rest else { return Err("its length is missing") };
            let code =
                number(code, radix).filter(|code| *code < 16).ok_or("its length is invalid for a frame")?;
            Ok(Event::Data { id, data: bytes_of(rest, code.min(8) as usize, radix)? })
        }
        [_, "Rx" | "Tx", ..] | [_] | [] => Err("is no whole frame"),
        [id, ..] if id_of(id, radix).is_ok() => Err("its direction is neither Rx nor Tx"),
        _ => Ok(Event::Other),
    }
}

/// An event of a CAN FD bus, from its direction on: `Rx 123 [name] 1 0 d 32 DE ...`.
fn flexible(tokens: &[&str], radix: u32) -> Result<Event, &'static str> {
    let ([_, id, rest @ ..], true) = (tokens, matches!(tokens.first(), Some(&("Rx" | "Tx")))) else {
        return Ok(Event::Other);
    };
    if id.eq_ignore_ascii_case("ErrorFrame") {
        return Ok(Event::Error);
    }
    let id = id_of(id, radix)?;
    let named = rest.first().is_some_and(|token| !matches!(*token, "0" | "1"));
    let [_switched, _passive, code, length, rest @ ..] = &rest[usize::from(named)..] else {
        return Err("is no whole frame");
    };
    let length = Some(length).filter(|token| is_number(token)).and_then(|token| token.parse::<usize>().ok());
    let length = length.filter(|length| *length <= MOST_BYTES).ok_or("its length is invalid for a frame")?;
    if length == 0 && *code != "0" {
        return Ok(Event::Remote);
    }
    Ok(Event::Data { id, data: bytes_of(rest, length, radix)? })
}

/// The bytes of a frame; the words after them belong to the event.
fn bytes_of(tokens: &[&str], length: usize, radix: u32) -> Result<([u8; MOST_BYTES], usize), &'static str> {
    let mut bytes = [0; MOST_BYTES];
    let tokens = tokens.get(..length).ok_or("has fewer bytes than its stated length")?;
    for (byte, token) in bytes.iter_mut().zip(tokens) {
        let number = number(token, radix).filter(|number| *number < 256);
        *byte = number.ok_or("its bytes are no numbers of the file's base")? as u8;
    }
    Ok((bytes, length))
}
