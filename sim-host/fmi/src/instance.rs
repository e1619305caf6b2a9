//! An instance of a model between its calls: phases, values, whole periods of time, saved states.

use crate::model::{Model, from_bytes, to_bytes};
use crate::setup::Setup;
use crate::variable::{Kind, Role, Table, Variable};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// Largest error of a time or a step, in time steps of the model.
const TOLERANCE: f64 = 1e-3;

/// What may be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    Instantiated,
    Initialising,
    Running,
    Terminated,
}

/// What does not change.
#[derive(Debug)]
struct Fixed {
    token: Arc<str>,
    setup: Setup,
    table: Table,
    step_s: f64,
}

/// An entry for the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LogEntry {
    /// A doubtful call of the importer.
    Warning(String),
    /// An event of the model.
    Event(String),
}

/// A saved state.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Token of its FMU.
    token: Arc<str>,
    phase: Phase,
    start_s: f64,
    /// Time steps of the model since the start.
    periods: u64,
    values: Vec<f64>,
    model: Model,
    /// Whether a long communication step has been reported.
    warned: bool,
}

/// An instance.
#[derive(Clone, Debug)]
pub struct Instance {
    fixed: Arc<Fixed>,
    now: Snapshot,
}

/// A serialized state.
#[derive(Serialize, Deserialize)]
struct Stored {
    token: String,
    phase: Phase,
    start_s: f64,
    periods: u64,
    values: Vec<f64>,
    model: Vec<u8>,
}

impl Instance {
    /// An instance of the FMU with these resources and the token of its model description.
    ///
    /// # Errors
    /// The resources can't be read, or belong to another FMU.
    pub fn new(token: &str, resources: &Path) -> Result<Self, String> {
        let (setup, table) = Setup::read(resources, token)?;
        let step_s = setup.step_s()?;
        let token: Arc<str> = token.into();
        let now = Snapshot::fresh(&token, &setup, &table)?;
        Ok(Self { fixed: Arc::new(Fixed { token, setup, table, step_s }), now })
    }

    /// Sets the time of the start, which is 0 otherwise \[s\].
    ///
    /// # Errors
    /// The initialisation has begun, or the time is not finite.
    pub fn set_start(&mut self, start_s: f64) -> Result<(), String> {
        self.only(Phase::Instantiated, "set the start time")?;
        if !start_s.is_finite() {
            return Err(format!("start time = {start_s} is not a finite number"));
        }
        self.now.start_s = start_s;
        Ok(())
    }

    /// Begins the initialisation. From here on the outputs are those of the start with the present parameters.
    ///
    /// # Errors
    /// It has begun before.
    pub fn enter(&mut self) -> Result<(), String> {
        self.only(Phase::Instantiated, "initialise")?;
        self.now.phase = Phase::Initialising;
        self.preview();
        Ok(())
    }

    /// The model as it would start now; as it is, if the parameters do not fit each other yet.
    fn begun(&self) -> Model {
        let mut model = self.now.model.clone();
        match model.begin(&self.now.values[self.fixed.table.of(Role::Parameter)]) {
            Ok(()) => model,
            // Told at the end of the initialisation.
            Err(_) => self.now.model.clone(),
        }
    }

    /// Copies the outputs of a start to the values.
    fn preview(&mut self) {
        let time_s = self.time_s();
        self.begun().outputs(&mut self.now.values[self.fixed.table.of(Role::Output)]);
        self.now.values[0] = time_s;
    }

    /// Ends the initialisation: the model starts with its parameters.
    ///
    /// # Errors
    /// A parameter with its value and range.
    pub fn exit(&mut self) -> Result<(), String> {
        self.only(Phase::Initialising, "end the initialisation")?;
        let Snapshot { model, values, .. } = &mut self.now;
        model.begin(&values[self.fixed.table.of(Role::Parameter)])?;
        self.now.phase = Phase::Running;
        self.publish();
        Ok(())
    }

