//! What a comparison found: numbers, from which every form of the report is made.
//!
//! Differences are B − A throughout. Angles are in rad, times in s of simulated time unless a name says
//! otherwise. Quantities that one of the runs doesn't have are absent.

use super::averages::{self, Averaged};
use super::beside::beside;
use super::budget::Energies;
use super::clock::ClockReport;
use super::discrepancy::{Discrepancy, Residuals};
use super::divergence::Divergence;
use super::field::seconds;
use super::floor::Floor;
use super::happened::{self, Happened, Ran};
use super::plan::ComparisonPlan;
use super::reading::{Findings, RunFindings};
use super::setup::{self, KeyDifference, SetupDifferences};
use super::signals::Signals;
use super::time_map::TimeMap;
use super::times::MessageTimes;
use super::topics::some_of;
use super::verdict::Verdict;
use crate::analysis::course::CourseReport;
use crate::analysis::phrase::date;
use crate::analysis::subject::Subject;
use crate::archive::format::{CONTENT_DIGEST, LIBRARY};
use crate::archive::publish::is_same_file;
use crate::archive::recording::Condition;
use crate::telemetry::fields::EVENTS;
use crate::telemetry::side::Side;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// What two runs have in common and in what they differ.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Report {
    /// The first run.
    pub a: ComparedRun,
    /// The second run.
    pub b: ComparedRun,
    /// How the comparison ended.
    pub verdict: Verdict,
    /// Whether everything could be read; if not, the verdict is about the rest.
    pub is_complete: bool,
    /// How the times of the report are to be read; absent if they are those of both runs.
    pub clock: Option<ClockReport>,
    /// The findings in a few sentences.
    pub summary: Vec<String>,
    /// What was different in the set-up.
    pub setup: SetupDifferences,
    /// What differs beside the values, in words, if all values are the same.
    pub beside: Vec<String>,
    /// What was different in what happened; only for recordings of toprise.
    pub happened: Option<Happened>,
    /// How the averaged motions differ; needs `/top/nutation` of both.
    pub averaged: Option<Averaged>,
    /// How the signals differ, point by point.
    pub signals: Signals,
    /// The first difference among its neighbours, for runs that should be the same: of one scenario, or of files that
    /// toprise did not write.
    pub divergence: Option<Divergence>,
    /// What B's model would have done along A's motion; needs both scenarios and `/top/state` of A.
    pub discrepancy: Option<Discrepancy>,
    /// The errors of the integrators; absent if they were not asked for or can't be computed.
    pub floor: Option<Floor>,
    /// What else must be known to read this.
    pub notes: Vec<String>,
}

/// One of the two runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ComparedRun {
    /// The run's name: that of its scenario or of its file.
    pub name: String,
    /// The run's file; absent for a scenario that was run on the fly.
    pub file: Option<String>,
    /// What kind of file it is.
    pub condition: Option<Condition>,
    /// What wrote the file.
    pub library: String,
    /// The encoding of the messages.
    pub encoding: Option<String>,
    /// Number of messages that were read.
    pub messages: u64,
    /// Time of the last message, s.
    pub last: f64,
    /// Time of the first message, ns; absent if there is none.
    pub first_ns: Option<u64>,
    /// Time of the last message, ns; absent if there is none.
    pub last_ns: Option<u64>,
    /// SHA-256 of the content, where that is noted.
    pub content_digest: Option<String>,
    /// What could not be read.
    pub losses: Vec<String>,
    /// What happened in the run.
    pub course: Option<CourseReport>,
}

