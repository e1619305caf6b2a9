//! What the image does when something goes wrong in it: every task as on the board, in QEMU.

use control::{Command, Config, Mode, SensorFrame};
use link::frame::{Decoder, MAX_FRAME, Received};
use link::lockstep::ToBoard;
use link::message::Message;
use link::report::{FaultKind, ResetCause};
use sim_host::board::Lockstep;
use sim_host::board::qemu::Qemu;
use std::time::Duration;
use xtask::{image, rides};

/// What a fault record tells.
#[derive(Debug, PartialEq)]
struct Kept {
    kind: FaultKind,
    boot: u32,
    mode: Mode,
    steps: u32,
    text: String,
}

/// A board that rides steadily, upright.
struct Rig {
    board: Qemu,
    motor: Decoder,
    line: Decoder,
    /// The number of the next step since the loop began anew.
    step: u16,
    now_us: u32,
    /// Sent with the next exchange.
    request: Vec<u8>,
    /// What the board said over the line, as far as it was asked for.
    kept: Vec<Kept>,
    logs: Vec<String>,
    done: u32,
    hash: Option<u32>,
    latest: Option<Command>,
    /// What the sensors say, upright.
    steady: SensorFrame,
}

impl Rig {
    /// Started with these words; the product with every sensor rides, its configuration is in flash.
    fn start(words: &[&str]) -> Self {
        let board =
            Qemu::start(&image::path("qemu-pil"), words, Duration::from_secs(60)).expect("the image starts");
        let mut rig = Self {
            board,
            motor: Decoder::default(),
            line: Decoder::default(),
            step: 0,
            now_us: 0,
            request: Vec::new(),
            kept: Vec::new(),
            logs: Vec::new(),
            done: 0,
            hash: None,
            latest: None,
            steady: rides::all_sensors_ride()[200],
        };
        let mut config = rides::product();
        config.calibration.polarity_checked = true;
        rig.begin(&config);
        rig.ask(&Message::Store);
        rig.ride(20, false);
        assert_eq!(rig.done, 1, "stored");
        rig
    }

    fn begin(&mut self, config: &Config) {
        let bytes = control::wire::encode_config(config);
        let mut sensors = Vec::new();
        for (i, piece) in bytes.chunks(256).enumerate() {
            put(&Message::PilConfig { at: 256 * i as u16, bytes: piece }, 0, &mut sensors);
        }
        put(&Message::PilReset, 0, &mut sensors);
        put(&Message::PilFrame(self.steady), 0, &mut sensors);
        (self.step, self.now_us) = (1, self.steady.now_us.wrapping_add(1000));
        self.exchange(&sensors);
    }

    fn ask(&mut self, message: &Message<'_>) {
        put(message, 9, &mut self.request);
    }

    /// So many milliseconds with the switch so.
    fn ride(&mut self, ms: u32, engage: bool) {
        for _ in 0..ms {
            let steady = self.steady;
            let frame = SensorFrame { now_us: self.now_us, engage, ..steady };
            let mut sensors = Vec::new();
            put(&Message::PilFrame(frame), self.step, &mut sensors);
            (self.step, self.now_us) = (self.step.wrapping_add(1), self.now_us.wrapping_add(1000));
            self.exchange(&sensors);
        }
    }

    fn exchange(&mut self, sensors: &[u8]) {
        let line = std::mem::take(&mut self.request);
        let starts = self.starts();
        self.board.exchange(&ToBoard { sensors, line: &line }).expect("the board goes on");
        if self.starts() != starts {
            // A new program counts its steps anew; it has done the first before it hands over.
            self.step = 1;
        }
        let said = self.board.last();
        for byte in said.motor {
            if let Some(Received::Frame(frame)) = self.motor.feed(*byte) {
                match Message::decode(&frame) {
                    Ok(Message::PilCommand { command, .. }) => self.latest = Some(command),
                    Ok(Message::Done) => {}
                    other => panic!("{other:?}"),
                }
            }
        }
        for byte in said.line {
            if let Some(Received::Frame(frame)) = self.line.feed(*byte) {
                match Message::decode(&frame) {
                    Ok(Message::KeptFault(kept)) => self.kept.extend(kept.record.map(|record| Kept {
                        kind: record.kind,
                        boot: record.boot,
                        mode: record.mode,
                        steps: record.steps,
                        text: record.text.into(),
                    })),
                    Ok(Message::Log(text)) => self.logs.push(text.into()),
                    Ok(Message::Hello(hello)) => self.hash = Some(hello.config_hash),
                    Ok(Message::Done) => self.done += 1,
                    _ => {}
                }
            }
        }
    }

