//! Reads two runs in parallel and pairs their messages.
//!
//! Each run is read by its own thread in batches. The run that is behind is advanced first, so that few messages wait.
//! Samples are paired by time while both runs are read; events, impacts and nutation cycles at the end, by their content
//! ([`occurrence`]). The averages over nutation cycles are compared as curves over time ([`super::averages`]).

mod occurrence;

use self::occurrence::{Occurrence, match_occurrences};
use super::averages;
use super::discrepancy::Residuals;
use super::error::DiffError;
use super::observer::Observer;
use super::tolerance::{Options, full_name};
use super::topic::TopicTally;
use crate::analysis::history::RunHistory;
use crate::analysis::history::energy::Energies;
use crate::analysis::normal_force::{NormalForce, NormalForces};
use crate::analysis::slip::{SlipComparison, SlipHistory};
use crate::analysis::subject::{ReadEnd, Subject};
use crate::archive::memory::Owned;
use crate::archive::recording::Condition;
use crate::run::time::seconds;
use crate::telemetry::fields::{ENERGY, NUTATION};
use crate::telemetry::side::Side;
use crate::telemetry::{Message, Topic, Topics};
use std::cmp::Ordering;
use std::collections::{BTreeSet, VecDeque};
use std::sync::mpsc::Receiver;
#[cfg(target_family = "wasm")]
use std::sync::mpsc::channel;
#[cfg(not(target_family = "wasm"))]
use std::{sync::mpsc::sync_channel, thread};

/// Messages in a batch.
const BATCH: usize = 1024;
/// Batches that may wait on each side. More would only take memory, since both runs advance together.
#[cfg(not(target_family = "wasm"))]
const WAITING: usize = 4;

/// The result of reading two runs.
#[derive(Debug)]
pub(super) struct Paired {
    /// A and B.
    pub(super) runs: [PairedRun; 2],
    /// For each topic of the table the comparison of its messages; `None` for topics that are not compared.
    pub(super) topics: Vec<Option<TopicTally>>,
    /// The energies of A and of B at equal times.
    pub(super) common: [Option<Energies>; 2],
    /// The differences of the two models at A's states, if both scenarios are known.
    pub(super) residuals: Option<Residuals>,
}

/// Data of one run.
#[derive(Debug, Default)]
pub(super) struct PairedRun {
    pub(super) history: RunHistory,
    /// Parts that could not be read.
    pub(super) losses: Vec<String>,
    /// State of the file; `None` for a simulation.
    pub(super) state: Option<Condition>,
    pub(super) is_ended: bool,
}

impl Paired {
    /// The topics that are compared.
    pub(super) fn compared(&self) -> impl Iterator<Item = &TopicTally> {
        self.topics.iter().flatten()
    }

    /// Whether both runs could be read as a whole and have the same messages, to the last bit.
    pub(super) fn is_identical(&self) -> bool {
        let is_whole = self.runs.iter().all(|run| run.losses.is_empty());
        is_whole && self.compared().all(TopicTally::is_identical)
    }

    /// The slip of both runs.
    pub(super) fn slip(&self) -> SlipComparison {
        let [a, b] = self.runs.each_ref().map(|run| {
            let slip = run.history.slip.as_ref();
            slip.and_then(SlipHistory::slip)
        });
        SlipComparison { a, b }
    }

    /// The normal forces of both runs.
    pub(super) fn normal_forces(&self) -> NormalForces {
        let forces = self.runs.each_ref().map(|run| run.history.normal_force);
        let [a, b] = forces.map(|force| force.map(NormalForce::from));
        NormalForces { a, b }
    }

    /// Number of messages of A and B that were compared with each other.
    pub(super) fn pairs(&self) -> u64 {
        self.compared().map(|topic| topic.found.pairs).sum()
    }

    /// The time up to which both runs have messages, ns.
    pub(super) fn common_end(&self) -> Option<u64> {
        let [a, b] = &self.runs;
        Some(a.history.last_ns?.min(b.history.last_ns?))
    }
}

/// The compared part of two runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits<'l> {
    /// The topics whose messages are compared.
    pub(super) topics: &'l [String],
    /// The time up to which they are, s; up to the end if there is none.
    pub(super) until: Option<f64>,
}

enum Parcel {
    Batch(Vec<Owned>, u64),
    End(ReadEnd),
}

