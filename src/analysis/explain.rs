//! Explanation of a run: events, motion of the axis, energy balance.
//!
//! It follows the argument of the paper (sections 2 and 3): between the two rates of regular precession, θ̈ is
//! negative; friction drives the precession above the slow rate, so the top rises.
//!
//! ```
//! use toprise::analysis::explain::explain;
//! use toprise::run::scenario::{Preset, Scenario};
//!
//! let mut values = Preset::find("paper")?.values()?;
//! values.set("stop.duration", "2.0")?;
//! let scenario = Scenario::new(values)?;
//! let explanation = explain(&scenario)?;
//! assert!(explanation.chapters.iter().any(|chapter| chapter.heading == "Why the axis moves"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod causes;
mod chapters;
mod claim;
mod evidence;
mod fact;
mod momentum;
mod observations;
mod precession;
mod sections;
mod story;
mod time_span;

pub use self::claim::{Claim, Hold, Inversion, Stopped, SufficientSpin, Weakness};
use self::evidence::Evidence;
pub use self::fact::ENERGY_ZERO;
pub use self::fact::{Fact, PrecessionRoot};
use self::observations::Observations;
pub use self::precession::Stage;
pub use self::story::Story;
use self::story::story;
pub use self::time_span::TimeSpan;

use crate::analysis::history::{RunHistory, RunSummary};
use crate::analysis::subject::{ReadEnd, Subject};
use crate::archive::recording::RecordingError;
use crate::physics::top::Top;
use crate::run::scenario::Scenario;
use crate::run::simulation::{EventKind, StopReason};
use crate::telemetry::fields::{ACCELERATION, ENERGY, EVENTS, NUTATION, STATE};
use crate::telemetry::{Message, Topic, Topics};
use crate::words::Piece;
use schemars::JsonSchema;
use serde::Serialize;
use thiserror::Error;

/// The topics that an explanation needs.
const NEEDED: [Topic; 4] = [STATE, ACCELERATION, ENERGY, EVENTS];

/// The reason why a run can't be explained.
#[derive(Debug, Error)]
pub enum ExplainError {
    /// The file is not a recording of toprise.
    #[error("not a toprise recording")]
    Foreign,
    /// The recording lacks a topic.
    #[error("it has no {missing}; required topics: {}", NEEDED.map(Topic::name).join(", "))]
    MissingTopic {
        /// The first topic that it lacks.
        missing: Topic,
    },
    /// The scenario of the recording can't be read.
    #[error(transparent)]
    Scenario(#[from] RecordingError),
    /// The explanation was cancelled.
    #[error("interrupted")]
    Interrupted,
    /// There is no motion between samples.
    #[error(
        "it has fewer than two samples ({})",
        match loss {
            Some(loss) => loss.clone(),
            None => "set a shorter sampling.period or a longer stop.duration".to_owned(),
        }
    )]
    TooFewSamples {
        /// The first part of the run that could not be read.
        loss: Option<String>,
    },
}

/// The explanation of a run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "ExplainReport")]
pub struct Explanation {
    /// The run and its end.
    pub title: String,
    /// The causes of the motion; without claims for a recording from which something is missing.
    pub story: Story,
    /// The facts, chapter by chapter.
    pub chapters: Vec<Chapter>,
    /// The kinds of events, in the order of their first times; empty for a recording with gaps, which may lack some.
    pub events: Vec<EventSummary>,
    /// The averaged motion in stages of equally many nutations; empty for a recording with gaps.
    pub stages: Vec<Stage>,
    /// A summary of the run.
    pub summary: RunSummary,
    /// Parts that could not be read.
    pub losses: Vec<String>,
}

/// Facts under a heading.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Chapter {
    /// The heading.
    pub heading: &'static str,
    /// The facts.
    pub facts: Vec<Fact>,
}

/// Events of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EventSummary {
    /// The kind of event.
    pub name: String,
    /// Number of times.
    pub count: u64,
    /// Time of the first, s.
    pub first: f64,
    /// Time of the last, s.
    pub last: f64,
    /// The description of the first.
    pub description: String,
}

/// Explains a run.
///
/// # Errors
/// [`ExplainError`] if it isn't a run of toprise, or lacks what is needed.
pub fn explain<'a>(subject: impl Into<Subject<'a>>) -> Result<Explanation, ExplainError> {
    explain_while(subject, &|| true)
}

/// Like [`explain`], but cancelled if `carry_on`, called for each message, returns false.
///
/// # Errors
/// As [`explain`], and if it is cancelled.
pub fn explain_while<'a>(
    subject: impl Into<Subject<'a>>,
    carry_on: &dyn Fn() -> bool,
) -> Result<Explanation, ExplainError> {
    let subject = subject.into();
    if !subject.is_ours() {
        return Err(ExplainError::Foreign);
    }
    for topic in NEEDED {
        if !subject.has_topic(topic) {
            return Err(ExplainError::MissingTopic { missing: topic });
        }
    }
    let scenario = match subject {
        Subject::Scenario(scenario) => scenario.clone(),
        Subject::Recording(recording) => recording.scenario()?,
    };
    let mut explainer = Explainer::new(&scenario);
    let ended = subject.read(&Topics::All, &mut |message, _| {
        explainer.take(message);
        carry_on()
    });
    // `read` ends without an error when it is told to.
    if !carry_on() {
        return Err(ExplainError::Interrupted);
    }
    explainer.finish(ended)
}

