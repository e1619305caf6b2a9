//! From a scenario to the conditions of its rides: loads and checks everything that it names.

use super::content::{Content, NONE, OrNone};
use super::error::ScenarioError;
use super::rider::LoadedRider;
use super::setting::DRAWS;
use super::speeds::{FASTEST_M_S, SpeedsError};
use super::ticks::{LONGEST_S, whole_ticks};
use super::{AssistKind, Preset, Scenario, cut_files, idle, law, parameter_file::ParameterFile, repeats};
use crate::bicycle::Geometry;
use crate::bicycle::catalogue::{self, Bicycle};
use crate::bicycle::onboard::fit;
use crate::parameters::{self, Rejected};
use crate::plant::Plant;
use crate::range::within;
use crate::ride::{Assist, Conditions, IdealLaw, ScheduleSpeed};
use crate::rider::compatibility_warnings;
use control::param::ParamError;
use control::{Config, Law, Limits, Taper, Wheel};
use std::path::Path;

/// What a scenario means.
#[derive(Clone, Debug)]
pub struct Resolved {
    /// The conditions of its rides.
    pub conditions: Conditions,
    /// The bicycle, with its changed parameters.
    pub bicycle: Bicycle,
    /// The rider; `None` for a rigid one.
    pub rider: Option<LoadedRider>,
    /// The law.
    pub law: Law,
    /// Its name, or the file as given.
    pub law_name: String,
    /// Doubts about rider and files, and faults without effect, as text; doubts about the bicycle are in the bicycle.
    pub warnings: Vec<String>,
    /// Choices that were made to suit bicycle and delay, as text.
    pub notes: Vec<String>,
    /// The same scenario with the contents of files in the places of their names: it can be run elsewhere.
    pub scenario: Scenario,
}

/// Beginning of the names of the firmware's parameters that the ideal law has, too.
const IDEAL_PARAMETERS: &str = "dead_band.";

/// Key of the option that sets a parameter of the control crate.
fn key_of(error: &ParamError) -> Option<&'static str> {
    match (error.leaf.group, error.leaf.name) {
        ("limits", "max_torque_nm") => Some("torque_limit_nm"),
        ("limits", "rise_nm_s" | "fall_nm_s") => Some("rate_limit_nm_s"),
        ("limits.taper", _) => Some("taper_m_s"),
        _ => None,
    }
}

impl Scenario {
    /// Loads and checks everything that the scenario names.
    ///
    /// # Errors
    /// States the key or file, the value and its range.
    pub fn resolve(&self) -> Result<Resolved, ScenarioError> {
        self.check_uses()?;
        let given = self.load_bicycle()?;
        let bicycle =
            given.clone().varied(&self.bicycle_set).map_err(|e| ScenarioError::value("bicycle_set", e))?;
        let rider = self.rider.load()?;
        let file = self.load_parameters()?;
        let (law_name, law) = self.load_law(file.as_ref(), rider.is_some())?;
        let mut config = self.config(&law, file.as_ref())?;
        self.set_parameters(&mut config)?;
        let period_s = 1.0 / f64::from(config.rate_hz);
        let flashed = law != Law::None && self.assist == AssistKind::Firmware;
        let mut notes = Vec::new();
        let step_s = match &rider {
            Some(one) => step(one.rider.delay_s, period_s, flashed, &mut notes)?,
            None => period_s,
        };
        let plant = self.plant.resolve(step_s)?;
        if flashed {
            let off = fit(&mut config, &Geometry::new(&bicycle.parameters), plant.sensors.imu.point_m);
            notes.extend(off.iter().map(|reason| format!("{}: for the flashed code {reason}", given.name)));
            self.set_parameters(&mut config)?;
        }
        let mut warnings =
            rider.as_ref().map_or(Vec::new(), |one| compatibility_warnings(&bicycle, &one.table));
        warnings.extend(cut_files::warnings(self.files()));
        if flashed {
            warnings.extend(repeats::warnings(&config, &plant.sensors));
        }
        if flashed && config.track.is_some() && !config.input.path.fitted {
            notes.push("track is on without a path: it gives no torque (--set input.path.fitted=on)".into());
        }
        let schedule_speed = self.scheduled_by(&config, flashed);
        let limited = config.limits != Limits::default();
        let assist = self.assist(&law, config, limited, &given.name)?;
        let sensor_delay_ticks = whole_ticks(self.sensor_delay_s, step_s, LONGEST_S)
            .map_err(|e| ScenarioError::value("sensor_delay_s", e))?;
        let conditions = self.conditions(&bicycle, assist, rider.as_ref(), (step_s, plant));
        let conditions = Conditions { schedule_speed, sensor_delay_ticks, ..conditions };
        conditions.check()?;
        warnings.extend(idle::warnings(&self.plant, &conditions));
        let own_law = self.law.as_ref().map(|_| law::content(&law_name, &law));
        let scenario = self.complete(given, rider.as_ref(), own_law, file)?;
        Ok(Resolved { conditions, bicycle, rider, law, law_name, warnings, notes, scenario })
    }

