//! One of the three models.

use crate::bicycle::Bicycle;
use crate::controller::Controller;
use crate::rider::Rider;
use crate::setup::Setup;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A model and its state.
#[derive(Clone, Debug)]
pub struct Model(Which);

#[derive(Clone, Debug)]
enum Which {
    Controller(Box<Controller>),
    Bicycle(Box<Bicycle>),
    Rider(Box<Rider>),
}

impl Model {
    /// The model before its start.
    ///
    /// # Errors
    /// The setup is wrong.
    pub fn new(setup: &Setup) -> Result<Self, String> {
        if let Setup::Controller { configuration, g_m_s2, .. } = setup {
            return Ok(Self(Which::Controller(Box::new(Controller::new(configuration, *g_m_s2)?))));
        }
        if let Some(bicycle) = Bicycle::new(setup) {
            return Ok(Self(Which::Bicycle(Box::new(bicycle))));
        }
        let rider = Rider::new(setup)?.ok_or("the model is unknown")?;
        Ok(Self(Which::Rider(Box::new(rider))))
    }

    /// Starts with the values of the parameters.
    ///
    /// # Errors
    /// The parameter with its value and range.
    pub fn begin(&mut self, parameters: &[f64]) -> Result<(), String> {
        match &mut self.0 {
            Which::Controller(model) => model.begin(parameters),
            Which::Bicycle(model) => model.begin(parameters),
            Which::Rider(model) => model.begin(parameters),
        }
    }

    /// One time step with the values of the inputs; returns an event for the log.
    pub fn step(&mut self, inputs: &[f64]) -> Option<String> {
        match &mut self.0 {
            Which::Controller(model) => model.step(inputs),
            Which::Bicycle(model) => return model.step(inputs),
            Which::Rider(model) => model.step(inputs),
        }
        None
    }

    /// Writes the values of the outputs.
    pub fn outputs(&self, to: &mut [f64]) {
        match &self.0 {
            Which::Controller(model) => model.outputs(to),
            Which::Bicycle(model) => model.outputs(to),
            Which::Rider(model) => model.outputs(to),
        }
    }

    /// The outputs that depend on the inputs of the same instant, in their order.
    pub fn direct(&self, inputs: &[f64]) -> Vec<f64> {
        match &self.0 {
            Which::Bicycle(model) => model.accelerations(inputs).into(),
            Which::Controller(_) | Which::Rider(_) => Vec::new(),
        }
    }

    /// The state as bytes.
    pub fn bytes(&self) -> Vec<u8> {
        match &self.0 {
            Which::Controller(model) => model.bytes(),
            Which::Bicycle(model) => model.bytes(),
            Which::Rider(model) => model.bytes(),
        }
    }

    /// Restores a state from bytes, after [`Model::begin`] with the same parameters.
    ///
    /// # Errors
    /// The bytes are no state of this model.
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), String> {
        match &mut self.0 {
            Which::Controller(model) => model.load(bytes),
            Which::Bicycle(model) => model.load(bytes),
            Which::Rider(model) => model.load(bytes),
        }
    }
}

/// A state as bytes. Plain numbers: it does not fail.
pub(crate) fn to_bytes(state: &impl Serialize) -> Vec<u8> {
    postcard::to_stdvec(state).unwrap_or_default()
}

/// A state from bytes.
pub(crate) fn from_bytes<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    postcard::from_bytes(bytes).map_err(|e| format!("the state can't be decoded: {e}"))
}
