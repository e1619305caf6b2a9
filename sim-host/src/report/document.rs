//! The JSON documents of rides, basins and eigenvalues: the contract for scripts (`docs/cli.md`, `docs/schema/`).

use super::resolved::{ResolvedConfig, ResolvedSearch};
use super::tool::{SCHEMA, Tool};
use crate::basin::{Basin, Drawn, QUANTILES, ScanPoint, Work};
use crate::eigen::StabilityChange;
use crate::ride::{Effort, FallCause, FinalState, Ride, Start};
use crate::rider::Drawing;
use crate::scenario::Scenario;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Reasons for which a ride can count as fallen, by the names of [`FallCause`], or none.
pub(super) const FALLS: [Option<&str>; 6] =
    [Some("roll"), Some("steer"), Some("laid-flat"), Some("too-quick"), Some("no-motion"), None];

/// `bicycle check`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the symbols of the paper")]
pub struct CheckDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The bicycle.
    pub bicycle: super::resolved::ResolvedBicycle,
    /// Mass matrix of `[roll, steer]` \[kg m^2\].
    pub M: [[f64; 2]; 2],
    /// Damping per unit speed \[kg m\].
    pub C1: [[f64; 2]; 2],
    /// Stiffness per unit gravity \[kg m\].
    pub K0: [[f64; 2]; 2],
    /// Stiffness per unit speed squared \[kg\].
    pub K2: [[f64; 2]; 2],
    /// Speed at which the weave pair forms \[m/s\].
    pub v_d: Option<f64>,
    /// Weave speed \[m/s\].
    pub v_w: Option<f64>,
    /// Capsize speed \[m/s\].
    pub v_c: Option<f64>,
    /// Ranges of speed in which the straight ride is stable, from rest to 20 m/s \[m/s\].
    pub stable_ranges: Vec<[f64; 2]>,
    /// The ends of these ranges, without the ends of the search.
    pub stability_changes: Vec<StabilityChange>,
    /// Parts of the firmware configuration (`--preset product`) that are off on this bicycle, with the reason.
    pub flashed_off: Vec<String>,
}

/// `eigen`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct EigenDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The bicycle.
    pub bicycle: super::resolved::ResolvedBicycle,
    /// The rider; null for a rigid rider, hands off.
    pub rider: Option<super::resolved::ResolvedRider>,
    /// Doubts about the combination of rider and bicycle.
    pub warnings: Vec<String>,
    /// The law.
    pub law: super::resolved::ResolvedLaw,
    /// The added capsize term; null without one.
    pub capsize: Option<super::resolved::ResolvedCapsize>,
    /// The actuator between law and steer axis; null for an ideal one.
    pub actuator: Option<crate::eigen::LinearActuator>,
    /// Speed at which the first complex pair forms \[m/s\]; not computed with a rider.
    pub v_d: Option<f64>,
    /// Weave speed \[m/s\].
    pub v_w: Option<f64>,
    /// Capsize speed \[m/s\].
    pub v_c: Option<f64>,
    /// Ranges of speed in which the straight ride is stable, from rest to 20 m/s \[m/s\].
    pub stable_ranges: Vec<[f64; 2]>,
    /// The ends of these ranges, without the ends of the search.
    pub stability_changes: Vec<StabilityChange>,
    /// Speeds \[m/s\].
    pub speeds: Vec<f64>,
    /// Per speed the eigenvalues `[re, im]` \[1/s\], largest real part first: four without a rider, else the requested
    /// number of rightmost ones, plus one to complete a pair.
    pub eigenvalues: Vec<Vec<[f64; 2]>>,
    /// Modes by name: per speed their one or two eigenvalues `[re, im]` \[1/s\], followed by continuity; omitted where
    /// left of all computed ones.
    pub modes: BTreeMap<String, Vec<Vec<[f64; 2]>>>,
}

/// `ride`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RideDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The scenario that gives this result again: see `--scenario`.
    pub scenario: Scenario,
    /// The conditions.
    pub config: ResolvedConfig,
    /// The initial state.
    pub start: Start,
    /// "fallen", "recovered" or "undecided".
    #[schemars(extend("enum" = ["fallen", "recovered", "undecided"]))]
    pub outcome: &'static str,
    /// Time of the fall \[s\]; null if the ride did not fall.
    pub time_to_fall_s: Option<f64>,
    /// Reason for which it counts as fallen (`config.fall`); null if it did not fall.
    #[schemars(extend("enum" = FALLS))]
    pub fall: Option<&'static str>,
    /// Whether there was no disturbance: an upright ride then stays upright, stable or not.
    pub undisturbed: bool,
    /// The state at the end.
    #[serde(rename = "final")]
    pub end: FinalState,
    /// Torques and work of motor and rider, largest angles.
    pub effort: Effort,
}

