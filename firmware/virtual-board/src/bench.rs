//! Test bench for a virtual board: power-on, run for a time, inspect and change the board in between.
//!
//! The core runs in its own thread and stops at the requested instants; in between a test has exclusive access to the
//! board.

use crate::board::{CORE_HZ, Options, Vesc6};
use crate::core_state::program_counter;
use crate::flash::{Array, Pace};
use crate::gap::gap;
use crate::image::Functions;
use crate::inject::put_back;
use crate::log::{self, Log, Rtt};
use crate::wiring::Wiring;
use rigless::emulator::{self, AccessKind, Driver, Host, Settled, Start, Stop};
use rigless::image::Image;
use rigless::session::{Reset, Session};
use rigless::soc::Width;
use rigless::time::VirtualNanos;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Interval between fetches of the log and checks for unmodelled accesses \[ns\].
const LOOK_NS: u64 = 1_000_000;

/// Flash range of the parameters, which `memory.x` keeps free.
const STORE: std::ops::Range<u64> = 0x0800_4000..0x0801_0000;

/// Address of the watchdog's key register, and the key that restarts its count.
const WATCHDOG_FEED: (u64, u64) = (0x4000_3000, 0xaaaa);

/// Size of that range \[bytes\].
pub const STORE_BYTES: usize = (STORE.end - STORE.start) as usize;

/// Errors of a run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The image can't be read, or is invalid.
    #[error("{path}: {reason}")]
    Image {
        /// File name.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// The emulator did not start, or failed.
    #[error("the emulator: {0}")]
    Emulator(String),
    /// The program used a feature that is not modelled.
    #[error("at {at_ms:.3} ms: {what}")]
    Gap {
        /// Time of detection \[ms\].
        at_ms: f64,
        /// Description, with instruction and function if known.
        what: String,
    },
    /// An expected event did not occur.
    #[error("at {at_ms:.3} ms: still no {what}; {whereabouts}")]
    Endless {
        /// Time of the timeout \[ms\].
        at_ms: f64,
        /// Name of the event.
        what: String,
        /// Present instruction, and the last one that accessed a register, each with its function.
        whereabouts: String,
    },
    /// The emulator took longer for a step than [`Options::timeout`].
    #[error("at {at_ms:.3} ms: the emulator did not come back within {timeout:?}")]
    Stuck {
        /// Simulated time at the start of the step \[ms\].
        at_ms: f64,
        /// Timeout.
        timeout: Duration,
    },
}

type Work = Box<dyn FnOnce(&mut Session<Vesc6>, &mut dyn Host) + Send>;

enum Order {
    RunUntil(u64),
    Work(Work),
}

/// The bench's side of the thread.
struct Stepper {
    orders: Receiver<Order>,
    reached: Sender<Reached>,
}

/// State of the core.
#[derive(Clone, Copy)]
struct Reached {
    at_ns: u64,
    instructions: u64,
}

impl Driver<Vesc6> for Stepper {
    fn on_settled(&mut self, session: &mut Session<Vesc6>, host: &mut dyn Host, settled: Settled) {
        if let Settled::Access { access, .. } = settled
            && let Some(counter) = access.program_counter
        {
            session.board_mut().last_access = counter as u32;
            // The session itself keeps no instruction of these.
            let troubled = !session.refused().is_empty() || session.told().next().is_some();
            if troubled && session.board().troubled_by.is_none() {
                session.board_mut().troubled_by = Some(counter as u32);
            }
        }
        if let Settled::Access { access, .. } = settled
            && access.kind == AccessKind::Write
            && (access.address, access.value) == WATCHDOG_FEED
        {
            session.board_mut().watchdog_feeds.push(access.virtual_time.0);
        }
        if let Settled::Hit(hit) = settled {
            session.board_mut().hits.push((hit.at.0, hit.address as u32));
        }
        if matches!(settled, Settled::Stop(_)) && !session.board().damage.is_empty() {
            put_back(session, host);
        }
        if session.board().flash.concerns(&settled) {
            let board = session.board_mut();
            let mut flash = std::mem::replace(&mut board.flash, Array::new(Pace::Typical));
            flash.settled(session, host, settled);
            session.board_mut().flash = flash;
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<Vesc6>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        session.board_mut().chip.wiring.advance(stop.at.0);
        // If the bench was dropped, the run ends.
        let reached = Reached { at_ns: stop.at.0, instructions: stop.instruction_count };
        self.reached.send(reached).ok()?;
        loop {
            match self.orders.recv().ok()? {
                Order::RunUntil(at_ns) => return Some(VirtualNanos(at_ns)),
                Order::Work(work) => work(session, host),
            }
        }
    }
}

/// A powered board.
pub struct Bench {
    orders: Option<Sender<Order>>,
    reached: Receiver<Reached>,
    thread: Option<JoinHandle<Result<(), String>>>,
    now_ns: u64,
    instructions: u64,
    cycles_per_instruction: f64,
    log: Log,
    rtt: Rtt,
    functions: Functions,
    image: PathBuf,
    timeout: Duration,
}

impl Bench {
    /// Powers a board with this image in its flash.
    ///
    /// # Errors
    /// An image that can't be read, or is not for this chip.
    pub fn power_on(image: &Path, options: Options, wiring: Wiring) -> Result<Self, Error> {
        Self::power_on_with_store(image, options, wiring, None)
    }

