//! The arguments of `toprise run`, resolved.

use super::file_plan::FilePlan;
use crate::archive::recording::Recording;
use crate::archive::supplements::about::About;
use crate::archive::writer::Form;
use crate::cli::extension::ShowRun;
use crate::run::scenario::{Scenario, Values};
use crate::telemetry::Topics;

/// A run and what becomes of it.
#[derive(Debug)]
pub(super) struct RunPlan {
    /// The scenario that is run.
    pub(super) scenario: Scenario,
    /// The keys and values before the changes of `--set`.
    pub(super) base: Values,
    /// The form of the MCAP file.
    pub(super) form: Form,
    /// The topics that are recorded.
    pub(super) topics: Topics,
    /// The recording that is repeated, unless it is changed: what it says of its run is not about another.
    pub(super) repeated: Option<Box<Recording>>,
    /// What the recording says of itself.
    pub(super) about: Option<About>,
    /// Simulated time per real time; `None` for as fast as possible.
    pub(super) speed: Option<f64>,
    /// The files that are read and written.
    pub(super) files: FilePlan,
    /// Where it is shown.
    pub(super) show: Option<Box<dyn ShowRun>>,
}
