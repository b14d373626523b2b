//! The stop conditions of a scenario.

use super::choice::OnStick;
use super::error::ScenarioError;
use super::values::Values;

/// The stop conditions of a run; at least one is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Stop when θ decreases to this angle, rad (`stop.theta_risen`).
    pub theta_risen: Option<f64>,
    /// Stop when θ increases to this angle, rad (`stop.theta_fallen`).
    pub theta_fallen: Option<f64>,
    /// Stop at this time, s (`stop.duration`).
    pub duration: Option<f64>,
    /// Whether the run continues when the contact point stops slipping; it may slip again (`stop.on_stick`).
    pub may_stick: bool,
}

impl Stop {
    /// The stop conditions of complete values.
    pub(super) fn new(values: &Values) -> Result<Self, ScenarioError> {
        let on_stick = values.optional_choice("stop.on_stick", OnStick::find)?;
        Ok(Self {
            theta_risen: values.optional_number("stop.theta_risen"),
            theta_fallen: values.optional_number("stop.theta_fallen"),
            duration: values.optional_number("stop.duration"),
            may_stick: match on_stick {
                Some(OnStick::Continue) => true,
                Some(OnStick::Stop) | None => false,
            },
        })
    }
}
