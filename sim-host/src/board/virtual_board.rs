//! The firmware image on the virtual board: a separate program whose standard input and output are the serial line.

use super::transport::{Transport, TransportError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::spawn;
use std::time::Duration;

/// Longest real time from the start to the first byte of the board, which starts within 0.3 s of its own time: some
/// seconds, more on a busy machine. A program that ends (or whose emulator hangs, which ends it) is detected at once.
const START: Duration = Duration::from_secs(600);

/// Default path of the program that `cargo xtask virtual-board` builds.
pub fn default_program() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().unwrap_or(manifest).join("target/virtual-board/virtual-board")
}

/// The serial line of a virtual board; dropping the value ends the program.
pub struct VirtualBoard {
    name: String,
    child: Child,
    to: Option<ChildStdin>,
    from: Receiver<Vec<u8>>,
    /// The first bytes, received during the start.
    first: Vec<u8>,
    /// The program's standard error: its log, at the end the reason why it ended.
    words: Receiver<Vec<u8>>,
}

impl VirtualBoard {
    /// Starts the program with the default or the given image, and waits for the first byte of the board.
    ///
    /// # Errors
    /// The program does not exist, or ends before the board has started; then with the reason it printed.
    pub fn start(program: &Path, image: Option<&Path>) -> Result<Self, TransportError> {
        let name = format!("{} (cargo xtask virtual-board --build makes it)", program.display());
        let failed = |error: io::Error| TransportError::Open { line: name.clone(), error };
        let mut command = Command::new(program);
        command.arg("--stdio").args(image.iter().flat_map(|image| [Path::new("--image"), image]));
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // Ctrl-C must reach this program only.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().map_err(failed)?;
        let to = child.stdin.take();
        let from = listen(child.stdout.take());
        let words = listen(child.stderr.take());
        let mut board =
            Self { name: program.display().to_string(), child, to, from, first: Vec::new(), words };
        match board.from.recv_timeout(START) {
            Ok(bytes) => board.first = bytes,
            Err(_) => {
                let last = board.last_words();
                return Err(failed(io::Error::other(format!("the board did not start: {last}"))));
            }
        }
        Ok(board)
    }

    /// The program has ended or does not read: the error with the reason that it printed.
    fn lost(&self, error: io::ErrorKind) -> TransportError {
        TransportError::Lost { line: self.name.clone(), error: io::Error::new(error, self.last_words()) }
    }

    /// The last line that the program wrote to standard error. Waits a moment for it, since the two streams of a
    /// program that ends close in any order.
    fn last_words(&self) -> String {
        let mut output = Vec::new();
        while let Ok(bytes) = self.words.recv_timeout(Duration::from_millis(200)) {
            output.extend(bytes);
        }
        String::from_utf8_lossy(&output).lines().last().unwrap_or("no output").to_owned()
    }
}

impl Transport for VirtualBoard {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        let sent = self.to.as_mut().map(|to| to.write_all(bytes).and_then(|()| to.flush()));
        match sent {
            Some(Ok(())) => Ok(()),
            _ => Err(self.lost(io::ErrorKind::BrokenPipe)),
        }
    }

    fn receive(&mut self, timeout: Duration) -> Result<Vec<u8>, TransportError> {
        if !self.first.is_empty() {
            return Ok(std::mem::take(&mut self.first));
        }
        match self.from.recv_timeout(timeout) {
            Ok(bytes) => Ok(bytes),
            Err(RecvTimeoutError::Timeout) => Ok(Vec::new()),
            Err(RecvTimeoutError::Disconnected) => Err(self.lost(io::ErrorKind::UnexpectedEof)),
        }
    }
}

impl Drop for VirtualBoard {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The program's output, read by a thread so that the program never blocks; the channel closes with the program.
fn listen(from: Option<impl Read + Send + 'static>) -> Receiver<Vec<u8>> {
    let (send, bytes) = channel();
    spawn(move || {
        let Some(mut from) = from else { return };
        let mut room = [0; 4096];
        while let Ok(length @ 1..) = from.read(&mut room) {
            if send.send(room[..length].to_vec()).is_err() {
                return;
            }
        }
    });
    bytes
}
