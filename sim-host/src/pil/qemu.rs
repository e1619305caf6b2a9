//! A board in QEMU, in lockstep over its standard input and output.

use super::watchdog::{Watchdog, locked};
use super::{BoardError, Lockstep};
use link::lockstep::{BOARD_HEAD, FromBoard, MAX_CHUNK, ToBoard};
use std::cell::Cell;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::Duration;

/// Timeout of an exchange, a thousand times its usual duration.
pub const LIMIT: Duration = Duration::from_secs(10);
/// Longest time from the end of the emulator's output to its exit \[ms\].
const GRACE_MS: u32 = 10_000;
/// Number of bytes kept of the end of the board's text output.
const OUTPUT_BYTES_MAX: usize = 1 << 14;

/// Default path of the loop's image, as built by `cargo xtask firmware`.
pub fn default_image() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = manifest.parent().unwrap_or(manifest);
    root.join("target/firmware/thumbv7em-none-eabihf/firmware/qemu-pil")
}

/// A running image in QEMU; dropping the value ends it.
#[derive(Debug)]
pub struct Qemu {
    image: PathBuf,
    child: Arc<Mutex<Child>>,
    /// `None` once closed.
    to: Option<ChildStdin>,
    from: ChildStdout,
    watchdog: Watchdog,
    words: Arc<Mutex<Vec<u8>>>,
    listener: Option<JoinHandle<()>>,
    exchanges: u64,
    room: [u8; MAX_CHUNK],
    /// Bytes of the chunk in `room`.
    used: usize,
}

impl Qemu {
    /// Starts an image with `words` as arguments and waits for its first chunk; `limit` is the timeout of every
    /// exchange.
    ///
    /// # Errors
    /// No image, no QEMU, or no first chunk.
    pub fn start(image: &Path, words: &[&str], limit: Duration) -> Result<Self, BoardError> {
        if !image.is_file() {
            return Err(BoardError::NoImage(image.into()));
        }
        stay_on_one_core();
        let mut child = command(image, words).spawn().map_err(BoardError::NoQemu)?;
        let (to, from, err) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let child = Arc::new(Mutex::new(child));
        let (Some(to), Some(from), Some(err)) = (to, from, err) else {
            return Err(BoardError::NoQemu(std::io::ErrorKind::BrokenPipe.into()));
        };
        let output = Arc::new(Mutex::new(Vec::new()));
        let listener = listen(err, Arc::clone(&output));
        let mut qemu = Self {
            image: image.into(),
            watchdog: Watchdog::new(Arc::clone(&child), limit),
            child,
            to: Some(to),
            from,
            words: output,
            listener: Some(listener),
            exchanges: 0,
            room: [0; MAX_CHUNK],
            used: 0,
        };
        qemu.watchdog.begin(1);
        qemu.take()?;
        qemu.watchdog.end();
        Ok(qemu)
    }

    /// The end of the board's text output so far.
    pub fn output(&self) -> String {
        String::from_utf8_lossy(&locked(&self.words)).trim_end().into()
    }

    /// Receives the next chunk.
    fn take(&mut self) -> Result<(), BoardError> {
        self.used = 0;
        let mut whole = BOARD_HEAD;
        while self.used < whole {
            match self.from.read(&mut self.room[self.used..]) {
                Ok(0) | Err(_) => return Err(self.ended()),
                Ok(got) => self.used += got,
            }
            if self.used >= BOARD_HEAD {
                let length = |at: usize| usize::from(u16::from_le_bytes([self.room[at], self.room[at + 1]]));
                whole = BOARD_HEAD + length(BOARD_HEAD - 4) + length(BOARD_HEAD - 2);
            }
            if whole > MAX_CHUNK || self.used > whole {
                let begin = &self.room[..self.used.min(BOARD_HEAD)];
                return Err(BoardError::NoChunk(format!("{} bytes beginning {begin:02x?}", self.used)));
            }
        }
        Ok(())
    }

    /// Exit status of the emulator, which is killed if it does not exit by itself.
    fn last_status(&mut self) -> String {
        let mut child = locked(&self.child);
        for _ in 0..GRACE_MS {
            match child.try_wait() {
                Ok(Some(status)) => return status.to_string(),
                Ok(None) => sleep(Duration::from_millis(1)),
                Err(error) => return error.to_string(),
            }
        }
        // It may have ended just now.
        let _ = child.kill();
        child.wait().map_or_else(|error| error.to_string(), |_| "its output ended before it did".into())
    }

