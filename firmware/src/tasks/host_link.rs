//! The serial link to the host: parameters, stored faults, telemetry. Runs at the lowest priority and blocks no other
//! task.

use super::settings::{self, StoredConfig};
use crate::heartbeat::Task;
use crate::telemetry::{Telemetry, latest};
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

/// Telemetry period: uses half of a line of 115200 baud.
const TELEMETRY_PERIOD: Duration = Duration::from_millis(20);

/// Queue of answers and telemetry.
type Queue = TxQueue<2048, 1024>;

/// Answers requests, and sends telemetry and new faults in between; the first message is the start log.
#[embassy_executor::task]
pub async fn line(image: Image, stored: &'static mut StoredConfig) {
    let (mut decoder, mut queue) = (Decoder::default(), Queue::new(1));
    let mut text = String::<{ MAX_PAYLOAD }>::new();
    // Longer text is cut.
    let _ = write!(
        text,
        "start {} after {}; parameters: {}",
        crash::starts(),
        crash::cause().name(),
        stored.found()
    );
    if let Some(offset) = stored.offset() {
        let _ = write!(text, "; encoder offset: {offset}");
    }
    queue.send(&Message::Log(&text));
    let mut faults = retained::with(|ring| fault_log::noted(ring)).unwrap_or(0);
    let mut telemetry_due = Ticker::every(TELEMETRY_PERIOD);
    let mut bytes = [0; 64];
    loop {
        Task::Line.report();
        match select(board::serial::read(&mut bytes), telemetry_due.next()).await {
            Either::First(taken) => {
                let mut bytes = bytes.get(..taken).unwrap_or_default();
                while !bytes.is_empty() {
                    take(&mut bytes, &mut decoder, image, stored, &mut queue).await;
                }
            }
            Either::Second(()) => {
                if let Some(telemetry) = latest() {
                    if telemetry.polarity == PolarityStep::Passed {
                        settings::polarity_passed(telemetry.configuration);
                    }
                    queue.step(&message(&telemetry));
                }
                retained::with(|ring| {
                    let before = core::mem::replace(&mut faults, fault_log::noted(ring));
                    if let (true, Some(newest)) = (faults != before, fault_log::faults(ring).next()) {
                        queue.send(&Message::Fault(newest));
                    }
                });
            }
        }
        send(&mut queue).await;
    }
}

/// Sends the queue in small blocks.
async fn send(queue: &mut Queue) {
    let mut bytes = [0; 64];
    loop {
        let mut used = 0;
        while used < bytes.len() {
            let Some(byte) = queue.next_byte() else { break };
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

/// Decodes bytes up to the end of a request, and answers it.
async fn take(
    bytes: &mut &[u8],
    decoder: &mut Decoder,
    image: Image,
    stored: &mut StoredConfig,
    queue: &mut Queue,
) {
    let Some(received) = decoder.take(bytes) else { return };
    let (sequence, request) = match requests::request(&received) {
        Ok(request) => request,
        Err(wrong) => {
            let (sequence, answer) = wrong.answer();
            queue.answer(&answer, sequence);
            return;
        }
    };
    match request {
        Message::AskHello => {
            let Image { name, version, commit } = image;
            let config_hash = config_hash(&settings::config());
            queue.answer(&Message::Hello(Hello { image: name, version, commit, config_hash }), sequence);
        }
        Message::Store if !settings::engaged() => {
            let saved = stored.save(&settings::config()).await;
            let rejected = |_| Message::Rejected(Rejection::of(RejectReason::NotStored));
            queue.answer(&saved.map_or_else(rejected, |()| Message::Done), sequence);
        }
        Message::ListFaults { from } => {
            retained::with(|log| {
                let total = fault_log::faults(log).count() as u16;
                let record = fault_log::faults(log).nth(from.into());
                queue.answer(&Message::StoredFault(StoredFault { place: from, total, record }), sequence);
            });
        }
        Message::ClearFaults => {
            retained::with(fault_log::clear);
            queue.answer(&Message::Done, sequence);
        }
        request => change(&request, sequence, queue),
    }
}

/// Answers a request about parameters; passes a changed configuration to the controller.
fn change(request: &Message<'_>, sequence: u16, queue: &mut Queue) {
    let before = settings::config();
    let (mut config, mut room) = (before.clone(), [0; PAGE_BYTES]);
    let answer = requests::answer(&Config::product(), &mut config, settings::engaged(), request, &mut room);
    if config != before
        && let Ok(plan) = config.plan()
    {
        settings::queue_plan(plan, false);
    }
    queue.answer(&answer.unwrap_or(Message::Rejected(Rejection::of(RejectReason::NotHere))), sequence);
}

/// Telemetry message of a control step.
fn message(latest: &Telemetry) -> link::telemetry::Telemetry {
    link::telemetry::Telemetry {
        steps: latest.deadlines.steps,
        late: latest.deadlines.late,
        driven: latest.drive.is_ok(),
        frame: latest.frame,
        command: latest.command,
        slopes: latest.slopes,
        polarity: latest.polarity as u8,
        polarity_torque_nm: latest.polarity_torque_nm,
    }
}