/// Explains a run while its messages are made or read.
///
/// ```
/// use toprise::analysis::explain::Explainer;
/// use toprise::analysis::subject::ReadEnd;
/// use toprise::archive::format::end_entries;
/// use toprise::run::scenario::{Preset, Scenario};
/// use toprise::run::simulation::Simulation;
/// use toprise::telemetry::Telemetry;
///
/// let mut values = Preset::find("frictionless")?.values()?;
/// values.set("stop.duration", "0.2")?;
/// let scenario = Scenario::new(values)?;
/// let mut explainer = Explainer::new(&scenario);
/// let (mut simulation, mut telemetry) = (Simulation::new(&scenario)?, Telemetry::default());
/// while let Some(record) = simulation.next() {
///     telemetry.messages(&record?, |message| {
///         explainer.take(message);
///         Ok::<_, Box<dyn std::error::Error>>(())
///     })?;
/// }
/// let ended = ReadEnd {
///     end: Some(end_entries(&simulation.end())),
///     ..ReadEnd::default()
/// };
/// let story = explainer.finish(ended)?.story.text().unwrap();
/// assert!(story.starts_with("Without friction, nothing changed the energy"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Explainer {
    scenario: Scenario,
    history: RunHistory,
    observations: Observations,
}

impl Explainer {
    /// Creates an explainer of a run of this scenario.
    pub fn new(scenario: &Scenario) -> Self {
        Self {
            history: RunHistory::new(Some(scenario)),
            observations: Observations::new(&scenario.model),
            scenario: scenario.clone(),
        }
    }

    /// Takes the next message, in the order of time.
    pub fn take(&mut self, message: &Message<'_>) {
        self.history.take(message);
        self.observations.take(message);
    }

    /// Explains the run after its last message.
    ///
    /// # Errors
    /// [`ExplainError`] if there are too few samples.
    pub fn finish(mut self, ended: ReadEnd) -> Result<Explanation, ExplainError> {
        self.history.finish(ended.end, ended.missing);
        self.observations.finish();
        if !has_motion(&self.history) {
            return Err(ExplainError::TooFewSamples {
                loss: ended.losses.into_iter().next(),
            });
        }
        Ok(explanation(Evidence {
            summary: self.history.summary(),
            peg_intervals: self.history.peg_intervals(),
            scenario: self.scenario,
            history: self.history,
            observations: self.observations,
            losses: ended.losses,
        }))
    }
}

/// Whether there are two samples, or the run ended in a state from which nothing moves before the second.
fn has_motion(history: &RunHistory) -> bool {
    let Some([first, last]) = history.states else {
        return false;
    };
    first.time < last.time || history.stop_reason() == Some(StopReason::Rest)
}

fn explanation(evidence: Evidence) -> Explanation {
    // Counts and averages of a recording with gaps are not those of the run.
    let history = &evidence.history;
    let lacks_averages = history.has_gaps || history.lacks(NUTATION);
    let lacks_events = history.has_gaps || history.lacks(EVENTS);
    // A cause must hold for all of the run.
    let story = if evidence.losses.is_empty() && !lacks_averages && !lacks_events {
        story(&evidence)
    } else {
        Story::default()
    };
    let motion = if lacks_averages || lacks_events {
        vec![chapters::start(&evidence)]
    } else {
        chapters::motion(&evidence)
    };
    let mut cause: Vec<Fact> = story.claims.iter().flat_map(Claim::facts).collect();
    if !lacks_averages && !history.lacks(ACCELERATION) {
        cause.extend(chapters::cause(&evidence));
    }
    let mut chapters = vec![
        Chapter {
            heading: "What happened",
            facts: motion,
        },
        Chapter {
            heading: if evidence.scenario.is_frictionless() {
                "How the axis moves"
            } else {
                "Why the axis moves"
            },
            facts: cause,
        },
        Chapter {
            heading: "Where the energy goes",
            facts: chapters::energy(&evidence),
        },
    ];
    chapters.retain(|chapter| !chapter.facts.is_empty());
    Explanation {
        title: title(&evidence),
        story,
        chapters,
        events: if lacks_events {
            Vec::new()
        } else {
            event_summaries(history, &evidence.scenario.model.top)
        },
        stages: if lacks_averages {
            Vec::new()
        } else {
            precession::stages(&evidence)
        },
        summary: evidence.summary,
        losses: evidence.losses,
    }
}

fn title(evidence: &Evidence) -> String {
    let history = &evidence.history;
    let scenario = evidence.scenario.title();
    let end = Piece::time(history.stop_time().unwrap_or(0.0));
    match history.stop_reason() {
        Some(reason) if history.is_recorded_to_end() => {
            format!("{scenario}: {} at t = {end}", reason.sentence())
        }
        _ => format!("{scenario}: incomplete, recorded until t = {end}"),
    }
}

/// Event kinds, without nutation extremes.
fn event_summaries(history: &RunHistory, top: &Top) -> Vec<EventSummary> {
    let mut summaries: Vec<EventSummary> = Vec::new();
    for event in &history.events {
        let Some(kind) = event.kind else { continue };
        if kind == EventKind::Start || kind.is_nutation_extreme() {
            continue;
        }
        match summaries.iter_mut().find(|known| known.name == kind.name()) {
            Some(known) => (known.count, known.last) = (known.count + 1, event.time),
            None => summaries.push(EventSummary {
                name: kind.name().to_owned(),
                count: 1,
                first: event.time,
                last: event.time,
                description: kind.sentence(top, event.state).to_string(),
            }),
        }
    }
    summaries
}
