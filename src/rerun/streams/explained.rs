//! A Rerun stream whose first page says why the top moves as it does.

use super::run::RerunSink;
use crate::analysis::explain::Explainer;
use crate::analysis::subject::ReadEnd;
use crate::archive::format::end_entries;
use crate::archive::sink::{Sink, SinkError};
use crate::rerun::error::{RerunError, ViewerError};
use crate::rerun::identity::Identity;
use crate::rerun::output::Destinations;
use crate::run::outcome::Outcome;
use crate::run::scenario::Scenario;
use crate::telemetry::Message;

/// A Rerun stream of a run, and the explanation of the run, made from the same messages.
pub struct ExplainedSink {
    sink: RerunSink,
    explainer: Explainer,
}

impl ExplainedSink {
    /// Opens the destinations of a run of this scenario.
    pub fn new(scenario: &Scenario, identity: &Identity, destinations: Destinations) -> Self {
        Self {
            sink: RerunSink::new(identity, destinations),
            explainer: Explainer::new(scenario),
        }
    }

    /// Whether data is being sent to a viewer, as far as is known.
    pub fn is_live(&self) -> bool {
        self.sink.is_live()
    }

    /// Viewer warnings since the last call.
    pub fn take_warnings(&mut self) -> Vec<ViewerError> {
        self.sink.take_warnings()
    }

    /// Adds the outcome of a complete run, and the reason for the motion if it is known.
    pub fn set_outcome(&mut self, outcome: &Outcome) {
        self.sink.set_outcome(outcome);
        let ended = ReadEnd {
            end: Some(end_entries(&outcome.end)),
            ..ReadEnd::default()
        };
        // A run that is too short to be explained is shown without an explanation.
        let Ok(explanation) = self.explainer.clone().finish(ended) else {
            return;
        };
        if let Some(story) = explanation.story.text() {
            self.sink.set_story(&story);
        }
    }

    /// Completes the stream. Returns pending warnings.
    ///
    /// # Errors
    /// [`RerunError`] if the file could not be written.
    pub fn finish(self) -> Result<Vec<ViewerError>, RerunError> {
        self.sink.finish()
    }
}

impl Sink for ExplainedSink {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        self.explainer.take(message);
        self.sink.write(message)
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        self.sink.flush()
    }
}
