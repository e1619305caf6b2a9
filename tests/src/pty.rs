//! Pseudo terminals: a board behind one, for programs that open it as a serial port, and programs on one.

use crate::link_board::{Shared, lock};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, Winsize, tcgetattr, tcsetattr, tcsetwinsize};
use std::fs::File;
use std::io::{Read, Write};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{JoinHandle, spawn};

/// Polling period of the line while it is idle: 4 ms.
const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 4_000_000 };

/// A board at a pseudo terminal, while this value exists.
pub struct Port {
    /// The device's name.
    pub name: String,
    unplugged: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    /// Open, so that the terminal stays when a program closes it.
    _device: File,
}

impl Port {
    /// Answers like `board`. After every poll of the line `also` gives further bytes to send, or `None` if the board
    /// is unplugged.
    pub fn new(board: &Shared, mut also: impl FnMut(&Shared) -> Option<Vec<u8>> + Send + 'static) -> Self {
        let (mut end, name, device) = open().expect("a pseudo terminal");
        let (unplugged, board) = (Arc::new(AtomicBool::new(false)), board.clone());
        let thread = spawn({
            let unplugged = unplugged.clone();
            move || {
                let mut bytes = [0; 4096];
                while !unplugged.load(Ordering::SeqCst) {
                    let _ = poll(&mut [PollFd::new(&end, PollFlags::IN)], Some(&LOOK));
                    let length = end.read(&mut bytes).unwrap_or(0);
                    let mut out = lock(&board).take(&bytes[..length]);
                    let Some(mut more) = also(&board) else { return };
                    out.append(&mut more);
                    // Without a listener it is lost, as on a wire.
                    let _ = end.write(&out);
                }
            }
        });
        Self { name, unplugged, thread: Some(thread), _device: device }
    }

    /// One that only answers.
    pub fn quiet(board: &Shared) -> Self {
        Self::new(board, |_| Some(Vec::new()))
    }
}

/// Exit code of a program, and all that it writes to a terminal with this number of rows and columns.
///
/// # Panics
/// If there is no pseudo terminal, or the program can't be started.
pub fn on_terminal(command: &mut Command, (rows, columns): (u16, u16)) -> (Option<i32>, String) {
    let (mut end, _, device) = open().expect("a pseudo terminal");
    rustix::io::ioctl_fionbio(&end, false).expect("can block");
    let size = Winsize { ws_row: rows, ws_col: columns, ws_xpixel: 0, ws_ypixel: 0 };
    tcsetwinsize(&end, size).expect("has a size");
    let second = device.try_clone().expect("another handle");
    let mut child = command.stdout(device).stderr(second).spawn().expect("the program starts");
    // Only the program's own handles stay open: the end of the program is the end of the text.
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let mut text = Vec::new();
    let _ = end.read_to_end(&mut text);
    let code = child.wait().expect("the program ends").code();
    (code, String::from_utf8_lossy(&text).into_owned())
}

/// The board's end, which does not block, and the raw device with its name. No other program inherits them, or the
/// device would not hang up.
fn open() -> std::io::Result<(File, String, File)> {
    let end = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
    grantpt(&end)?;
    unlockpt(&end)?;
    rustix::io::ioctl_fionbio(&end, true)?;
    let name = ptsname(&end, Vec::new())?.to_string_lossy().into_owned();
    let device = File::options().read(true).write(true).open(&name)?;
    let mut raw = tcgetattr(&device)?;
    raw.make_raw();
    tcsetattr(&device, OptionalActions::Now, &raw)?;
    Ok((end.into(), name, device))
}

impl Drop for Port {
    fn drop(&mut self) {
        self.unplugged.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
