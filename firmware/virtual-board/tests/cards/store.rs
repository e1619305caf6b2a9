//! The flash of the parameters: time, watchdog and power failures during erase and programming.

use crate::boards::{PRODUCT, image, query, slow};
use link::key::Key;
use link::message::Message;
use std::ops::Range;
use virtual_board::flash::{Change, Pace};
use virtual_board::wiring::Wiring;
use virtual_board::{Bench, Options};

/// Addresses of the flash of the parameters.
const STORE: Range<u32> = 0x0800_4000..0x0801_0000;

/// The product's board after its start, with these bytes in the flash of its parameters.
fn started(options: Options, store: &[u8]) -> Bench {
    let mut bench = Bench::power_on_with_store(&image(PRODUCT), options, Wiring::new(), Some(store)).unwrap();
    bench.run_ms(280.0).unwrap();
    bench
}

/// Sets the limit of the torque and stores it.
fn store(bench: &mut Bench, torque_nm: f32) {
    let set = Message::Set { key: Key::whole("limits.max_torque_nm"), value: Some(torque_nm) };
    let value = |message: &Message<'_>| match message {
        Message::Value { value, .. } => Some(*value),
        _ => None,
    };
    assert_eq!(query(bench, &set, 200.0, value), Some(torque_nm));
    query(bench, &Message::Store, 6000.0, |message| matches!(message, Message::Done).then_some(()));
}

/// Steps and clock \[us\] of the next telemetry, and its time of arrival \[us\].
fn clocks(bench: &mut Bench) -> [f64; 3] {
    let telemetry = |message: &Message<'_>| match message {
        Message::Telemetry(t) => Some((t.steps, t.frame.now_us)),
        _ => None,
    };
    let (steps, now_us) = query(bench, &Message::AskHello, 200.0, telemetry);
    [f64::from(steps), f64::from(now_us), bench.now_ms() * 1e3]
}

/// Situation: a flash full of zeros, which takes the longest times of its data sheet, and a watchdog whose oscillator
/// is the fastest.
/// Action: a store, which erases all three sectors.
/// Must hold: each is erased by words; the data cache holds nothing that was erased; no reset; the program's clock
/// loses nothing and control makes up for every step.
#[test]
fn the_longest_store_is_survived_without_losing_time() {
    let options = Options { flash: Pace::Longest, lsi_hz: 47_000, ..Options::default() };
    let mut bench = started(options, &[0; 48 << 10]);
    let before = clocks(&mut bench);
    store(&mut bench, 5.0);
    bench.run_ms(400.0).unwrap();
    let after = clocks(&mut bench);
    assert_eq!(bench.resets(), [], "resets");
    let erased: Vec<_> = bench.with(|board| {
        let erased = |(_, change): &(u64, Change)| match change {
            Change::Erased { sector, psize } => Some((*sector, *psize)),
            Change::Programmed { .. } => None,
        };
        board.flash.changes.iter().filter_map(erased).collect()
    });
    assert_eq!(erased, [(1, 2), (2, 2), (3, 2)], "sectors and PSIZE");
    assert_eq!(bench.with(|board| board.flash.stale_ns), None, "[ns], the data cache returns erased bytes");
    let [steps, clock_us, true_us] = [0, 1, 2].map(|i| after[i] - before[i]);
    println!("{:.1} ms true, {:.1} ms by the clock, {steps} steps", true_us * 1e-3, clock_us * 1e-3);
    assert!(true_us > 2.0e6, "{true_us} us");
    // Telemetry arrives some milliseconds old, not always by the same number.
    assert!((true_us - clock_us).abs() < 15e3, "{true_us} us, by the clock {clock_us} us");
    assert!((clock_us * 1e-3 - steps).abs() <= 1.0, "{clock_us} us, {steps} steps");
}