    /// Checks the start, the searches and the draws.
    fn check_uses(&self) -> Result<(), ScenarioError> {
        if let Some(start) = &self.start {
            let given = |key: &str, value: f64, most: f64| {
                within(key, value, -most, most).map_err(|e| ScenarioError::value(&format!("start.{key}"), e))
            };
            if start.speed_m_s.is_nan() && !self.options.contains("start.speed_m_s") {
                return Err(ScenarioError::value(
                    "start.speed_m_s",
                    SpeedsError::Missing { least_m_s: -FASTEST_M_S },
                ));
            }
            given("speed_m_s", start.speed_m_s, FASTEST_M_S)?;
            given("steer_rate_rad_s", start.steer_rate_rad_s, 100.0)?;
            given("roll_rate_rad_s", start.roll_rate_rad_s, 100.0)?;
        }
        self.search.resolve(self.is_ridden())?;
        if let Some(plane) = &self.plane {
            if plane.speed.is_nan() {
                return Err(ScenarioError::value("plane.speed", SpeedsError::Missing { least_m_s: 0.0 }));
            }
            plane.check().map_err(|e| ScenarioError::value("plane", e))?;
        }
        for (key, draws) in [("uncertain", self.uncertain), ("rider_draws", self.rider_draws)] {
            let (least, most) = (f64::from(*DRAWS.start()), f64::from(*DRAWS.end()));
            draws
                .map_or(Ok(()), |count| within("draws", f64::from(count), least, most))
                .map_err(|e| ScenarioError::value(key, e))?;
        }
        match self.rider_draws {
            Some(_) if self.uncertain.is_some() => Err(ScenarioError::value(
                "rider_draws",
                "bicycles are drawn already (uncertain); one band at a time",
            )),
            Some(_) if !self.is_ridden() => Err(ScenarioError::value("rider_draws", "there is no rider")),
            _ => Ok(()),
        }
    }

    /// The bicycle, with its changed parameters.
    ///
    /// # Errors
    /// States file or key, value and range.
    pub fn bicycle(&self) -> Result<Bicycle, ScenarioError> {
        self.load_bicycle()?.varied(&self.bicycle_set).map_err(|e| ScenarioError::value("bicycle_set", e))
    }

    /// Whether there is a rider.
    pub fn is_ridden(&self) -> bool {
        self.rider.is_some()
    }

    /// The bicycle, without the changes of `bicycle_set`.
    ///
    /// # Errors
    /// It can't be loaded.
    pub fn load_bicycle(&self) -> Result<Bicycle, ScenarioError> {
        match &self.bicycle {
            Content::Named(name) => Ok(catalogue::load(name)?),
            Content::Given(bicycle) => {
                (**bicycle).clone().checked().map_err(|e| ScenarioError::value("bicycle", e))
            }
        }
    }

    fn load_parameters(&self) -> Result<Option<ParameterFile>, ScenarioError> {
        let file = match &self.parameter_file {
            None => return Ok(None),
            Some(Content::Given(file)) => (**file).clone(),
            Some(Content::Named(name)) => ParameterFile::read(Path::new(name))?,
        };
        Ok(Some(file))
    }

