//! The error of a scenario.

use thiserror::Error;

/// Error of an invalid scenario: a text that names the key, the value and the allowed values.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct ScenarioError(pub(super) String);

impl ScenarioError {
    /// The error of a value that is not allowed.
    pub(super) fn of_value(key: &str, value: &str, reason: &str) -> Self {
        Self(format!("{key} = {value}: {reason}"))
    }
}