    /// A communication step of `step_s` seconds from the time `now_s`; returns the entries for the log.
    ///
    /// # Errors
    /// The time is not that of the instance, or the step is not a whole number of the model's time steps.
    pub fn step(&mut self, now_s: f64, step_s: f64) -> Result<Vec<LogEntry>, String> {
        self.only(Phase::Running, "step")?;
        let own_s = self.fixed.step_s;
        let expected_s = self.time_s();
        if (now_s - expected_s).abs() > TOLERANCE * own_s || now_s.is_nan() {
            return Err(format!(
                "the communication point {now_s} s is not the instance's time, {expected_s} s"
            ));
        }
        let count = (step_s / own_s).round();
        if !(1.0..=1e9).contains(&count) || (step_s - count * own_s).abs() > TOLERANCE * own_s {
            let least = (step_s / own_s).floor().max(1.0) * own_s;
            return Err(format!(
                "the communication step {step_s} s is not a whole number of the model's time steps of {own_s} s; nearest \
                 is {}, best {own_s} (FMPy: output_interval={own_s})",
                (least * 1e9).round() / 1e9
            ));
        }
        let mut entries = Vec::new();
        if count > 1.0 && !self.now.warned {
            self.now.warned = true;
            entries.push(LogEntry::Warning(format!(
                "the communication step {step_s} s is {count} time steps of {own_s} s: the inputs are held over all \
                 of them"
            )));
        }
        let inputs = self.fixed.table.of(Role::Input);
        for _ in 0..count as u64 {
            let Snapshot { model, values, .. } = &mut self.now;
            entries.extend(model.step(&values[inputs.clone()]).map(LogEntry::Event));
            self.now.periods += 1;
        }
        self.publish();
        Ok(entries)
    }

    /// The instance's time \[s\].
    pub fn time_s(&self) -> f64 {
        // Rounded to whole nanoseconds, as the times of a ride.
        self.now.start_s + (self.now.periods as f64 * self.fixed.step_s * 1e9).round() / 1e9
    }

    /// Ends the simulation.
    pub fn terminate(&mut self) {
        self.now.phase = Phase::Terminated;
    }

    /// Back to the instance as it was created.
    ///
    /// # Errors
    /// The setup is wrong, which it was not before.
    pub fn reset(&mut self) -> Result<(), String> {
        self.now = Snapshot::fresh(&self.fixed.token, &self.fixed.setup, &self.fixed.table)?;
        Ok(())
    }

    /// The value of a variable of one of the types `accepted`.
    ///
    /// # Errors
    /// No such variable.
    pub fn get(&self, reference: u32, accepted: fn(Kind) -> bool) -> Result<f64, String> {
        if !self.variable(reference, accepted)?.direct {
            return Ok(self.now.values[reference as usize]);
        }
        let Fixed { table, .. } = &*self.fixed;
        let before = &table.variables()[..reference as usize];
        let place = before.iter().filter(|variable| variable.direct).count();
        let inputs = &self.now.values[table.of(Role::Input)];
        let direct = match self.now.phase {
            Phase::Initialising => self.begun().direct(inputs),
            _ => self.now.model.direct(inputs),
        };
        Ok(direct.get(place).copied().unwrap_or(0.0))
    }

    /// Sets the value of a variable of one of the types `accepted`.
    ///
    /// # Errors
    /// No such variable; it can't be set, at least not now; the value with its range.
    pub fn set(&mut self, reference: u32, accepted: fn(Kind) -> bool, value: f64) -> Result<(), String> {
        let variable = self.variable(reference, accepted)?;
        let before = matches!(self.now.phase, Phase::Instantiated | Phase::Initialising);
        match variable.role {
            Role::Input => {}
            Role::Parameter if before => {}
            Role::Parameter => {
                return Err(format!("{} is fixed: it can be set before the start only", variable.name));
            }
            Role::Time | Role::Constant | Role::Output => {
                return Err(format!("{} can't be set", variable.name));
            }
        }
        variable.check(value)?;
        let parameter = variable.role == Role::Parameter;
        self.now.values[reference as usize] = value;
        if parameter && self.now.phase == Phase::Initialising {
            self.preview();
        }
        Ok(())
    }

