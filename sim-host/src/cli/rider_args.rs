//! The options that select the rider.

use super::Failure;
use super::outputs::complain_once;
use crate::range::time;
use crate::rider::{Fit, MAX_DELAY_S, Outside, Rider, RiderTable, catalogue};

#[derive(clap::Args)]
pub(super) struct RiderArgs {
    /// Rider: a built-in one (see `rider list`), a table FILE, or none [default: none, a rigid rider, hands off]
    #[arg(long, value_name = "NAME|FILE")]
    rider: Option<String>,
    /// Fit of the rider's gains over speed [default: mean]
    #[arg(long, requires = "rider")]
    gains: Option<Fit>,
    /// The rider's neural delay, 0 to 1 s, for example 60ms [default: the table's own]
    #[arg(long, value_name = "TIME", requires = "rider", value_parser = delay, allow_hyphen_values = true)]
    delay: Option<f64>,
    /// The rider's gains beyond the measured speeds [default: extrapolate]
    #[arg(long, requires = "rider")]
    gains_outside: Option<Outside>,
}

fn delay(text: &str) -> Result<f64, String> {
    Ok(time(text, MAX_DELAY_S)?)
}

impl RiderArgs {
    /// The rider's name or file; `None` without a rider.
    pub(super) fn name(&self) -> Option<&str> {
        self.rider.as_deref().filter(|name| *name != "none")
    }

    /// The requested rider, with its table and fit.
    pub(super) fn load(&self) -> Result<Option<(Rider, RiderTable, Fit)>, Failure> {
        let Some(name) = self.name() else { return Ok(None) };
        let (fit, outside) = (self.gains.unwrap_or_default(), self.gains_outside.unwrap_or_default());
        let table = catalogue::load(name)?;
        let rider = table
            .rider(fit, outside, self.delay)
            .map_err(|e| format!("rider `{name}`, gains {}: {e}", fit.name()))?;
        Ok(Some((rider, table, fit)))
    }
}

/// An integration step that divides `delay_s`, `period_s` if possible. With the firmware it must be the control period;
/// otherwise a shorter step is chosen, with a note on standard error.
pub(super) fn step(delay_s: f64, period_s: f64, firmware: bool) -> Result<f64, String> {
    let ms = |s: f64| format!("{} ms", (s * 1e9).round() / 1e6);
    let periods = delay_s / period_s;
    if (periods - periods.round()).abs() < 1e-6 {
        return Ok(period_s);
    }
    if firmware {
        return Err(format!(
            "--delay: {} is not a whole number of control periods of {}; nearest are {} and {} \
             (without --assist firmware any delay will do)",
            ms(delay_s),
            ms(period_s),
            ms(periods.floor() * period_s),
            ms(periods.ceil() * period_s)
        ));
    }
    let step = delay_s / periods.ceil();
    if step < 1e-5 {
        return Err(format!("--delay: {} is less than the shortest step, 0.01 ms", ms(delay_s)));
    }
    complain_once(&format!(
        "note: step {} so that the delay of {} is {} steps",
        ms(step),
        ms(delay_s),
        periods.ceil()
    ));
    Ok(step)
}
