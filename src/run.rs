//! Runs: the scenario that defines one, the simulation that turns it into samples, events and nutation cycles, and the
//! outcome that is left of it in a table of many.

pub(crate) mod listed;
pub mod outcome;
pub mod scenario;
pub mod simulation;

pub use outcome::outcome;
