//! Many parameters set at once.

use crate::client::SHORT;
use control::safety::limits::{EndStop, SpeedCap};
use control::{Config, GainSchedule, Law, Taper};
use sim_host::board::Client;
use sim_host::board::settings::{Setting, Settings};
use sim_host::board::tune::{Tuned, tune};
use tests::link_board::{LinkBoard, LinkChannel, Shared, Wire, lock, shared};

fn board(config: &Config) -> Shared {
    shared(LinkBoard { config: config.clone(), ..LinkBoard::default() })
}

fn client(wire: Wire) -> Client {
    Client::new(Box::new(wire), SHORT)
}

/// All settings of a board with this configuration.
fn settings_of(config: &Config) -> Vec<Setting> {
    Settings::read(&mut client(Wire::good(&board(config)))).expect("settings").all()
}

/// A configuration with other values of every kind: a law with points, numbers, limits on and off, groups switched
/// on.
fn other() -> Config {
    let mut config = Config::product();
    config.law = Law::Table(GainSchedule::new(&[(0.0, 12.0), (6.0, 0.5)]).expect("a table"));
    config.limits.taper = Some(Taper { zero_m_s: 2.0, full_m_s: 3.0 });
    config.limits.fall_nm_s = None;
    config.limits.end_stop = Some(EndStop { soft_rad: 0.7, hard_rad: 1.1 });
    (config.limits.speed_cap, config.limits.rider_motion) = (Some(SpeedCap::default()), None);
    config.permit.ramp_in_ticks += 7;
    config.calibration.gyro_bias_rad_s[0] = 0.01;
    config
}

/// Situation: two boards of different configurations, one beyond the other's ranges that depend on each other.
/// Action: set the values of each on the other; then once more.
/// Must hold: bit for bit the same configuration; the second time nothing is set.
#[test]
fn settings_are_copied_between_boards() {
    assert!(other().plan().is_ok());
    for (from, to) in [(Config::product(), other()), (other(), Config::product())] {
        let board = board(&from);
        let mut client = client(Wire::good(&board));
        let expected = settings_of(&to);
        let before = Settings::read(&mut client).expect("settings");
        let Tuned { set, differing, now } = tune(&mut client, &before, &expected).expect("set");
        assert_eq!((lock(&board).config.clone(), differing.len()), (to, 0));
        assert!((7..=20).contains(&set.len()), "{set:?}");
        assert_eq!(tune(&mut client, &now, &expected).expect("set").set, [""; 0]);
    }
}

/// Situation: a board whose polarity check is passed.
/// Action: set another calibration; then the settings of a board whose check is passed.
/// Must hold: the check is cleared, never set, and reported as differing.
#[test]
fn a_passed_polarity_check_is_never_set() {
    let mut checked = Config::product();
    checked.calibration.polarity_checked = true;
    let mut turned = checked.clone();
    turned.calibration.gyro_bias_rad_s[0] = 0.01;
    let expected = settings_of(&turned);
    let board = board(&checked);
    let mut client = client(Wire::good(&board));
    let before = Settings::read(&mut client).expect("settings");
    let tuned = tune(&mut client, &before, &expected).expect("set");
    assert_eq!(tuned.set, ["calibration.gyro_bias_x_rad_s"]);
    assert_eq!(tuned.differing, ["calibration.polarity_checked"]);
    assert!(!lock(&board).config.calibration.polarity_checked);
}

/// Situation: settings that are valid alone, but not together; a board that is engaged.
/// Action: set them.
/// Must hold: an error with the reason; the configuration is unchanged to the bit.
#[test]
fn a_rejected_set_changes_nothing() {
    let start = other();
    let board = board(&start);
    let mut client = client(Wire::good(&board));
    let before = Settings::read(&mut client).expect("settings");
    let of = |key: &str, value| Setting::Value { key: key.into(), value };
    // The end-stop's ends in the wrong order, after changes that are accepted and in front of the calibration.
    let expected = [
        Setting::Law(Law::Cl1.into()),
        of("limits.taper", Some(0.0)),
        of("limits.end_stop.soft_rad", Some(1.4)),
        of("limits.end_stop.hard_rad", Some(0.6)),
        of("calibration.gyro_bias_x_rad_s", Some(0.0)),
    ];
    let error = tune(&mut client, &before, &expected).map(drop).expect_err("refused").to_string();
    for word in ["limits.end_stop", "is outside", "nothing is set: the previous values are restored"] {
        assert!(error.contains(word), "{error}");
    }
    assert_eq!(lock(&board).config, start);
    lock(&board).engaged = true;
    let error = tune(&mut client, &before, &expected).map(drop).expect_err("engaged").to_string();
    assert!(error.contains("rejected while engaged; nothing is set"), "{error}");
    assert_eq!(lock(&board).config, start);
}

