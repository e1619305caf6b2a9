//! CAN broadcasts of the board's state for displays and loggers. Nothing is received: no filter accepts a frame.
//!
//! Each of the three frames uses its own one of the three mailboxes. A frame is tried once; a pending one is aborted
//! when the next is due. So a missing, shorted or busy bus affects only the counters.

use super::pins::{Pin, alternate};
use crate::tasks::settings;
use crate::telemetry::{Telemetry, latest};
use control::Calibration;
use control::sensors::calibration::CalibrationPlan;
use devices::vesc6::CAN_CLOCK_HZ;
use embassy_stm32::gpio::{AfType, OutputType, Pull, Speed};
use embassy_stm32::pac::CAN1;
use embassy_stm32::{peripherals, rcc};
use embassy_time::{Duration, Instant, Timer};
use link::can::{BIT_HZ, Frame, Message, Motion, PERIOD_MS, State, fresh};
use link::can_bit_timing::bit_timing;
use link::can_mailbox::{Action, Counts, Mailbox};

/// Alternate function of CAN1.
const FUNCTION: u8 = 9;
/// Timeouts: the controller answers within a bit or two, and joins after 11 recessive bits of 2 us.
const TIMEOUT: Duration = Duration::from_millis(1);

/// Configures the controller. Without its answer it stays off the bus; on a busy bus it joins as soon as the bus is
/// idle.
pub(super) fn start(receive: Pin, transmit: Pin) {
    rcc::enable_and_reset::<peripherals::CAN1>();
    // Pull-up, so that a missing transceiver reads as an idle bus.
    alternate(receive, FUNCTION, AfType::input(Pull::Up));
    alternate(transmit, FUNCTION, AfType::output(OutputType::PushPull, Speed::Medium));
    CAN1.mcr().modify(|w| {
        w.set_sleep(false);
        w.set_inrq(true);
        // No retransmission; automatic recovery from bus-off; mailbox priority by identifier.
        w.set_nart(true);
        w.set_abom(true);
        w.set_txfp(false);
    });
    let Some(timing) =
        bit_timing(CAN_CLOCK_HZ, BIT_HZ).filter(|_| within_timeout(|| CAN1.msr().read().inak()))
    else {
        defmt::error!("can: not initialised, nothing is sent");
        return;
    };
    // The registers contain each number less one.
    CAN1.btr().write(|w| {
        w.set_brp(timing.prescaler - 1);
        w.set_ts(0, timing.segment_1 - 1);
        w.set_ts(1, timing.segment_2 - 1);
        w.set_sjw(timing.jump - 1);
    });
    // Without an active filter, received frames are acknowledged and dropped.
    CAN1.fmr().modify(|w| w.set_finit(false));
    CAN1.mcr().modify(|w| w.set_inrq(false));
    defmt::info!("can: bus quiet={=bool}", within_timeout(|| !CAN1.msr().read().inak()));
}

/// Waits for a condition with a timeout; returns whether it occurred.
fn within_timeout(came: impl Fn() -> bool) -> bool {
    let end = Instant::now() + TIMEOUT;
    while !came() {
        if Instant::now() > end {
            return false;
        }
    }
    true
}

/// Broadcasts the last control step every [`PERIOD_MS`], and logs the frame counters over RTT once per second.
#[embassy_executor::task]
pub async fn broadcast() {
    let mut counts = Counts::default();
    let mut configuration = None;
    let mut calibration = Calibration::default().plan();
    for time in (0..1000 / PERIOD_MS).cycle() {
        Timer::after_millis(PERIOD_MS).await;
        let Some(telemetry) = latest() else { continue };
        if configuration != Some(telemetry.configuration) {
            configuration = Some(telemetry.configuration);
            calibration = settings::config().calibration.plan();
        }
        for (place, message) in messages(&telemetry, &calibration).iter().enumerate() {
            put(place, &message.frame(), &mut counts);
        }
        if time == 0 {
            let errors = CAN1.esr().read();
            let Counts { sent, lost } = counts;
            defmt::info!(
                "can: sent={=u32} lost={=u32} errors={=u8} off={=bool}",
                sent,
                lost,
                errors.tec(),
                errors.boff()
            );
        }
    }
}

/// Frames of a control step, the most urgent first.
fn messages(t: &Telemetry, calibration: &CalibrationPlan) -> [Message; 3] {
    let rear = &t.frame.rear_wheel_m_s;
    let state = State {
        mode: t.command.mode,
        driven: t.drive.is_ok(),
        engage: t.frame.engage,
        polarity: t.polarity,
        limits: t.command.limits,
        authority: Some(t.authority),
        speed_m_s: fresh(rear.value, rear.age_ticks),
        steps: t.deadlines.steps as u8,
    };
    let motion = Motion::of(calibration, &t.frame, &t.command);
    [Message::State(state), Message::Motion(motion), Message::Causes(t.command.causes)]
}

/// Loads a frame into its mailbox, or aborts a pending one.
fn put(place: usize, frame: &Frame, counts: &mut Counts) {
    let status = CAN1.tsr().read();
    let mailbox =
        Mailbox { empty: status.tme(place), completed: status.rqcp(place), acknowledged: status.txok(place) };
    match counts.step(mailbox) {
        Action::Put => {
            let [b0, b1, b2, b3, b4, b5, b6, b7] = frame.bytes;
            let to = CAN1.tx(place);
            to.tdtr().write(|w| w.set_dlc(8));
            to.tdlr().write(|w| w.0 = u32::from_le_bytes([b0, b1, b2, b3]));
            to.tdhr().write(|w| w.0 = u32::from_le_bytes([b4, b5, b6, b7]));
            to.tir().write(|w| {
                w.set_stid(frame.identifier);
                w.set_txrq(true);
            });
        }
        // The other bits of this register change only where a one is written.
        Action::Abort => CAN1.tsr().write(|w| w.set_abrq(place, true)),
    }
}
