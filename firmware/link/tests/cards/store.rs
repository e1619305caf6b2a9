//! Stored values are found again; those of another version are checked.

use crate::flash::{Flash, PAGE, PAGES, load, save};
use control::{Config, GainSchedule, Law};
use embassy_futures::block_on;
use link::Key;
use link::bytes::Reader;
use link::parameter_list::{each, each_but_law};
use link::record::{Applied, InvalidRecord, LAYOUT, NoRecord, RECORD_BYTES, decode, encode};
use link::store::{Found, MIN_PAGE, MIN_PAGES, NotStored, Store};
use sequential_storage::cache::Cache;
use sequential_storage::map::{MapConfig, MapStorage};

/// A checked product with a user's law.
fn own() -> Config {
    let table = GainSchedule::new(&[(-1.0, 0.0), (2.0, 12.0), (8.0, 0.0)]).expect("a table");
    let mut config = Config { law: Law::Table(table), ..Config::product() };
    config.calibration.polarity_checked = true;
    config.calibration.gyro_bias_rad_s = [0.01, -0.02, 0.003];
    config.limits.window = None;
    config.input.max_gap_ms = None;
    config
}

/// A record's bytes.
fn record(config: &Config, number: u32) -> Vec<u8> {
    let mut room = [0; RECORD_BYTES];
    let used = encode(config, number, None, &mut room).expect("room");
    room[..used].to_vec()
}

/// Flash with this record, whatever its bytes.
fn flashed(record: &[u8]) -> Flash {
    let flash = Flash::new();
    let range = 0..flash.bytes.len() as u32;
    let mut map = MapStorage::<u8, _, _>::new(flash, MapConfig::new(range), Cache::new_uncached());
    block_on(map.store_item(&mut [0; 4096], &1, &record)).expect("stored");
    map.destroy().0
}

/// The same bytes, except the value of one parameter.
fn with(record: &[u8], key: &str, value: f32) -> Vec<u8> {
    let hash = Key::whole(key).hash().to_le_bytes();
    let at = record.windows(4).rposition(|four| four == hash).expect("the parameter");
    let mut changed = record.to_vec();
    changed[at + 4..at + 8].copy_from_slice(&value.to_le_bytes());
    changed
}

/// The same bytes, as if the parameter had another name.
fn renamed(record: &[u8], key: &str) -> Vec<u8> {
    let (old, new) = (Key::whole(key).hash().to_le_bytes(), Key::whole("another.name").hash().to_le_bytes());
    let at = record.windows(4).rposition(|four| four == old).expect("the parameter");
    let mut changed = record.to_vec();
    changed[at..at + 4].copy_from_slice(&new);
    changed
}

/// Situation: empty flash.
/// Action: start, with defaults that claim a passed polarity check; store; start again.
/// Must hold: nothing was found and the check is not passed; then every parameter, the law included, as stored.
#[test]
fn a_stored_configuration_is_found_again() {
    let mut boastful = Config::product();
    boastful.calibration.polarity_checked = true;
    let (config, found, flash) = load(Flash::new(), &boastful);
    assert_eq!((config, found), (Config::product(), Found::Nothing));
    for law in
        [own().law, Law::Cl2 { k: 2.5 }, Law::BalanceAssist { kappa: 3.9 }, Law::None, Law::H { cut: true }]
    {
        let config = Config { law, ..own() };
        let (done, flash) = save(flash.clone(), &config);
        assert_eq!(done, Ok(()));
        let (found, result, _) = load(flash, &Config::product());
        assert_eq!((found, result), (config, Found::Record(Applied::default())));
    }
}

/// Situation: a configuration that `Config::plan` rejects, with another one stored.
/// Action: store it.
/// Must hold: rejected with its parameter; no byte of the flash changes.
#[test]
fn an_invalid_configuration_is_not_stored() {
    let flash = save(Flash::new(), &own()).1;
    let mut wrong = own();
    wrong.rate_hz = 1.0;
    let (done, after) = save(flash.clone(), &wrong);
    assert!(matches!(done, Err(NotStored::Rejected(error)) if error.leaf.name == "rate_hz"), "{done:?}");
    assert_eq!(after, flash);
}

