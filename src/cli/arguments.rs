//! Arguments shared by several commands.

use crate::telemetry::encoding::Encoding;
use clap::builder::PossibleValue;
use clap::{Command, ValueEnum};
use std::ops::{Bound, RangeBounds};
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

/// What the value of an option must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("must be {0}")]
pub(super) struct ArgumentError(pub(super) &'static str);

/// Reads a number of a range; `expected` says of which.
pub(super) fn parse_number(
    text: &str,
    range: impl RangeBounds<f64>,
    expected: &'static str,
) -> Result<f64, ArgumentError> {
    match text.parse() {
        Ok(number) if range.contains(&number) => Ok(number),
        Ok(_) | Err(_) => Err(ArgumentError(expected)),
    }
}

/// Reads a positive number.
pub(super) fn parse_positive(text: &str) -> Result<f64, ArgumentError> {
    let positive = (Bound::Excluded(0.0), Bound::Excluded(f64::INFINITY));
    parse_number(text, positive, "a positive number, e.g. 0.5")
}

/// Reads a number that is zero or positive.
pub(super) fn parse_tolerance(text: &str) -> Result<f64, ArgumentError> {
    let expected = "a number of 0 or more, e.g. 1e-9";
    parse_number(text, 0.0..f64::INFINITY, expected)
}

/// Reads the value of `--set`.
pub(super) fn parse_override(text: &str) -> Result<Override, ArgumentError> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => {
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        }
        Some(_) | None => Err(ArgumentError("KEY=VALUE, as in friction.k=0.02")),
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
