//! A fake board behind a pseudo terminal, for programs that open it as a serial port.

use crate::board::{Shared, lock};
use serialport::{SerialPort, TTYPort};
use std::io::{ErrorKind, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{JoinHandle, spawn};
use std::time::Duration;

/// A board at a pseudo terminal, as long as this lives.
pub struct Port {
    /// The device's name.
    pub name: String,
    gone: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    /// Kept, so that the terminal stays when a program closes it.
    _device: TTYPort,
}

impl Port {
    /// Answers as `board` does. After every look at the line, some thousandths of a second apart, `also` says what else
    /// goes out, or with `None` that the board is pulled out.
    pub fn new(board: &Shared, mut also: impl FnMut(&Shared) -> Option<Vec<u8>> + Send + 'static) -> Self {
        let (mut end, device) = TTYPort::pair().expect("a pseudo terminal");
        end.set_timeout(Duration::from_millis(4)).expect("a timeout");
        let (gone, board) = (Arc::new(AtomicBool::new(false)), board.clone());
        let name = device.name().expect("a name");
        let thread = spawn({
            let gone = gone.clone();
            move || {
                let mut bytes = [0; 4096];
                while !gone.load(Ordering::SeqCst) {
                    let length = match end.read(&mut bytes) {
                        Ok(length) => length,
                        Err(error) if error.kind() == ErrorKind::TimedOut => 0,
                        Err(error) => panic!("{error}"),
                    };
                    let mut out = lock(&board).take(&bytes[..length]);
                    let Some(mut more) = also(&board) else { return };
                    out.append(&mut more);
                    end.write_all(&out).expect("the terminal takes it");
                }
            }
        });
        Self { name, gone, thread: Some(thread), _device: device }
    }

    /// One that only answers.
    pub fn quiet(board: &Shared) -> Self {
        Self::new(board, |_| Some(Vec::new()))
    }
}

impl Drop for Port {
    fn drop(&mut self) {
        self.gone.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
