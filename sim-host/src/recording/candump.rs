//! Reads logs of `candump` (Linux can-utils): the format of `-l` and `-L`, and screen output with time stamps.
//!
//! The log format (`(1436509052.249713) can0 123#DEADBEEF`) is the one that other can-utils read. Screen output
//! (`(1436509052.249713)  can0  123   [4]  DE AD BE EF`) is supported with the time stamps of `-t a`, `-t A` (a date,
//! read as UTC) and `-t z`. Time stamps from frame to frame (`-t d`) look like those of `-t z` but decrease: a file of
//! small time stamps that decrease anywhere is rejected.

use super::Remark;
use super::frames::{Frames, Id, MOST_BYTES};
use super::remarks::Remarks;
use super::stamp::date_time;

/// Lines at the beginning of a file among which the first whole one is searched.
const HEAD_LINES: usize = 50;
/// Time stamps from here on are seconds since 1970 \[s\]: no ride is three years long.
const FROM_1970_S: f64 = 1e8;
/// Bit of an identifier that marks an error frame in can-utils.
const ERROR_FLAG: u32 = 0x2000_0000;

/// Content of a line.
enum Line<'a> {
    Data { stamp: Stamp, bus: &'a str, id: Id, data: ([u8; MOST_BYTES], usize) },
    Remote,
    Error,
}

/// A time stamp \[s\], and whether the line is screen output.
#[derive(Clone, Copy)]
struct Stamp {
    time_s: f64,
    screen: bool,
}

/// Whether a text is a candump log, by its first lines.
pub fn is_one(text: &str) -> bool {
    let shaped = |line: &str| line_of(line).is_ok() || screen_without_stamp(line);
    text.lines().map(str::trim).filter(|line| !line.is_empty()).take(HEAD_LINES).any(shaped)
}

/// Reads a log.
///
/// # Errors
/// No line is a frame; the lines have no time stamps, or time stamps of an unknown origin.
pub fn parse(text: &str) -> Result<Frames, Remark> {
    let (mut frames, mut remarks) = (Frames::default(), Remarks::default());
    let ends_whole = text.ends_with('\n');
    let last = text.lines().count() as u64;
    // The previous time stamp, and the first line with a smaller one, of screen output.
    let (mut before_s, mut fell, mut small) = (f64::NEG_INFINITY, None, false);
    for (line, number) in text.lines().map(str::trim).zip(1_u64..).filter(|(line, _)| !line.is_empty()) {
        match line_of(line) {
            Ok(Line::Data { stamp, bus, id, data: (bytes, length) }) => {
                if stamp.screen {
                    small |= stamp.time_s < FROM_1970_S;
                    fell = fell.or((stamp.time_s < before_s).then_some(number));
                    before_s = stamp.time_s;
                }
                frames.push(stamp.time_s, number, bus, id, &bytes[..length]);
            }
            Ok(Line::Remote) => frames.remote += 1,
            Ok(Line::Error) => frames.errors += 1,
            Err(_) if screen_without_stamp(line) => {
                return Err(at(number, "has no time stamp; record with `candump -L`"));
            }
            Err(error) => {
                let cut = number == last && !ends_whole;
                remarks.add("lines that are no frame; left out", Some(number), None, || {
                    format!("{error}{}; left out", if cut { ", the file ends within it" } else { "" })
                });
            }
        }
    }
    if let (true, Some(line)) = (small, fell) {
        return Err(at(
            line,
            "the time stamp falls, so they may count from frame to frame (`candump -t d`); record with `candump -L`",
        ));
    }
    frames.checked(remarks)
}

fn at(line: u64, what: &str) -> Remark {
    Remark { line: Some(line), column: None, what: what.to_owned() }
}

/// Parses a line.
fn line_of(line: &str) -> Result<Line<'_>, &'static str> {
    const SHAPE: &str = "is no line of candump";
    let (stamp, rest) = line.strip_prefix('(').and_then(|line| line.split_once(')')).ok_or(SHAPE)?;
    let time_s = seconds(stamp).ok_or("its time stamp is no number")?;
    let mut tokens = rest.split_whitespace();
    let (bus, second) = (tokens.next().ok_or(SHAPE)?, tokens.next().ok_or(SHAPE)?);
    match second.split_once('#') {
        Some((id, data)) => {
            // Since 2020 a word follows that distinguishes received from sent frames.
            match tokens.next() {
                None | Some("R" | "T") => compact(Stamp { time_s, screen: false }, bus, id, data),
                Some(_) => Err(SHAPE),
            }
        }
        None => screen(Stamp { time_s, screen: true }, bus, second, tokens),
    }
}

/// Largest time stamp \[s\]: the year 5138.
const MOST_S: f64 = 1e11;

/// A time stamp in seconds, from a number or a date.
fn seconds(stamp: &str) -> Option<f64> {
    let number = || stamp.parse::<f64>().ok().filter(|s| s.abs() <= MOST_S && !stamp.contains(['e', 'E']));
    number().or_else(|| date_time(stamp))
}

