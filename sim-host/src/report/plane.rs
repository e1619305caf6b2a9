//! Document and table of `basin plane`.

use super::document::FALLS;
use super::resolved::ResolvedConfig;
use super::tool::{SCHEMA, Tool};
use crate::basin::{Plane, PlaneSearch, ScanPoint, Work};
use crate::ride::FallCause;
use schemars::JsonSchema;
use serde::Serialize;

/// `basin plane`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct PlaneDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The conditions.
    pub config: ResolvedConfig,
    /// The search.
    pub search: PlaneSearch,
    /// False after an interruption: rays and the area are then missing.
    pub complete: bool,
    /// Area inside the outline \[rad^2/s^2\].
    pub area: Option<f64>,
    /// Whether the area is a lower bound because nothing fell up to the end of some ray.
    pub area_capped: bool,
    /// The closed border around the undisturbed ride: `[steer rate, roll rate]` \[rad/s\].
    pub outline: Vec<[f64; 2]>,
    /// The rays of one half; the other half is the mirror image.
    pub rays: Vec<RayEntry>,
    /// Amount of computation.
    pub work: Work,
    /// Computing time \[s\].
    pub seconds: f64,
}

/// One ray.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RayEntry {
    /// Steer rate at its end \[rad/s\].
    pub steer_rate: f64,
    /// Roll rate at its end \[rad/s\].
    pub roll_rate: f64,
    /// Border, as a fraction of the ray.
    pub upper: f64,
    /// Whether nothing fell up to its end.
    pub capped: bool,
    /// Reason for which the nearest ride beyond counts as fallen; null if nothing fell.
    #[schemars(extend("enum" = FALLS))]
    pub fall: Option<&'static str>,
    /// Islands: parts of the ray beyond the first fall from which a ride does not fall, `[from, to]`.
    pub islands: Vec<[f64; 2]>,
}

impl PlaneDocument {
    /// The document of a plane.
    pub fn new(config: ResolvedConfig, search: PlaneSearch, plane: &Plane, seconds: f64) -> Self {
        let complete = plane.rays.len() == search.rays;
        let entry = |ray: &crate::basin::Ray| RayEntry {
            steer_rate: ray.steer_rate,
            roll_rate: ray.roll_rate,
            upper: ray.column.upper,
            capped: ray.column.capped,
            fall: ray.column.beyond.map(FallCause::name),
            islands: ray.column.islands.iter().map(|i| [i.from, i.to]).collect(),
        };
        Self {
            schema: SCHEMA,
            tool: Tool::this(),
            config,
            search,
            complete,
            area: complete.then(|| plane.area()),
            area_capped: plane.capped(),
            outline: plane.outline().into_iter().map(|(steer, roll)| [steer, roll]).collect(),
            rays: plane.rays.iter().map(entry).collect(),
            work: plane.work(),
            seconds,
        }
    }
}

/// One line of the table: a ride of the scan, or the border of a ray.
#[derive(Clone, Debug, Serialize)]
pub struct PlaneRow {
    /// Disturbance of the steer rate.
    pub steer_rate_rad_s: f64,
    /// Disturbance of the roll rate.
    pub roll_rate_rad_s: f64,
    /// "fallen", "recovered", "undecided", or "border" for the outline.
    pub outcome: &'static str,
    /// Time to fall; empty if the ride did not fall.
    pub time_to_fall_s: Option<f64>,
    /// Reason of the fall, at the border that of the nearest ride beyond; empty without a fall.
    pub fall: Option<&'static str>,
    /// For a border: whether nothing fell up to the ray's end.
    pub capped: Option<bool>,
}

/// The scans and borders as rows, without mirror images.
pub fn plane_rows(plane: &Plane) -> Vec<PlaneRow> {
    let mut rows = Vec::new();
    for ray in &plane.rays {
        let row = |s: f64, outcome, time_to_fall_s, fall: Option<FallCause>| {
            let (steer_rate_rad_s, roll_rate_rad_s) = ray.at(s);
            let fall = fall.map(FallCause::name);
            PlaneRow { steer_rate_rad_s, roll_rate_rad_s, outcome, time_to_fall_s, fall, capped: None }
        };
        let border = row(ray.column.upper, "border", None, ray.column.beyond);
        rows.push(PlaneRow { capped: Some(ray.column.capped), ..border });
        let scan = ray.column.scan.iter();
        rows.extend(scan.map(|ScanPoint { rate, outcome }| {
            row(*rate, outcome.name(), outcome.time_to_fall_s(), outcome.fall())
        }));
    }
    rows
}
