//! Whether the simulation gives the recording again, bit for bit.

use crate::archive::check::{Check, Group, Verdict};
use crate::archive::format::{CONTENT_DIGEST, COUNTS, STOP_REASON, VERSION, end_entries};
use crate::archive::memory::Owned;
use crate::archive::recording::{Condition, Entries, Recording};
use crate::physics::math::ulp_distance;
use crate::run::scenario::Scenario;
use crate::run::simulation::{Simulation, StopReason};
use crate::telemetry::{Message, Telemetry, TelemetryError, Topics, Version, channels};
use std::collections::VecDeque;

/// A simulation that runs alongside a recording.
pub(super) struct Reproduction {
    simulation: Result<Simulation, String>,
    /// The version of the telemetry that was recorded: only what it has is compared.
    of: Version,
    telemetry: Telemetry,
    /// Messages that have been simulated and not been met.
    ahead: VecDeque<Owned>,
    /// The time up to which everything has been simulated.
    reached_ns: Option<u64>,
    equal: u64,
    missing: u64,
    difference: Option<String>,
    /// The first message that stands before others of its time that the simulation gives earlier, or that are missing.
    early: Option<String>,
    /// Whether the simulation could not go on.
    has_failed: bool,
    end: Option<Entries>,
    is_recovered: bool,
    version: Option<String>,
}

impl Reproduction {
    /// `version` is that of the recording's telemetry.
    pub(super) fn new(recording: &Recording, scenario: &Scenario, of: Version) -> Self {
        let version = recording.run().and_then(|run| run.get(VERSION));
        Self {
            simulation: match Simulation::new(scenario) {
                Ok(simulation) if of.number() == 1 => Ok(simulation.by_first_rules()),
                simulation => simulation.map_err(|error| error.to_string()),
            },
            of,
            telemetry: Telemetry::with_topics(&Topics::Only(recording.topics())),
            ahead: VecDeque::new(),
            reached_ns: None,
            equal: 0,
            missing: 0,
            difference: None,
            early: None,
            has_failed: false,
            end: recording.end().cloned(),
            is_recovered: recording.condition() == Condition::Recovered,
            version: version.filter(|v| *v != env!("CARGO_PKG_VERSION")).cloned(),
        }
    }

    /// Compares a recorded message with the simulated one.
    pub(super) fn take(&mut self, recorded: &Message<'_>) {
        if self.difference.is_some() {
            return;
        }
        self.simulate_past(recorded.time_ns);
        let found = self.ahead.iter().position(|simulated| {
            simulated.channel == recorded.channel && simulated.sequence == recorded.sequence
        });
        if found.is_some_and(|at| at > 0) && self.early.is_none() {
            self.early = Some(place(recorded));
        }
        match found.and_then(|at| self.ahead.remove(at)) {
            Some(simulated) => {
                self.difference = difference(recorded, &simulated, self.of.kept(recorded.channel));
                self.equal += 1;
            }
            None => {
                self.difference = Some(format!(
                    "{}: the simulation gives no such message",
                    place(recorded)
                ));
            }
        }
    }

    /// Simulates until everything up to a time is known.
    fn simulate_past(&mut self, time_ns: u64) {
        while self.reached_ns.is_none_or(|reached| reached <= time_ns) {
            if !self.simulate_one() {
                self.reached_ns = Some(u64::MAX);
            }
            self.leave_behind(time_ns);
        }
        self.leave_behind(time_ns);
    }

    /// What is earlier than what is recorded next, and was not met, is not recorded.
    fn leave_behind(&mut self, time_ns: u64) {
        while self.ahead.front().is_some_and(|m| m.time_ns < time_ns) {
            self.ahead.pop_front();
            self.missing += 1;
        }
    }

    /// Simulates one record; false at the end.
    fn simulate_one(&mut self) -> bool {
        let Ok(simulation) = &mut self.simulation else {
            return false;
        };
        if self.has_failed {
            return false;
        }
        let record = match simulation.next() {
            Some(Ok(record)) => record,
            ended => {
                self.has_failed = ended.is_some();
                return false;
            }
        };
        self.reached_ns = Some(record.time_ns());
        let ahead = &mut self.ahead;
        let logged = self.telemetry.messages(&record, |message| {
            ahead.push_back(Owned::from(message));
            Ok::<(), TelemetryError>(())
        });
        // What could not be logged ended the run that was recorded, too.
        self.has_failed = logged.is_err();
        logged.is_ok()
    }

    /// `is_all_there` tells whether the recording is whole.
    pub(super) fn check(mut self, is_all_there: bool) -> Check {
        let (verdict, finding) = self.conclude(is_all_there);
        let finding = match &self.version {
            Some(version) if verdict == Verdict::Failed => {
                let this = env!("CARGO_PKG_VERSION");
                format!("{finding}; recorded by toprise {version}, simulated by {this}")
            }
            _ => finding,
        };
        Check::new(Group::Reproduction, "simulated again", verdict, finding)
    }

