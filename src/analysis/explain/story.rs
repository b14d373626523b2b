//! What is told of a run.

use schemars::JsonSchema;
use serde::Serialize;

/// A run in words.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Story {
    /// What happened, in a few words.
    pub title: String,
    /// Its parts.
    pub chapters: Vec<Chapter>,
    /// What of the recording could not be read.
    pub losses: Vec<String>,
}

/// A part of a story.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Chapter {
    /// What it is about.
    pub heading: &'static str,
    /// Sentences.
    pub sentences: Vec<String>,
    /// Whether each sentence stands by itself, as an entry of a list.
    pub is_list: bool,
    /// Names of columns, and rows; none if there is nothing to tabulate.
    pub table: Option<(Vec<String>, Vec<Vec<String>>)>,
}
