//! The report of the figures that were drawn.

use schemars::JsonSchema;
use serde::Serialize;

/// Figures of some runs: those that were drawn, and those that were not.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct FiguresReport {
    /// The files that were written.
    pub files: Vec<FigureFile>,
    /// Missing data; the figures were drawn without it or not at all.
    pub lacking: Vec<Lacking>,
    /// Runs left out because a figure does not apply to them.
    pub left_out: Vec<LeftOut>,
    /// Parts of the runs that could not be read.
    pub losses: Vec<RunLoss>,
}

/// A file with a figure.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FigureFile {
    /// Name of the figure.
    pub figure: &'static str,
    /// Content of the figure.
    pub title: &'static str,
    /// Names of the runs that it shows.
    pub runs: Vec<String>,
    /// Path of the file.
    pub path: String,
    /// Size of the file, bytes.
    pub bytes: u64,
}

/// Missing data of a run for a figure.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Lacking {
    /// Name of the run.
    pub run: String,
    /// Name of the figure.
    pub figure: &'static str,
    /// The topic, its messages or the field.
    pub missing: String,
}

/// A run that a figure does not apply to.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LeftOut {
    /// Name of the run.
    pub run: String,
    /// Name of the figure.
    pub figure: &'static str,
    /// Reason.
    pub because: &'static str,
}

/// A part of a run that could not be read.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RunLoss {
    /// Name of the run.
    pub run: String,
    /// The loss, in a sentence.
    pub loss: String,
}
