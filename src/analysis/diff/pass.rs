//! Reading two runs side by side.

use super::discrepancy::Residuals;
use super::pairing::{Frontier, Given, Lane, Lonely, Rule};
use super::plan::Plan;
use super::report::{ChannelDifference, Floor, Report, Setup, Signals, Verdict};
use super::signals::{Channel, Field, KINDS};
use super::stream::{Batch, Parcel, Wanted, read};
use super::timing::TimeMap;
use super::tolerance::Tolerances;
use super::{DiffError, Observer, Subject, averages, happened, run as about_run, setup};
use crate::analysis::course::Course;
use crate::analysis::subject::Ended;
use crate::archive::publish::is_same_file;
use crate::archive::sink::SinkError;
use crate::telemetry::fields::EVENTS;
use crate::telemetry::side::Side;
use crate::telemetry::{Message, channels};
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;

/// Batches that may wait on each side.
const WAITING: usize = 4;
/// What was found in reading two runs.
pub(super) struct Passed {
    pub(super) courses: [Course; 2],
    pub(super) channels: Vec<Option<Channel>>,
    pub(super) messages: [u64; 2],
    /// The times of the first and the last message, ns.
    pub(super) spans: [Option<(u64, u64)>; 2],
    pub(super) losses: [Vec<String>; 2],
    lanes: Vec<Option<Lane>>,
    residuals: Option<Residuals>,
    /// Fields that only A and only B has.
    alone: [Vec<String>; 2],
}

/// Reads both runs.
pub(super) fn run(
    a: Subject<'_>,
    b: Subject<'_>,
    plan: &Plan,
    tolerances: &Tolerances,
    observer: &mut dyn Observer,
) -> Result<Passed, DiffError> {
    let models = [a, b].map(|subject| subject.scenario().map(|scenario| scenario.model));
    let mut pass = Pass::new(plan, tolerances, observer);
    if let [Some(a), Some(b)] = models {
        pass.passed.residuals = Some(Residuals::new(a, b));
    }
    if plan.is_ours {
        pass.prepare_table([a, b])?;
    }
    let wanted = if plan.is_ours {
        Wanted::Table(&plan.read)
    } else {
        Wanted::Numbers(&plan.topics)
    };
    thread::scope(|scope| {
        let incoming = [a, b].map(|subject| {
            let (out, incoming) = sync_channel(WAITING);
            scope.spawn(move || read(subject, wanted, &out));
            incoming
        });
        pass.take_all(&incoming)
    })?;
    pass.finish()
}

/// A comparison under way.
struct Pass<'p> {
    plan: &'p Plan,
    tolerances: &'p Tolerances,
    observer: &'p mut dyn Observer,
    passed: Passed,
    frontiers: [Frontier; 2],
    /// The latest time of each run, ns.
    latest: [u64; 2],
    /// The names of the fields of each topic of A and B, where they come up as the files are read.
    names: [Vec<Vec<String>>; 2],
    /// Which of them have ever been numbers.
    seen: [Vec<Vec<bool>>; 2],
    difference: Vec<f64>,
}

impl<'p> Pass<'p> {
    fn new(plan: &'p Plan, tolerances: &'p Tolerances, observer: &'p mut dyn Observer) -> Self {
        let lanes: Vec<_> = plan
            .rules
            .iter()
            .map(|rule| rule.clone().map(Lane::new))
            .collect();
        let channel = |(topic, rule): (&String, &Option<Rule>)| {
            let is_interpolated = matches!(rule.as_ref()?, Rule::Interpolated { .. });
            Some(Channel::new(topic, is_interpolated))
        };
        Self {
            passed: Passed {
                courses: [Course::default(), Course::default()],
                channels: plan.topics.iter().zip(&plan.rules).map(channel).collect(),
                messages: [0; 2],
                spans: [None; 2],
                losses: [Vec::new(), Vec::new()],
                lanes,
                residuals: None,
                alone: [Vec::new(), Vec::new()],
            },
            frontiers: [Frontier::default(); 2],
            latest: [0; 2],
            names: [(); 2].map(|()| vec![Vec::new(); plan.topics.len()]),
            seen: [(); 2].map(|()| vec![Vec::new(); plan.topics.len()]),
            difference: Vec::new(),
            plan,
            tolerances,
            observer,
        }
    }