    /// As [`Self::power_on`], with the parameter flash of an earlier board ([`Self::store`]).
    ///
    /// # Errors
    /// An image that can't be read, or is not for this chip.
    pub fn power_on_with_store(
        image: &Path,
        options: Options,
        wiring: Wiring,
        store: Option<&[u8]>,
    ) -> Result<Self, Error> {
        let wrong = |reason: String| Error::Image { path: image.to_owned(), reason };
        let bytes = std::fs::read(image).map_err(|e| wrong(e.to_string()))?;
        let functions = Functions::read(&bytes).map_err(wrong)?;
        let log = Log::new(&bytes).map_err(wrong)?;
        let rtt = Rtt::find(&bytes).map_err(wrong)?;
        let mut images = vec![Image::new(image, bytes, None).map_err(|e| wrong(e.to_string()))?];
        if let Some(store) = store {
            let kept = Image::new(Path::new("the store"), store.to_vec(), Some(STORE.start));
            images.push(kept.map_err(|e| wrong(e.to_string()))?);
        }
        let board = Vesc6::new(options, wiring).map_err(|e| Error::Emulator(e.to_string()))?;
        let session =
            Session::new(Box::new(board), 0, VirtualNanos(0)).map_err(|e| Error::Emulator(e.to_string()))?;
        let ((orders, to_do), (done, reached)) = (channel(), channel());
        let thread = std::thread::spawn(move || {
            let stepper = Stepper { orders: to_do, reached: done };
            emulator::run(session, &Start::new(&images), stepper).map(|_| ()).map_err(|e| e.to_string())
        });
        let mut bench = Self {
            orders: Some(orders),
            reached,
            thread: Some(thread),
            now_ns: 0,
            instructions: 0,
            cycles_per_instruction: options.cycles_per_instruction,
            log,
            rtt,
            functions,
            image: image.to_owned(),
            timeout: options.timeout,
        };
        bench.wait()?;
        Ok(bench)
    }

    /// Runs the board for a time \[ms\].
    ///
    /// # Errors
    /// [`Error::Gap`] if the program uses a feature that is not modelled.
    pub fn run_ms(&mut self, ms: f64) -> Result<(), Error> {
        self.run_until_ns(self.now_ns + (ms * 1e6).round() as u64)
    }

    /// Runs the board until a time after power-on \[ns\].
    ///
    /// # Errors
    /// As of [`Self::run_ms`].
    pub fn run_until_ns(&mut self, end_ns: u64) -> Result<(), Error> {
        while self.now_ns < end_ns {
            let look_ns = (self.now_ns / LOOK_NS + 1) * LOOK_NS;
            self.order(Order::RunUntil(look_ns.min(end_ns)));
            self.wait()?;
            if self.now_ns >= look_ns {
                self.look()?;
            }
        }
        Ok(())
    }

    /// Runs the board until a condition, checked each millisecond, is true; `what` names it in the error.
    ///
    /// # Errors
    /// [`Error::Endless`] after `limit_ms`, and as of [`Self::run_ms`].
    pub fn run_until(
        &mut self,
        limit_ms: f64,
        what: &str,
        mut so: impl FnMut(&mut Self) -> bool,
    ) -> Result<(), Error> {
        let end_ms = self.now_ms() + limit_ms;
        while !so(self) {
            if self.now_ms() >= end_ms {
                return Err(self.endless(what));
            }
            self.run_ms(1.0)?;
        }
        Ok(())
    }

    /// Address of the only function of this name.
    ///
    /// # Errors
    /// [`Error::Image`] where none or several have it.
    pub fn function(&self, name: &str) -> Result<u32, Error> {
        self.functions.start(name).map_err(|reason| Error::Image { path: self.image.clone(), reason })
    }

    /// Error for an event that did not occur.
    pub fn endless(&mut self, what: &str) -> Error {
        let (last, saved) =
            self.with_session(|session, host| (session.board().last_access, host.save_state().ok()));
        let next = saved.and_then(|saved| program_counter(&saved)).unwrap_or(0);
        let [next, last] = [next, last].map(|counter| self.place(counter));
        let whereabouts = format!("the program is {next}, the last access to a register was {last}");
        Error::Endless { at_ms: self.now_ms(), what: what.into(), whereabouts }
    }

