//! What the commands need of a scenario.

use crate::bicycle::Parameters;
use crate::bicycle::uncertain::Measured;
use crate::report::resolved::{ResolvedConfig, ResolvedLaw};
use crate::ride::{Assist, Conditions, OwnLaw};
use crate::scenario::{AssistKind, Content, LoadedRider, Resolved, Scenario, ScenarioError};

/// A loaded and checked scenario.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The conditions of its rides.
    pub conditions: Conditions,
    /// The same for an output.
    pub config: ResolvedConfig,
    /// Parameters of the bicycle.
    pub parameters: Parameters,
    /// The uncertainties of these, if they are known.
    pub measured: Option<Measured>,
    /// The rider; `None` for a rigid one.
    pub rider: Option<LoadedRider>,
    /// The scenario that reproduces the result.
    pub scenario: Scenario,
    /// Choices that were made to suit bicycle and delay, as text.
    pub notes: Vec<String>,
}

impl Setup {
    /// Loads and checks all conditions of a scenario.
    ///
    /// # Errors
    /// States the key or file, the value and its range.
    pub fn new(scenario: &Scenario) -> Result<Self, ScenarioError> {
        let resolved = scenario.resolve()?;
        let config = ResolvedConfig::new(&resolved);
        let Resolved { conditions, bicycle, rider, scenario, notes, .. } = resolved;
        let (parameters, measured) = (bicycle.parameters, bicycle.measured);
        Ok(Self { conditions, config, parameters, measured, rider, scenario, notes })
    }

    /// The same for a scenario without a law, steered by a function called `name`: the ideal assist with this law. The
    /// scenario of the result names the law, but can't be run again without the function.
    ///
    /// # Errors
    /// As [`Self::new`]; the scenario has a law, or a part that acts on the flashed code only.
    pub fn steered_by(scenario: &Scenario, name: &str, law: OwnLaw) -> Result<Self, ScenarioError> {
        if scenario.law.is_some() {
            return Err(ScenarioError::value("law", "is given in addition to a function"));
        }
        let alone = Scenario { law: Some("none".into()), assist: AssistKind::Ideal, ..scenario.clone() };
        let mut setup = Self::new(&alone)?;
        setup.conditions.assist = Assist::Own(law);
        setup.conditions.check()?;
        setup.config.law = ResolvedLaw { name: name.into(), points: None };
        setup.config.assist = "ideal";
        setup.scenario.law = Some(Content::Named(name.into()));
        Ok(setup)
    }

    /// Doubts about bicycle, rider and files, and faults without effect, as text: those about the bicycle with its name.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        let bicycle = &self.config.bicycle;
        let of_bicycle = bicycle.warnings.iter().map(|doubt| format!("{}: {doubt}", bicycle.name));
        of_bicycle.chain(self.config.warnings.iter().cloned())
    }
}
