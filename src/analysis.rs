//! Analysis of runs: diff and explain.

pub mod diff;
pub mod explain;
pub mod history;
pub mod losses;
pub mod normal_force;
pub mod slip;
pub mod subject;
