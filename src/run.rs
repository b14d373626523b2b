//! Scenarios, their simulation, and outcomes.

#![deny(
    clippy::wildcard_enum_match_arm,
    clippy::match_wildcard_for_single_variants
)]

pub(crate) mod listed;
pub(crate) mod nearest;
pub mod outcome;
pub mod scenario;
pub mod simulation;

pub use outcome::outcome;
