//! What to fit.

use super::model::Loss;
use crate::measured::Data;
use crate::run::scenario::Scenario;

/// What to fit, and how.
#[derive(Clone, Debug)]
pub struct Request {
    /// The scenario; free keys start at its values.
    pub scenario: Scenario,
    /// The measured signals.
    pub data: Data,
    /// Names of the free parameters: keys, or `initial` for all of the start that the signals show.
    pub free: Vec<String>,
    /// Bounds of parameters.
    pub bounds: Vec<(String, [f64; 2])>,
    /// How residuals count.
    pub loss: Loss,
    /// Time in the data at which the scenario starts, s. By default that of the first sample, and 0 for recordings of
    /// toprise.
    pub origin: Option<f64>,
    /// Use only the data until this time on their clock, s.
    pub until: Option<f64>,
    /// Part of the time at the end that is not fitted, but predicted.
    pub holdout: f64,
    /// Laws to compare.
    pub compare: Vec<String>,
    /// Parameters whose profile likelihoods are wanted.
    pub profile: Vec<String>,
    /// Whether to multiply variances by χ²/ν.
    pub rescale: bool,
}

impl Request {
    /// A request with the default options.
    pub fn new(scenario: Scenario, data: Data, free: &[&str]) -> Self {
        Self {
            scenario,
            data,
            free: free.iter().map(|name| (*name).to_owned()).collect(),
            bounds: Vec::new(),
            loss: Loss::default(),
            origin: None,
            until: None,
            holdout: 0.0,
            compare: Vec::new(),
            profile: Vec::new(),
            rescale: false,
        }
    }
}
