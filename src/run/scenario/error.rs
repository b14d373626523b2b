//! Errors of a scenario.

use thiserror::Error;

/// Error of an invalid scenario. Each message names the key, the value and the allowed values.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ScenarioError {
    /// No preset of this name.
    #[error(
        "unknown preset {name:?}{hint}; presets: {allowed}. For a scenario file, give the path, e.g. ./{name}.toml"
    )]
    UnknownPreset {
        /// The unknown name.
        name: String,
        /// A "did you mean" hint; may be empty.
        hint: String,
        /// The names of all presets.
        allowed: String,
    },
    /// Not TOML.
    #[error("not valid TOML: {0}")]
    Syntax(String),
    /// An unknown key.
    #[error("unknown key {key}{hint}; allowed: {allowed}")]
    UnknownKey {
        /// The key.
        key: String,
        /// A "did you mean" hint; may be empty.
        hint: String,
        /// The keys of its section, or all keys.
        allowed: String,
    },
    /// Required keys are missing.
    #[error("missing: {missing}")]
    MissingKeys {
        /// The keys.
        keys: Vec<&'static str>,
        /// The keys with descriptions and allowed values.
        missing: String,
    },
    /// Text instead of a number, or the reverse.
    #[error("{key} = {value}: must be {expected}")]
    WrongType {
        /// The key.
        key: &'static str,
        /// The rejected value.
        value: String,
        /// The allowed values.
        expected: String,
    },
    /// A value that is not allowed.
    #[error("{key} = {value}: must be {allowed}")]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// The rejected value.
        value: String,
        /// The allowed values.
        allowed: String,
    },
    /// A key that does not apply because of the value of another key.
    #[error(
        "{key} does not apply {circumstance}: set {other} = {needed}, or remove {key} (--set {key}=)"
    )]
    Inapplicable {
        /// The key.
        key: &'static str,
        /// The other key, and its value if it has one.
        circumstance: String,
        /// The key that makes it inapplicable.
        other: &'static str,
        /// The values of that key with which it applies.
        needed: String,
    },
    /// Two values that exclude each other.
    #[error("{key} = {value}: {reason}")]
    Conflict {
        /// The key.
        key: &'static str,
        /// Its value.
        value: String,
        /// The reason, with the other key.
        reason: String,
    },
    /// No stop condition.
    #[error(
        "the run would never stop: set stop.duration, stop.theta_risen or stop.theta_fallen (without friction: stop.duration)"
    )]
    NeverStops,
}