impl RideDocument {
    /// The document of a ride.
    pub fn new(config: ResolvedConfig, scenario: Scenario, ride: &Ride) -> Self {
        Self {
            schema: SCHEMA,
            tool: Tool::this(),
            scenario,
            config,
            start: ride.start,
            outcome: ride.outcome.name(),
            time_to_fall_s: ride.outcome.time_to_fall_s(),
            fall: ride.outcome.fall().map(FallCause::name),
            undisturbed: ride.undisturbed(),
            end: ride.end,
            effort: ride.effort,
        }
    }
}

/// Upper and lower border of the interval around zero, per speed \[rad/s\]; null if not computed.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Height {
    /// Border to the right.
    pub upper: Vec<Option<f64>>,
    /// Border to the left: the mirror image.
    pub lower: Vec<Option<f64>>,
}

/// A range of disturbances outside the basin from which a ride does not fall either; it has a mirror image.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct IslandEntry {
    /// Speed \[m/s\].
    pub speed: f64,
    /// Smallest disturbance \[rad/s\].
    pub from: f64,
    /// Largest disturbance \[rad/s\].
    pub to: f64,
}

/// The ride at the border at one speed.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Border {
    /// Speed \[m/s\].
    pub speed: f64,
    /// "recovered" or "undecided".
    #[schemars(extend("enum" = ["recovered", "undecided"]))]
    pub outcome: &'static str,
    /// Torques and work of motor and rider, largest angles.
    pub effort: Effort,
    /// Reason for which the nearest ride beyond the border counts as fallen; null if nothing fell.
    #[schemars(extend("enum" = FALLS))]
    pub fall: Option<&'static str>,
}

/// All rides of the scan, per speed and rate.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Map {
    /// Disturbances \[rad/s\].
    pub rates: Vec<f64>,
    /// "fallen", "recovered" or "undecided" per speed and rate; an empty list if not computed.
    pub outcome: Vec<Vec<&'static str>>,
    /// Time to fall per speed and rate \[s\]; null for a ride that did not fall.
    pub time_to_fall_s: Vec<Vec<Option<f64>>>,
    /// Reason of the fall per speed and rate; null for a ride that did not fall.
    pub fall: Vec<Vec<Option<&'static str>>>,
}

/// The basins of drawn bicycles or riders.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct UncertainEntry {
    /// Draws whose basin is complete.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// The quantiles reported here: 5 %, 50 % and 95 %.
    pub quantiles: [f64; 3],
    /// These quantiles of the height per speed \[rad/s\].
    pub upper: Vec<[f64; 3]>,
    /// These quantiles of the area \[rad m/s^2\]; null at a single speed.
    pub area: Option<[f64; 3]>,
    /// These quantiles of the mean height \[rad/s\].
    pub mean_height: [f64; 3],
    /// Number of draws with a height that is a lower bound.
    pub capped: usize,
    /// The height per draw and speed \[rad/s\].
    pub heights: Vec<Vec<f64>>,
}

impl UncertainEntry {
    /// The entry of drawn basins.
    pub fn new(drawn: &Drawn) -> Self {
        let heights = |basin: &Basin| basin.columns.iter().map(|c| c.upper).collect();
        let one_has_area = drawn.basins.iter().any(|basin| basin.enclosed_area().is_some());
        Self {
            draws: drawn.basins.len(),
            seed: drawn.seed,
            quantiles: QUANTILES,
            upper: drawn.heights(),
            area: one_has_area.then(|| drawn.quantiles(Basin::area)),
            mean_height: drawn.quantiles(|basin| basin.mean_height().unwrap_or(0.0)),
            capped: drawn.capped(),
            heights: drawn.basins.iter().map(heights).collect(),
        }
    }
}