/// The identifier's number and flags; 3 digits mean 11 bits, 8 digits 29 bits.
fn id_of(digits: &str) -> Result<(u32, bool), &'static str> {
    let number = hexadecimal(digits).ok_or("its identifier is no hexadecimal number")?;
    match digits.len() {
        3 => Ok((number, false)),
        8 => Ok((number, true)),
        _ => Err("its identifier has neither 3 nor 8 digits"),
    }
}

fn hexadecimal(digits: &str) -> Option<u32> {
    let all = !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    all.then(|| u32::from_str_radix(digits, 16).ok()).flatten()
}

/// A frame in the format of `-L`: data is `DEADBEEF`, `#` and a digit of flags before it for CAN FD, `R` or `R8`.
fn compact<'a>(stamp: Stamp, bus: &'a str, id: &str, data: &str) -> Result<Line<'a>, &'static str> {
    const BITS: &str = "its identifier has too many bits";
    let (number, extended) = id_of(id)?;
    if extended && number & ERROR_FLAG != 0 {
        return Ok(Line::Error);
    }
    let id = Id::new(number, extended).ok_or(BITS)?;
    // The length requested may follow, and as `_9` to `_F` the code as sent.
    let length = |text: &str| text.bytes().all(|byte| byte.is_ascii_hexdigit() || byte == b'_');
    if data.strip_prefix('R').is_some_and(length) {
        return Ok(Line::Remote);
    }
    let (most, digits) = match data.strip_prefix('#') {
        Some(flagged) if flagged.starts_with('#') => return Err("frames of CAN XL are not read"),
        Some(flagged) => match flagged.split_at_checked(1) {
            Some((flags, digits)) if hexadecimal(flags).is_some() => (MOST_BYTES, digits),
            _ => return Err("the flags of CAN FD are missing"),
        },
        // `_9` to `_F` after eight bytes: the length code as sent.
        None => match data.split_once('_') {
            Some((digits, code)) if digits.len() == 16 && hexadecimal(code).is_some() => (8, digits),
            _ => (8, data),
        },
    };
    if !digits.len().is_multiple_of(2) {
        return Err("half a byte is missing");
    }
    let (mut bytes, length) = ([0; MOST_BYTES], digits.len() / 2);
    if length > most {
        return Err("has more bytes than a frame");
    }
    for (byte, pair) in bytes.iter_mut().zip(digits.as_bytes().chunks(2)) {
        let pair = std::str::from_utf8(pair).ok().and_then(hexadecimal);
        *byte = pair.ok_or("its bytes are no hexadecimal digits")? as u8;
    }
    Ok(Line::Data { stamp, bus, id, data: (bytes, length) })
}

/// A frame of screen output, from its identifier on; with `-x`, words come between bus and identifier.
fn screen<'a>(
    stamp: Stamp,
    bus: &'a str,
    second: &'a str,
    mut tokens: std::str::SplitWhitespace<'a>,
) -> Result<Line<'a>, &'static str> {
    let mut id = second;
    let mut length = tokens.next();
    for _ in 0..3 {
        if matches!(id, "RX" | "TX" | "-" | "B" | "E") {
            (id, length) = (length.unwrap_or_default(), tokens.next());
        }
    }
    let (number, extended) = id_of(id)?;
    let length = length.and_then(|token| token.strip_prefix('[')).and_then(|token| token.strip_suffix(']'));
    let length: usize = length.and_then(|token| token.parse().ok()).ok_or("its length is missing")?;
    if extended && number & ERROR_FLAG != 0 {
        return Ok(Line::Error);
    }
    let id = Id::new(number, extended).ok_or("its identifier has too many bits")?;
    if length > MOST_BYTES {
        return Err("has more bytes than a frame");
    }
    let mut bytes = [0; MOST_BYTES];
    for byte in &mut bytes[..length] {
        match tokens.next() {
            Some("remote") => return Ok(Line::Remote),
            Some(token) if token.len() == 2 => {
                *byte = hexadecimal(token).ok_or("its bytes are no hexadecimal digits")? as u8;
            }
            _ => return Err("has fewer bytes than its stated length"),
        }
    }
    if length == 0 && tokens.next() == Some("remote") {
        return Ok(Line::Remote);
    }
    Ok(Line::Data { stamp, bus, id, data: (bytes, length) })
}

/// Whether a line is screen output without a time stamp.
fn screen_without_stamp(line: &str) -> bool {
    let mut tokens = line.split_whitespace();
    let bus = tokens.next().is_some_and(|bus| bus.starts_with(|c: char| c.is_ascii_alphabetic()));
    let id = tokens.next().is_some_and(|id| id_of(id).is_ok());
    let length = tokens.next().is_some_and(|token| {
        token
            .strip_prefix('[')
            .and_then(|token| token.strip_suffix(']'))
            .is_some_and(|n| n.parse::<usize>().is_ok())
    });
    bus && id && length
}
