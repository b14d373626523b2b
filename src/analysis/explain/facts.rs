//! The facts that a story is made from.

use super::stages::Stages;
use crate::analysis::course::Course;
use crate::analysis::subject::Subject;
use crate::run::scenario::Scenario;
use crate::telemetry::fields::{ACCELERATION, ENERGY, EVENTS, STATE};
use crate::telemetry::{Topic, Topics};
use std::ops::ControlFlow;
use thiserror::Error;

/// The channels without which there is no story.
const NEEDED: [Topic; 4] = [STATE, ACCELERATION, ENERGY, EVENTS];

/// Why a run can't be explained.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ExplainError {
    /// The recording was not made by toprise.
    #[error("not a toprise recording: its story can't be told")]
    Foreign,
    /// The recording's scenario can't be read, so nothing is known of the top.
    #[error("{0}")]
    NoScenario(String),
    /// A channel is missing.
    #[error("it has no {missing}: needed are {}", NEEDED.map(Topic::name).join(", "))]
    Channel {
        /// The channel.
        missing: Topic,
    },
    /// The run is empty.
    #[error("it has fewer than two samples")]
    Empty,
}

/// The facts of a run.
pub(super) struct Facts {
    pub(super) scenario: Scenario,
    pub(super) course: Course,
    pub(super) stages: Stages,
    pub(super) losses: Vec<String>,
    pub(super) is_cut: bool,
}

/// Reads a run for its story.
pub(super) fn gather(subject: Subject<'_>) -> Result<Facts, ExplainError> {
    if !subject.is_ours() {
        return Err(ExplainError::Foreign);
    }
    if let Some(missing) = NEEDED.into_iter().find(|topic| !subject.has_topic(*topic)) {
        return Err(ExplainError::Channel { missing });
    }
    let scenario = match subject {
        Subject::Scenario(scenario) => scenario.clone(),
        Subject::Recording(recording) => recording
            .scenario()
            .map_err(|error| ExplainError::NoScenario(error.to_string()))?,
    };
    let mut course = Course::default();
    let mut stages = Stages::new(scenario.model.top);
    let ended = subject.read(&Topics::All, &mut |message, _| {
        course.take(message);
        stages.take(message);
        ControlFlow::Continue(())
    });
    course.end = ended.end;
    let mut losses = ended.losses;
    if let Subject::Recording(recording) = subject {
        losses.splice(0..0, recording.losses().iter().map(ToString::to_string));
    }
    if stages.is_empty() {
        return Err(ExplainError::Empty);
    }
    Ok(Facts {
        scenario,
        is_cut: subject.is_cut() || !losses.is_empty(),
        course,
        stages,
        losses,
    })
}