impl Report {
    /// Puts together what was found, but for the summary.
    pub(super) fn new<'f>(
        [a, b]: [Subject<'_>; 2],
        plan: &ComparisonPlan,
        findings: &'f Findings,
        floor: Option<Floor>,
    ) -> Self {
        let [found_a, found_b] = &findings.runs;
        let run_a = ComparedRun::new(a, found_a, plan.are_ours);
        let run_b = ComparedRun::new(b, found_b, plan.are_ours);
        let is_cut = [
            a.is_cut() || !run_a.losses.is_empty(),
            b.is_cut() || !run_b.losses.is_empty(),
        ];
        let floor_of = |field: &str| floor.as_ref()?.of(field);
        let mut signals = Signals::new(&plan.alignment, findings.compared(), &floor_of);
        for (channel, times) in signals.channels.iter_mut().zip(&plan.times) {
            [channel.times_a, channel.times_b] = times.clone();
        }
        let mut setup = setup::compare(a, b);
        [setup.topics_only_in_a, setup.topics_only_in_b] = plan.alone.clone();
        [setup.fields_only_in_a, setup.fields_only_in_b] = [Side::A, Side::B].map(|side| {
            let topics = findings.compared();
            topics
                .flat_map(|topic| topic.fields_only_in(side))
                .collect()
        });
        let beside = beside(&setup, &signals.channels);
        let verdict = Verdict::of(plan, findings, &signals.channels, &setup, is_cut);
        let verdict = match verdict {
            Verdict::Identical if !beside.is_empty() => Verdict::SameValues,
            other => other,
        };
        let should_be_same = !setup.scenario.iter().any(KeyDifference::changes_the_run);
        let (course_a, course_b) = (&found_a.course, &found_b.course);
        Self {
            beside: if verdict == Verdict::SameValues {
                beside
            } else {
                Vec::new()
            },
            verdict,
            is_complete: is_cut == [false; 2],
            clock: plan.clock.report(),
            summary: Vec::new(),
            setup,
            happened: plan.are_ours.then(|| {
                let both_have_events = a.has_topic(EVENTS) && b.has_topic(EVENTS);
                let ran = |found: &'f RunFindings, common: &'f Energies| Ran {
                    course: &found.course,
                    touches: &found.touches,
                    energies: &found.energies,
                    common: (plan.map == TimeMap::Same).then_some(common),
                };
                let [of_a, of_b] = &findings.common;
                let runs = [ran(found_a, of_a), ran(found_b, of_b)];
                happened::compare(runs, plan.levels, both_have_events, floor.as_ref())
            }),
            averaged: averages::compare(course_a, course_b),
            signals,
            divergence: divergence(findings).filter(|_| should_be_same),
            discrepancy: findings.residuals.as_ref().and_then(Residuals::report),
            floor,
            notes: notes(a, b, plan, findings),
            a: run_a,
            b: run_b,
        }
    }
}

impl Report {
    /// A time of the report, s, for people: as UTC and as an offset from the start if clocks count from 1970.
    #[must_use]
    pub fn moment(&self, time: f64) -> String {
        let clock = self.clock.as_ref();
        match clock.filter(|clock| clock.origin.is_some()) {
            Some(clock) => {
                let ns = (clock.origin_ns as u64).saturating_add((time * 1e9).round() as u64);
                format!("{} ({time} s from the start)", date(ns))
            }
            None => format!("{time} s"),
        }
    }
}

/// The first pair that differs by more than the tolerances, of all topics.
fn divergence(findings: &Findings) -> Option<Divergence> {
    let differing = findings.compared();
    let differing = differing.filter_map(|topic| Some((topic.tally.first_divergence()?, topic)));
    let (_, first) = differing.min_by_key(|(time_ns, _)| *time_ns)?;
    first.tally.divergence()
}

