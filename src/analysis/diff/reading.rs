//! Two runs read side by side.
//!
//! Each run is read by a thread of its own (`stream`), which hands over batches of messages. The run that is behind
//! is taken from next, so that little waits for a counterpart. What is kept doesn't grow with the number of samples:
//! events, nutation cycles, and a few sums for each field.

use super::budget::Energies;
use super::discrepancy::Residuals;
use super::error::DiffError;
use super::item::Item;
use super::lane::Frontier;
use super::nutation::end_with_nutation;
use super::observer::Observer;
use super::plan::ComparisonPlan;
use super::rule::Rule;
use super::stream::{Batch, Parcel, read};
use super::tolerance::{Tolerances, full_name};
use super::topic::ComparedTopic;
use super::topics::{is_view, some_of};
use super::touch::Touches;
use crate::analysis::course::Course;
use crate::analysis::subject::{Ended, Subject};
use crate::archive::sink::SinkError;
use crate::telemetry::fields::ENERGY;
use crate::telemetry::side::Side;
use crate::telemetry::{Message, Topic};
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;

/// Batches that may wait on each side.
const WAITING: usize = 4;
/// No more memory than this is held by messages that wait for their counterparts, bytes.
const MOST_HELD: usize = 1 << 29;

/// What was found in reading two runs.
#[derive(Debug)]
pub(super) struct Findings {
    /// What was found in A and in B.
    pub(super) runs: [RunFindings; 2],
    /// The topics of the plan; none for those that are not compared.
    pub(super) topics: Vec<Option<ComparedTopic>>,
    /// The energies of A and of B at equal times.
    pub(super) common: [Energies; 2],
    /// The differences of the two models at A's states, if both scenarios are known.
    pub(super) residuals: Option<Residuals>,
}

impl Findings {
    /// The topics that are compared.
    pub(super) fn compared(&self) -> impl Iterator<Item = &ComparedTopic> {
        self.topics.iter().flatten()
    }

    /// The time up to which both runs have messages, ns.
    pub(super) fn common_end(&self) -> Option<u64> {
        let spans = self.runs.iter().filter_map(|run| run.span);
        spans.map(|(_, last)| last).min()
    }
}

/// What was found in reading one run.
#[derive(Debug, Default)]
pub(super) struct RunFindings {
    /// What happened in it, if it is of toprise.
    pub(super) course: Course,
    /// When θ first was at the levels of both.
    pub(super) touches: Touches,
    /// Its energy.
    pub(super) energies: Energies,
    /// How many messages were read.
    pub(super) messages: u64,
    /// The times of the first and the last message, ns.
    pub(super) span: Option<(u64, u64)>,
    /// What could not be read.
    pub(super) losses: Vec<String>,
    /// What must be known of what was read.
    pub(super) remarks: Vec<String>,
    frontier: Frontier,
}

/// Reads both runs.
pub(super) fn read_both(
    runs: [Subject<'_>; 2],
    plan: &ComparisonPlan,
    tolerances: &Tolerances,
    observer: &mut dyn Observer,
) -> Result<Findings, DiffError> {
    let mut reading = Reading::new(runs, plan, tolerances, observer)?;
    let are_views_wanted = &AtomicBool::new(true);
    thread::scope(|scope| {
        let incoming = runs.map(|run| {
            let (out, incoming) = sync_channel(WAITING);
            scope.spawn(move || read(run, plan, are_views_wanted, &out));
            incoming
        });
        reading.take_all(&incoming, are_views_wanted)
    })?;
    reading.finish()
}

/// A comparison under way.
struct Reading<'p> {
    plan: &'p ComparisonPlan,
    tolerances: &'p Tolerances,
    observer: &'p mut dyn Observer,
    findings: Findings,
    /// How many messages have come since pairs were looked for.
    unpaired: usize,
    /// How much memory is held by messages that wait for their counterparts, bytes.
    held: usize,
}

