//! Runs: the scenario that defines one, and the simulation that turns it into samples, events and nutation cycles.

pub mod scenario;
pub mod simulation;
