//! Analysis of runs: verify, diff, explain, figures.

pub mod diff;
pub mod explain;
pub mod figures;
pub mod history;
pub(crate) mod phrase;
pub(crate) mod plot;
pub mod subject;
pub mod verify;