/// Situation: all parameters, with each law.
/// Action: hash their names.
/// Must hold: no two have the same hash, and their number, 200 to 300, leaves room for those of other versions.
#[test]
fn no_two_parameters_share_a_hash() {
    for law in [Law::None, Law::Cl2 { k: 1.0 }, Law::BalanceAssist { kappa: 1.0 }] {
        let mut hashes = Vec::new();
        each(&mut Config { law, ..Config::product() }, |parameter| {
            hashes.push(parameter.key().hash());
            parameter.value
        });
        let count = hashes.len();
        hashes.sort_unstable();
        hashes.dedup();
        assert_eq!(hashes.len(), count);
        assert!((200..=300).contains(&count), "{count}");
    }
}

/// Situation: the hashed names.
/// Action: hash one of them by its parts and as a whole.
/// Must hold: the number that is in the flash of every board: it cannot change any more.
#[test]
fn the_hash_of_a_name_stays() {
    // The check value of CRC-32/ISO-HDLC.
    assert_eq!(Key::whole("123456789").hash(), 0xcbf4_3926);
    let parted = Key { group: "limits.end_stop", name: "soft_rad" };
    assert_eq!(parted.hash(), Key::whole("limits.end_stop.soft_rad").hash());
    assert_eq!(parted, Key::whole("limits.end_stop.soft_rad"));
}

/// Situation: a record of another version: one of today's parameters has another name there.
/// Action: start; store; read the record that was stored.
/// Must hold: one value unknown, one missing and at its default; the unknown one is still in the flash, after any
/// number of stores.
#[test]
fn values_of_another_version_are_preserved_and_ignored() {
    let mut config = own();
    config.permit.ramp_in_ticks = 777;
    let (found, result, mut flash) =
        load(flashed(&renamed(&record(&config, 1), "permit.ramp_in_ticks")), &Config::product());
    assert_eq!(result, Found::Record(Applied { unknown: 1, missing: 1, ..Applied::default() }));
    config.permit.ramp_in_ticks = Config::product().permit.ramp_in_ticks;
    assert_eq!(found, config);
    for _ in 0..20 {
        let (done, after) = save(flash, &found);
        assert_eq!(done, Ok(()));
        let (again, result, after) = load(after, &Config::product());
        assert_eq!(
            (again, result),
            (found.clone(), Found::Record(Applied { unknown: 1, ..Applied::default() }))
        );
        flash = after;
    }
    assert!(flash.erases > 0);
}

/// Situation: a record full of values of other versions.
/// Action: write today's configuration after it.
/// Must hold: all of today's values are there, those of others as far as there is room.
#[test]
fn todays_values_come_first_when_there_is_no_room() {
    let mut stuffed = record(&own(), 1);
    while stuffed.len() + 8 <= RECORD_BYTES {
        let foreign = stuffed.len() as u64;
        stuffed.extend_from_slice(&foreign.to_le_bytes());
    }
    let mut room = [0; RECORD_BYTES];
    let used = encode(&own(), 2, Some(&decode(&stuffed).expect("a record")), &mut room).expect("room");
    let mut config = Config::product();
    let applied = decode(&room[..used]).expect("a record").apply(&mut config);
    assert_eq!((config, applied.missing, applied.rejected), (own(), 0, 0));
    assert!(applied.unknown > 50 && used > RECORD_BYTES - 8, "{} {used}", applied.unknown);
}

