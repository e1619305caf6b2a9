//! Binary logs of Vector that are whole, cut, damaged or odd.

use super::file;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;
use sim_host::recording::Remark;
use sim_host::recording::blf::parse;
use sim_host::recording::frames::{Frame, Frames};
use tests::draws::runner;

const KINDS: [u32; 3] = [1, 86, 100];

/// An object: its head of version 1, with a time in ns, and its body.
pub(super) fn object(kind: u32, time_ns: u64, body: &[u8]) -> Vec<u8> {
    let mut bytes = b"LOBJ".to_vec();
    bytes.extend([32_u16, 1].iter().flat_map(|n| n.to_le_bytes()));
    bytes.extend([32 + body.len() as u32, kind, 2, 0].iter().flat_map(|n| n.to_le_bytes()));
    bytes.extend(time_ns.to_le_bytes());
    bytes.extend(body);
    bytes.resize(bytes.len() + body.len() % 4, 0);
    bytes
}

/// The body of a classic frame.
pub(super) fn classic(bus: u16, flags: u8, length: u8, id: u32, data: [u8; 8]) -> Vec<u8> {
    [&bus.to_le_bytes()[..], &[flags, length], &id.to_le_bytes(), &data].concat()
}

/// A container without compression.
pub(super) fn container(content: &[u8]) -> Vec<u8> {
    let mut bytes = b"LOBJ".to_vec();
    bytes.extend([16_u16, 1].iter().flat_map(|n| n.to_le_bytes()));
    bytes.extend([32 + content.len() as u32, 10].iter().flat_map(|n| n.to_le_bytes()));
    bytes.extend([0; 8]);
    bytes.extend((content.len() as u32).to_le_bytes());
    bytes.extend([0; 4]);
    bytes.extend(content);
    bytes.resize(bytes.len() + content.len() % 4, 0);
    bytes
}

/// A file without a date, with these bytes after its header.
pub(super) fn log(content: &[u8]) -> Vec<u8> {
    let mut bytes = b"LOGG\x90\0\0\0".to_vec();
    bytes.resize(144, 0);
    bytes.extend(content);
    bytes
}

fn read(content: &[u8]) -> Result<Frames, Remark> {
    parse(&log(content))
}

fn whats(frames: &Frames) -> Vec<&str> {
    frames.remarks.iter().map(|remark| remark.what.as_str()).collect()
}

/// Situation: a whole file, and the same cut after each of its bytes.
/// Action: read.
/// Must hold: the frames are the first ones of the whole file, more of them the longer the part, and what is missing is
/// reported; or there are none, and the reason.
#[test]
fn a_cut_file_is_read_up_to_its_end() {
    let bytes = std::fs::read(file("odd.blf")).unwrap();
    let whole = parse(&bytes).unwrap();
    assert_eq!((whole.len(), whole.errors, whole.remote, whats(&whole)), (75, 1, 1, vec![]));
    let all: Vec<Frame<'_>> = whole.iter().collect();
    let (mut before, mut partly) = (0, 0);
    for end in 0..bytes.len() - 1 {
        match parse(&bytes[..end]) {
            Ok(part) => {
                let part_frames: Vec<Frame<'_>> = part.iter().collect();
                assert_eq!(part_frames, all[..part.len()], "{end}");
                assert!(part.len() >= before, "{end}");
                // At the end of a container the rest is missing without a trace, unless a frame goes on in the next.
                partly += usize::from(!part.remarks.is_empty());
                before = part.len();
            }
            Err(error) => assert!(!error.what.is_empty() && before == 0, "{end}: {error}"),
        }
    }
    assert!(before >= 70 && partly > 1500, "{before} {partly}");
}

/// Situation: containers without compression, objects in none, a frame over two containers, an object of another kind,
/// frames with an invalid length, an identifier of too many bits and a length code above 8.
/// Action: read.
/// Must hold: frames in order with their times; each unusable one is named.
#[test]
fn every_kind_of_object_is_read_or_named() {
    let good = |n: u8| object(86, u64::from(n) * 20_000_000, &classic(1, 0, 8, 0x320, [n; 8]));
    let frames = read(&[container(&[good(0), good(1)].concat()), good(2)].concat()).unwrap();
    let times: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
    assert_eq!((times, whats(&frames)), (vec![0.0, 0.02, 0.04], vec![]));
    assert_eq!(frames.buses, ["1"]);

    let (first, second) = (good(0), good(1));
    let (before, after) = second.split_at(21);
    let frames = read(&[container(&[&first, before].concat()), container(after)].concat()).unwrap();
    assert_eq!((frames.len(), whats(&frames)), (2, vec![]));

    let odd = [
        good(0),
        object(86, 1, &classic(1, 0, 16, 0x320, [0; 8])),
        object(86, 2, &classic(1, 0, 8, 0x800, [0; 8])),
        object(86, 3, &classic(1, 0, 12, 0x321, [7; 8])),
        object(1, 4, &classic(2, 0x80, 8, 0x321, [7; 8])),
        object(65, 5, &[1, 2, 3]),
        object(73, 6, &[0; 32]),
        object(86, 7, &[1, 0, 0]),
        object(1, 8, &classic(2, 0, 3, 0x9abc_def0, [1, 2, 3, 0, 0, 0, 0, 0])),
    ];
    let frames = read(&container(&odd.concat())).unwrap();
    let lengths: Vec<usize> = frames.iter().map(|frame| frame.data.len()).collect();
    assert_eq!((lengths, frames.remote, frames.errors), (vec![8, 8, 3], 1, 1));
    assert!(frames.iter().last().unwrap().id.extended);
    assert_eq!(
        whats(&frames),
        [
            "frames whose length is invalid; left out",
            "frames whose identifier has too many bits; left out",
            "frames with fewer bytes than their kind has; left out",
        ]
    );
}

