//! The options that select the board and its line.

use super::Failure;
use crate::board::serial::Serial;
use crate::board::virtual_board::{VirtualBoard, default_program};
use crate::board::{BoardName, Client, RetryPolicy, Transport};
use crate::pil::demo_board::DemoBoard;
use crate::pil::qemu::default_image;
use clap::ArgGroup;
use std::path::PathBuf;

/// Group of the options of which one must name a board.
pub(super) fn board() -> ArgGroup {
    ArgGroup::new("board").required(true).args(["port", "qemu", "virtual_board"])
}

/// Options of all commands that connect to a board.
#[derive(clap::Args)]
pub(super) struct PortArgs {
    /// Serial port of the board, for example /dev/ttyACM0
    #[arg(long, value_name = "DEVICE")]
    port: Option<String>,
    /// The board's image in QEMU, on a bicycle that rolls upright at 4 m/s [default IMAGE: where `cargo xtask firmware` builds it]
    #[arg(long, value_name = "IMAGE", require_equals = true)]
    qemu: Option<Option<PathBuf>>,
    /// The flashed image on the virtual board [default IMAGE: where `cargo xtask firmware` builds it]
    #[arg(long, value_name = "IMAGE", require_equals = true)]
    virtual_board: Option<Option<PathBuf>>,
    /// Baud rate of the serial port of --port; no effect over USB
    #[arg(long, default_value_t = 115_200, value_name = "BAUD", conflicts_with_all = ["qemu", "virtual_board"], value_parser = clap::value_parser!(u32).range(300..=4_000_000))]
    baud: u32,
}

impl PortArgs {
    /// Opens the line; `None` if no board is named.
    pub(super) fn open(&self) -> Result<Option<Box<dyn Transport>>, Failure> {
        match (&self.port, &self.qemu, &self.virtual_board) {
            (Some(port), ..) => Ok(Some(Box::new(Serial::open(port, self.baud)?))),
            (_, Some(image), _) => {
                Ok(Some(Box::new(DemoBoard::start(image.as_ref().unwrap_or(&default_image()))?)))
            }
            (.., Some(image)) => {
                Ok(Some(Box::new(VirtualBoard::start(&default_program(), image.as_deref())?)))
            }
            (None, None, None) => Ok(None),
        }
    }

    /// Connects to the board and requests its identity, which also checks the version of the link.
    pub(super) fn connect(&self) -> Result<(Client, BoardName), Failure> {
        let line = self.open()?.ok_or("no board is named; see --port, --qemu and --virtual-board")?;
        let mut client = Client::new(line, RetryPolicy::default());
        let board = client.hello()?;
        Ok((client, board))
    }
}
