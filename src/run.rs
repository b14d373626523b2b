//! Scenarios, their simulation, and outcomes.

#![deny(
    clippy::wildcard_enum_match_arm,
    clippy::match_wildcard_for_single_variants
)]

pub(crate) mod listed;
pub mod outcome;
pub mod scenario;
pub mod simulation;
pub(crate) mod suggestion;
pub(crate) mod time;

pub use outcome::outcome;
