//! Program `virtual-board`: a live board with its log and its serial line.

use clap::Parser;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use virtual_board::bench::STORE_BYTES;
use virtual_board::pty::Pty;
use virtual_board::wiring::Wiring;
use virtual_board::{Bench, Error, Options};

/// Simulated time between two polls of the serial line \[ms\].
const LOOK_MS: f64 = 2.0;

/// Timeout of the first log line \[ms after power-on\]: the board's images log their name within 5 ms.
const SILENT_MS: f64 = 2000.0;

/// Largest time at which the board answers on its serial line \[ms after power-on\]. On this machine that takes some
/// seconds, longer than the tools' timeout.
const LISTENS_MS: f64 = 400.0;

/// Time of the rider's press \[ms after power-on\]: the switch was open for long enough by then.
const SWITCH_MS: f64 = 2000.0;

/// A VESC 6 with the flashed image, executed at register level: its log here, its serial line at a pseudo terminal.
#[derive(Parser)]
#[command(
    version,
    after_help = "\
Examples:
  virtual-board                                   # the product image, until Ctrl-C
  virtual-board --align --switch --seconds 7      # align the encoder of the virtual motor
  virtual-board --store board.flash --seconds 3   # parameters preserved between runs
  sim-host monitor --port /dev/pts/5              # in another terminal, with the device that was printed

Exit status: 0 after the requested time or Ctrl-C; 1 where the program used something without a model,
or wrote no line of its log in the first 2 s; 2 for wrong options and images that can't be used."
)]
struct Arguments {
    /// The image [default: where `cargo xtask firmware` builds it]
    #[arg(long, value_name = "ELF")]
    image: Option<PathBuf>,
    /// Take the image that aligns the encoder instead of the product's
    #[arg(long, conflicts_with = "image")]
    align: bool,
    /// Simulated time to run [s]; without it until Ctrl-C
    #[arg(long, value_name = "TIME", value_parser = positive)]
    seconds: Option<f64>,
    /// The rider's switch is pressed 2 s after power-on, and held
    #[arg(long)]
    switch: bool,
    /// File with the flash of the parameters: read at the start where there is one, written at the end
    #[arg(long, value_name = "FILE")]
    store: Option<PathBuf>,
    /// Clock cycles that an instruction is taken to last
    #[arg(long, value_name = "CYCLES", default_value_t = Options::default().cycles_per_instruction, value_parser = cycles)]
    cycles_per_instruction: f64,
    /// The serial line is standard input and output, the log goes to standard error
    #[arg(long)]
    stdio: bool,
    /// A second node on the CAN bus acknowledges; what it takes is printed
    #[arg(long)]
    can: bool,
    /// As fast as possible, not in real time
    #[arg(long)]
    fast: bool,
}

fn positive(text: &str) -> Result<f64, String> {
    in_range(text, 1e-3, 1e5)
}

fn cycles(text: &str) -> Result<f64, String> {
    in_range(text, 1.0, 4.0)
}

fn in_range(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_string())?;
    if (least..=most).contains(&value) { Ok(value) } else { Err(format!("must be from {least} to {most}")) }
}

/// The serial line's other end.
enum Line {
    Pty(Box<Pty>),
    Stdio(Receiver<Vec<u8>>),
}

impl Line {
    /// Bytes for the board; `None` if nothing can be sent any more.
    fn read(&mut self) -> Option<Vec<u8>> {
        match self {
            Line::Pty(pty) => Some(pty.read()),
            Line::Stdio(bytes) => match bytes.try_recv() {
                Ok(bytes) => Some(bytes),
                Err(std::sync::mpsc::TryRecvError::Empty) => Some(Vec::new()),
                Err(std::sync::mpsc::TryRecvError::Disconnected) => None,
            },
        }
    }

    fn write(&mut self, bytes: &[u8]) {
        match self {
            Line::Pty(pty) => pty.write(bytes),
            Line::Stdio(_) => {
                let mut out = std::io::stdout().lock();
                // A closed output is detected at the end of the input.
                let _ = out.write_all(bytes).and_then(|()| out.flush());
            }
        }
    }
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("virtual-board: {error}");
            let program = matches!(error, Failure::Board(Error::Gap { .. } | Error::Endless { .. }));
            ExitCode::from(if program { 1 } else { 2 })
        }
    }
}

