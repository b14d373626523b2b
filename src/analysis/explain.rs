//! The story of a run, told from its numbers: what friction did to the precession, why the axis rose or fell,
//! and where the energy went.
//!
//! The argument is the paper's (V. Tanrıverdi, arXiv:2204.14060, sections 2 and 3): between the two rates of
//! regular precession θ̈ is negative, friction hurries the precession beyond the slow one, and so the top
//! rises.
//!
//! ```
//! use toprise::analysis::explain::explain;
//! use toprise::run::scenario::{Preset, Scenario};
//!
//! let mut values = Preset::find("paper")?.values()?;
//! values.set("stop.duration", "2.0")?;
//! let scenario = Scenario::new(values)?;
//! let story = explain(&scenario)?;
//! assert!(story.chapters.iter().any(|chapter| chapter.heading == "Why the axis moves"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod stages;
mod story;

use crate::analysis::course::Course;
use crate::analysis::subject::Subject;
use crate::run::scenario::Scenario;
use schemars::JsonSchema;
use serde::Serialize;
use stages::Stages;
use std::ops::ControlFlow;
use thiserror::Error;

/// The channels without which there is no story.
const NEEDED: [&str; 4] = ["/top/state", "/top/acceleration", "/top/energy", "/events"];

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

/// Why a run can't be explained.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ExplainError {
    /// Not one of ours.
    #[error("not a toprise recording: its story can't be told")]
    Foreign,
    /// Without the scenario nothing is known of the top.
    #[error("{0}")]
    NoScenario(String),
    /// A channel is missing.
    #[error("it has no {missing}: needed are {}", NEEDED.join(", "))]
    Channel {
        /// The channel.
        missing: &'static str,
    },
    /// It is empty.
    #[error("it has fewer than two samples")]
    Empty,
}

/// Everything that a story is made from.
struct Facts {
    scenario: Scenario,
    course: Course,
    stages: Stages,
    losses: Vec<String>,
    is_cut: bool,
}

/// Tells the story of a run.
///
/// # Errors
/// [`ExplainError`] if it lacks what is needed.
pub fn explain<'a>(subject: impl Into<Subject<'a>>) -> Result<Story, ExplainError> {
    let subject = subject.into();
    if !subject.is_ours() {
        return Err(ExplainError::Foreign);
    }
    if let Some(missing) = NEEDED.into_iter().find(|topic| !subject.has_topic(topic)) {
        return Err(ExplainError::Channel { missing });
    }
    let facts = gather(subject)?;
    if facts.stages.is_empty() {
        return Err(ExplainError::Empty);
    }
    Ok(story::tell(&facts))
}

fn gather(subject: Subject<'_>) -> Result<Facts, ExplainError> {
    let scenario = match subject {
        Subject::Scenario(scenario) => scenario.clone(),
        Subject::Recording(recording) => recording
            .scenario()
            .map_err(|error| ExplainError::NoScenario(error.to_string()))?,
    };
    let mut course = Course::default();
    let mut stages = Stages::new(scenario.model.top);
    let ended = subject.read(&subject.topics(), &mut |message, _| {
        course.take(message);
        stages.take(message);
        ControlFlow::Continue(())
    });
    course.end = ended.end;
    let mut losses = ended.losses;
    if let Subject::Recording(recording) = subject {
        losses.splice(0..0, recording.losses().iter().map(ToString::to_string));
    }
    Ok(Facts {
        scenario,
        is_cut: subject.is_cut() || !losses.is_empty(),
        course,
        stages,
        losses,
    })
}
