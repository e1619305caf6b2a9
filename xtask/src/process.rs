//! Runs other programs with a time limit.

use crate::Result;
use std::fmt::Display;
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::{Duration, Instant};

/// How a program ended.
#[derive(Debug)]
pub struct Outcome {
    /// Its exit status; `None` when a signal ended it.
    pub status: Option<i32>,
    /// Its output on standard output.
    pub stdout: String,
    /// Its output on standard error.
    pub stderr: String,
}

/// Runs a program and captures its output.
///
/// # Errors
/// It cannot be started, or exceeded the limit and was killed.
pub fn capture(command: &mut Command, limit: Duration) -> Result<Outcome> {
    let mut child = start(command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()))?;
    let (out, err) = (child.stdout.take().map(drain), child.stderr.take().map(drain));
    let ended = wait(&mut child, limit);
    let [stdout, stderr] = [out, err].map(|reader| reader.map_or_else(String::new, text));
    match ended {
        Ok(status) => Ok(Outcome { status, stdout, stderr }),
        Err(error) => Err(format!("{command:?}: {error}\n{stdout}{stderr}")),
    }
}

/// Runs a program that writes to the terminal itself; any failure is an error.
///
/// # Errors
/// It cannot be started, exceeded the limit and was killed, or failed.
pub fn must(command: &mut Command, limit: Duration) -> Result<()> {
    let mut child = start(command.stdin(Stdio::null()))?;
    let outcome = wait(&mut child, limit);
    ended(command, outcome)
}

/// Processor time of all ended child processes \[s\]; `None` where the system has no `/proc`.
pub(crate) fn processor_s() -> Option<f64> {
    // Linux counts in hundredths of a second for every program.
    const TICKS_PER_S: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The program's name, in brackets, can contain spaces. Fields 16 and 17 are user and system time of children.
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(13);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / TICKS_PER_S)
}

/// Success, or an error with the exit status.
pub(crate) fn ended(
    command: &Command,
    outcome: std::result::Result<Option<i32>, impl Display>,
) -> Result<()> {
    match outcome {
        Ok(Some(0)) => Ok(()),
        Ok(status) => {
            Err(format!("{command:?} failed ({})", status.map_or("signal".into(), |s| s.to_string())))
        }
        Err(error) => Err(format!("{command:?}: {error}")),
    }
}

pub(crate) fn start(command: &mut Command) -> Result<Child> {
    command.spawn().map_err(|e| format!("can't start {:?}: {e}", command.get_program()))
}

fn wait(child: &mut Child, limit: Duration) -> Result<Option<i32>> {
    let start = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Ok(status.code()),
            Ok(None) if start.elapsed() < limit => sleep(Duration::from_millis(10)),
            unfinished => {
                // It may have ended meanwhile.
                let _ = child.kill();
                let _ = child.wait();
                return Err(unfinished.err().map_or(format!("killed after {limit:?}"), |e| e.to_string()));
            }
        }
    }
}

fn drain(mut pipe: impl Read + Send + 'static) -> JoinHandle<Vec<u8>> {
    spawn(move || {
        let mut bytes = Vec::new();
        // After an error, the bytes read so far are the output.
        let _ = pipe.read_to_end(&mut bytes);
        bytes
    })
}

fn text(reader: JoinHandle<Vec<u8>>) -> String {
    String::from_utf8_lossy(&reader.join().unwrap_or_default()).into_owned()
}