impl<'p> Reading<'p> {
    fn new(
        runs: [Subject<'_>; 2],
        plan: &'p ComparisonPlan,
        tolerances: &'p Tolerances,
        observer: &'p mut dyn Observer,
    ) -> Result<Self, DiffError> {
        let models = runs.map(|run| run.scenario().map(|scenario| scenario.model));
        let residuals = match models {
            [Some(a), Some(b)] => Residuals::new(a, b),
            _ => None,
        };
        let topics = plan.topics.iter().zip(&plan.rules);
        let topics = topics.map(|(topic, rule)| Some(ComparedTopic::new(topic, rule.clone()?)));
        let mut reading = Self {
            findings: Findings {
                runs: models.map(|model| RunFindings {
                    course: Course::of(model),
                    touches: Touches::new(plan.levels.common),
                    ..RunFindings::default()
                }),
                topics: topics.collect(),
                common: Default::default(),
                residuals,
            },
            unpaired: 0,
            held: 0,
            plan,
            tolerances,
            observer,
        };
        if plan.are_ours {
            let missing = runs.map(missing_fields);
            for (topic, compared) in Topic::all().zip(&mut reading.findings.topics) {
                if let Some(compared) = compared {
                    compared.tally.add_table(topic, &missing, tolerances);
                    let at_same_times = compared.lane.rule == Rule::SameTime { finer: None };
                    if at_same_times && !plan.clock.is_shifted() {
                        compared.tally.count_sequences();
                    }
                }
            }
            reading.check_patterns()?;
        }
        Ok(reading)
    }

    /// Refuses tolerances for fields that there are none of.
    fn check_patterns(&self) -> Result<(), DiffError> {
        let compared = self.findings.compared();
        let known: Vec<String> = compared.flat_map(|topic| topic.tally.names()).collect();
        let unmatched = self.tolerances.unmatched(&known, &self.plan.ignored);
        unmatched.map_or(Ok(()), Err)
    }

    /// Takes everything that comes, always from the run that is behind.
    fn take_all(
        &mut self,
        incoming: &[Receiver<Parcel>; 2],
        are_views_wanted: &AtomicBool,
    ) -> Result<(), DiffError> {
        while let Some(side) = self.behind() {
            match incoming[side.index()].recv() {
                Ok(Parcel::Batch(batch)) => self.take(side, batch)?,
                Ok(Parcel::End { ended, remarks }) => self.end(side, ended, remarks),
                // Its thread has died.
                Err(_) => self.end(side, Ended::default(), Vec::new()),
            }
            // Looking for pairs takes as long as there are topics: it must not be done for each of their messages.
            let is_due = self.unpaired >= self.plan.topics.len();
            if is_due || self.held > MOST_HELD || self.behind().is_none() {
                self.pair()?;
                self.leave_views(are_views_wanted);
            }
        }
        Ok(())
    }

    /// The run of which less has been read, unless both have ended.
    fn behind(&self) -> Option<Side> {
        let [a, b] = &self.findings.runs;
        // Where B has nothing to compare with, nothing of B is needed.
        let in_b = self.plan.map.target(a.frontier.time_ns);
        let in_b = in_b.map_or(0, |at| at.ns);
        match [a.frontier.is_ended, b.frontier.is_ended] {
            [true, true] => None,
            [false, true] => Some(Side::A),
            [true, false] => Some(Side::B),
            // What comes in the same place may be at any time.
            _ if self.plan.is_by_index => Some(match a.messages <= b.messages {
                true => Side::A,
                false => Side::B,
            }),
            _ if (in_b, a.messages) <= (b.frontier.time_ns, b.messages) => Some(Side::A),
            _ => Some(Side::B),
        }
    }

    fn end(&mut self, side: Side, ended: Ended, remarks: Vec<String>) {
        let run = &mut self.findings.runs[side.index()];
        run.frontier.is_ended = true;
        run.losses = ended.losses;
        run.remarks = remarks;
        run.course.finish(ended.end);
    }

    fn take(&mut self, side: Side, batch: Batch) -> Result<(), DiffError> {
        self.observer.progress(batch.bytes);
        for (topic, names) in batch.fields {
            if let Some(compared) = &mut self.findings.topics[topic] {
                for name in names {
                    compared.tally.learn(side, &name, self.tolerances);
                }
            }
        }
        self.unpaired += batch.messages.len();
        for message in batch.messages {
            self.take_message(side, message)?;
        }
        Ok(())
    }

    fn take_message(&mut self, side: Side, mut message: Item) -> Result<(), DiffError> {
        let time_ns = message.time_ns;
        let run = &mut self.findings.runs[side.index()];
        // In a recording of toprise, messages of other channels tell nothing of the run.
        if !self.plan.are_ours || message.rest.is_none() {
            run.messages += 1;
            let (first, last) = run.span.unwrap_or((time_ns, time_ns));
            run.span = Some((first.min(time_ns), last.max(time_ns)));
        }
        if self.plan.are_ours && message.rest.is_none() && !message.is_misplaced {
            let seen = message.as_message();
            run.course.take(&seen);
            run.touches.take(&seen);
            run.energies.take(&seen);
            self.observer.message(side, &seen)?;
            if side == Side::A
                && let Some(residuals) = &mut self.findings.residuals
            {
                residuals.take(&seen);
            }
        }
        message.time_ns = self.plan.clock.time(side, time_ns);
        // Nothing before it can come any more: neither of another topic.
        let reached = message.time_ns;
        let reached = reached.saturating_sub(self.plan.disorder[side.index()]);
        run.frontier.time_ns = run.frontier.time_ns.max(reached);
        if let Some(compared) = &mut self.findings.topics[message.topic] {
            compared.tally.note_values(side, &message.values);
            self.held += compared.lane.push(side, message);
        }
        Ok(())
    }

    /// Compares all pairs that are certain.
    fn pair(&mut self) -> Result<(), DiffError> {
        self.unpaired = 0;
        self.held = 0;
        let frontiers = [0, 1].map(|side| self.findings.runs[side].frontier);
        let mut shown: Result<(), SinkError> = Ok(());
        for (channel, compared) in self.findings.topics.iter_mut().enumerate() {
            let Some(compared) = compared else {
                continue;
            };
            // Where a recording of another version lacks a field, there is no row of the table.
            let is_row = self.plan.are_ours && compared.tally.is_complete;
            let is_energy = self.plan.are_ours && channel == ENERGY.index();
            let common = &mut self.findings.common;
            compared.drain(frontiers, &self.plan.map, &mut |pair, difference| {
                // Messages that don't fit the table have no numbers.
                if is_energy && !(pair.a.is_empty() || pair.b.is_empty()) {
                    common[0].add(pair.time_ns, pair.a);
                    common[1].add(pair.time_ns, pair.b);
                }
                if is_row && shown.is_ok() && difference.iter().all(|d| d.is_finite()) {
                    shown = self.observer.difference(&Message {
                        channel,
                        sequence: pair.sequence,
                        time_ns: pair.time_ns,
                        numbers: difference,
                        texts: &[],
                    });
                }
            });
            self.held += compared.lane.held();
        }
        shown?;
        if self.held > MOST_HELD {
            return Err(DiffError::TooFarApart {
                megabytes: MOST_HELD >> 20,
            });
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Findings, DiffError> {
        for compared in self.findings.topics.iter_mut().flatten() {
            compared.lane.finish();
        }
        for run in &mut self.findings.runs {
            if run.course.peg.is_none() {
                end_with_nutation(&mut run.course.cycles);
            }
        }
        if !self.plan.are_ours {
            self.check_patterns()?;
        }
        let [a, b] = &self.findings.runs;
        // Nothing is the same as nothing, if that is all there is.
        let is_empty = |run: &RunFindings| run.span.is_none() && run.losses.is_empty();
        let are_empty = is_empty(a) && is_empty(b);
        if are_empty || self.findings.compared().any(ComparedTopic::has_pairs) {
            return Ok(self.findings);
        }
        let empty = |side: Side, run: &RunFindings| DiffError::NoMessages {
            side: side.name(),
            topics: some_of(&self.plan.topics),
            losses: match run.losses.as_slice() {
                [] => String::new(),
                losses => some_of(losses),
            },
        };
        Err(match (a.span, b.span) {
            (Some(a), Some(b)) if !self.plan.overlap(a, b) => DiffError::NoOverlap { a, b },
            (Some(_), Some(_)) => DiffError::NoCommonTimes,
            (None, Some(_)) => empty(Side::A, a),
            (None, None) if !is_empty(a) => empty(Side::A, a),
            (_, None) => empty(Side::B, b),
        })
    }
}

impl Reading<'_> {
    /// Leaves what is derived for viewers as soon as what it is derived from differs: then it says nothing more.
    fn leave_views(&mut self, are_views_wanted: &AtomicBool) {
        if !self.plan.are_ours || !are_views_wanted.load(Ordering::Relaxed) {
            return;
        }
        let table = Topic::all().count();
        let (ours, others) = self.findings.topics.split_at_mut(table);
        if ours.iter().flatten().all(ComparedTopic::is_same) {
            return;
        }
        are_views_wanted.store(false, Ordering::Relaxed);
        for (compared, topic) in others.iter_mut().zip(&self.plan.topics[table..]) {
            if is_view(topic) {
                *compared = None;
            }
        }
    }
}

/// The fields of the table that a recording of another version lacks.
fn missing_fields(run: Subject<'_>) -> BTreeSet<String> {
    let Subject::Recording(recording) = run else {
        return BTreeSet::new();
    };
    let mut missing = BTreeSet::new();
    for (topic, fields) in recording.differences() {
        missing.extend(fields.missing.iter().map(|field| full_name(&topic, field)));
    }
    missing
}
