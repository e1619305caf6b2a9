//! Options of a board in the loop and its link.

use super::ended::Failure;
use crate::commands::Setup;
use crate::pil::qemu::{LIMIT, Qemu, default_image};
use crate::pil::{BoardError, Controller, LinkFault};
use crate::ride::Assist;
use std::path::PathBuf;

/// The board and its link.
#[derive(clap::Args)]
pub(super) struct BoardArgs {
    /// The board's image [default: where `cargo xtask firmware` builds it]
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Inject a fault into the link, for example sensors:late=3ms@1s..2s or motor:drop@1s; may be repeated
    #[arg(long, value_name = "DIRECTION:FAULT@FROM..TO", conflicts_with = "compare")]
    inject: Vec<String>,
    /// Compute the same on the host, and fail at the first differing bit
    #[arg(long)]
    pub(super) compare: bool,
}

impl BoardArgs {
    /// A function that starts a board with its controller for rides under these conditions, which are checked.
    pub(super) fn starter(
        &self,
        setup: &Setup,
    ) -> Result<impl Fn() -> Result<Controller<Qemu>, BoardError> + use<>, Failure> {
        let conditions = &setup.conditions;
        let Assist::Firmware(plan) = &conditions.assist else {
            return Err(
                "a board in the loop needs a controller: --assist firmware and a --law but none".into()
            );
        };
        let rate_hz = plan.config().rate_hz;
        if rate_hz != 1000.0 || conditions.step_s != 1e-3 {
            return Err(BoardError::Rate(rate_hz).into());
        }
        let faults: Result<Vec<LinkFault>, _> = self.inject.iter().map(|text| text.parse()).collect();
        let faults = faults.map_err(|error| format!("--inject {error}"))?;
        let image = self.image.clone().unwrap_or_else(default_image);
        let seed = conditions.plant.seed;
        Ok(move || Ok(Controller::new(Qemu::start(&image, &[], LIMIT)?, &faults, seed)))
    }
}
