//! Deserializers with human-readable errors.

use serde::de::{Deserialize, Deserializer, Error as _};
use std::num::NonZeroU64;

/// Reads a value.
fn read<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
    what: &str,
) -> Result<T, D::Error> {
    // serde would name Rust's types.
    T::deserialize(deserializer).map_err(|_| D::Error::custom(format!("must be {what}")))
}

/// A positive integer.
pub(super) fn count<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    read(deserializer, "a whole number of at least 1").map(NonZeroU64::get)
}

/// As [`count`], but optional.
pub(super) fn some_count<'de, D: Deserializer<'de>>(source: D) -> Result<Option<u64>, D::Error> {
    count(source).map(Some)
}

/// A non-negative number.
pub(super) fn seed<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    read(deserializer, "a whole number of at least 0")
}

/// Method by which the points of a sample are chosen.
pub(super) fn method<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<T, D::Error> {
    read(deserializer, "\"sobol\" or \"random\"")
}

/// A list of strings.
pub(super) fn texts<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    read(deserializer, "a list of strings, e.g. [\"…\", \"…\"]")
}

/// A section of keys and values.
pub(super) fn section<'de, D: Deserializer<'de>>(deserializer: D) -> Result<toml::Table, D::Error> {
    read(deserializer, "a section of keys and values")
}