    /// Names the fields of the table that both have.
    fn prepare_table(&mut self, subjects: [Subject<'_>; 2]) -> Result<(), DiffError> {
        let missing = subjects.map(missing_fields);
        for (at, info) in channels().iter().enumerate() {
            let Some(channel) = &mut self.passed.channels[at] else {
                continue;
            };
            for (place, leaf) in info.numbers.iter().enumerate() {
                let lacks =
                    |side: usize| missing[side].contains(&super::full_name(info.topic, &leaf.path));
                match [lacks(0), lacks(1)] {
                    [false, false] => channel.add_field(
                        Field {
                            name: leaf.path.clone(),
                            unit: leaf.unit,
                            places: [Some(place); 2],
                        },
                        self.tolerances,
                    ),
                    [true, true] => {}
                    [in_b_only, _] => {
                        let alone = &mut self.passed.alone[usize::from(in_b_only)];
                        alone.push(super::full_name(info.topic, &leaf.path));
                    }
                }
            }
            channel.add_derived();
        }
        self.check_patterns()
    }

    fn check_patterns(&self) -> Result<(), DiffError> {
        let known: Vec<String> = self
            .passed
            .channels
            .iter()
            .flatten()
            .flat_map(Channel::names)
            .collect();
        self.tolerances.unmatched(&known).map_or(Ok(()), Err)
    }

    /// Takes everything that comes, always from the run that is behind.
    fn take_all(&mut self, incoming: &[Receiver<Parcel>; 2]) -> Result<(), DiffError> {
        while !self.frontiers.iter().all(|frontier| frontier.is_ended) {
            let side = self.behind();
            let parcel = incoming[side.index()].recv();
            match parcel {
                Ok(Parcel::Batch(batch)) => self.take(side, batch)?,
                Ok(Parcel::End(ended)) => self.end(side, ended),
                // Its thread has died.
                Err(_) => self.end(side, Ended::default()),
            }
            self.drain()?;
        }
        Ok(())
    }

    /// The run of which less has been read.
    fn behind(&self) -> Side {
        let [a, b] = self.frontiers;
        // Where B has nothing to compare with, nothing of B is needed.
        let in_b = self.plan.map.target(a.time_ns).map_or(0, |at| at.ns);
        let [read_a, read_b] = self.passed.messages;
        if b.is_ended || (!a.is_ended && (in_b, read_a) <= (b.time_ns, read_b)) {
            Side::A
        } else {
            Side::B
        }
    }

    fn end(&mut self, side: Side, ended: Ended) {
        let at = side.index();
        self.frontiers[at].is_ended = true;
        self.passed.losses[at] = ended.losses;
        self.passed.courses[at].end = ended.end;
    }

    fn take(&mut self, side: Side, batch: Batch) -> Result<(), DiffError> {
        self.observer.progress(batch.bytes);
        for (topic, names) in batch.fields {
            self.learn(side, topic, names);
        }
        let at = side.index();
        for message in batch.messages {
            let time_ns = message.time_ns;
            self.passed.messages[at] += 1;
            let (first, last) = self.passed.spans[at].unwrap_or((time_ns, time_ns));
            self.passed.spans[at] = Some((first.min(time_ns), last.max(time_ns)));
            self.latest[at] = self.latest[at].max(time_ns);
            if self.plan.is_ours {
                let course = &mut self.passed.courses[at];
                let seen = message.as_message();
                course.take(&seen);
                self.observer.message(side, &seen)?;
                if side == Side::A
                    && let Some(residuals) = &mut self.passed.residuals
                    && let Some(tilt) = course.new_tilt(&seen)
                {
                    residuals.add(time_ns, tilt);
                }
            } else {
                let seen = &mut self.seen[at][message.channel];
                seen.resize(message.numbers.len(), false);
                for (seen, number) in seen.iter_mut().zip(&message.numbers) {
                    *seen |= !number.is_nan();
                }
            }
            if let Some(lane) = &mut self.passed.lanes[message.channel] {
                lane.push(side, message);
            }
        }
        let disorder = self.plan.disorder[at];
        self.frontiers[at].time_ns = self.latest[at].saturating_sub(disorder);
        Ok(())
    }

    /// Takes in fields that have come up in a topic of one run.
    fn learn(&mut self, side: Side, topic: usize, names: Vec<String>) {
        let known = &mut self.names[side.index()][topic];
        for name in names {
            if let Some(channel) = &mut self.passed.channels[topic] {
                channel.learn(side.index(), &name, known.len(), self.tolerances);
            }
            known.push(name);
        }
    }

    /// Compares all pairs that are certain.
    fn drain(&mut self) -> Result<(), DiffError> {
        let Self {
            passed,
            plan,
            frontiers,
            difference,
            observer,
            ..
        } = self;
        let mut failed: Option<SinkError> = None;
        for (topic, (lane, channel)) in passed
            .lanes
            .iter_mut()
            .zip(&mut passed.channels)
            .enumerate()
        {
            let (Some(lane), Some(channel)) = (lane, channel) else {
                continue;
            };
            let interpolated = match &lane.rule {
                Rule::Interpolated { grid, .. } => 1 - grid.index(),
                _ => 0,
            };
            // Where a recording of another version lacks a field, there is no row of the table.
            let is_shown = plan.is_ours && channel.is_complete(channels()[topic].numbers.len());
            lane.drain(*frontiers, &plan.map, &mut |given| match given {
                Given::Pair(pair) => {
                    channel.add(&pair, difference);
                    if is_shown && failed.is_none() && difference.iter().all(|d| d.is_finite()) {
                        let message = Message {
                            channel: topic,
                            sequence: pair.sequence,
                            time_ns: pair.time_ns,
                            numbers: difference,
                            texts: &[],
                        };
                        failed = observer.difference(&message).err();
                    }
                }
                Given::Estimate { field, error } => {
                    channel.add_estimate(interpolated, field, error)
                }
            });
        }
        failed.map_or(Ok(()), |error| Err(error.into()))
    }

    fn finish(mut self) -> Result<Passed, DiffError> {
        for lane in self.passed.lanes.iter_mut().flatten() {
            lane.finish();
        }
        if !self.plan.is_ours {
            self.check_patterns()?;
            self.find_lonely_fields();
        }
        let passed = self.passed;
        let pairs: u64 = passed
            .channels
            .iter()
            .flatten()
            .map(|channel| channel.pairs)
            .sum();
        if pairs > 0 {
            return Ok(passed);
        }
        let topics = self.plan.topics.join(", ");
        let empty = |side: usize| DiffError::NoMessages {
            side: ["A", "B"][side],
            topics: topics.clone(),
            losses: passed.losses[side].join("; "),
        };
        match passed.spans {
            [Some(a), Some(b)] if a.1 < b.0 || b.1 < a.0 => Err(DiffError::NoOverlap { a, b }),
            [Some(_), Some(_)] => Err(DiffError::NoCommonTimes),
            [None, _] => Err(empty(0)),
            [_, None] => Err(empty(1)),
        }
    }

    /// Finds the fields that only one run has numbers in.
    fn find_lonely_fields(&mut self) {
        for topic in 0..self.plan.topics.len() {
            let with_numbers = |side: usize| -> Vec<&String> {
                let names = self.names[side][topic].iter().zip(&self.seen[side][topic]);
                names
                    .filter(|(_, seen)| **seen)
                    .map(|(name, _)| name)
                    .collect()
            };
            let both = [0, 1].map(with_numbers);
            // Without messages there are no fields, which says nothing about them.
            let lane = self.passed.lanes[topic].as_ref();
            if lane.is_none_or(|lane| lane.counts.contains(&0)) {
                continue;
            }
            for side in 0..2 {
                let alone = both[side]
                    .iter()
                    .filter(|name| !both[1 - side].contains(name));
                let full = alone.map(|name| super::full_name(&self.plan.topics[topic], name));
                self.passed.alone[side].extend(full);
            }
        }
    }
}

/// The fields of the table that a recording of another version lacks.
fn missing_fields(subject: Subject<'_>) -> Vec<String> {
    let Subject::Recording(recording) = subject else {
        return Vec::new();
    };
    let differences = recording.differences().into_iter();
    let missing = differences.flat_map(|(topic, fields)| {
        let name = move |field: &String| super::full_name(&topic, field);
        fields.missing.iter().map(name).collect::<Vec<_>>()
    });
    missing.collect()
}

impl Passed {
    /// Everything that was found, but for the summary.
    pub(super) fn report(
        &self,
        a: Subject<'_>,
        b: Subject<'_>,
        plan: &Plan,
        floor: Option<Floor>,
    ) -> Report {
        let runs =
            [(a, 0), (b, 1)].map(|(subject, side)| about_run(subject, self, side, plan.is_ours));
        // Where a run is not there as a whole, what the other has more of is no difference.
        let is_cut = [(a, 0), (b, 1)]
            .map(|(subject, side)| subject.is_cut() || !runs[side].losses.is_empty());
        let signals = self.signals(plan, floor.as_ref());
        let mut setup = setup::compare(a, b);
        self.complete(&mut setup, plan);
        let [run_a, run_b] = runs;
        let [course_a, course_b] = &self.courses;
        Report {
            verdict: self.verdict(plan, &signals, &setup, is_cut),
            is_complete: !is_cut[0] && !is_cut[1],
            summary: Vec::new(),
            setup,
            happened: plan.is_ours.then(|| {
                let has_events = [a, b].iter().all(|subject| subject.has_topic(EVENTS));
                happened::compare(course_a, course_b, has_events)
            }),
            averaged: averages::compare(course_a, course_b),
            signals,
            discrepancy: self.residuals.as_ref().and_then(Residuals::report),
            floor,
            notes: notes(a, b, plan),
            a: run_a,
            b: run_b,
        }
    }

