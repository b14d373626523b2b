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

mod evidence;
mod fact;
mod fixed;
mod free;
mod precession;

use self::evidence::Evidence;
pub use self::fact::Fact;
pub use self::precession::Stage;

use crate::analysis::history::{RunHistory, RunSummary};
use crate::analysis::phrase::moment;
use crate::analysis::subject::Subject;
use crate::archive::format::STOP_REASON;
use crate::run::simulation::{EventKind, StopReason};
use crate::telemetry::fields::{ACCELERATION, ENERGY, EVENTS, NUTATION, STATE};
use crate::telemetry::{Topic, Topics};
use schemars::JsonSchema;
use serde::Serialize;
use thiserror::Error;

/// The topics that an explanation needs.
const NEEDED: [Topic; 4] = [STATE, ACCELERATION, ENERGY, EVENTS];

/// The reason why a run can't be explained.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct ExplainError(String);

/// The explanation of a run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Explanation {
    /// The run and its end.
    pub title: String,
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
    let evidence = gather(subject.into(), carry_on)?;
    let [motion, cause, energy] = if evidence.scenario.model.support.is_free() {
        [free::motion, free::cause, free::energy]
    } else {
        [fixed::motion, fixed::cause, fixed::energy]
    };
    // Counts and averages of a recording with gaps are not those of the run.
    let history = &evidence.history;
    let lacks_averages = history.has_gaps || history.lacks(NUTATION);
    let lacks_events = history.has_gaps || history.lacks(EVENTS);
    let motion = if lacks_averages || lacks_events {
        vec![fixed::start(&evidence)]
    } else {
        motion(&evidence)
    };
    let cause = if lacks_averages || history.lacks(ACCELERATION) {
        Vec::new()
    } else {
        cause(&evidence)
    };
    let events = if lacks_events {
        Vec::new()
    } else {
        event_summaries(history)
    };
    let stages = if lacks_averages {
        Vec::new()
    } else {
        precession::stages(&evidence)
    };
    let chapter = |heading, facts| Chapter { heading, facts };
    let mut chapters = vec![
        chapter("What happened", motion),
        chapter("Why the axis moves", cause),
        chapter("Where the energy goes", energy(&evidence)),
    ];
    chapters.retain(|chapter| !chapter.facts.is_empty());
    Ok(Explanation {
        title: title(&evidence),
        chapters,
        events,
        stages,
        summary: evidence.summary,
        losses: evidence.losses,
    })
}

/// Reads a run.
fn gather(subject: Subject<'_>, carry_on: &dyn Fn() -> bool) -> Result<Evidence, ExplainError> {
    let refused = |reason: String| Err(ExplainError(reason));
    if !subject.is_ours() {
        return refused("not a toprise recording".to_owned());
    }
    if let Some(missing) = NEEDED.into_iter().find(|topic| !subject.has_topic(*topic)) {
        let needed = NEEDED.map(Topic::name).join(", ");
        return refused(format!("it has no {missing}; required topics: {needed}"));
    }
    let scenario = match subject {
        Subject::Scenario(scenario) => scenario.clone(),
        Subject::Recording(recording) => recording
            .scenario()
            .map_err(|error| ExplainError(error.to_string()))?,
    };
    let mut history = RunHistory::new(Some(scenario.model), None);
    let peg_radius = scenario.model.top.peg_radius;
    history.set_flight_at_start(scenario.start().is_in_flight(peg_radius));
    let ended = subject.read(&Topics::All, &mut |message, _| {
        history.take(message);
        carry_on()
    });
    if !carry_on() {
        return refused("interrupted".to_owned());
    }
    history.finish(ended.end, ended.missing);
    let losses = ended.losses;
    let has_samples = history
        .states
        .is_some_and(|[first, last]| first.time < last.time);
    if !has_samples {
        let reason = losses.first().map_or_else(
            || "set a shorter sampling.period or a longer stop.duration".to_owned(),
            |loss| format!("missing: {loss}"),
        );
        return refused(format!("it has fewer than two samples ({reason})"));
    }
    Ok(Evidence {
        summary: history.summary(),
        peg_intervals: history.peg_intervals(),
        scenario,
        history,
        losses,
    })
}

fn title(evidence: &Evidence) -> String {
    let reason = evidence.history.end_entry(STOP_REASON);
    let mut known = StopReason::ALL.into_iter();
    let reason = known.find(|stop| Some(stop.name()) == reason);
    let scenario = evidence.scenario.title();
    let end = moment(evidence.history.stop_time().unwrap_or(0.0));
    match reason {
        Some(reason) if evidence.history.is_recorded_to_end() => {
            format!("{scenario}: {} at t = {end}", reason.sentence())
        }
        _ => format!("{scenario}: incomplete, recorded until t = {end}"),
    }
}

/// Event kinds, without nutation extremes.
fn event_summaries(history: &RunHistory) -> Vec<EventSummary> {
    let mut event_summaries: Vec<EventSummary> = Vec::new();
    let is_listed = |kind: EventKind| kind != EventKind::Start && !kind.is_of_nutation();
    let events = history.events.iter();
    let events = events.filter_map(|event| Some((event.kind?, event)));
    for (kind, event) in events.filter(|(kind, _)| is_listed(*kind)) {
        let mut known = event_summaries.iter_mut();
        match known.find(|known| known.name == kind.name()) {
            Some(known) => (known.count, known.last) = (known.count + 1, event.time),
            None => event_summaries.push(EventSummary {
                name: kind.name().to_owned(),
                count: 1,
                first: event.time,
                last: event.time,
                description: event.description.clone(),
            }),
        }
    }
    event_summaries
}
