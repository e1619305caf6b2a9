//! CAN1 (bxCAN, RM0090 rev 22, chapter 32) and its bus: three mailboxes, single transmission, error counters, bus-off
//! and recovery; a second node that acknowledges, and sends frames that no filter accepts.
//!
//! Reception is only the acknowledgement: this board activates no filter, and an active filter ends the run.

use crate::wiring::{AsCan, Wiring};
use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::Layout;
use rigless::soc::stm32f427::generated::can1::Register;
use rigless::time::{EventId, VirtualNanos};

/// Clock of the controller: APB1 \[Hz\].
const CLOCK_HZ: u64 = 42_000_000;

const INRQ: u32 = 1;
const SLEEP: u32 = 1 << 1;
const NART: u32 = 1 << 4;
const ABOM: u32 = 1 << 6;
const MCR_RESET: u32 = 0x0001_0000 | SLEEP;
const INAK: u32 = 1;
const SLAK: u32 = 1 << 1;
/// Number of recessive bits after which a node joins the bus, and after which it recovers from bus-off (32.7.6).
const QUIET_BITS: u64 = 11;
const RECOVERY_BITS: u64 = 128 * 11;
/// Error counts from which a node is in warning, passive and bus-off state.
const WARNED: u32 = 96;
const PASSIVE: u32 = 128;
const OFF: u32 = 256;
/// Last error codes (32.9.2).
const LEC_ACKNOWLEDGEMENT: u32 = 3;
const LEC_BIT_DOMINANT: u32 = 5;

/// A transmitted frame with a standard identifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Time of its last bit \[ns\].
    pub at_ns: u64,
    /// Identifier.
    pub identifier: u16,
    /// Number of data bytes.
    pub length: u8,
    /// Data.
    pub bytes: [u8; 8],
}

/// The rest of the bus.
#[derive(Clone, Debug, Default)]
pub struct Network {
    /// Whether a second node is present and acknowledges.
    pub node: bool,
    /// Whether the wires are shorted: no bit is read back as sent.
    pub shorted: bool,
    /// Frames received by the second node.
    pub received: Vec<Frame>,
}

/// One mailbox.
#[derive(Clone, Copy, Debug, Default)]
struct Mailbox {
    identifier: u32,
    length: u32,
    data: [u32; 2],
    waits: bool,
    /// RQCP, TXOK, ALST, TERR.
    status: u32,
    abort: bool,
}

const RQCP: u32 = 1;
const TXOK: u32 = 1 << 1;
const TERR: u32 = 1 << 3;
const ABRQ: u32 = 1 << 7;

/// Event that the controller waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// The bus has been idle for long enough to join.
    Join,
    /// End of this mailbox's frame.
    Sent(usize),
    /// The bus has been idle for long enough to recover from bus-off.
    Recover,
}

/// The controller and its bus.
#[derive(Clone, Debug)]
pub struct Can {
    mcr: u32,
    msr: u32,
    btr: u32,
    mailboxes: [Mailbox; 3],
    transmit_errors: u32,
    last_error: u32,
    off: bool,
    event: Option<(EventId, Step)>,
    /// The bus.
    pub network: Network,
}

impl Default for Can {
    fn default() -> Self {
        Self {
            mcr: MCR_RESET,
            msr: SLAK,
            btr: 0,
            mailboxes: [Mailbox::default(); 3],
            transmit_errors: 0,
            last_error: 0,
            off: false,
            event: None,
            network: Network::default(),
        }
    }
}

impl Can {
    /// Resets the chip's part; the bus keeps its state.
    pub(crate) fn reset(&mut self) {
        *self = Self { network: std::mem::take(&mut self.network), ..Self::default() };
    }

    /// Length of a bit \[ns\] (32.7.7).
    fn bit_ns(&self) -> f64 {
        let field = |from: u32, bits: u32| self.btr >> from & ((1 << bits) - 1);
        let quanta = 3 + field(16, 4) + field(20, 3);
        f64::from(quanta * (field(0, 10) + 1)) * 1e9 / CLOCK_HZ as f64
    }

    /// Bit rate \[bit/s\].
    pub fn bit_hz(&self) -> f64 {
        1e9 / self.bit_ns()
    }

    fn takes_part(&self) -> bool {
        self.msr & (INAK | SLAK) == 0 && !self.off
    }

