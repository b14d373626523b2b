//! Errors of a scenario.

use thiserror::Error;

/// The reason why a text is not a scenario that can be run. Each message names the key, the value and what is
/// allowed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ScenarioError {
    /// No preset of this name.
    #[error(
        "there is no preset {name:?}{near}; presets: {allowed} (a scenario file needs its path, for example ./{name}.toml)"
    )]
    UnknownPreset {
        /// The name that was asked for.
        name: String,
        /// A question after the name that was meant; empty if none is like it.
        near: String,
        /// The names that exist.
        allowed: String,
    },
    /// Not TOML.
    #[error("not valid TOML: {0}")]
    Syntax(String),
    /// A key that scenarios don't have.
    #[error("unknown key {key}{near}; allowed: {allowed}")]
    UnknownKey {
        /// The key.
        key: String,
        /// A question after the key that was meant; empty if none is like it.
        near: String,
        /// Those of its section, or all.
        allowed: String,
    },
    /// Keys that have to be there are not.
    #[error("missing: {missing}")]
    MissingKeys {
        /// The keys.
        keys: Vec<&'static str>,
        /// The keys with what they take.
        missing: String,
    },
    /// A number where a word belongs, or the reverse.
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
    /// A key that is ignored with, or without, the value of another.
    #[error(
        "{key} does not apply {circumstance}: set {other} = {needed}, or remove {key} (--set {key}= on the command line)"
    )]
    Inapplicable {
        /// The key.
        key: &'static str,
        /// The other key, and its value if it has one.
        circumstance: String,
        /// The key that makes it meaningless.
        other: &'static str,
        /// The values of that key with which it has a meaning.
        needed: String,
    },
    /// Two values that exclude each other.
    #[error("{key} = {value}: {reason}")]
    Conflict {
        /// The key.
        key: &'static str,
        /// Its value.
        value: String,
        /// The contradicted key.
        reason: String,
    },
    /// Nothing would end the run.
    #[error(
        "the run would never stop: set stop.duration (without friction) or at least one of stop.theta_risen, stop.theta_fallen, stop.duration"
    )]
    NeverStops,
}