/// The basins of drawn riders.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RiderDrawsEntry {
    /// What the gains are drawn from: each set from the normal distribution of its covariance ("posterior"), or sets of each
    /// group with replacement ("bootstrap").
    pub drawn_from: Drawing,
    /// Per speed, the number of drawn riders whose straight ride is unstable by the linear model. They are part of all
    /// quantiles.
    pub unstable: Vec<usize>,
    /// The basins.
    #[serde(flatten)]
    pub basins: UncertainEntry,
}

/// `basin`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct BasinDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The scenario that gives this result again: see `--scenario`.
    pub scenario: Scenario,
    /// The conditions.
    pub config: ResolvedConfig,
    /// The search.
    pub search: ResolvedSearch,
    /// False after an interruption: some heights and all measures are then null, or there are fewer draws than requested.
    pub complete: bool,
    /// Forward speeds \[m/s\].
    pub speeds: Vec<f64>,
    /// Upper and lower border.
    pub height: Height,
    /// Whether nothing fell up to `search.max_rate`, per speed; null if not computed.
    pub capped: Vec<Option<bool>>,
    /// Islands beyond the border.
    pub islands: Vec<IslandEntry>,
    /// Area between zero and `upper`, trapezoidal rule \[rad m/s^2\]; null at a single speed.
    pub area: Option<f64>,
    /// Mean of `upper` \[rad/s\].
    pub mean_height: Option<f64>,
    /// Whether area and mean are lower bounds because a height is one.
    pub area_capped: bool,
    /// The basins of bicycles drawn from the uncertainties of the parameters; null if not requested.
    pub uncertain: Option<UncertainEntry>,
    /// The basins of riders drawn from what is known of the gains; null if not requested.
    pub rider_draws: Option<RiderDrawsEntry>,
    /// The rides at the border.
    pub border: Vec<Border>,
    /// All rides of the scan.
    pub map: Map,
    /// Amount of computation.
    pub work: Work,
    /// Computing time \[s\].
    pub seconds: f64,
}

impl BasinDocument {
    /// The document of a basin over `speeds`, some of which can be missing.
    pub fn new(
        (config, search, scenario): (ResolvedConfig, ResolvedSearch, Scenario),
        speeds: &[f64],
        basin: &Basin,
        seconds: f64,
    ) -> Self {
        let complete = basin.columns.len() == speeds.len();
        let column = |v: &f64| basin.columns.iter().find(|c| c.speed == *v);
        let columns: Vec<_> = speeds.iter().map(column).collect();
        let upper: Vec<Option<f64>> = columns.iter().map(|c| c.map(|c| c.upper)).collect();
        let islands = basin
            .columns
            .iter()
            .flat_map(|c| c.islands.iter().map(|i| IslandEntry { speed: c.speed, from: i.from, to: i.to }))
            .collect();
        let border = basin
            .columns
            .iter()
            .filter_map(|c| {
                c.border.map(|ride| Border {
                    speed: c.speed,
                    outcome: ride.outcome.name(),
                    effort: ride.effort,
                    fall: c.beyond.map(FallCause::name),
                })
            })
            .collect();
        let scans: Vec<&[ScanPoint]> = columns.iter().map(|c| c.map_or(&[][..], |c| &c.scan)).collect();
        Self {
            schema: SCHEMA,
            tool: Tool::this(),
            scenario,
            config,
            search,
            complete,
            speeds: speeds.to_vec(),
            // A zero has no sign, so its mirror image is 0 and not -0.
            height: Height { lower: upper.iter().map(|u| u.map(|u| 0.0 - u)).collect(), upper },
            capped: columns.iter().map(|c| c.map(|c| c.capped)).collect(),
            islands,
            area: basin.enclosed_area().filter(|_| complete),
            mean_height: basin.mean_height().filter(|_| complete),
            area_capped: basin.capped(),
            uncertain: None,
            rider_draws: None,
            border,
            map: Map {
                rates: basin.columns.first().map_or(Vec::new(), |c| c.scan.iter().map(|p| p.rate).collect()),
                outcome: scans.iter().map(|s| s.iter().map(|p| p.outcome.name()).collect()).collect(),
                time_to_fall_s: scans
                    .iter()
                    .map(|s| s.iter().map(|p| p.outcome.time_to_fall_s()).collect())
                    .collect(),
                fall: scans
                    .iter()
                    .map(|s| s.iter().map(|p| p.outcome.fall().map(FallCause::name)).collect())
                    .collect(),
            },
            work: basin.work(),
            seconds,
        }
    }
}