/// Situation: a stored value outside today's range; a fraction; not a number; a law that does not exist.
/// Action: start.
/// Must hold: the value is named; its parameter has the default, all others the stored values; the polarity check
/// must be passed again.
#[test]
fn a_value_outside_todays_range_is_rejected_and_named() {
    let whole = record(&own(), 1);
    for (key, value, name) in [
        ("limits.max_torque_nm", 1e9, "max_torque_nm"),
        ("permit.ramp_in_ticks", 3.5, "ramp_in_ticks"),
        ("permit.ramp_in_ticks", f32::from_bits(u32::MAX), "ramp_in_ticks"),
        ("calibration.steer_zero_rad", f32::NAN, "steer_zero_rad"),
        ("input.wheel", 7.0, "wheel"),
        ("calibration.motor_reversed", 2.0, "motor_reversed"),
        // Within the range, but the board's control step has another rate.
        ("rate_hz", 500.0, "rate_hz"),
    ] {
        let (found, result, _) = load(flashed(&with(&whole, key, value)), &Config::product());
        let Found::Record(applied) = result else { panic!("{key}: {result:?}") };
        assert_eq!((applied.rejected, applied.missing, applied.unknown), (1, 0, 0), "{key}");
        assert_eq!(applied.first_rejected.map(|error| error.leaf.name), Some(name));
        let mut expected = own();
        expected.calibration.polarity_checked = false;
        each_but_law(&mut expected, |parameter| match parameter.key() == Key::whole(key) {
            true => link::parameter_list::get(&Config::product(), parameter.key())
                .and_then(|default| default.value),
            false => parameter.value,
        });
        assert_eq!(found, expected, "{key}");
    }
    let mut lawless = whole;
    lawless[7] = 200;
    let (found, result, _) = load(flashed(&lawless), &Config::product());
    assert!(matches!(result, Found::Record(Applied { rejected: 1, .. })), "{result:?}");
    assert_eq!((found.law, found.calibration.polarity_checked), (Config::product().law, false));
}

/// Situation: a record without one parameter of the calibration.
/// Action: start.
/// Must hold: all others as stored, except the polarity check: it was passed with another calibration and must be
/// passed again.
#[test]
fn a_missing_calibration_is_an_unchecked_one() {
    let record = renamed(&record(&own(), 1), "calibration.motor_reversed");
    let (found, result, _) = load(flashed(&record), &Config::product());
    let missing = Applied { unknown: 1, missing: 1, calibration_missing: true, ..Applied::default() };
    assert_eq!(result, Found::Record(missing));
    let mut expected = own();
    expected.calibration.polarity_checked = false;
    assert_eq!(found, expected);
}

/// Situation: values that are valid each alone, but inconsistent; another layout; wrong lengths.
/// Action: start with each, then store.
/// Must hold: the defaults, with the check not passed, and the reason; the store succeeds and is found.
#[test]
fn an_inconsistent_record_is_not_used() {
    let whole = record(&own(), 1);
    let unfit = with(&with(&whole, "limits.taper.full_m_s", 0.5), "limits.taper.zero_m_s", 1.5);
    let mut layout = whole.clone();
    layout[0] = LAYOUT + 1;
    let short = whole[..whole.len() - 1].to_vec();
    for (bytes, expected) in [
        (unfit, None),
        (layout, Some(InvalidRecord::NoRecord(NoRecord::Layout(LAYOUT + 1)))),
        (short, Some(InvalidRecord::NoRecord(NoRecord::Malformed))),
        (vec![], Some(InvalidRecord::NoRecord(NoRecord::Malformed))),
    ] {
        let (found, result, flash) = load(flashed(&bytes), &Config::product());
        match expected {
            Some(invalid) => assert_eq!(result, Found::Invalid(invalid)),
            None => assert!(matches!(result, Found::Invalid(InvalidRecord::Inconsistent(_))), "{result:?}"),
        }
        assert_eq!(found, Config::product());
        let (done, flash) = save(flash, &own());
        assert_eq!(done, Ok(()));
        assert_eq!(load(flash, &Config::product()).0, own());
    }
    assert!(Reader(&whole).u8() == Some(LAYOUT));
}

/// Situation: ranges of flash that cannot be a store: two pages, half pages, beyond the end, none.
/// Action: open a store there.
/// Must hold: none; three pages are one, and a page of the simulated flash is large enough.
#[test]
fn a_store_needs_three_whole_pages() {
    const { assert!(PAGE >= MIN_PAGE && PAGES == MIN_PAGES) };
    let page = PAGE as u32;
    let end = page * PAGES as u32;
    let half = page / 2;
    for range in [
        0..2 * page,
        0..end - half,
        half..end,
        half..end + half,
        0..end + page,
        page..end + page,
        page..page,
        end..0,
    ] {
        assert!(Store::new(Flash::new(), range.clone()).is_none(), "{range:?}");
    }
    assert!(Store::new(Flash::new(), 0..end).is_some());
}
