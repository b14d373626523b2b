//! Arguments that features add to commands, and what the commands do with them.
//!
//! A command has a field for such arguments and asks it for a plan. Without the feature, the type of the field is
//! [`Absent`]: no arguments, no plan.

#[cfg(feature = "sweep")]
pub(super) use super::commands::sweep::RowArgument;
#[cfg(feature = "sweep")]
pub(super) use super::commands::sweep::figures::MapArguments;
#[cfg(feature = "rerun")]
pub(super) use super::rerun::diff::ShowPairArguments;
#[cfg(all(feature = "rerun", feature = "fit"))]
pub(super) use super::rerun::fit::ShowFitArguments;
#[cfg(feature = "rerun")]
pub(super) use super::rerun::run::ShowRunArguments;
#[cfg(all(not(feature = "rerun"), feature = "fit"))]
pub(super) use Absent as ShowFitArguments;
#[cfg(not(feature = "sweep"))]
pub(super) use Absent as MapArguments;
#[cfg(not(feature = "sweep"))]
pub(super) use Absent as RowArgument;
#[cfg(not(feature = "rerun"))]
pub(super) use {Absent as ShowPairArguments, Absent as ShowRunArguments};

use super::commands::run::{FilePlan, McapFile};
use super::report::Completed;
use crate::analysis::diff::{Report, Subject};
use crate::archive::publish::Drafts;
#[cfg(feature = "fit")]
use crate::archive::publish::Existing;
use crate::archive::sink::Sink;
use crate::figures::Map;
#[cfg(feature = "fit")]
use crate::fit::Fit;
use crate::run::outcome::Outcome;
use crate::run::scenario::{Scenario, Values};
use crate::telemetry::side::Side;
use crate::telemetry::{Message, Telemetry};
use anyhow::Error;
use clap::Args;
use std::fmt::Debug;
use std::path::Path;

/// Arguments that a feature adds to a command.
pub(super) trait FeatureArguments<Context, Plan> {
    /// Resolves the arguments; `None` if they ask for nothing.
    fn plan(&self, context: Context) -> Result<Option<Plan>, Error>;
}

/// The arguments of a feature that the program lacks.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub(super) struct Absent {}

impl<Context, Plan> FeatureArguments<Context, Plan> for Absent {
    fn plan(&self, _: Context) -> Result<Option<Plan>, Error> {
        Ok(None)
    }
}

/// The row of a sweep that is run again.
pub(super) struct SweepRow {
    pub(super) number: u64,
    pub(super) values: Values,
}

/// A table of a sweep, to be drawn.
pub(super) trait MapTable {
    /// The file with the table.
    fn path(&self) -> &Path;

    /// Reads what the figure shows.
    fn read(&self) -> Result<Map, Error>;
}

/// Where a run is shown.
pub(super) trait ShowRun: Debug {
    /// A note for the report.
    fn note(&self) -> Option<&'static str>;

    /// Opens the requested outputs of the run that is recorded in `mcap`; `None` if there are none. An unreachable viewer
    /// is only a warning.
    fn open(
        &self,
        files: &FilePlan,
        drafts: &Drafts,
        mcap: &Path,
        scenario: &Scenario,
        telemetry: &Telemetry,
    ) -> Result<Option<Box<dyn RunViewer>>, Error>;
}

/// A run that is shown.
pub(super) trait RunViewer {
    fn sink(&mut self) -> &mut dyn Sink;

    /// Finishes as the MCAP file was finished.
    fn finish(self: Box<Self>, mcap: &McapFile, outcome: &Outcome) -> Result<Completed, Error>;
}

/// End of a sentence of the report of `diff`: how to see more in the viewer.
pub(super) const SPAWN_HINT: &str = if cfg!(feature = "rerun") {
    ", --spawn shows both tops in Rerun"
} else {
    ""
};

/// Where a comparison is shown.
pub(super) trait ShowPair {
    fn open(
        &self,
        subjects: [Subject<'_>; 2],
        names: [&str; 2],
        drafts: &Drafts,
    ) -> Result<Box<dyn PairViewer>, Error>;
}

/// A comparison that is shown.
pub(super) trait PairViewer {
    fn write(&mut self, side: Side, message: &Message<'_>);

    fn write_difference(&mut self, message: &Message<'_>);

    /// Adds the report to the recording and completes the file. Returns whether the viewer went away before it had
    /// everything.
    fn finish(self: Box<Self>, report: &Report) -> Result<bool, Error>;
}

/// Where a fit is shown.
#[cfg(feature = "fit")]
pub(super) trait ShowFit {
    /// The file to write.
    fn file(&self) -> Option<&Path>;

    /// Shows the best fit, with a report in Markdown. An unreachable viewer is only a warning.
    fn show(
        &self,
        fit: &Fit,
        report: String,
        drafts: &Drafts,
        existing: Existing,
    ) -> Result<Completed, Error>;
}