    fn schedule(&mut self, bits: u64, step: Step, context: &mut DeviceContext<'_>) {
        let at = context.now().0 + (bits as f64 * self.bit_ns()) as u64;
        self.event = Some((context.schedule(VirtualNanos(at)), step));
    }

    /// Starts a pending transmission if possible.
    fn go_on(&mut self, context: &mut DeviceContext<'_>) {
        if self.event.is_some() {
            return;
        }
        if self.off {
            // A bus that is held dominant is never idle.
            if self.mcr & ABOM != 0 && !self.network.shorted {
                self.schedule(RECOVERY_BITS, Step::Recover, context);
            }
            return;
        }
        if self.mcr & (INRQ | SLEEP) == 0 && self.msr & INAK != 0 {
            if !self.network.shorted {
                self.schedule(QUIET_BITS, Step::Join, context);
            }
            return;
        }
        // The lowest identifier has priority (32.7.1).
        let next = (0..3)
            .filter(|place| self.mailboxes[*place].waits)
            .min_by_key(|place| self.mailboxes[*place].identifier >> 21);
        if let Some(place) = next.filter(|_| self.takes_part()) {
            let bits = if self.network.shorted { 1 } else { frame_bits(&self.frame(place, 0)) };
            self.schedule(bits, Step::Sent(place), context);
        }
    }

    fn frame(&self, place: usize, at_ns: u64) -> Frame {
        let mailbox = &self.mailboxes[place];
        let mut bytes = [0; 8];
        bytes[..4].copy_from_slice(&mailbox.data[0].to_le_bytes());
        bytes[4..].copy_from_slice(&mailbox.data[1].to_le_bytes());
        Frame {
            at_ns,
            identifier: (mailbox.identifier >> 21 & 0x7ff) as u16,
            length: (mailbox.length & 0xf).min(8) as u8,
            bytes,
        }
    }

    /// Ends a transmission attempt.
    fn sent(&mut self, place: usize, at_ns: u64) {
        let frame = self.frame(place, at_ns);
        let good = self.network.node && !self.network.shorted;
        if good {
            self.network.received.push(frame);
            self.transmit_errors = self.transmit_errors.saturating_sub(1);
        } else {
            // A missing acknowledgement does not count for a passive node (ISO 11898-1, fault confinement, exception).
            let counts = self.network.shorted || self.transmit_errors < PASSIVE;
            self.transmit_errors += if counts { 8 } else { 0 };
            self.last_error = if self.network.shorted { LEC_BIT_DOMINANT } else { LEC_ACKNOWLEDGEMENT };
            self.off = self.transmit_errors >= OFF;
        }
        let mailbox = &mut self.mailboxes[place];
        if good || self.mcr & NART != 0 || mailbox.abort {
            mailbox.waits = false;
            mailbox.status = RQCP | if good { TXOK } else { TERR };
            mailbox.abort = false;
        }
    }

    fn tsr(&self) -> u32 {
        let of = |(place, mailbox): (usize, &Mailbox)| {
            mailbox.status << (8 * place) | u32::from(!mailbox.waits) << (26 + place)
        };
        self.mailboxes.iter().enumerate().map(of).sum()
    }

    fn esr(&self) -> u32 {
        let flags = u32::from(self.transmit_errors >= WARNED)
            | u32::from(self.transmit_errors >= PASSIVE) << 1
            | u32::from(self.off) << 2;
        self.transmit_errors.min(255) << 16 | self.last_error << 4 | flags
    }

    fn write_tsr(&mut self, value: u32) {
        let sending = self.event.map(|(_, step)| step);
        for place in 0..3 {
            let (bits, mailbox) = (value >> (8 * place), &mut self.mailboxes[place]);
            if bits & RQCP != 0 {
                mailbox.status = 0;
            }
            if bits & ABRQ != 0 && mailbox.waits {
                // A frame being sent is aborted at the end of its attempt (32.7.1).
                mailbox.abort = sending == Some(Step::Sent(place));
                if !mailbox.abort {
                    (mailbox.waits, mailbox.status) = (false, RQCP);
                }
            }
        }
    }

