//! The tools for a board on an image in QEMU: the requests that other tests send to a board of the link.

use crate::steady_board::SteadyBoard;
use control::{Config, Law};
use link::Key;
use link::message::Message;
use link::parameter_list::each;
use sim_host::board::settings::{Setting, Settings};
use sim_host::board::tune::tune;
use sim_host::board::{Client, RetryPolicy};
use sim_host::pil::demo_board::DemoBoard;
use std::time::Duration;
use tests::cli::{Bench, word};
use xtask::image;

/// Situation: the image with every task, on a bicycle that rolls upright.
/// Action: request its identity; list; set a parameter, the law and a group; store; request its faults; listen.
/// Must hold: every parameter of the flashed code is listed; set values are read back, and the hash of the
/// configuration differs; there is no fault; telemetry continues, its steps 18 to 22 apart in the mean, as it waits
/// behind answers.
#[test]
fn an_image_answers_as_a_board() {
    if !image::ready() {
        return;
    }
    let board = DemoBoard::start(&image::path("qemu-pil")).expect("the image starts");
    let mut client = Client::new(Box::new(board), RetryPolicy::default());
    let hello = client.hello().expect("an answer");
    assert_eq!(hello.image, "qemu-pil");
    let before = Settings::read(&mut client).expect("settings");
    let mut names = Vec::new();
    each(&mut Config::product(), |parameter| {
        names.push(parameter.key().to_string());
        parameter.value
    });
    assert_eq!(before.parameters.iter().map(|one| one.key.clone()).collect::<Vec<_>>(), names);
    let of = |key: &str, value| Setting::Value { key: key.into(), value: Some(value) };
    let expected = [
        of("limits.max_torque_nm", 5.0),
        of("limits.end_stop", 0.0),
        Setting::Law(Law::Cl2 { k: 3.0 }.into()),
    ];
    let tuned = tune(&mut client, &before, &expected).expect("set");
    assert_eq!((tuned.set.len(), tuned.differing.len()), (3, 0), "{:?}", tuned.differing);
    client.store().expect("stored");
    assert_ne!(client.hello().expect("an answer").configuration, hello.configuration);
    assert_eq!(client.faults().expect("faults"), []);
    let mut steps = Vec::new();
    while steps.len() < 40 {
        for received in client.listen(Duration::from_secs(1)).expect("it goes on") {
            if let Ok(Message::Telemetry(step)) = received.message() {
                steps.push(step.steps);
            }
        }
    }
    let rising = steps.windows(2).all(|two| two[0] < two[1]);
    let mean = f64::from(steps[steps.len() - 1] - steps[0]) / (steps.len() - 1) as f64;
    assert!(rising && (18.0..=22.0).contains(&mean), "{mean} {steps:?}");
}

/// Situation: the same image, by the program.
/// Action: get a parameter, list faults, monitor, by the image's name and without.
/// Must hold: they succeed and name the board; further arguments are not taken for an image; a missing image is
/// named.
#[test]
fn the_program_takes_an_image_for_a_board() {
    if !image::ready() {
        return;
    }
    let bench = Bench::new(env!("CARGO_BIN_EXE_sim-host-under-test"));
    let image = word(&image::path("qemu-pil"));
    let run = |line: &str| {
        let run = bench.run(line);
        assert_eq!(run.code, Some(0), "{line}: {run:?}");
        run.stdout
    };
    assert!(run(&format!("param get rate_hz --qemu={image}")).contains("1000 Hz"));
    assert!(run("param get --qemu rate_hz").contains("1000 Hz"));
    assert_eq!(run("faults --qemu"), "no faults\n");
    let monitored = run("monitor --qemu --for 1s");
    assert!(
        monitored.contains("qemu-pil") && monitored.contains(" 0 missing, 0 damaged, 0 restarts"),
        "{monitored}"
    );
    bench.run("param list --qemu=no-such-image").rejected_naming(&["no-such-image", "cargo xtask firmware"]);
}

/// Situation: image qemu-pil at rest.
/// Action: request a parameter repeatedly, some kilobytes in all.
/// Must hold: every request is answered, and once.
#[test]
fn no_request_is_lost() {
    if !image::ready() {
        return;
    }
    let mut board = SteadyBoard::with(&[], &Config::product());
    let requests = 150;
    for _ in 0..requests {
        board.request(&Message::Get { key: Key::whole("rate_hz") });
        board.ride(30, false);
    }
    assert_eq!((board.values.len(), board.values[0]), (requests, Some(1000.0)));
}
