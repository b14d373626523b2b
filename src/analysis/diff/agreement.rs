//! Agreement of two runs that are different as a whole: one goes on for longer, or they part at an event.

use super::evidence::Evidence;
use super::findings::end_conditions;
use super::findings::finding::Finding;
use super::findings::quantity::{EndCondition, Quantity};
use super::topic::ChannelDifference;
use crate::analysis::history::RunHistory;
use crate::run::simulation::{EventKind, StopReason};
use crate::run::time::seconds;
use crate::telemetry::Topic;
use crate::telemetry::fields::{IMPACTS, STATE, state};
use crate::telemetry::side::Side;
use crate::words::{Piece, Sentence, sentence};
use schemars::JsonSchema;
use serde::Serialize;
use std::ops::{Bound, RangeBounds as _};

/// Extent to which the motions of two runs agree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Agreement {
    /// They agree as long as both run.
    WhileBothRun {
        /// Number of samples that both runs have.
        samples: u64,
        /// Precision of the agreement.
        precision: Precision,
        /// The ends of A and of B, if they differ.
        ends: Option<[RunEnd; 2]>,
    },
    /// They are bit-identical until a time, and differ afterwards.
    Until {
        /// The time, s.
        time: f64,
        /// The change of the forces at that time, if there is one.
        change: Option<Change>,
    },
}

/// A change of the forces at which two motions part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Change {
    /// An impact of the peg.
    Impact,
    /// An event of both runs.
    Event {
        /// The kind.
        event: EventKind,
    },
    /// An event of one run.
    EventOf {
        /// The run.
        side: Side,
        /// The kind.
        event: EventKind,
    },
}

/// Precision to which two motions agree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Precision {
    /// All values are bit-identical.
    Exact,
    /// No value differs by more than the integration error.
    IntegrationError {
        /// The largest difference of θ, rad.
        theta: f64,
    },
}

/// The end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RunEnd {
    /// Time, s.
    pub time: f64,
    /// The condition; absent if it is not recorded.
    pub condition: Option<EndCondition>,
}

/// Extent to which the motions agree; `None` if they differ from the start, or nothing shows why they part.
pub(super) fn agreement(
    evidence: &Evidence<'_>,
    findings: &[Finding],
    channels: &[ChannelDifference],
) -> Option<Agreement> {
    let sampled: Vec<_> = channels
        .iter()
        .filter(|channel| Topic::find(&channel.topic).is_some_and(|topic| topic.info().is_sampled))
        .collect();
    let motion = *sampled
        .iter()
        .find(|channel| channel.topic == STATE.name())?;
    let ends = ends(evidence)?;
    let common_end = ends[0].time.min(ends[1].time);
    // The last sample of a run that ends between two samples has no partner.
    let has_partners = sampled.iter().all(|channel| {
        channel
            .first_unmatched
            .is_none_or(|time| time >= common_end)
    });
    if motion.pairs == 0 || !has_partners {
        return None;
    }
    let precision = match first_different(&sampled) {
        None => Precision::Exact,
        Some(_) if sampled.iter().all(|channel| is_within_error(channel)) => {
            Precision::IntegrationError {
                theta: largest_of_theta(motion)?,
            }
        }
        Some(time) => return parting(evidence, channels, time),
    };
    let has_other_end = findings
        .iter()
        .any(|finding| matches!(finding.quantity, Quantity::End { .. }) && finding.differs());
    Some(Agreement::WhileBothRun {
        samples: motion.pairs,
        precision,
        ends: Some(ends).filter(|[a, b]| has_other_end && a.time != b.time),
    })
}

/// The ends of both runs.
fn ends(evidence: &Evidence<'_>) -> Option<[RunEnd; 2]> {
    let [a, b] = evidence.histories().map(RunHistory::stop_time);
    let times = [a?, b?];
    let conditions = end_conditions(evidence);
    Some(Side::BOTH.map(|side| RunEnd {
        time: times[side.index()],
        condition: conditions[side.index()],
    }))
}

/// Time of the first sample that is not bit-identical, s.
fn first_different(sampled: &[&ChannelDifference]) -> Option<f64> {
    sampled
        .iter()
        .flat_map(|channel| &channel.fields)
        .filter(|field| !field.is_derived)
        .filter_map(|field| field.first_different)
        .reduce(f64::min)
}

/// Whether no field of a topic differs by more than the integration error.
fn is_within_error(channel: &ChannelDifference) -> bool {
    channel
        .fields
        .iter()
        .filter(|field| !field.is_derived)
        .all(|field| field.first_different.is_none() || field.is_within_integration_error)
}

/// The largest difference of θ, rad.
fn largest_of_theta(motion: &ChannelDifference) -> Option<f64> {
    let theta = motion
        .fields
        .iter()
        .find(|field| field.field == state::THETA.path())?;
    Some(theta.largest.abs())
}

/// The longer of the sampling periods, at which both runs have samples, s.
fn sample_period(evidence: &Evidence<'_>) -> Option<f64> {
    let [a, b] = evidence
        .scenarios
        .each_ref()
        .map(|scenario| Some(scenario.as_ref()?.sample_period_ns));
    Some(seconds(a?.max(b?)))
}