    fn place(&self, counter: u32) -> String {
        match (counter, self.functions.at(counter).unwrap_or("no function")) {
            (0, _) => "nowhere".into(),
            (_, function) => format!("at the instruction {counter:#010x} in {function}"),
        }
    }

    /// Time since power-on \[ns\].
    pub fn now_ns(&self) -> u64 {
        self.now_ns
    }

    /// Time since power-on \[ms\].
    pub fn now_ms(&self) -> f64 {
        self.now_ns as f64 * 1e-6
    }

    /// Time since power-on in which the core did not wait for an interrupt \[ms\].
    pub fn busy_ms(&self) -> f64 {
        self.instructions as f64 * self.cycles_per_instruction / CORE_HZ as f64 * 1e3
    }

    /// Log lines so far, each with its time \[ms\].
    pub fn log(&self) -> &[log::Line] {
        self.log.lines()
    }

    /// Accesses the board while it is stopped between two instructions.
    pub fn with<T: Send + 'static>(&mut self, work: impl FnOnce(&mut Vesc6) -> T + Send + 'static) -> T {
        self.with_session(|session, _| work(session.board_mut()))
    }

    /// Sends bytes on the serial line from now on.
    pub fn send(&mut self, bytes: &[u8]) {
        let (bytes, now_ns) = (bytes.to_vec(), self.now_ns);
        self.with(move |board| board.computer().send(&bytes, now_ns));
    }

    /// Bytes sent by the board since the last call.
    pub fn received(&mut self) -> Vec<u8> {
        self.with(|board| board.computer().take())
    }

    /// Resets so far.
    pub fn resets(&mut self) -> Vec<Reset> {
        self.with_session(|session, _| session.resets().to_vec())
    }

    /// Accesses the session and the core's memory.
    pub fn with_session<T: Send + 'static>(
        &mut self,
        work: impl FnOnce(&mut Session<Vesc6>, &mut dyn Host) -> T + Send + 'static,
    ) -> T {
        let (send, answer) = channel();
        self.order(Order::Work(Box::new(move |session, host| {
            // The receiver waits below.
            let _ = send.send(work(session, host));
        })));
        answer.recv().expect("the emulator's thread runs while the bench lives")
    }

    fn order(&self, order: Order) {
        if let Some(orders) = &self.orders {
            // A terminated thread is detected by the next wait.
            let _ = orders.send(order);
        }
    }

    fn wait(&mut self) -> Result<(), Error> {
        match self.reached.recv_timeout(self.timeout) {
            Ok(Reached { at_ns, instructions }) => {
                (self.now_ns, self.instructions) = (at_ns, instructions);
                Ok(())
            }
            Err(RecvTimeoutError::Timeout) => {
                // The thread is abandoned: nothing can stop it.
                self.thread = None;
                Err(Error::Stuck { at_ms: self.now_ms(), timeout: self.timeout })
            }
            Err(RecvTimeoutError::Disconnected) => Err(Error::Emulator(self.end())),
        }
    }

    /// Reason for the thread's end.
    fn end(&mut self) -> String {
        let ended = self.thread.take().map(JoinHandle::join);
        match ended {
            Some(Ok(Err(reason))) => reason,
            Some(Ok(Ok(()))) | None => "the run ended".into(),
            Some(Err(_)) => "the emulator's thread panicked".into(),
        }
    }

    /// Fetches the log, and checks for unmodelled accesses.
    fn look(&mut self) -> Result<(), Error> {
        let rtt = self.rtt;
        let (bytes, gap) = self.with_session(move |session, host| (rtt.drain(host), gap(session)));
        self.log.push(&bytes, self.now_ns as f64 * 1e-6);
        let Some((what, counter)) = gap else { return Ok(()) };
        let by = counter.map_or_else(String::new, |counter| format!(", {}", self.place(counter)));
        Err(Error::Gap { at_ms: self.now_ms(), what: format!("{what}{by}") })
    }

    /// Content of the parameter flash: sectors 1 to 3.
    pub fn store(&mut self) -> Vec<u8> {
        self.with_session(|_, host| {
            let words = STORE.step_by(4).map(|at| host.read(at, Width::W32).unwrap_or(0) as u32);
            words.flat_map(u32::to_le_bytes).collect()
        })
    }

    /// A word of memory.
    pub fn word(&mut self, address: u32) -> Option<u32> {
        self.with_session(move |_, host| {
            host.read(u64::from(address), Width::W32).ok().map(|word| word as u32)
        })
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.orders = None;
        if let Some(thread) = self.thread.take() {
            // The call that met the error has returned it.
            let _ = thread.join();
        }
    }
}
