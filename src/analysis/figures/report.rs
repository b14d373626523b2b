//! The report of the figures that were drawn.

use schemars::JsonSchema;
use serde::Serialize;

/// What was drawn of some runs, and what was not.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct FiguresReport {
    /// The files that were written.
    pub files: Vec<FigureFile>,
    /// What runs lack of what figures need: these figures were drawn without them, or not at all.
    pub lacking: Vec<Lacking>,
    /// What was left out because a figure says nothing of a run.
    pub left_out: Vec<LeftOut>,
    /// What could not be read of the runs.
    pub losses: Vec<RunLoss>,
}

/// A file with a figure.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FigureFile {
    /// Name of the figure.
    pub figure: &'static str,
    /// What the figure shows.
    pub title: &'static str,
    /// Names of the runs that it is drawn of.
    pub runs: Vec<String>,
    /// Path of the file.
    pub path: String,
    /// Size of the file, bytes.
    pub bytes: u64,
}

/// What a run lacks of what a figure needs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Lacking {
    /// Name of the run.
    pub run: String,
    /// Name of the figure.
    pub figure: &'static str,
    /// The topic, its messages or the field.
    pub missing: String,
}

/// A run that a figure says nothing of, whatever it has recorded.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LeftOut {
    /// Name of the run.
    pub run: String,
    /// Name of the figure.
    pub figure: &'static str,
    /// Why.
    pub because: &'static str,
}

/// Something of a run that could not be read.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RunLoss {
    /// Name of the run.
    pub run: String,
    /// What is lost, in a sentence.
    pub loss: String,
}