/// Where two motions part, whose samples differ from this time on, s: at a change of the forces since the samples before, if
/// there is one. `None` if they part at the start.
fn parting(
    evidence: &Evidence<'_>,
    channels: &[ChannelDifference],
    first_different: f64,
) -> Option<Agreement> {
    let since = first_different - sample_period(evidence)?;
    // The motions start alike, whatever the forces.
    if since <= 0.0 {
        return None;
    }
    let near = (Bound::Excluded(since), Bound::Included(first_different));
    let [a, b] = evidence.histories().map(|run| {
        let mut events = Vec::new();
        for event in run.events.iter().filter(|event| near.contains(&event.time)) {
            if let Some(kind) = event.kind.filter(|kind| changes_forces(*kind)) {
                events.push((event.time, kind));
            }
        }
        events
    });
    let common = a.iter().rfind(|event| b.contains(event));
    let mut changes = Vec::new();
    if let Some(&(time, kind)) = common {
        changes.push((time, Change::Event { event: kind }));
    } else {
        for (side, events) in [(Side::A, &a), (Side::B, &b)] {
            changes.extend(
                events
                    .first()
                    .map(|&(time, kind)| (time, Change::EventOf { side, event: kind })),
            );
        }
    }
    let impact = first_other_impact(channels).filter(|time| near.contains(time));
    changes.extend(impact.map(|time| (time, Change::Impact)));
    let change = changes
        .into_iter()
        .min_by(|(one, _), (other, _)| one.total_cmp(other));
    Some(Agreement::Until {
        time: change.map_or(since, |(time, _)| time),
        change: change.map(|(_, change)| change),
    })
}

/// Time of the first impact that is not the same in both runs, s.
fn first_other_impact(channels: &[ChannelDifference]) -> Option<f64> {
    let impacts = channels
        .iter()
        .find(|channel| channel.topic == IMPACTS.name())?;
    let different = impacts
        .fields
        .iter()
        .filter_map(|field| field.first_different);
    different.chain(impacts.first_unmatched).reduce(f64::min)
}

/// Whether other forces act after an event of this kind than before it. Others only mark what the motion passes, and would
/// be near a difference by chance.
fn changes_forces(kind: EventKind) -> bool {
    match kind {
        EventKind::SlipStops
        | EventKind::Stick
        | EventKind::SlipResumes
        | EventKind::Rest
        | EventKind::LiftOff
        | EventKind::Landing
        | EventKind::RollBegins
        | EventKind::RollEnds
        | EventKind::Jam
        | EventKind::Pivot => true,
        EventKind::Start
        | EventKind::Risen
        | EventKind::Fallen
        | EventKind::NutationMinimum
        | EventKind::NutationMaximum
        | EventKind::UprightPassage
        | EventKind::LoopingBegins
        | EventKind::LoopingEnds
        | EventKind::Inverts
        | EventKind::WeakTop
        | EventKind::StrongTop
        | EventKind::Singular => false,
    }
}

impl RunEnd {
    /// The time of the end and the reason.
    fn sentence(self) -> Sentence {
        let time = Piece::time(self.time);
        match self.condition {
            None => time.into(),
            Some(EndCondition {
                reason: reason @ (StopReason::Risen | StopReason::Fallen),
                limit: Some(level),
            }) => sentence!(
                "{}, {} to {}",
                time,
                reason.words(),
                Piece::number(level, 3, "rad")
            ),
            Some(EndCondition { reason, .. }) => sentence!("{}, {}", time, reason.words()),
        }
    }
}

impl Agreement {
    /// How far the motions agree, and what ends the agreement.
    pub fn sentence(self) -> Sentence {
        match self {
            Self::WhileBothRun {
                samples,
                precision,
                ends,
            } => {
                let samples = Piece::count(samples, "sample");
                let precision = match precision {
                    Precision::Exact => sentence!("{} are identical, bit for bit.", samples),
                    Precision::IntegrationError { theta } => sentence!(
                        "{} differ by no more than the integration error, θ by {} at most.",
                        samples,
                        Piece::number(theta, 2, "rad")
                    ),
                };
                let ends = ends.map(ends_sentence).unwrap_or_default();
                sentence!(
                    "As long as both run, the motions agree: {}{}",
                    precision,
                    ends
                )
            }
            Self::Until { time, change } => sentence!(
                "The motions are identical, bit for bit, until {}{}.",
                Piece::time(time),
                change.map(Change::sentence).unwrap_or_default()
            ),
        }
    }
}

impl Change {
    /// What changes, after the time of the change.
    fn sentence(self) -> Sentence {
        match self {
            Self::Impact => sentence!(", when an impact parts them"),
            Self::Event { event } => sentence!(", the event “{}”", event.words(1)),
            Self::EventOf { side, event } => {
                sentence!(", {}'s event “{}”", side.name(), event.words(1))
            }
        }
    }
}

/// Which run ends first, and why.
fn ends_sentence(ends: [RunEnd; 2]) -> Sentence {
    let shorter = if ends[0].time < ends[1].time {
        Side::A
    } else {
        Side::B
    };
    let longer = shorter.other();
    sentence!(
        " {} ends first, at {}; {} ends at {}.",
        shorter.name(),
        ends[shorter.index()].sentence(),
        longer.name(),
        ends[longer.index()].sentence()
    )
}
