//! Arguments shared by several commands.

use crate::telemetry::encoding::Encoding;
use clap::builder::PossibleValue;
use clap::{Command, ValueEnum};
use thiserror::Error;

/// Heading in the help of the options that choose what is written.
pub(super) const OUTPUT: &str = "Output";
/// Heading in the help of the options of viewers.
pub(super) const VIEWER: &str = "Viewer";

/// Output format.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// Human-readable.
    #[default]
    Text,
    /// Machine-readable; described by schemas/toprise.*Report.json.
    Json,
    /// Markdown.
    Markdown,
    /// The findings of `diff`, as a table of comma-separated values.
    Csv,
}

/// Encodings use their names as command-line values.
impl ValueEnum for Encoding {
    fn value_variants<'a>() -> &'a [Self] {
        &Self::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.name()).help(self.meaning()))
    }
}

/// A key of a scenario and the value that it is set to.
pub(super) type Override = (String, String);

/// Error in the value of an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub(super) enum ArgumentError {
    /// `--set` without a key or a value.
    #[error("must be KEY=VALUE, as in friction.k=0.02")]
    Override,
    /// A speed or another number that must be positive.
    #[error("must be a positive number, e.g. 0.5")]
    Positive,
    /// A tolerance.
    #[error("must be a number of 0 or more, e.g. 1e-9")]
    Tolerance,
}

/// Reads a positive number.
pub(super) fn parse_positive(text: &str) -> Result<f64, ArgumentError> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        Ok(_) | Err(_) => Err(ArgumentError::Positive),
    }
}

/// Reads a number that is zero or positive.
pub(super) fn parse_tolerance(text: &str) -> Result<f64, ArgumentError> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number >= 0.0 => Ok(number),
        Ok(_) | Err(_) => Err(ArgumentError::Tolerance),
    }
}

/// Reads the value of `--set`.
pub(super) fn parse_override(text: &str) -> Result<Override, ArgumentError> {
    let (key, value) = text.split_once('=').ok_or(ArgumentError::Override)?;
    match key.trim() {
        "" => Err(ArgumentError::Override),
        key => Ok((key.to_owned(), value.trim().to_owned())),
    }
}

/// Lets the options of a command and its subcommands have negative numbers. clap would take these for options; the parser
/// of an option's value says which numbers are allowed.
pub(super) fn allow_negative_numbers(command: Command) -> Command {
    command
        .mut_args(|argument| {
            if argument.get_action().takes_values() && !argument.is_positional() {
                argument.allow_negative_numbers(true)
            } else {
                argument
            }
        })
        .mut_subcommands(allow_negative_numbers)
}

/// Parses a line of arguments, without the program and the command.
#[cfg(test)]
pub(super) fn parse<A: clap::Args>(line: &str) -> Result<A, clap::Error> {
    let command = allow_negative_numbers(A::augment_args(Command::new("toprise")));
    let words = std::iter::once("toprise").chain(line.split_whitespace());
    A::from_arg_matches(&command.try_get_matches_from(words)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parses_overrides() {
        let set = |key: &str, value: &str| Ok((key.to_owned(), value.to_owned()));
        assert_eq!(
            parse_override("friction.k = 0.02"),
            set("friction.k", "0.02")
        );
        assert_eq!(parse_override("name=a=b"), set("name", "a=b"));
        assert_eq!(parse_override("stop.duration="), set("stop.duration", ""));
        assert!(parse_override("friction.k").is_err());
        assert!(parse_override("=3").is_err());
    }
}