    fn conclude(&mut self, is_all_there: bool) -> (Verdict, String) {
        if let Err(error) = &self.simulation {
            return (Verdict::Failed, error.clone());
        }
        if let Some(difference) = &self.difference {
            return (Verdict::Failed, difference.clone());
        }
        let missing = self.missing;
        if is_all_there && missing > 0 {
            let finding = format!("{missing} messages of the simulation are not recorded");
            return (Verdict::Failed, finding);
        }
        if let Some(early) = self.early.as_ref().filter(|_| is_all_there) {
            let finding = format!("{early}: the simulation gives others of its time before it");
            return (Verdict::Failed, finding);
        }
        let mut equal = format!("all {} messages are equal, bit for bit", self.equal);
        if !self.of.is_current() {
            let number = self.of.number();
            equal += &format!(", in all fields of telemetry {number}");
        }
        let reason = self.end.as_ref().and_then(|end| end.get(STOP_REASON));
        // The simulation would go on.
        let is_interrupted = reason.is_some_and(|r| r == StopReason::Interrupted.name());
        if is_all_there || self.is_recovered {
            let compared = match is_interrupted {
                true => self.refuse_unknown_ends(),
                false => self.compare_ends(is_all_there),
            };
            if let Err(problem) = compared {
                return (Verdict::Failed, problem);
            }
        }
        if is_all_there && !is_interrupted {
            return (Verdict::Passed, equal);
        }
        let finding = match missing {
            0 => format!("{equal}, as far as they go"),
            missing => format!("{equal}; {missing} are missing in between"),
        };
        (Verdict::Incomplete, finding)
    }

    /// Compares the end of the run that was recorded with the simulation's. What a recovered recording counts is what
    /// is left.
    fn compare_ends(&mut self, is_all_there: bool) -> Result<(), String> {
        while (self.ahead.is_empty() || !is_all_there) && self.simulate_one() {
            if !is_all_there {
                self.ahead.clear();
            }
        }
        if let Some(next) = self.ahead.front().filter(|_| is_all_there) {
            return Err(format!(
                "the recording ends, but the simulation goes on with {} at {} s",
                channels()[next.channel].topic,
                next.time_ns as f64 / 1e9
            ));
        }
        let (Ok(simulation), Some(recorded)) = (&self.simulation, &self.end) else {
            return Ok(());
        };
        let mut end = simulation.end();
        if self.has_failed {
            end.stop = StopReason::Failed;
        }
        let is_count = |key: &String| COUNTS.iter().any(|(count, _)| count == key);
        for (key, simulated) in end_entries(&end) {
            let noted = recorded.get(&key).map_or("nothing", String::as_str);
            if noted != simulated && (is_all_there || !is_count(&key)) {
                return Err(format!(
                    "the end record says {key} = {noted}, the simulation {simulated}"
                ));
            }
        }
        self.refuse_unknown_ends()
    }

    /// Refuses an end record that says something beside what those of a simulation say.
    fn refuse_unknown_ends(&self) -> Result<(), String> {
        let (Ok(simulation), Some(recorded)) = (&self.simulation, &self.end) else {
            return Ok(());
        };
        let known = end_entries(&simulation.end());
        let mut said = recorded.iter();
        let unknown = said.find(|(key, _)| !known.contains_key(*key) && *key != CONTENT_DIGEST);
        match unknown {
            None => Ok(()),
            Some((key, value)) => Err(format!(
                "the end record says {key} = {value}, which means nothing"
            )),
        }
    }
}

/// The first difference between two messages, for people.
fn difference(recorded: &Message<'_>, simulated: &Owned, kept: &[usize]) -> Option<String> {
    let info = &channels()[recorded.channel];
    if recorded.time_ns != simulated.time_ns {
        let time = simulated.time_ns as f64 / 1e9;
        return Some(format!("{}: simulated at {time} s", place(recorded)));
    }
    for at in kept {
        let (a, b) = (&recorded.numbers[*at], &simulated.numbers[*at]);
        if a.to_bits() != b.to_bits() {
            return Some(format!(
                "t = {} s {}.{}: recorded {a:?}, simulated {b:?}, {} ulp apart",
                recorded.time_ns as f64 / 1e9,
                info.topic,
                info.numbers[*at].path,
                ulp_distance(*a, *b)
            ));
        }
    }
    for (leaf, (a, b)) in info
        .texts
        .iter()
        .zip(recorded.texts.iter().zip(&simulated.texts))
    {
        if a != b {
            return Some(format!(
                "t = {} s {}.{}: recorded {a:?}, simulated {b:?}",
                recorded.time_ns as f64 / 1e9,
                info.topic,
                leaf.path
            ));
        }
    }
    None
}

fn place(message: &Message<'_>) -> String {
    format!(
        "{} message {} at {} s",
        channels()[message.channel].topic,
        message.sequence,
        message.time_ns as f64 / 1e9
    )
}