/// Situation: three containers, of which the second is of an unknown compression, damaged, or not there at all.
/// Action: read.
/// Must hold: the frames of the first and the third, and one remark.
#[test]
fn a_damaged_container_does_not_cost_the_others() {
    let good = |n: u8| object(86, u64::from(n), &classic(1, 0, 8, 0x320, [n; 8]));
    let [first, second, third] = [0, 1, 2].map(|n| container(&good(n)));
    let (mut unknown, mut damaged, mut marked) = (second.clone(), second.clone(), second.clone());
    unknown[16] = 9;
    damaged[16] = 2;
    marked[0] = b'X';
    for broken in [unknown, damaged, marked] {
        let frames = read(&[&first[..], &broken, &third].concat()).unwrap();
        let data: Vec<u8> = frames.iter().map(|frame| frame.data[0]).collect();
        // The frame of a container whose mark is damaged is found by its own.
        assert!(data == [0, 2] || data == [0, 1, 2], "{data:?}");
        assert_eq!(frames.remarks.len(), 1, "{:?}", frames.remarks);
    }
}

/// Situation: files without a frame.
/// Action: read. Must hold: rejected with the reason.
#[test]
fn a_file_without_frames_is_rejected() {
    let error = |content: &[u8]| read(content).unwrap_err().what;
    assert_eq!(error(&[]), "no data frame in it");
    assert_eq!(error(&container(&object(65, 0, &[]))), "no data frame in it");
    assert_eq!(error(b"not an object at all"), "bytes that are no object; skipped up to the next one");
    assert_eq!(parse(b"LOGG\x90\0\0\0").unwrap_err().what, "ends within its header");
}

/// Situation: any classic frames, in containers of any size.
/// Action: read.
/// Must hold: every frame as written, whatever the containers' borders.
#[test]
fn frames_arrive_over_any_borders() {
    let frame = (0..3_usize, 0..0x800_u32, any::<[u8; 8]>(), 0..=8_u8);
    runner(500)
        .run(&(vec(frame, 1..40), vec(1..200_usize, 1..20)), |(frames, sizes)| {
            let mut row = Vec::new();
            for (n, (kind, id, data, length)) in frames.iter().enumerate() {
                let mut body = classic(1, 0, *length, *id, *data);
                if KINDS[*kind] == 100 {
                    body.truncate(8);
                    body.extend([0; 6]);
                    body.push(*length);
                    body.extend([0; 5]);
                    body.extend(data);
                    body.resize(84, 0);
                }
                row.extend(object(KINDS[*kind], n as u64 * 1000, &body));
            }
            let (mut content, mut rest) = (Vec::new(), &row[..]);
            for size in sizes.iter().cycle() {
                let (one, other) = rest.split_at((*size).min(rest.len()));
                content.extend(container(one));
                rest = other;
                if rest.is_empty() {
                    break;
                }
            }
            let got = read(&content).map_err(|error| TestCaseError::fail(error.to_string()))?;
            prop_assert!(got.remarks.is_empty(), "{:?}", got.remarks);
            prop_assert_eq!(got.len(), frames.len());
            for (got, (_, id, data, length)) in got.iter().zip(&frames) {
                prop_assert_eq!(got.id.number, *id);
                prop_assert_eq!(got.data, &data[..usize::from(*length)]);
            }
            Ok(())
        })
        .unwrap();
}

/// Situation: files with bytes changed and cut, and any bytes after the mark of one.
/// Action: read.
/// Must hold: frames or a reason, bounded by the file's size.
#[test]
fn any_bytes_are_read_or_rejected() {
    let files: Vec<Vec<u8>> = ["ride.blf", "odd.blf"].map(|name| std::fs::read(file(name)).unwrap()).to_vec();
    let good = object(86, 1, &classic(1, 0, 8, 0x320, [1; 8]));
    let plain = log(&container(&good.repeat(20)));
    let files = [files, vec![plain.clone(), plain]].concat();
    let changes = vec((any::<Index>(), any::<u8>()), 0..8);
    let sound = |bytes: &[u8]| match parse(bytes) {
        Ok(frames) => {
            prop_assert!(frames.iter().map(|frame| frame.data.len()).sum::<usize>() <= 1100 * bytes.len());
            prop_assert!(frames.iter().all(|frame| frame.time_s.is_finite()));
            prop_assert!(frames.remarks.len() < 40);
            Ok(())
        }
        Err(error) => {
            prop_assert!(!error.what.is_empty());
            Ok(())
        }
    };
    runner(4000)
        .run(
            &(prop::sample::select(files), changes, any::<Index>(), any::<bool>()),
            |(mut bytes, changes, end, cut)| {
                for (at, byte) in changes {
                    let at = at.index(bytes.len());
                    bytes[at] = byte;
                }
                if cut {
                    bytes.truncate(end.index(bytes.len()));
                }
                sound(&bytes)
            },
        )
        .unwrap();
    runner(500)
        .run(&vec(any::<u8>(), 0..2000), |noise| sound(&[&b"LOGG\x38\0\0\0"[..], &noise].concat()))
        .unwrap();
}