    /// Closes the input, on which the image exits; returns the exit status and the end of its text output.
    pub fn close(&mut self) -> (String, String) {
        self.to = None;
        let status = self.last_status();
        // The text is complete when the listener has ended.
        let _ = self.listener.take().map(JoinHandle::join);
        (status, self.output())
    }

    /// The error of an ended emulator.
    fn ended(&mut self) -> BoardError {
        let (status, output) = self.close();
        let output = match output {
            output if output.is_empty() => output,
            output => format!("; its output:\n{output}"),
        };
        let (image, exchanges) = (self.image.clone(), self.exchanges);
        match self.watchdog.ended() {
            true => BoardError::Silent { image, limit: self.watchdog.limit, exchanges, output },
            false => BoardError::Ended { image, status, exchanges, output },
        }
    }
}

impl Lockstep for Qemu {
    fn last(&self) -> FromBoard<'_> {
        // A chunk with consistent lengths always decodes.
        let none = FromBoard { time_ms: 0, starts: 0, motor: &[], line: &[] };
        FromBoard::decode(&self.room[..self.used]).unwrap_or(none)
    }

    fn exchange(&mut self, chunk: &ToBoard<'_>) -> Result<(), BoardError> {
        let mut room = [0; MAX_CHUNK];
        let too_much = || BoardError::TooMuch(chunk.sensors.len(), chunk.line.len());
        let used = chunk.encode(&mut room).ok_or_else(too_much)?;
        self.watchdog.begin(self.exchanges + 2);
        let sent = self.to.as_mut().is_some_and(|to| to.write_all(&room[..used]).is_ok());
        if !sent {
            return Err(self.ended());
        }
        self.take()?;
        self.watchdog.end();
        self.exchanges += 1;
        Ok(())
    }
}

impl Drop for Qemu {
    fn drop(&mut self) {
        let mut child = locked(&self.child);
        // It may have ended already.
        let _ = child.kill();
        let _ = child.wait();
    }
}

/// Pins this thread, and the QEMU that it starts next, to one core; different threads to different cores if possible.
///
/// Host and board take turns, so one core is enough. On two, each would wait for the other core to wake up, which takes
/// longer than a control step. If the system does not allow pinning, nothing changes.
fn stay_on_one_core() {
    static NEXT: AtomicUsize = AtomicUsize::new(0);
    thread_local!(static PINNED: Cell<bool> = const { Cell::new(false) });
    if PINNED.replace(true) {
        return;
    }
    let cores = core_affinity::get_core_ids().unwrap_or_default();
    if let Some(core) = cores.get(NEXT.fetch_add(1, Ordering::Relaxed) % cores.len().max(1)) {
        core_affinity::set_for_current(*core);
    }
}

fn command(image: &Path, words: &[&str]) -> Command {
    let name = image.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let words = words.iter().fold(format!(",arg={name}"), |line, word| format!("{line},arg={word}"));
    let mut qemu = Command::new("qemu-system-arm");
    qemu.args(["-machine", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "none"]);
    // An instruction takes 16 ns of simulated time, 2.7 clocks of the chip; sleeping takes no host time.
    qemu.args(["-icount", "shift=4,sleep=off"]);
    qemu.arg("-semihosting-config").arg(format!("enable=on,target=native{words}"));
    qemu.arg("-kernel").arg(image);
    qemu.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    // Ctrl-C must reach this program only, which may finish a ride first.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut qemu, 0);
    qemu
}

/// Stores the end of the board's text output.
fn listen(mut from: ChildStderr, to: Arc<Mutex<Vec<u8>>>) -> JoinHandle<()> {
    spawn(move || {
        let mut room = [0; 1024];
        while let Ok(got @ 1..) = from.read(&mut room) {
            let mut output = locked(&to);
            output.extend_from_slice(&room[..got]);
            let much = output.len().saturating_sub(OUTPUT_BYTES_MAX);
            output.drain(..much);
        }
    })
}