impl ComparedRun {
    fn new(subject: Subject<'_>, found: &RunFindings, is_ours: bool) -> Self {
        let mut run = Self {
            name: subject.name(),
            library: LIBRARY.to_owned(),
            messages: found.messages,
            last: found.span.map_or(0.0, |(_, last)| seconds(last)),
            first_ns: found.span.map(|(first, _)| first),
            last_ns: found.span.map(|(_, last)| last),
            losses: found.losses.clone(),
            course: is_ours.then(|| found.course.report()),
            ..Self::default()
        };
        if let Subject::Recording(recording) = subject {
            run.file = Some(recording.path().display().to_string());
            run.condition = Some(recording.condition());
            run.library = recording.library().to_owned();
            run.encoding = Some(setup::encodings(recording));
            let end = recording.end();
            run.content_digest = end.and_then(|end| end.get(CONTENT_DIGEST).cloned());
            run.losses
                .splice(0..0, recording.losses().iter().map(ToString::to_string));
            if recording.condition() == Condition::Foreign
                && !recording.is_closed()
                && run.losses.is_empty()
            {
                run.losses
                    .push("what may follow: the file was not closed".to_owned());
            }
            if recording.condition() == Condition::Interrupted {
                run.losses
                    .push("the end of the run: it was interrupted".to_owned());
            }
        }
        run
    }
}

/// What else must be known.
fn notes(
    a: Subject<'_>,
    b: Subject<'_>,
    plan: &ComparisonPlan,
    findings: &Findings,
) -> Vec<String> {
    let mut notes = Vec::new();
    if !plan.ignored.is_empty() {
        notes.push(format!("Ignored: {}.", some_of(&plan.ignored)));
    }
    if !plan.are_ours {
        notes.extend(unread([a, b], &plan.topics));
        notes.extend(disorder(plan));
    }
    for (run, name) in findings.runs.iter().zip(["A", "B"]) {
        notes.extend(
            run.remarks
                .iter()
                .map(|remark| format!("{name}: {remark}.")),
        );
    }
    if let (Subject::Recording(a), Subject::Recording(b)) = (a, b)
        && is_same_file(a.path(), b.path())
    {
        notes.push("A and B are the same file.".to_owned());
    }
    for (subject, name) in [(a, "A"), (b, "B")] {
        if let Subject::Recording(recording) = subject
            && let (Err(error), true) = (recording.scenario(), subject.is_ours())
        {
            notes.push(format!("{name}: {error}."));
        }
    }
    notes
}

/// The encodings of compared topics that are not read, and for each the topics.
fn unread(runs: [Subject<'_>; 2], topics: &[String]) -> Vec<String> {
    let compared: BTreeSet<&String> = topics.iter().collect();
    let mut unread: BTreeMap<String, BTreeSet<&str>> = BTreeMap::new();
    for run in runs {
        let Subject::Recording(recording) = run else {
            continue;
        };
        let channels = recording.channels().iter();
        for channel in channels.filter(|channel| compared.contains(&channel.topic)) {
            if let Err(reason) = channel.payload_decoder() {
                let topics = unread.entry(reason.to_string()).or_default();
                topics.insert(&channel.topic);
            }
        }
    }
    let told = unread.iter().map(|(reason, topics)| {
        let topics: Vec<String> = topics.iter().map(ToString::to_string).collect();
        format!("Compared byte by byte: {} ({reason}).", some_of(&topics))
    });
    told.collect()
}

/// The topics with messages that repeat the time of another or stand behind later ones.
fn disorder(plan: &ComparisonPlan) -> Vec<String> {
    let mut told = Vec::new();
    for (side, name) in ["A", "B"].into_iter().enumerate() {
        let times = || plan.topics.iter().zip(&plan.times);
        type Count = fn(&MessageTimes) -> u64;
        let counts: [(Count, _); 2] = [
            (|times| times.duplicates, "at the time of the one before"),
            (
                |times| times.out_of_order,
                "behind later ones of their topic",
            ),
        ];
        for (count, what) in counts {
            let some = times().filter_map(|(topic, times)| {
                let count = times[side].as_ref().map_or(0, count);
                (count > 0).then(|| (format!("{topic} ({count})"), count))
            });
            let (topics, counts): (Vec<_>, Vec<_>) = some.unzip();
            match counts.iter().sum::<u64>() {
                0 => {}
                1 => told.push(format!("{name} has 1 message {what}: {}.", topics[0])),
                all => told.push(format!(
                    "{name} has {all} messages {what}: {}.",
                    some_of(&topics)
                )),
            }
        }
    }
    told
}