#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error(transparent)]
    Board(#[from] Error),
    #[error("{0}: {1}")]
    File(PathBuf, std::io::Error),
    #[error("{0}: {1} bytes, a flash of the parameters has {2}; the file was left as it is")]
    NoStore(PathBuf, usize, usize),
    #[error("no pseudo terminal: {0}")]
    Pty(std::io::Error),
    #[error("Ctrl-C can't be caught: {0}")]
    Interrupt(ctrlc::Error),
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let requested = Arc::clone(&stop);
    ctrlc::set_handler(move || requested.store(true, Ordering::Relaxed)).map_err(Failure::Interrupt)?;
    let store = arguments.store.as_deref().map(stored).transpose()?.flatten();
    let mut wiring = Wiring::new();
    wiring.can.network.node = arguments.can;
    let options = Options { cycles_per_instruction: arguments.cycles_per_instruction, ..Options::default() };
    let image = arguments.image.clone().unwrap_or_else(|| built(arguments.align));
    let mut bench = Bench::power_on_with_store(&image, options, wiring, store.as_deref())?;
    let mut line = if arguments.stdio {
        Line::Stdio(standard_input())
    } else {
        Line::Pty(Box::new(Pty::open().map_err(Failure::Pty)?))
    };
    let (begin, mut shown, mut listens) = (Instant::now(), 0, false);
    let end_ms = arguments.seconds.map_or(f64::INFINITY, |seconds| seconds * 1e3);
    let mut result = Ok(());
    while result.is_ok() && bench.now_ms() < end_ms && !stop.load(Ordering::Relaxed) {
        let Some(bytes) = line.read() else { break };
        bench.send(&bytes);
        let pressed = arguments.switch && bench.now_ms() >= SWITCH_MS;
        bench.with(move |board| board.chip.wiring.analog.switch_closed = pressed);
        result = bench.run_ms(LOOK_MS.min(end_ms - bench.now_ms()));
        line.write(&bench.received());
        for entry in &bench.log()[shown..] {
            eprintln!("{:10.3} ms {:5} {}", entry.at_us as f64 * 1e-3, entry.level, entry.text);
        }
        shown = bench.log().len();
        if let Line::Pty(pty) = &line
            && !std::mem::replace(&mut listens, bench.now_ms() >= LISTENS_MS)
            && listens
        {
            eprintln!("serial line at {}: sim-host monitor --port {}", pty.name, pty.name);
        }
        if result.is_ok() && shown == 0 && bench.now_ms() >= SILENT_MS {
            result = Err(bench.endless("line of the log"));
        }
        if arguments.can {
            show_can(&mut bench);
        }
        let ahead = Duration::from_secs_f64(bench.now_ms() * 1e-3).saturating_sub(begin.elapsed());
        if !arguments.fast {
            std::thread::sleep(ahead);
        }
    }
    if let Some(file) = &arguments.store {
        std::fs::write(file, bench.store()).map_err(|e| Failure::File(file.clone(), e))?;
    }
    Ok(result?)
}

/// Prints what the second node took.
fn show_can(bench: &mut Bench) {
    for frame in bench.with(|board| std::mem::take(&mut board.chip.wiring.can.network.received)) {
        let bytes: String =
            frame.bytes[..frame.length.into()].iter().map(|byte| format!("{byte:02X}")).collect();
        eprintln!("({:.6}) can0 {:03X}#{bytes}", frame.at_ns as f64 * 1e-9, frame.identifier);
    }
}

/// The flash of the parameters in a file, if there is one. A file that is none, or can't be written at the end, is
/// rejected before the run.
fn stored(file: &Path) -> Result<Option<Vec<u8>>, Failure> {
    let failed = |error| Failure::File(file.to_owned(), error);
    let store = match std::fs::read(file) {
        Ok(bytes) if bytes.len() == STORE_BYTES => Some(bytes),
        Ok(bytes) => return Err(Failure::NoStore(file.to_owned(), bytes.len(), STORE_BYTES)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
        Err(error) => return Err(failed(error)),
    };
    std::fs::OpenOptions::new().append(true).create(true).open(file).map_err(failed)?;
    if store.is_none() {
        // An erased flash, so that a run that fails leaves a file that the next one takes.
        std::fs::write(file, vec![0xff; STORE_BYTES]).map_err(failed)?;
    }
    Ok(store)
}

/// Where `cargo xtask firmware` leaves the board's images.
fn built(align: bool) -> PathBuf {
    let name = if align { "board-vesc6-align" } else { "board-vesc6" };
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../target/firmware/thumbv7em-none-eabihf/firmware")
        .join(name)
}

/// Standard input, read by a thread; its end closes the channel.
fn standard_input() -> Receiver<Vec<u8>> {
    let (send, bytes) = channel();
    std::thread::spawn(move || {
        let mut room = [0; 4096];
        while let Ok(length @ 1..) = std::io::stdin().read(&mut room) {
            if send.send(room[..length].to_vec()).is_err() {
                return;
            }
        }
    });
    bytes
}
