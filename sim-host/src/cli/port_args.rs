//! The options that say where a board is.

use super::Failure;
use crate::board::demo_board::DemoBoard;
use crate::board::qemu::default_image;
use crate::board::serial::Serial;
use crate::board::virtual_board::{VirtualBoard, default_program};
use crate::board::{BoardName, Client, Patience, Transport};
use clap::ArgGroup;
use std::path::PathBuf;

/// One board must be named.
pub(super) fn board() -> ArgGroup {
    ArgGroup::new("board").required(true).args(["port", "qemu", "virtual_board"])
}

/// Options of all commands that speak with a board.
#[derive(clap::Args)]
pub(super) struct PortArgs {
    /// Serial port of the board, as /dev/ttyACM0
    #[arg(long, value_name = "DEVICE")]
    port: Option<String>,
    /// The board's image in QEMU, on a bicycle that rolls upright at 4 m/s [default IMAGE: where `cargo xtask firmware` builds it]
    #[arg(long, value_name = "IMAGE", require_equals = true)]
    qemu: Option<Option<PathBuf>>,
    /// The image that is flashed, on the virtual board [default IMAGE: where `cargo xtask firmware` builds it]
    #[arg(long, value_name = "IMAGE", require_equals = true)]
    virtual_board: Option<Option<PathBuf>>,
    /// Baud rate of the serial port; means nothing over USB
    #[arg(long, default_value_t = 115_200, value_name = "BAUD", value_parser = clap::value_parser!(u32).range(300..=4_000_000))]
    baud: u32,
}

impl PortArgs {
    /// Opens the line; none if no board is named.
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

    /// The board and who it is, asked first: it tells whether both speak the same version.
    pub(super) fn connect(&self) -> Result<(Client, BoardName), Failure> {
        let line = self.open()?.ok_or("no board is named; see --port, --qemu and --virtual-board")?;
        let mut client = Client::new(line, Patience::default());
        let board = client.hello()?;
        Ok((client, board))
    }
}