/// Situation: a board that is engaged after the third setting.
/// Action: set six.
/// Must hold: the error reports the rejection, the three that are set, and that they cannot be reset, which is true.
#[test]
fn settings_that_cannot_be_reset_are_reported() {
    let start = Config::product();
    let board = board(&start);
    let (rider, mut sets) = (board.clone(), 0);
    let engages = move |bytes: Vec<u8>| {
        // The 0 before a frame, the first of the stuffing, the version, and then the kind: 4 is to set.
        sets += u32::from(bytes[3] == 4);
        lock(&rider).engaged = sets > 3;
        LinkChannel::Arrives(bytes)
    };
    let mut client = client(Wire::new(&board, Box::new(engages), Box::new(LinkChannel::Arrives)));
    let before = Settings::read(&mut client).expect("settings");
    let keys = ["limits.rise_nm_s", "limits.fall_nm_s", "limits.max_torque_nm", "permit.ramp_in_ticks"];
    let expected: Vec<_> =
        keys.iter().map(|key| Setting::Value { key: (*key).into(), value: Some(40.0) }).collect();
    let error = tune(&mut client, &before, &expected).map(drop).expect_err("engaged").to_string();
    for word in [
        "rejected while engaged",
        "set: limits.rise_nm_s, limits.fall_nm_s, limits.max_torque_nm;",
        "can't be restored",
    ] {
        assert!(error.contains(word), "{error}");
    }
    let now = lock(&board).config.clone();
    assert_eq!(
        (now.limits.max_torque_nm, now.permit.ramp_in_ticks),
        (Some(40.0), start.permit.ramp_in_ticks)
    );
}

/// Behaviour of a line from the frame of a number on.
#[derive(Clone, Copy, PartialEq)]
enum Break {
    /// Lost, before the request arrives.
    Before,
    /// Lost, before the answer arrives.
    After,
    /// No answer for a while.
    Mute,
}

/// Situation: six settings over a line that is lost, before or after the request, or silent for a while, at each of
/// them.
/// Action: set them.
/// Must hold: each setting reported as set is set, each reported as not set is not; only the current one is unknown,
/// and after a silence none.
#[test]
fn a_line_that_fails_half_way_is_reported_correctly() {
    let keys = [
        "rise_nm_s",
        "fall_nm_s",
        "max_torque_nm",
        "rider_torque.multiplier",
        "taper.full_m_s",
        "taper.zero_m_s",
    ];
    let keys = keys.map(|key| format!("limits.{key}"));
    for broken in [Break::Before, Break::After, Break::Mute] {
        for at in 0..keys.len() as u32 {
            let board = board(&Config::product());
            let (there, back) = (board.clone(), board.clone());
            let mut reader = client(Wire::good(&board));
            let before = Settings::read(&mut reader).expect("settings");
            lock(&board).requests = 0;
            let mut mute = SHORT.tries;
            let wire = Wire::new(
                &board,
                Box::new(move |bytes| match lock(&there).requests == at && broken == Break::Before {
                    true => LinkChannel::Lost,
                    false => LinkChannel::Arrives(bytes),
                }),
                Box::new(move |bytes| match broken {
                    Break::After if lock(&back).requests > at => LinkChannel::Lost,
                    Break::Mute if lock(&back).requests > at && mute > 0 => {
                        mute -= 1;
                        LinkChannel::Arrives(Vec::new())
                    }
                    _ => LinkChannel::Arrives(bytes),
                }),
            );
            let mut client = client(wire);
            let expected: Vec<_> = keys
                .iter()
                .zip([11.0, 12.0, 6.5, 0.75, 2.5, 1.25])
                .map(|(key, value)| Setting::Value { key: key.clone(), value: Some(value) })
                .collect();
            let error = tune(&mut client, &before, &expected).map(drop).expect_err("it failed").to_string();
            let now = Settings::read(&mut reader).expect("settings");
            let received = |start: &str| {
                let rest = error.split_once(start).map_or("", |(_, rest)| rest);
                rest.split(';').next().unwrap_or("").split(", ").map(String::from).collect::<Vec<_>>()
            };
            let (set, unset, unknown) = (received("; set: "), received("not set: "), received("not known: "));
            let set = if error.contains("read back: set: ") { received("read back: set: ") } else { set };
            let mut counts = [0; 3];
            for one in &expected {
                let key = one.key().to_owned();
                let place = [&set, &unset, &unknown].iter().position(|keys| keys.contains(&key));
                let place = place.unwrap_or_else(|| panic!("{key} is not reported: {error}"));
                counts[place] += 1;
                match place {
                    0 => assert!(now.has(one), "{key} is reported as set: {error}"),
                    1 => assert!(!now.has(one), "{key} is reported as not set: {error}"),
                    _ => {}
                }
            }
            let (at, all) = (at as usize, keys.len());
            match broken {
                Break::Mute => assert_eq!(counts, [at + 1, all - at - 1, 0], "{error}"),
                _ => assert_eq!(counts, [at, all - at - 1, 1], "{error}"),
            }
        }
    }
}
