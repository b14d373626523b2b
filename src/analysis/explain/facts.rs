//! The facts that a story is made from.

use super::pieces::Pieces;
use super::stages::{Stage, stages};
use crate::analysis::course::{Course, CourseReport};
use crate::analysis::phrase::{pair, quantity};
use crate::analysis::subject::Subject;
use crate::archive::format::STEPS;
use crate::run::scenario::Scenario;
use crate::run::simulation::EventKind;
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
    #[error("{}", .without.as_ref().map_or_else(|| "it has fewer than two samples".to_owned(), |loss| format!("it lacks {loss}")))]
    Empty {
        /// What of it could not be read or simulated.
        without: Option<String>,
    },
    /// Nobody wanted the story any more.
    #[error("it was interrupted before the run was read to its end")]
    Interrupted,
}

/// The facts of a run.
pub(super) struct Facts {
    pub(super) scenario: Scenario,
    pub(super) course: Course,
    pub(super) pieces: Pieces,
    pub(super) stages: Vec<Stage>,
    /// The channels that there are.
    pub(super) topics: Vec<Topic>,
    pub(super) losses: Vec<String>,
    pub(super) is_cut: bool,
}

/// Steps in which the integrator takes a nutation at its usual tolerances, about, where the number of all steps is not
/// recorded: 10 at tolerances of 1e-6, 20 to 30 at 1e-12.
const STEPS_PER_NUTATION: f64 = 30.0;

impl Facts {
    /// What the errors of the integrator can have added up to in a quantity of this size: in each step as much as its
    /// tolerance. Below it nothing is told.
    pub(super) fn floor(&self, size: f64) -> f64 {
        let end = self.course.end.as_ref();
        let steps = end
            .and_then(|end| end.get(STEPS)?.parse::<f64>().ok())
            .unwrap_or(STEPS_PER_NUTATION * (self.course.cycles.len() + 1) as f64);
        let tolerances = &self.scenario.tolerances;
        // A run of a few steps is still rounded.
        steps.max(10.0) * (tolerances.absolute + tolerances.relative * size.abs())
    }

    /// A value, or zero if it is nothing beside `size`, the size that the quantity has, but the integrator's errors.
    pub(super) fn or_zero(&self, value: f64, size: f64) -> f64 {
        if value.abs() <= self.floor(size) {
            0.0
        } else {
            value
        }
    }

    /// Two values of a quantity, as "went from … to …", or as "stayed at …" if they don't differ by more than the
    /// integrator's errors.
    pub(super) fn went(&self, values: [f64; 2], unit: &str) -> String {
        let [first, last] = values;
        if (last - first).abs() <= self.floor(first.abs().max(last.abs())) {
            return format!("stayed at {}", quantity(last, 5, unit));
        }
        let size = first.abs().max(last.abs());
        let [begun, ended] = pair(values.map(|value| self.or_zero(value, size)));
        format!("went from {begun} to {ended} {unit}")
    }

    /// That the energy stayed as it was, if it did.
    pub(super) fn energy_stayed(&self, course: &CourseReport) -> Option<String> {
        let (first, last) = (course.energy_first?, course.energy_last?);
        let change = (last - first).abs();
        let stayed = self.scenario.is_frictionless() || change <= self.floor(first);
        // Friction only takes, so that it changed most to the end; without friction all change is imbalance.
        let most = change.max(course.energy_imbalance?);
        stayed.then(|| {
            format!(
                "The energy stayed at {}, to {}.",
                quantity(first, 6, "J"),
                quantity(most, 2, "J")
            )
        })
    }

    /// Whether there is a channel with this topic.
    pub(super) fn has(&self, topic: Topic) -> bool {
        self.topics.contains(&topic)
    }

    /// How many events of a kind there are.
    pub(super) fn count(&self, kind: EventKind) -> u64 {
        let events = self.course.events.iter();
        events.filter(|event| event.name == kind.name()).count() as u64
    }

    /// The time of the last sample, s.
    pub(super) fn last_time(&self) -> f64 {
        self.pieces.ends.map_or(0.0, |[_, (time, _)]| time)
    }
}

/// Reads a run for its story.
pub(super) fn gather(
    subject: Subject<'_>,
    carry_on: &dyn Fn() -> bool,
) -> Result<Facts, ExplainError> {
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
    let mut course = Course::of(Some(scenario.model));
    let mut pieces = Pieces::new(scenario.model);
    let ended = subject.read(&Topics::All, &mut |message, _| {
        course.take(message);
        pieces.take(message);
        match carry_on() {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    });
    if !carry_on() {
        return Err(ExplainError::Interrupted);
    }
    pieces.finish();
    course.finish(ended.end);
    let mut losses = ended.losses;
    if let Subject::Recording(recording) = subject {
        losses.splice(0..0, recording.losses().iter().map(ToString::to_string));
    }
    if pieces.samples < 2 {
        return Err(ExplainError::Empty {
            without: losses.into_iter().next(),
        });
    }
    let mut facts = Facts {
        scenario,
        is_cut: subject.is_cut() || !losses.is_empty(),
        course,
        pieces,
        stages: Vec::new(),
        topics: subject.topics(),
        losses,
    };
    // Angles are of the order of 1.
    let floor = facts.floor(1.0);
    let is_lossless = !facts.scenario.model.friction.has_losses();
    facts.stages = stages(&facts.pieces.path, &facts.course.events, floor, is_lossless);
    Ok(facts)
}