    fn starts(&self) -> u16 {
        self.board.last().starts
    }

    fn time_ms(&self) -> u32 {
        self.board.last().time_ms
    }

    fn mode(&self) -> Mode {
        self.latest.expect("a command").mode
    }

    fn torque_nm(&self) -> f32 {
        self.latest.expect("a command").torque_nm
    }
}

fn put(message: &Message<'_>, sequence: u16, to: &mut Vec<u8>) {
    let mut room = [0; MAX_FRAME];
    let used = message.encode(sequence, &mut room).expect("room");
    to.extend(&room[..used]);
}

/// When the mishap happens \[ms\]: long after the switch was pressed and the assist has its authority.
const AT_MS: u32 = 2500;

/// Situation: the product, engaged, its configuration in flash; all tasks run.
/// Action: 2.5 s after the start a task waits for ever, a task never ends, control never ends, a panic, a bus fault, the
/// supply falls; the switch stays pressed; later it is released and pressed again.
/// Must hold: engaged until then; a new start within the stated time, and just one; no torque from then on, and no
/// engagement until the fresh press, then engagement; the fault is kept with its kind, start, mode and words; the cause of
/// the new start is told; the stored configuration is in force.
#[test]
fn whatever_goes_wrong_ends_in_a_new_start_without_torque() {
    if !image::ready() {
        return;
    }
    use FaultKind::{BrownOut, Exception, Panic, Watchdog};
    let thread = "the lowest priority stood still";
    for (mishap, ms, kind, boot, text, cause) in [
        ("control-mute", 100..171, Watchdog, 1, "control", ResetCause::Watchdog),
        ("line-mute", 100..171, Watchdog, 1, "line", ResetCause::Watchdog),
        ("report-mute", 100..171, Watchdog, 1, "report", ResetCause::Watchdog),
        ("control-spin", 80..111, Watchdog, 2, thread, ResetCause::Watchdog),
        ("line-spin", 80..121, Watchdog, 2, thread, ResetCause::Watchdog),
        ("report-spin", 80..131, Watchdog, 2, thread, ResetCause::Watchdog),
        ("panic", 0..6, Panic, 1, "on purpose", ResetCause::Software),
        ("bus", 0..6, Exception, 1, "", ResetCause::Software),
        ("brown-out", 0..6, BrownOut, 1, "supply too low", ResetCause::Software),
    ] {
        let (at, word) = (format!("at_ms={AT_MS}"), format!("mishap={mishap}"));
        let mut rig = Rig::start(&[&word, &at]);
        rig.ride(1000, false);
        let stored = rides::product();
        while rig.starts() == 1 && rig.time_ms() < AT_MS {
            rig.ride(1, true);
        }
        assert_eq!(rig.mode(), Mode::Engaged, "{mishap}: until then, {:?}, {}", rig.latest, rig.board.said());
        while rig.starts() == 1 && rig.time_ms() < AT_MS + 1000 {
            rig.ride(1, true);
        }
        let took = rig.time_ms() - AT_MS;
        assert!(ms.contains(&took), "{mishap}: {took} ms");
        for _ in 0..2000 {
            rig.ride(1, true);
            assert!(rig.torque_nm() == 0.0 && !rig.mode().drives(), "{mishap}: {:?}", rig.latest);
        }
        let mut checked = stored.clone();
        checked.calibration.polarity_checked = true;
        rig.ask(&Message::AskHello);
        rig.ask(&Message::ListFaults { from: 0 });
        rig.ride(200, false);
        assert_eq!(
            rig.hash,
            Some(link::report::config_hash(&checked)),
            "{mishap}: what was stored is in force"
        );
        let kept = &rig.kept[0];
        assert_eq!((kept.kind, kept.boot), (kind, boot), "{mishap}: {kept:?}");
        assert!(kept.text.contains(text), "{mishap}: {kept:?}");
        assert_eq!(kept.mode, Mode::Engaged, "{mishap}: {kept:?}");
        assert!((AT_MS - 2..AT_MS + 171).contains(&kept.steps), "{mishap}: {kept:?}");
        let told = format!("start 2 after {}; parameters: stored ones", cause.name());
        assert!(rig.logs.iter().any(|log| log.contains(&told)), "{mishap}: {:?}", rig.logs);
        rig.ride(2000, true);
        assert_eq!((rig.mode(), rig.starts()), (Mode::Engaged, 2), "{mishap}: a fresh press engages");
    }
}