    fn write_mcr(&mut self, value: u32) {
        self.mcr = value;
        if value & SLEEP == 0 {
            self.msr &= !SLAK;
        }
        if value & INRQ != 0 && !matches!(self.event, Some((_, Step::Sent(_)))) {
            (self.msr, self.event) = (self.msr | INAK, None);
        }
    }

    fn write_mailbox(&mut self, register: Register, value: u32) {
        let row = register.index() - Register::Ti0r.index();
        let mailbox = &mut self.mailboxes[row / 4];
        match row % 4 {
            0 => {
                mailbox.identifier = value;
                if value & 1 != 0 {
                    (mailbox.waits, mailbox.status, mailbox.abort) = (true, 0, false);
                }
            }
            1 => mailbox.length = value,
            word => mailbox.data[word - 2] = value,
        }
    }
}

impl Device for AsCan {
    type Register = Register;

    fn read(&mut self, register: Register, _: &mut RegisterFile, _: &mut DeviceContext<'_>) -> Option<u64> {
        let can = &Wiring::of_can(self).can;
        match register {
            Register::Msr => Some(u64::from(can.msr)),
            Register::Tsr => Some(u64::from(can.tsr())),
            Register::Esr => Some(u64::from(can.esr())),
            _ => None,
        }
    }

    fn write(
        &mut self,
        register: Register,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let (value, wiring) = (value as u32, Wiring::of_can(self));
        let connected = wiring.can_is_connected();
        let can = &mut wiring.can;
        match register {
            Register::Mcr => can.write_mcr(value),
            Register::Btr if can.msr & INAK != 0 => can.btr = value,
            Register::Btr => context.tell("BTR", "written outside of initialisation"),
            Register::Tsr => can.write_tsr(value),
            Register::Fmr => (),
            Register::Fa1r | Register::Ier => {
                if value != 0 {
                    context.tell(register.spec().name, "filters and interrupts are not modelled");
                }
            }
            _ if (Register::Ti0r.index()..Register::Ri0r.index()).contains(&register.index()) => {
                if !connected {
                    context.tell("TIxR", "a frame is sent, but PB8 and PB9 are not CAN1's");
                }
                can.write_mailbox(register, value);
            }
            _ => context.tell(register.spec().name, "not modelled"),
        }
        // The hardware clears TXRQ; the register file would keep it.
        registers.set(Register::Ti0r, u64::from(can.mailboxes[0].identifier & !1));
        can.go_on(context);
    }

    fn on_event(&mut self, event: EventId, _: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let can = &mut Wiring::of_can(self).can;
        let Some((_, step)) = can.event.filter(|(id, _)| *id == event) else { return };
        can.event = None;
        match step {
            Step::Join => can.msr &= !INAK,
            Step::Sent(place) => can.sent(place, context.now().0),
            Step::Recover => (can.off, can.transmit_errors) = (false, 0),
        }
        can.go_on(context);
    }
}

/// Length of a data frame with stuff bits, from its start to the end of the interframe space \[bits\] (ISO 11898-1).
pub fn frame_bits(frame: &Frame) -> u64 {
    let mut bits = vec![false];
    let mut push = |value: u64, count: u32| bits.extend((0..count).rev().map(|bit| value >> bit & 1 == 1));
    push(u64::from(frame.identifier), 11);
    // Remote request, extended, reserved: all dominant.
    push(0, 3);
    push(u64::from(frame.length), 4);
    frame.bytes[..usize::from(frame.length)].iter().for_each(|byte| push(u64::from(*byte), 8));
    let check = crc15(&bits);
    bits.extend((0..15).rev().map(|bit| check >> bit & 1 == 1));
    let (mut stuffed, mut run, mut last) = (0_u64, 0, None);
    for bit in bits {
        run = if last == Some(bit) { run + 1 } else { 1 };
        (last, stuffed) = (Some(bit), stuffed + 1);
        if run == 5 {
            (last, run, stuffed) = (Some(!bit), 1, stuffed + 1);
        }
    }
    // Delimiters and acknowledgement, end of frame, space.
    stuffed + 3 + 7 + 3
}

fn crc15(bits: &[bool]) -> u16 {
    bits.iter().fold(0, |crc: u16, bit| {
        let next = (crc >> 14 & 1 == 1) != *bit;
        let shifted = crc << 1 & 0x7fff;
        if next { shifted ^ 0x4599 } else { shifted }
    })
}
