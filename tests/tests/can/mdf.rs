//! Measurement files.

use super::{column, file, group, recorded, remarks, written};
use sim_host::recording::mdf;

/// Situation: channels that asammdf wrote decoded: a conversion, invalid samples, both byte orders, a number of 64
/// bits; two groups of other rates, compressed and transposed.
/// Action: read without a database.
/// Must hold: a group each, its times those of its own master, the numbers as written.
#[test]
fn channels_that_are_numbers_are_columns() {
    let recording = recorded("channels.mf4", &[]).unwrap();
    let (imu, wheel) = (group(&recording, "Imu"), group(&recording, "Wheel"));
    let times_s = imu.times_s.as_ref().unwrap();
    assert_eq!((times_s.len(), wheel.times_s.as_ref().unwrap().len()), (40, 8));
    assert!(imu.lines.is_empty() && recording.remarks.is_empty(), "{:?}", remarks(&recording));
    for (n, time_s) in times_s.iter().enumerate() {
        let t = n as f64 * 0.01 + 0.5;
        assert!((time_s - t).abs() < 1e-12, "{n}");
        let raw = n as f64 * 100.0 - 2000.0;
        assert!((column(imu, "RollRate")[n] - (0.001 * raw - 0.25)).abs() < 1e-12, "{n}");
        let steer = column(imu, "Steer")[n];
        assert!(
            if n == 3 || n == 4 { steer.is_nan() } else { (steer - t.sin()).abs() < 1e-7 },
            "{n}: {steer}"
        );
        assert_eq!(column(imu, "Mode")[n], (n % 3) as f64);
        assert_eq!(column(imu, "BigEndian")[n], raw);
        assert_eq!(column(imu, "Large")[n], (n as f64) * 2.0_f64.powi(40));
    }
    assert!((column(wheel, "Speed")[7] - (0.87_f64).cos()).abs() < 1e-12);
    let units: Vec<&str> = imu.columns.iter().map(|column| column.unit.as_str()).collect();
    assert_eq!(units, ["rad/s", "rad", "", "N", ""]);
}

/// Situation: a logger's file cut at every length, as at a power failure.
/// Action: read.
/// Must hold: never more frames than the complete file has, and none fewer at a greater length; the frames are the
/// first ones of the complete file; from the first complete frame on it is a recording, reported as not finished.
#[test]
fn a_loggers_file_can_end_anywhere() {
    let whole = std::fs::read(file("logger.mf4")).unwrap();
    let all = mdf::parse(&whole).unwrap().frames;
    assert_eq!((all.len(), all.errors), (60, 0));
    let mut before = 0;
    for length in 0..=whole.len() {
        let Ok(content) = mdf::parse(&whole[..length]) else {
            assert_eq!(before, 0, "{length}");
            continue;
        };
        assert!(content.frames.len() >= before && content.frames.len() <= 60, "{length}");
        assert!(content.frames.iter().zip(all.iter()).all(|(got, expected)| got == expected), "{length}");
        assert!(content.remarks[0].what.contains("not finished"), "{:?}", content.remarks);
        before = content.frames.len();
    }
    assert_eq!(before, 60);
}

/// Situation: a finished file that was cut while it was copied.
/// Action: read.
/// Must hold: its content is read, and the message reports that the file ends within its data.
#[test]
fn a_finished_file_that_was_cut_is_reported() {
    let whole = std::fs::read(file("unsorted.mf4")).unwrap();
    let recording = written("a.mf4", &whole[..whole.len() - 400], &["odd.dbc"]).unwrap();
    let rows: usize = recording.groups.iter().map(|group| group.times_s.as_ref().unwrap().len()).sum();
    assert!((40..60).contains(&rows), "{rows}");
    assert!(remarks(&recording)[0].contains("the file ends within its data"), "{:?}", remarks(&recording));
}

/// Situation: finished files cut at every length.
/// Action: read.
/// Must hold: each is read in part or rejected; either way the first remark says that the file was cut, with its own length and that
/// of the data it refers to, unless everything that a reader needs is there.
#[test]
fn a_cut_file_is_called_cut() {
    for (name, needed) in
        [("sorted.mf4", 0.95), ("channels.mf4", 0.95), ("unsorted.mf4", 0.95), ("ride.mf4", 0.95)]
    {
        let whole = std::fs::read(file(name)).unwrap();
        let mut called = 0;
        for length in (10..whole.len()).step_by(7) {
            let first = match mdf::parse(&whole[..length]) {
                Ok(content) => content.remarks.first().map(ToString::to_string),
                Err(remark) => Some(remark.to_string()),
            };
            let cut = first.is_some_and(|what| {
                what.contains("was cut") && (what.contains(&format!("at byte {length}")) || length < 64)
            });
            called += usize::from(cut);
        }
        let lengths = (10..whole.len()).step_by(7).count();
        assert!(called as f64 >= needed * lengths as f64, "{name}: {called} of {lengths}");
    }
}