    fn complete(&self, setup: &mut Setup, plan: &Plan) {
        let [a, b] = plan.alone.clone();
        (setup.topics_only_in_a, setup.topics_only_in_b) = (a, b);
        let [a, b] = self.alone.clone();
        (setup.fields_only_in_a, setup.fields_only_in_b) = (a, b);
    }

    fn signals(&self, plan: &Plan, floor: Option<&Floor>) -> Signals {
        let floor = |name: &str| {
            let floor = floor?;
            let of = |fields: &[(String, f64)]| {
                fields.iter().find(|(field, _)| field == name).map(|f| f.1)
            };
            Some(of(&floor.a.fields)? + of(&floor.b.fields)?)
        };
        let pairs = self.lanes.iter().zip(&self.channels);
        let both = pairs.filter_map(|(lane, channel)| Some((lane.as_ref()?, channel.as_ref()?)));
        let mut signals = Signals {
            alignment: plan.alignment.clone(),
            ..Signals::default()
        };
        let mut span: Option<(u64, u64)> = None;
        for (lane, channel) in both {
            signals
                .channels
                .push(with_lonely(channel.report(&floor), lane));
            if let Some((first, last)) = channel.span {
                let (from, to) = span.unwrap_or((first, last));
                span = Some((from.min(first), to.max(last)));
            }
            signals.growth.extend(channel.growths());
            // Events and cycles are there only afterwards.
            if !matches!(lane.rule, Rule::SameSequence) {
                signals.parted.extend(channel.partings(&floor));
            }
        }
        let rank = |kind: &str| KINDS.iter().position(|known| *known == kind);
        signals.parted.sort_by(|x, y| {
            x.time
                .total_cmp(&y.time)
                .then_with(|| rank(&x.kind).cmp(&rank(&y.kind)))
        });
        (signals.from, signals.to) = span.map_or((0.0, 0.0), |(first, last)| {
            (first as f64 / 1e9, last as f64 / 1e9)
        });
        signals
    }