/// Reads both runs and compares their messages within limits.
pub(super) fn read_both(
    runs: [Subject<'_>; 2],
    limits: &Limits<'_>,
    options: &Options,
    observer: &mut dyn Observer,
    carry_on: &dyn Fn() -> bool,
) -> Result<Paired, DiffError> {
    let mut pairing = Pairing::new(runs, limits, options, observer);
    #[cfg(not(target_family = "wasm"))]
    thread::scope(|scope| {
        let incoming = runs.map(|run| {
            let (out, incoming) = sync_channel(WAITING);
            scope.spawn(move || read(run, &|parcel| out.send(parcel).is_ok()));
            incoming
        });
        pairing.take_all(&incoming, carry_on)
    })?;
    // Without threads (WebAssembly), the runs are read sequentially and buffered.
    #[cfg(target_family = "wasm")]
    pairing.take_all(
        &runs.map(|run| {
            let (out, incoming) = channel();
            read(run, &|parcel| out.send(parcel).is_ok());
            incoming
        }),
        carry_on,
    )?;
    pairing.show_mean_differences()?;
    Ok(pairing.paired)
}

/// Passes the messages of a run to `send` in batches, until the receiver is gone.
fn read(run: Subject<'_>, send: &dyn Fn(Parcel) -> bool) {
    let (mut batch, mut bytes) = (Vec::with_capacity(BATCH), 0);
    let ended = run.read(&Topics::All, &mut |message, more| {
        batch.push(Owned::from(message));
        bytes += more;
        if batch.len() < BATCH {
            return true;
        }
        let full = std::mem::replace(&mut batch, Vec::with_capacity(BATCH));
        send(Parcel::Batch(full, std::mem::take(&mut bytes)))
    });
    if send(Parcel::Batch(batch, bytes)) {
        send(Parcel::End(ended));
    }
}

/// A comparison in progress.
struct Pairing<'o> {
    observer: &'o mut dyn Observer,
    paired: Paired,
    /// For each topic the messages of A and B that are not paired yet.
    waiting: Vec<[VecDeque<Owned>; 2]>,
    /// Times between samples, ns.
    periods: [Option<u64>; 2],
    /// The time up to which messages are compared, s.
    until: f64,
}