/// Situation: six records of a time and a number, in two blocks of which the first ends within the third record; the
/// same in a transposed block whose size is no multiple of its columns, by itself and in a list; a list that names a
/// block twice; a list that leads back to itself.
/// Action: read.
/// Must hold: in the first three all six numbers; the last two give an error or the records once, and end.
#[test]
fn records_go_on_over_blocks() {
    for layout in [Layout::Split, Layout::Transposed, Layout::List] {
        let content = mdf::parse(&six_records(layout)).unwrap();
        let group = &content.groups[0];
        assert_eq!(column(group, "Value"), [1.0, 1001.0, 2001.0, 3001.0, 4001.0, 5001.0], "{layout:?}");
        assert_eq!(group.times_s, Some(vec![0.0, 0.01, 0.02, 0.03, 0.04, 0.05]), "{layout:?}");
        assert_eq!(content.remarks, [], "{layout:?}");
    }
    for layout in [Layout::Twice, Layout::Circle] {
        let content = mdf::parse(&six_records(layout)).unwrap();
        assert!(column(&content.groups[0], "Value").len() <= 6 && !content.remarks.is_empty(), "{layout:?}");
    }
}

#[derive(Clone, Copy, Debug)]
enum Layout {
    Split,
    Transposed,
    List,
    Twice,
    Circle,
}

/// A file of one group, byte by byte.
fn six_records(layout: Layout) -> Vec<u8> {
    let mut file = b"MDF     4.10    by hand\0\0\0\0\0".to_vec();
    file.extend(410_u16.to_le_bytes());
    file.resize(64, 0);
    let header = put(&mut file, b"##HD", &[0; 6], &[0; 32]);
    let value = channel(&mut file, 0, "Value", [0, 0, 2, 0], 8, 32);
    let time = channel(&mut file, value, "Time", [2, 1, 4, 0], 0, 64);
    let mut shape = [0; 32];
    (shape[8], shape[24]) = (6, 12);
    let group = put(&mut file, b"##CG", &[0, time, 0, 0, 0, 0], &shape);
    let data_group = put(&mut file, b"##DG", &[0, group, 0, 0], &[0; 8]);
    let mut records = Vec::new();
    for k in 0..6_i32 {
        records.extend((0.01 * f64::from(k)).to_le_bytes());
        records.extend((1000 * k + 1).to_le_bytes());
    }
    let data = match layout {
        Layout::Transposed => transposed(&mut file, &records, 10),
        Layout::List => {
            let part = transposed(&mut file, &records, 10);
            let list = put(&mut file, b"##DL", &[0, part], &[0; 16]);
            put(&mut file, b"##HL", &[list], &[0; 8])
        }
        Layout::Split | Layout::Twice | Layout::Circle => {
            let first = put(&mut file, b"##DT", &[], &records[..30]);
            let second =
                if let Layout::Twice = layout { first } else { put(&mut file, b"##DT", &[], &records[30..]) };
            let list = put(&mut file, b"##DL", &[0, first, second], &[0; 24]);
            if let Layout::Circle = layout {
                link(&mut file, list, 0, list);
            }
            list
        }
    };
    link(&mut file, header, 0, data_group);
    link(&mut file, data_group, 2, data);
    file
}

fn put(file: &mut Vec<u8>, name: &[u8; 4], links: &[u64], data: &[u8]) -> u64 {
    file.resize(file.len().next_multiple_of(8), 0);
    let at = file.len() as u64;
    file.extend(name);
    file.extend([0; 4]);
    file.extend((24 + 8 * links.len() as u64 + data.len() as u64).to_le_bytes());
    file.extend((links.len() as u64).to_le_bytes());
    links.iter().for_each(|link| file.extend(link.to_le_bytes()));
    file.extend(data);
    at
}

fn link(file: &mut [u8], block: u64, n: usize, to: u64) {
    let at = block as usize + 24 + 8 * n;
    file[at..at + 8].copy_from_slice(&to.to_le_bytes());
}

fn channel(file: &mut Vec<u8>, next: u64, name: &str, kind: [u8; 4], byte: u32, bits: u32) -> u64 {
    let text = put(file, b"##TX", &[], format!("{name}\0").as_bytes());
    let mut data = kind.to_vec();
    data.extend(byte.to_le_bytes());
    data.extend(bits.to_le_bytes());
    data.resize(72, 0);
    put(file, b"##CN", &[next, 0, text, 0, 0, 0, 0, 0], &data)
}

/// A compressed block whose bytes were transposed in complete rows of `columns` bytes.
fn transposed(file: &mut Vec<u8>, bytes: &[u8], columns: usize) -> u64 {
    let rows = bytes.len() / columns;
    let mut across: Vec<u8> = (0..rows * columns).map(|n| bytes[n % rows * columns + n / rows]).collect();
    across.extend(&bytes[rows * columns..]);
    let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    std::io::Write::write_all(&mut packer, &across).unwrap();
    let packed = packer.finish().unwrap();
    let mut data = b"DT\x01\0".to_vec();
    data.extend((columns as u32).to_le_bytes());
    data.extend((bytes.len() as u64).to_le_bytes());
    data.extend((packed.len() as u64).to_le_bytes());
    data.extend(packed);
    put(file, b"##DZ", &[], &data)
}