    /// The present state.
    pub fn save(&self) -> Snapshot {
        self.now.clone()
    }

    /// Returns to a state of an instance of this FMU.
    ///
    /// # Errors
    /// It is that of another FMU.
    pub fn restore(&mut self, state: &Snapshot) -> Result<(), String> {
        self.owns(&state.token)?;
        self.now = state.clone();
        Ok(())
    }

    /// A state as bytes, for another instance or process with the same FMU.
    ///
    /// # Errors
    /// It is that of another FMU.
    pub fn serialize(&self, state: &Snapshot) -> Result<Vec<u8>, String> {
        self.owns(&state.token)?;
        let Snapshot { phase, start_s, periods, values, model, .. } = state;
        let model = if *phase == Phase::Running { model.bytes() } else { Vec::new() };
        let mut bytes = to_bytes(&Stored {
            token: self.fixed.token.to_string(),
            phase: *phase,
            start_s: *start_s,
            periods: *periods,
            values: values.clone(),
            model,
        });
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        Ok(bytes)
    }

    /// A state from bytes.
    ///
    /// # Errors
    /// The bytes are damaged, or of another FMU.
    pub fn deserialize(&self, bytes: &[u8]) -> Result<Snapshot, String> {
        let sound = bytes
            .split_last_chunk::<4>()
            .filter(|(rest, crc)| crc32fast::hash(rest) == u32::from_le_bytes(**crc));
        let (bytes, _) = sound.ok_or("the state is damaged: its checksum is wrong")?;
        let Stored { token, phase, start_s, periods, values, model: state } = from_bytes(bytes)?;
        self.owns(&token)?;
        let Fixed { token, setup, table, .. } = &*self.fixed;
        if values.len() != table.variables().len() {
            return Err("the state has another number of variables".into());
        }
        let mut model = Model::new(setup)?;
        if phase == Phase::Running {
            model.begin(&values[table.of(Role::Parameter)])?;
            model.load(&state)?;
        }
        Ok(Snapshot { token: token.clone(), phase, start_s, periods, values, model, warned: false })
    }

    /// Copies the model's outputs and the time to the values.
    fn publish(&mut self) {
        self.now.values[0] = self.time_s();
        let Snapshot { model, values, .. } = &mut self.now;
        model.outputs(&mut values[self.fixed.table.of(Role::Output)]);
    }

    /// Rejects what belongs to another FMU, by its token.
    fn owns(&self, token: &str) -> Result<(), String> {
        if token == &*self.fixed.token {
            return Ok(());
        }
        Err(format!("the state is that of another FMU, with the token {token}"))
    }

    fn only(&self, phase: Phase, what: &str) -> Result<(), String> {
        if self.now.phase == phase {
            return Ok(());
        }
        Err(format!(
            "can't {what}: the instance is {}",
            match self.now.phase {
                Phase::Instantiated => "not initialised",
                Phase::Initialising => "being initialised",
                Phase::Running => "running",
                Phase::Terminated => "terminated",
            }
        ))
    }

    fn variable(&self, reference: u32, accepted: fn(Kind) -> bool) -> Result<&Variable, String> {
        let variables = self.fixed.table.variables();
        let variable = variables.get(reference as usize).ok_or_else(|| {
            format!("no variable has the value reference {reference}; the last is {}", variables.len() - 1)
        })?;
        if accepted(variable.kind) {
            return Ok(variable);
        }
        Err(format!("{} has another type", variable.name))
    }
}

impl Snapshot {
    fn fresh(token: &Arc<str>, setup: &Setup, table: &Table) -> Result<Self, String> {
        Ok(Self {
            token: token.clone(),
            phase: Phase::Instantiated,
            start_s: 0.0,
            periods: 0,
            values: table.start(),
            model: Model::new(setup)?,
            warned: false,
        })
    }
}
