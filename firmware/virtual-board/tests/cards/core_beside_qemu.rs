//! The emulated core beside QEMU's: the same image, the same outputs, bit for bit.

use crate::boards::slow;
use crate::gdb::FileHost;
use control::{Config, SensorFrame};
use rigless::emulator::{self, Driver, Host, Start, Stop};
use rigless::image::Image;
use rigless::session::Session;
use rigless::time::VirtualNanos;
use std::net::TcpListener;
use std::path::Path;
use std::time::Duration;
use virtual_board::Options;
use virtual_board::board::Vesc6;
use virtual_board::wiring::Wiring;
use xtask::{image, qemu, rides};

/// Lets the run continue to its own end.
struct On;

impl Driver<Vesc6> for On {
    fn on_stop(&mut self, _: &mut Session<Vesc6>, stop: Stop, _: &mut dyn Host) -> Option<VirtualNanos> {
        Some(VirtualNanos(stop.at.0 + 1_000_000_000))
    }
}

/// Runs an image with semihosting in a directory with its files; returns its exit status.
fn run(name: &str, directory: &Path) -> Option<u32> {
    let board = Vesc6::new(Options::default(), Wiring::new()).expect("the chip is described soundly");
    let session = Session::new(Box::new(board), 0, VirtualNanos(1_000_000_000)).expect("the board fits");
    let images = [Image::read(&image::path(name), None).expect("the image is there")];
    let server = TcpListener::bind("127.0.0.1:0").expect("a port of this machine");
    let at = server.local_addr().expect("it has an address");
    let directory = directory.to_owned();
    let files = std::thread::spawn(move || FileHost::connect(at, &directory)?.serve());
    let mut start = Start::new(&images);
    (start.debugger, start.wait_for_debugger, start.semihosting) = (Some(&server), true, true);
    let finished = emulator::run(session, &start, On).expect("the core runs");
    let served = files.join().expect("the files' thread ends").expect("the connection check");
    assert_eq!(served.map(u32::from), finished.exit_status, "exit status over the connection");
    finished.exit_status
}

/// Situation: rides with every sensor and each of them faulty, NaN, infinities and denormals among the values, under
/// the product and every feature; every third ride, all of them with `STEER_ASSIST_SLOW`.
/// Action: `qemu-replay` steps through them in QEMU and on the emulated core.
/// Must hold: both end with 0, and every byte of every command is the same; there are some, and not all are alike.
#[test]
fn the_core_gives_the_same_bits_as_qemu() {
    if !image::ready() {
        return;
    }
    let (whole, broken) = (rides::all_sensors_ride(), rides::broken_rides());
    let odd: Vec<SensorFrame> = whole
        .iter()
        .zip([f32::NAN, f32::INFINITY, f32::MIN_POSITIVE / 3.0, -0.0, f32::MAX].into_iter().cycle())
        .map(|(frame, value)| {
            let mut frame = *frame;
            frame.steer_rad.value = value;
            frame
        })
        .collect();
    let (product, everything) = (rides::product(), rides::everything());
    let mut recorded: Vec<(&Config, &[SensorFrame])> = Vec::new();
    for config in [&product, &everything] {
        recorded.extend([(config, whole.as_slice()), (config, odd.as_slice())]);
        recorded.extend(broken.iter().step_by(7).map(|ride| (config, ride.as_slice())));
    }
    if !slow() {
        recorded = recorded.into_iter().step_by(3).collect();
    }
    let bytes = rides::encode(&recorded);
    let [in_qemu, on_core] = ["core-qemu", "core-emulated"].map(|name| qemu::directory(name).expect("made"));
    for directory in [&in_qemu, &on_core] {
        std::fs::write(directory.join("rides.bin"), &bytes).expect("written");
    }
    let outcome =
        qemu::run("qemu-replay", &[], &in_qemu, qemu::UNTIMED, Duration::from_secs(600)).expect("QEMU runs");
    assert_eq!((outcome.status, run("qemu-replay", &on_core)), (Some(0), Some(0)));
    let [theirs, ours] =
        [in_qemu, on_core].map(|directory| std::fs::read(directory.join("commands.bin")).expect("commands"));
    let steps: usize = recorded.iter().map(|(_, frames)| frames.len()).sum();
    assert!(theirs.len() > steps && steps > 2000, "{} bytes for {steps} steps", theirs.len());
    assert!(theirs.iter().any(|byte| *byte != theirs[0]));
    let differs = theirs.iter().zip(&ours).position(|(a, b)| a != b);
    assert_eq!((ours.len(), differs), (theirs.len(), None), "first byte that differs");
}