    fn verdict(&self, plan: &Plan, signals: &Signals, setup: &Setup, is_cut: [bool; 2]) -> Verdict {
        let [cut_a, cut_b] = is_cut;
        // What one has more of is a difference, unless the other was cut off.
        let only_a = [&setup.topics_only_in_a, &setup.fields_only_in_a];
        let only_b = [&setup.topics_only_in_b, &setup.fields_only_in_b];
        let are_empty = |lists: [&Vec<String>; 2]| lists.iter().all(|list| list.is_empty());
        let has_same = (cut_b || are_empty(only_a)) && (cut_a || are_empty(only_b));
        let is_whole = |channel: &ChannelDifference| {
            let more_in_a = channel.only_in_a + channel.beyond_in_a;
            let more_in_b = channel.only_in_b + channel.beyond_in_b;
            (cut_b || more_in_a == 0) && (cut_a || more_in_b == 0) && channel.out_of_order == 0
        };
        // At other times than A's, the ends of the runs mean nothing.
        let is_mapped = plan.map != TimeMap::Same;
        let all_whole = signals
            .channels
            .iter()
            .all(|channel| is_mapped || is_whole(channel));
        if !has_same || !all_whole {
            return Verdict::Different;
        }
        let lanes = || signals.channels.iter().zip(self.lanes.iter().flatten());
        let is_identical = |(channel, lane): (&ChannelDifference, &Lane)| {
            let is_exact = matches!(
                lane.rule,
                Rule::SameSequence | Rule::SameTime { finer: None }
            );
            channel.identical == channel.pairs && is_exact
        };
        let is_everything = plan.is_ours && plan.uncompared.is_empty() && !is_mapped;
        if is_everything && lanes().all(is_identical) {
            return Verdict::Identical;
        }
        let is_equal = |channel: &ChannelDifference| {
            let own = channel.fields.iter().filter(|field| !field.is_derived);
            own.into_iter().all(|field| field.beyond == 0)
        };
        let says_same = |channel: &Channel| !channel.kinds_differ && channel.other_words == 0;
        if signals.channels.iter().all(is_equal) && self.channels.iter().flatten().all(says_same) {
            Verdict::Equal
        } else {
            Verdict::Different
        }
    }
}

/// Adds the messages without a counterpart: within the time of both, and beyond it.
fn with_lonely(mut report: ChannelDifference, lane: &Lane) -> ChannelDifference {
    let split = |lonely: &Lonely| {
        let beyond = if report.pairs == 0 {
            lonely.count
        } else {
            lonely.before + lonely.since
        };
        (lonely.count - beyond, beyond)
    };
    let [a, b] = &lane.lonely;
    let ((in_a, beyond_a), (in_b, beyond_b)) = (split(a), split(b));
    [report.messages_a, report.messages_b] = lane.counts;
    (report.only_in_a, report.beyond_in_a) = (in_a, beyond_a);
    (report.only_in_b, report.beyond_in_b) = (in_b, beyond_b);
    report.out_of_order = lane.out_of_order;
    report
}

/// What else must be known.
fn notes(a: Subject<'_>, b: Subject<'_>, plan: &Plan) -> Vec<String> {
    let mut notes = Vec::new();
    if !plan.uncompared.is_empty() {
        notes.push(format!(
            "Not compared, because toprise has no such channels: {}.",
            plan.uncompared.join(", ")
        ));
    }
    if !plan.is_ours {
        notes.push("Only numbers are compared: neither texts nor bytes, and integers beyond 2^53 as the nearest double.".to_owned());
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
