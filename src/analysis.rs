//! Questions asked of runs: whether a recording can be trusted, how two runs differ, what happened and how it looks.

pub mod diff;
pub mod explain;
pub mod figures;
pub mod history;
pub(crate) mod phrase;
pub(crate) mod plot;
pub mod subject;
pub mod verify;