/// The configuration as reported in the log of a start.
fn configuration(store: &[u8]) -> String {
    let mut bench =
        Bench::power_on_with_store(&image(PRODUCT), Options::default(), Wiring::new(), Some(store)).unwrap();
    let logged = |bench: &mut Bench| {
        let mut lines = bench.log().iter().map(|line| &line.text);
        lines.find(|text| text.starts_with("configuration ")).cloned()
    };
    bench.run_until(300.0, "configuration", |bench| logged(bench).is_some()).unwrap();
    logged(&mut bench).expect("logged")
}

/// Situation: a configuration is stored.
/// Action: another is stored over it, and the power fails between two words that are programmed.
/// Must hold: the next start has the old one or the new one, from some word on the new one, and reports a stored one.
/// A few of the words; all of them with `STEER_ASSIST_SLOW`.
#[test]
fn a_store_cut_by_a_power_failure_is_the_old_one_or_the_new_one() {
    let mut bench = started(Options::default(), &[0xff; 48 << 10]);
    store(&mut bench, 5.0);
    let old = bench.store();
    let from = bench.with(|board| board.flash.changes.len());
    store(&mut bench, 4.0);
    let changes = bench.with(move |board| board.flash.changes[from..].to_vec());
    let new = bench.store();
    drop(bench);
    let words: Vec<(u32, u32)> = changes
        .iter()
        .map(|(_, change)| match change {
            Change::Programmed { address, value } => (*address as u32, *value),
            Change::Erased { sector, .. } => panic!("sector {sector} erased"),
        })
        .collect();
    assert!(words.len() > 20, "{} words", words.len());
    let after = |count: usize| {
        let mut flash = old.clone();
        for (address, value) in &words[..count] {
            let at = (address - STORE.start) as usize;
            flash[at..at + 4].iter_mut().zip(value.to_le_bytes()).for_each(|(byte, new)| *byte &= new);
        }
        flash
    };
    assert_eq!(after(words.len()), new, "the words are all changes");
    let (before, then) = (configuration(&old), configuration(&new));
    assert_ne!(before, then);
    assert!(before.ends_with("stored ones") && then.ends_with("stored ones"), "{before}, {then}");
    let last = words.len() - 1;
    let cuts: Vec<usize> = if slow() { (1..=last).collect() } else { vec![2, last] };
    let found: Vec<bool> = cuts
        .iter()
        .map(|count| {
            let found = configuration(&after(*count));
            assert!(found == before || found == then, "cut after {count} words: {found}");
            found == then
        })
        .collect();
    println!(
        "{} words, {} cuts, the new one {} times",
        words.len(),
        cuts.len(),
        found.iter().filter(|new| **new).count()
    );
    assert!(!found[0] && found.is_sorted(), "{found:?}");
}

/// Situation: the watchdog's fastest oscillator, the slowest instructions and the longest times of the flash, which is
/// erased.
/// Action: more stores than a sector holds, each of another value.
/// Must hold: each is confirmed; one sector is erased for them; no reset; the watchdog is always fed within its extended
/// timeout, 1.36 s here, with a tenth to spare.
#[test]
fn a_store_that_begins_a_new_sector_is_survived() {
    const STORES: u8 = 20;
    const LONGEST_MS: f64 = 1.36e3 * 0.9;
    let slowest =
        Options { cycles_per_instruction: 1.6, lsi_hz: 47_000, flash: Pace::Longest, ..Options::default() };
    let mut bench = started(slowest, &[0xff; 48 << 10]);
    for count in 0..STORES {
        store(&mut bench, 4.0 + f32::from(count) / 8.0);
    }
    assert_eq!(bench.resets(), [], "resets");
    let (feeds, changes) = bench.with(|board| (board.watchdog_feeds.clone(), board.flash.changes.clone()));
    let erased = changes.iter().filter(|(_, change)| matches!(change, Change::Erased { .. })).count();
    assert_eq!(erased, 1, "sectors");
    let longest_ns = feeds.windows(2).map(|pair| pair[1] - pair[0]).max().expect("it is fed");
    let longest_ms = longest_ns as f64 * 1e-6;
    println!("longest time without feeding the watchdog: {longest_ms:.0} ms");
    assert!((500.0..LONGEST_MS).contains(&longest_ms), "{longest_ms} ms");
}