    /// The law and its name.
    fn load_law(&self, file: Option<&ParameterFile>, ridden: bool) -> Result<(String, Law), ScenarioError> {
        if let (None, Some(law)) = (&self.law, file.and_then(|file| file.law.clone())) {
            return Ok((law.to_string(), law));
        }
        let default = match (self.preset, ridden) {
            (Preset::Product, _) => "h-cut",
            (Preset::Thesis, true) => NONE,
            (Preset::Thesis, false) => "h",
        };
        Ok(law::resolve(self.law.as_ref().unwrap_or(&default.into()))?)
    }

    /// The controller's configuration before it is fitted to the bicycle.
    fn config(&self, law: &Law, file: Option<&ParameterFile>) -> Result<Config, ScenarioError> {
        let base = match self.preset {
            Preset::Thesis => Config::thesis(Law::H { cut: false }),
            Preset::Product => Config::product(),
        };
        let mut config = Config { law: law.clone(), ..base };
        config.input = config.input.scheduled_by(match self.schedule_speed {
            ScheduleSpeed::Front | ScheduleSpeed::Initial => Wheel::Front,
            ScheduleSpeed::Rear => Wheel::Rear,
        });
        if let Some(file) = file {
            file.apply(&mut config)?;
        }
        // The simulated bicycle is assembled correctly.
        config.calibration.polarity_checked = true;
        if let Some(limit) = self.torque_limit_nm {
            config.limits.max_torque_nm = limit.value().map(|x| x as f32);
            if limit == OrNone::Off {
                // Both limits are relative to the torque limit.
                (config.limits.rider_torque, config.limits.limp_fraction) = (None, None);
            }
        }
        if let Some(limit) = self.rate_limit_nm_s {
            config.limits.rise_nm_s = limit.value().map(|x| x as f32);
            config.limits.fall_nm_s = config.limits.rise_nm_s;
        }
        if let Some(taper) = self.taper_m_s {
            let taper = taper.value();
            config.limits.taper =
                taper.map(|[zero, full]| Taper { zero_m_s: zero as f32, full_m_s: full as f32 });
        }
        Ok(config)
    }

    fn set_parameters(&self, config: &mut Config) -> Result<(), ScenarioError> {
        self.parameters.iter().try_for_each(|(key, value)| {
            parameters::set_value(config, key, value).map_err(|error| {
                let (key, value) = (key.clone(), value.clone());
                ScenarioError::value("parameters", Rejected { key, value, error })
            })
        })
    }

    /// Speed that schedules the gain: a single wheel sensor measures its own wheel's speed.
    fn scheduled_by(&self, config: &Config, flashed: bool) -> ScheduleSpeed {
        match (config.input.front_wheel.fitted, config.input.rear_wheel.fitted) {
            _ if !flashed || self.schedule_speed == ScheduleSpeed::Initial => self.schedule_speed,
            (true, false) => ScheduleSpeed::Front,
            (false, true) => ScheduleSpeed::Rear,
            _ => self.schedule_speed,
        }
    }

    fn assist(
        &self,
        law: &Law,
        config: Config,
        limited: bool,
        bicycle: &str,
    ) -> Result<Assist, ScenarioError> {
        let flashed = *law != Law::None && self.assist == AssistKind::Firmware;
        let given = |key| match key {
            "torque_limit_nm" => self.torque_limit_nm.is_some(),
            "rate_limit_nm_s" => self.rate_limit_nm_s.is_some(),
            _ => self.taper_m_s.is_some(),
        };
        let plan = config.plan().map_err(|e| match key_of(&e) {
            Some(key) if given(key) => ScenarioError::value(key, e),
            None if flashed && e.leaf.group.starts_with("estimate") => {
                ScenarioError::Flashed { bicycle: bicycle.into(), error: e }
            }
            _ => ScenarioError::Parameter(e),
        })?;
        let ideal = self.assist == AssistKind::Ideal;
        if let Some(key) = self.flashed_only(limited).filter(|_| ideal) {
            let reason = "acts on the flashed code only (assist firmware); an ideal law, as every function is, has neither \
                          limits nor sensor delay";
            return Err(ScenarioError::value(key, reason));
        }
        if let Some(key) = self.parameters.keys().find(|key| ideal && !key.starts_with(IDEAL_PARAMETERS)) {
            let reason =
                format!("{key} acts on --assist firmware only; the ideal law has {IDEAL_PARAMETERS}* alone");
            return Err(ScenarioError::value("parameters", reason));
        }
        Ok(match self.assist {
            _ if *law == Law::None => Assist::None,
            AssistKind::Firmware => Assist::Firmware(Box::new(plan)),
            AssistKind::Ideal => {
                let dead_band = plan.config().dead_band;
                Assist::Ideal(Box::new(IdealLaw { law: law.clone(), dead_band }))
            }
        })
    }