impl<'o> Pairing<'o> {
    fn new(
        runs: [Subject<'_>; 2],
        limits: &Limits<'_>,
        options: &Options,
        observer: &'o mut dyn Observer,
    ) -> Self {
        let scenarios = runs.map(Subject::scenario);
        let models = scenarios
            .each_ref()
            .map(|s| s.as_ref().map(|s| s.model.clone()));
        let missing = runs.map(missing_fields);
        let periods = scenarios
            .each_ref()
            .map(|scenario| scenario.as_ref().map(|s| s.sample_period_ns));
        // The sequence number of a sample is its index, which depends on the sampling period.
        let has_sequences = periods[0] == periods[1];
        let mut tallies = Vec::new();
        for topic in Topic::all() {
            let is_compared = limits.topics.iter().any(|name| topic.name() == name);
            tallies.push(
                is_compared
                    .then(|| TopicTally::new(topic, &missing, &options.tolerances, has_sequences)),
            );
        }
        let paired = Paired {
            topics: tallies,
            runs: scenarios.each_ref().map(|scenario| PairedRun {
                history: RunHistory::new(scenario.as_ref()),
                ..PairedRun::default()
            }),
            common: Default::default(),
            residuals: match models {
                [Some(a), Some(b)] => Residuals::new(a, b),
                _ => None,
            },
        };
        Self {
            observer,
            waiting: paired.topics.iter().map(|_| Default::default()).collect(),
            paired,
            periods,
            until: limits.until.unwrap_or(f64::INFINITY),
        }
    }

    /// Receives all messages, always from the run that is behind.
    fn take_all(
        &mut self,
        incoming: &[Receiver<Parcel>; 2],
        carry_on: &dyn Fn() -> bool,
    ) -> Result<(), DiffError> {
        while let Some(side) = self.behind() {
            if !carry_on() {
                return Err(DiffError::Interrupted);
            }
            match incoming[side.index()].recv() {
                Ok(Parcel::Batch(messages, bytes)) => {
                    self.observer.progress(bytes);
                    for message in messages {
                        self.take(side, message)?;
                    }
                }
                Ok(Parcel::End(ended)) => self.end(side, ended),
                // The thread of this run has panicked.
                Err(_) => self.end(side, ReadEnd::default()),
            }
            for topic in Topic::all().filter(|topic| topic.info().is_sampled) {
                self.pair_samples(topic)?;
            }
        }
        for topic in Topic::all().filter(|topic| !topic.info().is_sampled) {
            self.pair_occurrences(topic)?;
        }
        Ok(())
    }

    /// The run that is behind; `None` if both have ended.
    fn behind(&self) -> Option<Side> {
        let [a, b] = &self.paired.runs;
        match [a.is_ended, b.is_ended] {
            [true, true] => None,
            [false, true] => Some(Side::A),
            // `None`, before the first message, is less than any time.
            [false, false] if a.history.last_ns <= b.history.last_ns => Some(Side::A),
            [_, false] => Some(Side::B),
        }
    }

    fn end(&mut self, side: Side, ended: ReadEnd) {
        let run = &mut self.paired.runs[side.index()];
        run.is_ended = true;
        run.losses = ended.losses;
        run.state = ended.state;
        run.history.finish(ended.end, ended.missing);
    }

    fn take(&mut self, side: Side, message: Owned) -> Result<(), DiffError> {
        let run = &mut self.paired.runs[side.index()];
        let seen = message.as_message();
        run.history.take(&seen);
        self.observer.message(side, &seen)?;
        if side == Side::A
            && let Some(residuals) = &mut self.paired.residuals
        {
            residuals.take(&seen);
        }
        let channel = message.channel;
        if seconds(message.time_ns) <= self.until
            && let Some(tally) = &mut self.paired.topics[channel]
        {
            tally.count(side);
            self.waiting[channel][side.index()].push_back(message);
        }
        Ok(())
    }

    /// Compares the samples of a topic that have a partner, and counts those that have none.
    fn pair_samples(&mut self, topic: Topic) -> Result<(), DiffError> {
        if self.paired.topics[topic.index()].is_none() {
            return Ok(());
        }
        while let Some(order) = self.next(topic) {
            let [a, b] = &mut self.waiting[topic.index()];
            let next = (
                a.pop_front_if(|_| order != Ordering::Greater),
                b.pop_front_if(|_| order != Ordering::Less),
            );
            match next {
                (Some(a), Some(b)) => self.compare(topic, &a.as_message(), &b.as_message())?,
                (Some(a), None) => self.count_unmatched(topic, Side::A, a.time_ns),
                (None, Some(b)) => self.count_unmatched(topic, Side::B, b.time_ns),
                (None, None) => {}
            }
        }
        Ok(())
    }

    /// Which run has the next sample of a topic (`Less`: A, `Equal`: both, `Greater`: B); `None` if that isn't known yet.
    fn next(&self, topic: Topic) -> Option<Ordering> {
        let [a, b] = &self.waiting[topic.index()];
        let [a_ended, b_ended] = self.paired.runs.each_ref().map(|run| run.is_ended);
        match (a.front(), b.front()) {
            (Some(a), Some(b)) => Some(a.time_ns.cmp(&b.time_ns)),
            (Some(_), None) => b_ended.then_some(Ordering::Less),
            (None, Some(_)) => a_ended.then_some(Ordering::Greater),
            (None, None) => None,
        }
    }

    /// Compares all messages of a topic that isn't sampled. They are few, as are the events and cycles of the history,
    /// and their partners are known only when both runs are.
    fn pair_occurrences(&mut self, topic: Topic) -> Result<(), DiffError> {
        let waiting = std::mem::take(&mut self.waiting[topic.index()]);
        let [a, b] = waiting.map(Vec::from);
        let is_whole = self.paired.runs.iter().all(|run| run.losses.is_empty());
        for occurrence in match_occurrences(topic, &a, &b, is_whole) {
            match occurrence {
                Occurrence::Both(of_a, of_b) => {
                    self.compare(topic, &a[of_a].as_message(), &b[of_b].as_message())?;
                }
                Occurrence::OnlyA(of_a) => {
                    self.count_unmatched(topic, Side::A, a[of_a].time_ns);
                }
                Occurrence::OnlyB(of_b) => {
                    self.count_unmatched(topic, Side::B, b[of_b].time_ns);
                }
            }
        }
        Ok(())
    }

    /// Compares two messages, and shows the observer their difference if it is finite.
    fn compare(&mut self, topic: Topic, a: &Message<'_>, b: &Message<'_>) -> Result<(), DiffError> {
        let Some(tally) = &mut self.paired.topics[topic.index()] else {
            return Ok(());
        };
        let difference = tally.add(a, b);
        if topic == ENERGY {
            for (energies, message) in self.paired.common.iter_mut().zip([a, b]) {
                Energies::take(energies, message);
            }
        }
        // Averages over nutations are compared as curves instead. Fields that a recording lacks are NaN.
        if topic != NUTATION && difference.iter().all(|number| number.is_finite()) {
            self.observer.difference(&Message {
                numbers: &difference,
                texts: &[],
                ..*a
            })?;
        }
        Ok(())
    }

    /// Counts a message without a partner. Samples between those of the other run, and after its end, are counted separately.
    fn count_unmatched(&mut self, topic: Topic, side: Side, time_ns: u64) {
        let other = side.other().index();
        let period = self.periods[other].filter(|_| topic.info().is_sampled);
        let is_between = period.is_some_and(|period| !time_ns.is_multiple_of(period));
        let end = self.paired.runs[other].history.last_ns;
        let is_beyond = end.is_none_or(|end| time_ns > end);
        if let Some(tally) = &mut self.paired.topics[topic.index()] {
            tally.count_unmatched(side, time_ns, is_between, is_beyond);
        }
    }

    /// Reports the differences of the averages to the observer, at the midpoints of A's nutations.
    fn show_mean_differences(&mut self) -> Result<(), DiffError> {
        let [a, b] = &self.paired.runs;
        for difference in averages::differences(&a.history, &b.history) {
            self.observer.difference(&difference.as_message())?;
        }
        Ok(())
    }
}

/// Table fields missing in a recording of another version.
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
