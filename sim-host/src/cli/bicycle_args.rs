//! Options that select a bicycle.

use super::ended::Failure;
use super::options::{Bicycle as BicycleOptions, Options};
use crate::bicycle::catalogue::Bicycle;

/// Selection of a bicycle.
#[derive(clap::Args)]
pub(super) struct BicycleArgs {
    #[command(flatten)]
    options: Options<BicycleOptions>,
}

impl BicycleArgs {
    /// The bicycle with the requested changes.
    ///
    /// # Errors
    /// The error with file, key or value.
    pub(super) fn load(&self) -> Result<Bicycle, Failure> {
        self.options.bicycle()
    }
}