    /// The key of a sensor delay, or of what made the controller's configuration `limited`, except single parameters.
    fn flashed_only(&self, limited: bool) -> Option<&'static str> {
        let value = |limit: &Option<OrNone<f64>>| limit.is_some_and(|limit| limit != OrNone::Off);
        let limits = [
            ("torque_limit_nm", value(&self.torque_limit_nm)),
            ("rate_limit_nm_s", value(&self.rate_limit_nm_s)),
            ("taper_m_s", self.taper_m_s.is_some_and(|taper| taper != OrNone::Off)),
            ("preset", self.preset == Preset::Product),
            ("parameter_file", self.parameter_file.is_some()),
        ];
        let of_limit = limits.into_iter().find(|(_, given)| limited && *given).map(|(key, _)| key);
        of_limit.or((self.sensor_delay_s > 0.0).then_some("sensor_delay_s"))
    }

    fn conditions(
        &self,
        bicycle: &Bicycle,
        assist: Assist,
        rider: Option<&LoadedRider>,
        (step_s, plant): (f64, Plant),
    ) -> Conditions {
        Conditions {
            rider: rider.map(|one| one.rider.clone()),
            imu: self.imu,
            plant,
            fall: self.fall.into(),
            time_limit_s: self.time_limit_s,
            step_s,
            recovered_below: self.recovered_below,
            ..Conditions::thesis(Geometry::new(&bicycle.parameters), assist)
        }
    }

    /// Names that can be files, except the bicycle's, whose loader warns itself.
    fn files(&self) -> impl Iterator<Item = &str> {
        let law = self.law.as_ref().and_then(Content::name);
        let rider = self.rider.table.as_ref().and_then(Content::name);
        let parameters = self.parameter_file.as_ref().and_then(Content::name);
        [law, rider, parameters].into_iter().flatten().chain(self.plant.files())
    }

    /// The scenario with contents in the places of files.
    fn complete(
        &self,
        bicycle: Bicycle,
        rider: Option<&LoadedRider>,
        law: Option<Content<super::LawTable>>,
        file: Option<ParameterFile>,
    ) -> Result<Self, ScenarioError> {
        let mut all = Self { law, ..self.clone() };
        if !catalogue::shipped_names().contains(&bicycle.name) {
            all.bicycle = Content::Given(Box::new(bicycle));
        }
        if let Some(rider) = rider
            && !crate::rider::catalogue::shipped_names().any(|name| name == rider.table.name)
        {
            all.rider.table = Some(Content::Given(Box::new(rider.table.clone())));
        }
        all.parameter_file = file.map(|file| Content::Given(Box::new(file)));
        all.plant.include()?;
        Ok(all)
    }
}

/// An integration step that divides `delay_s`: `period_s` if possible. With the firmware it must be the control period;
/// otherwise a shorter step is chosen, with a note.
fn step(delay_s: f64, period_s: f64, firmware: bool, notes: &mut Vec<String>) -> Result<f64, ScenarioError> {
    let ms = |s: f64| format!("{} ms", (s * 1e9).round() / 1e6);
    let periods = delay_s / period_s;
    if (periods - periods.round()).abs() < 1e-6 {
        return Ok(period_s);
    }
    let wrong = |reason: String| ScenarioError::value("rider.delay_s", reason);
    if firmware {
        return Err(wrong(format!(
            "{} is not a whole number of control periods of {}; nearest are {} and {} \
             (without --assist firmware any delay will do)",
            ms(delay_s),
            ms(period_s),
            ms(periods.floor() * period_s),
            ms(periods.ceil() * period_s)
        )));
    }
    let step = delay_s / periods.ceil();
    if step < 1e-5 {
        return Err(wrong(format!("{} is less than the shortest step, 0.01 ms", ms(delay_s))));
    }
    notes.push(format!("step {} so that the delay of {} is {} steps", ms(step), ms(delay_s), periods.ceil()));
    Ok(step)
}
