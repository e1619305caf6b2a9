//! The engineer's line: parameters, kept faults, telemetry. At the lowest priority; nothing waits for it.

use super::settings::{self, StoredConfig};
use super::{Telemetry, latest};
use crate::heartbeat::Task;
use crate::{Image, board, crash, retained};
use ::control::Config;
use ::control::sensors::polarity::PolarityStep;
use core::fmt::Write;
use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Ticker};
use heapless::String;
use link::frame::MAX_PAYLOAD;
use link::message::Message;
use link::page::PAGE_BYTES;
use link::rejection::{RejectReason, Rejection};
use link::report::{Hello, StoredFault, config_hash};
use link::{Decoder, TxQueue, fault_log, requests};

/// How often telemetry is told: half of a line of 115200 baud.
const TELL: Duration = Duration::from_millis(20);

/// Answers and telemetry that wait.
type Waiting = TxQueue<2048, 1024>;

/// Takes requests, answers them, and tells telemetry in between, new faults, and first of all how the program started.
#[embassy_executor::task]
pub async fn line(image: Image, stored: &'static mut StoredConfig) {
    let (mut decoder, mut waiting) = (Decoder::default(), Waiting::new(1));
    let mut words = String::<{ MAX_PAYLOAD }>::new();
    // What does not fit is cut.
    let _ = write!(
        words,
        "start {} after {}; parameters: {}",
        crash::starts(),
        crash::cause().name(),
        stored.found()
    );
    if let Some(offset) = stored.offset() {
        let _ = write!(words, "; encoder offset: {offset}");
    }
    waiting.send(&Message::Log(&words));
    let mut faults = retained::with(|ring| fault_log::noted(ring)).unwrap_or(0);
    let mut tell = Ticker::every(TELL);
    let mut bytes = [0; 64];
    loop {
        Task::Line.report();
        match select(board::serial::read(&mut bytes), tell.next()).await {
            Either::First(taken) => {
                let mut bytes = bytes.get(..taken).unwrap_or_default();
                while !bytes.is_empty() {
                    take(&mut bytes, &mut decoder, image, stored, &mut waiting).await;
                }
            }
            Either::Second(()) => {
                if let Some(telemetry) = latest() {
                    if telemetry.polarity == PolarityStep::Passed {
                        settings::polarity_passed(telemetry.configuration);
                    }
                    waiting.step(&told(&telemetry));
                }
                retained::with(|ring| {
                    let before = core::mem::replace(&mut faults, fault_log::noted(ring));
                    if let (true, Some(newest)) = (faults != before, fault_log::faults(ring).next()) {
                        waiting.send(&Message::Fault(newest));
                    }
                });
            }
        }
        send(&mut waiting).await;
    }
}

/// Sends what waits, a little at a time.
async fn send(waiting: &mut Waiting) {
    let mut bytes = [0; 64];
    loop {
        let mut used = 0;
        while used < bytes.len() {
            let Some(byte) = waiting.next_byte() else { break };
            bytes[used] = byte;
            used += 1;
        }
        if used == 0 {
            return;
        }
        board::serial::write(&bytes[..used]).await;
        Task::Line.report();
    }
}

/// Takes bytes up to the end of a request, and answers it.
async fn take(
    bytes: &mut &[u8],
    decoder: &mut Decoder,
    image: Image,
    stored: &mut StoredConfig,
    waiting: &mut Waiting,
) {
    let Some(received) = decoder.take(bytes) else { return };
    let (sequence, request) = match requests::request(&received) {
        Ok(request) => request,
        Err(wrong) => {
            let (sequence, answer) = wrong.answer();
            waiting.answer(&answer, sequence);
            return;
        }
    };
    match request {
        Message::AskHello => {
            let Image { name, version, commit } = image;
            let config_hash = config_hash(&settings::config());
            waiting.answer(&Message::Hello(Hello { image: name, version, commit, config_hash }), sequence);
        }
        Message::Store if !settings::engaged() => {
            let stored = stored.save(&settings::config()).await;
            let refused = |_| Message::Refused(Rejection::of(RejectReason::NotStored));
            waiting.answer(&stored.map_or_else(refused, |()| Message::Done), sequence);
        }
        Message::ListFaults { from } => {
            retained::with(|stored| {
                let total = fault_log::faults(stored).count() as u16;
                let record = fault_log::faults(stored).nth(from.into());
                waiting.answer(&Message::StoredFault(StoredFault { place: from, total, record }), sequence);
            });
        }
        Message::ClearFaults => {
            retained::with(fault_log::clear);
            waiting.answer(&Message::Done, sequence);
        }
        request => change(&request, sequence, waiting),
    }
}

/// Answers what is asked of the parameters; the controller gets those that changed.
fn change(request: &Message<'_>, sequence: u16, waiting: &mut Waiting) {
    let before = settings::config();
    let (mut config, mut room) = (before.clone(), [0; PAGE_BYTES]);
    let answer = requests::answer(&Config::product(), &mut config, settings::engaged(), request, &mut room);
    if config != before
        && let Ok(plan) = config.plan()
    {
        settings::offer(plan, false);
    }
    waiting.answer(&answer.unwrap_or(Message::Refused(Rejection::of(RejectReason::NotHere))), sequence);
}

/// A control step as it is told.
fn told(latest: &Telemetry) -> link::telemetry::Telemetry {
    link::telemetry::Telemetry {
        steps: latest.deadlines.steps,
        late: latest.deadlines.late,
        driven: latest.drive.is_ok(),
        frame: latest.frame,
        command: latest.command,
        slopes: latest.slopes,
        polarity: latest.polarity as u8,
        shown_nm: latest.shown_nm,
    }
}
