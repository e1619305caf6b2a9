//! Options that select a bicycle.

use super::ended::Failure;
use crate::bicycle::catalogue::{self, Bicycle};

/// Selection of a bicycle.
#[derive(clap::Args)]
pub(super) struct BicycleArgs {
    /// Built-in bicycle, FILE, or FILE#NAME
    #[arg(long, default_value = "rigid_jason", value_name = "NAME|FILE")]
    bicycle: String,
    /// Changes one of the bicycle's parameters, SI units, for example lam=0.3; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    bicycle_set: Vec<String>,
}

impl BicycleArgs {
    /// The bicycle with the requested changes.
    ///
    /// # Errors
    /// The error with file, key or value.
    pub(super) fn load(&self) -> Result<Bicycle, Failure> {
        Ok(catalogue::load(&self.bicycle)?.varied(&self.bicycle_set)?)
    }
}
