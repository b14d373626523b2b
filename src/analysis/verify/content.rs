//! The messages, one by one: as their schemas say, at their times, in sequence, counted.

use super::physics::Physics;
use super::reproduction::Reproduction;
use crate::archive::check::{Check, Group, Problems, Verdict};
use crate::archive::format::{
    CONTENT_DIGEST, COUNTS, LIBRARY_PREFIX, SAMPLE_PERIOD, SCENARIO_DIGEST, STEPS, VERSION,
    run_entries,
};
use crate::archive::recording::{Any, Condition, NoScenario, Recording, Selection, Undecoded};
use crate::run::scenario::Scenario;
use crate::telemetry::digest::ContentDigest;
use crate::telemetry::encoding::Encoding;
use crate::telemetry::views::{Views, view_channels};
use crate::telemetry::{Message, channels};
use std::collections::VecDeque;

/// What to check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Whether to simulate the scenario again, which takes longest.
    pub reproduce: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { reproduce: true }
    }
}

/// Checks everything about the messages of a recording.
pub(super) fn check(recording: &Recording, options: Options, progress: &dyn Fn(u64)) -> Vec<Check> {
    let scenario = recording.scenario();
    let mut checks = vec![attached(recording, &scenario)];
    let scenario = scenario.ok();
    let mut content = Content::new(recording, scenario.as_ref());
    let steps = recording.end().and_then(|end| end.get(STEPS)?.parse().ok());
    let mut physics = scenario.as_ref().map(|s| Physics::new(s, steps));
    let mut reproduction = match &scenario {
        Some(scenario) if options.reproduce => Some(Reproduction::new(recording, scenario)),
        _ => None,
    };
    let mut views = scenario.as_ref().map(|s| ViewCheck::new(recording, s));
    let mut reader = recording.reader(Selection::default());
    while let Some(next) = reader.next_of_any() {
        match next {
            Ok(Any::Decoded(message)) => {
                content.take(&message);
                if let Some(physics) = &mut physics {
                    physics.take(&message);
                }
                if let Some(reproduction) = &mut reproduction {
                    reproduction.take(&message);
                }
                if let Some(views) = &mut views {
                    views.expect(&message);
                }
            }
            Ok(Any::Other(message)) => {
                if let Some(views) = &mut views {
                    views.take(&message);
                }
            }
            Err(error) => content.messages.add(|| error.to_string()),
        }
        progress(reader.progress());
    }
    let losses = recording.losses().iter().chain(reader.losses());
    let lost = losses.filter(|loss| loss.span.is_some()).count();
    let is_all_there =
        lost == 0 && content.messages.count == 0 && recording.condition() == Condition::Whole;
    checks.extend(content.checks(recording, lost));
    checks.extend(views.map(|views| views.check(is_all_there)));
    checks.extend(physics.into_iter().flat_map(Physics::checks));
    checks.push(match reproduction {
        Some(reproduction) => reproduction.check(is_all_there),
        None => {
            let finding = match options.reproduce {
                true => "without its scenario it can't be simulated again",
                false => "not asked for",
            };
            Check::new(
                Group::Reproduction,
                "simulated again",
                Verdict::Skipped,
                finding.to_owned(),
            )
        }
    });
    checks
}

/// Whether the scenario is there and fits what the recording says of it.
fn attached(recording: &Recording, scenario: &Result<Scenario, NoScenario>) -> Check {
    let mut problems = Problems::default();
    let mut finding = String::new();
    match scenario {
        Ok(scenario) => {
            finding = format!("{}, digest {:.16}…", scenario.name(), scenario.digest());
            let run = recording.run();
            let noted = run.and_then(|run| run.get(SCENARIO_DIGEST));
            problems.unless(noted == Some(&scenario.digest()), || match noted {
                Some(noted) => format!("its digest is {}, not {noted}", scenario.digest()),
                None => "the record toprise.run, which names its digest, is lost".to_owned(),
            });
            for (key, expected) in run_entries(scenario) {
                let noted = run.and_then(|run| run.get(&key));
                let is_right = run.is_none() || key == VERSION || noted == Some(&expected);
                problems.unless(is_right, || match noted {
                    Some(noted) => {
                        format!("toprise.run says that {key} is {noted}, not {expected}")
                    }
                    None => format!("toprise.run doesn't say what {key} is"),
                });
            }
            // A run that was cut off is as its simulation left it.
            let version = recording.library().strip_prefix(LIBRARY_PREFIX);
            let noted = run.and_then(|run| run.get(VERSION)).map(String::as_str);
            let is_original = recording.condition() == Condition::Interrupted;
            problems.unless(!is_original || run.is_none() || noted == version, || {
                "toprise.run names another version than the header of the file".to_owned()
            });
        }
        Err(error) if recording.recovery().is_some() => {
            let finding = error.to_string();
            return Check::new(Group::Telemetry, "scenario", Verdict::Incomplete, finding);
        }
        Err(error) => problems.add(|| error.to_string()),
    }
    Check::of(Group::Telemetry, "scenario", &problems, finding)
}

/// What is seen of the messages.
struct Content {
    messages: Problems,
    times: Problems,
    sequence: Problems,
    counts: Vec<Count>,
    digest: ContentDigest,
    period_ns: Option<u64>,
    last_ns: u64,
    total: u64,
}

/// Messages of one channel.
#[derive(Clone, Copy, Default)]
struct Count {
    messages: u64,
    last: Option<(u32, u64)>,
    /// Messages that are missing in between.
    gaps: u64,
}

impl Content {
    fn new(recording: &Recording, scenario: Option<&Scenario>) -> Self {
        let run = recording.run();
        let noted = run.and_then(|run| run.get(SAMPLE_PERIOD)?.parse().ok());
        let of_scenario = || scenario.map(|scenario| scenario.sample_period_ns);
        Self {
            messages: Problems::default(),
            times: Problems::default(),
            sequence: Problems::default(),
            counts: vec![Count::default(); channels().len()],
            digest: ContentDigest::default(),
            period_ns: noted.or_else(of_scenario),
            last_ns: 0,
            total: 0,
        }
    }

    fn take(&mut self, message: &Message<'_>) {
        self.total += 1;
        self.digest.update(message);
        let info = &channels()[message.channel];
        let (topic, time, number) = (info.topic, message.time_ns, message.sequence);
        let place = || format!("{topic} message {number} at {} s", time as f64 / 1e9);
        let finite = message.numbers.iter().all(|number| number.is_finite());
        self.messages.unless(finite, || {
            format!("{}: not all of its numbers are finite", place())
        });
        self.times.unless(self.last_ns <= time, || {
            format!("{}: it stands behind a later one", place())
        });
        self.last_ns = time;
        let count = &mut self.counts[message.channel];
        if info.is_sampled {
            let due = |period| u64::from(number).saturating_mul(period);
            let due = self.period_ns.map(due);
            self.times.unless(due.is_none_or(|due| due == time), || {
                format!(
                    "{}: it is due at {} s",
                    place(),
                    due.unwrap_or(0) as f64 / 1e9
                )
            });
        }
        let next = count.last.map_or(0, |(last, _)| u64::from(last) + 1);
        let is_later = u64::from(number) >= next;
        self.sequence.unless(is_later, || {
            format!("{}: it comes twice or out of order", place())
        });
        let is_strict = !info.is_sampled || count.last.is_none_or(|(_, last)| last < time);
        self.times.unless(is_strict, || {
            format!("{}: it is no later than the last", place())
        });
        if !info.is_optional {
            count.gaps += u64::from(number).saturating_sub(next);
        }
        count.last = Some((number, time));
        count.messages += 1;
    }

    fn checks(mut self, recording: &Recording, lost: usize) -> Vec<Check> {
        let group = Group::Telemetry;
        let mut schemas = Problems::default();
        self.check_schemas(recording, &mut schemas);
        let messages = format!("all {} are what their schemas say", self.total);
        let period = self.period_ns.map(|period| period as f64 / 1e9);
        let times = match period {
            Some(period) => format!(
                "samples every {period} s, to {} s",
                self.last_ns as f64 / 1e9
            ),
            None => format!("ordered, to {} s", self.last_ns as f64 / 1e9),
        };
        let mut checks = vec![
            Check::of(
                group,
                "schemas",
                &schemas,
                "those of this version".to_owned(),
            ),
            Check::of(group, "messages", &self.messages, messages),
            Check::of(group, "times", &self.times, times),
            self.sequence_check(recording, lost),
        ];
        checks.extend(self.end_checks(recording));
        checks
    }

    fn check_schemas(&self, recording: &Recording, problems: &mut Problems) {
        for (topic, differences) in recording.differences() {
            let mut parts = Vec::new();
            if !differences.missing.is_empty() {
                parts.push(format!("lacks {}", differences.missing.join(", ")));
            }
            if !differences.unknown.is_empty() {
                parts.push(format!("has beside it {}", differences.unknown.join(", ")));
            }
            problems.add(|| format!("{topic} {}", parts.join(" and ")));
        }
        for channel in recording.channels() {
            let (Some(info), Some(schema)) = (channel.info(), &channel.schema) else {
                continue;
            };
            let Some(encoding) = Encoding::find(&channel.encoding) else {
                problems.add(|| {
                    let encoding = &channel.encoding;
                    format!(
                        "{} is encoded as {encoding:?}, not json or protobuf",
                        channel.topic
                    )
                });
                continue;
            };
            let is_ours = schema.name == info.schema
                && schema.encoding == encoding.schema_encoding()
                && schema.data == encoding.schema(info);
            problems.unless(is_ours, || {
                format!(
                    "the schema of {} is not that of this version",
                    channel.topic
                )
            });
        }
    }

    fn sequence_check(&mut self, recording: &Recording, lost: usize) -> Check {
        let group = Group::Telemetry;
        let gaps: u64 = self.counts.iter().map(|count| count.gaps).sum();
        let excused = lost > 0 || recording.condition() == Condition::Recovered;
        if gaps > 0 && excused && self.sequence.count == 0 {
            let finding = format!("{gaps} messages are missing where parts were lost");
            return Check::new(group, "sequence", Verdict::Incomplete, finding);
        }
        for (info, count) in channels().iter().zip(&self.counts) {
            let (topic, gaps) = (info.topic, count.gaps);
            self.sequence.unless(gaps == 0, || {
                format!("{topic} lacks {gaps} messages in between")
            });
        }
        let finding = "no message is missing in between".to_owned();
        Check::of(group, "sequence", &self.sequence, finding)
    }

    /// What the end record says, against what there is.
    fn end_checks(&self, recording: &Recording) -> Vec<Check> {
        let group = Group::Telemetry;
        let digest = self.digest.finish();
        let Some(end) = recording.end() else {
            let finding = format!("{digest} so far; there is no end record to hold it to");
            let verdict = Verdict::Incomplete;
            return vec![Check::new(group, "content digest", verdict, finding)];
        };
        let mut counts = Problems::default();
        for (key, topic) in COUNTS {
            let is_recorded = recording.has(topic);
            let found = self.counts[topic.index()].messages.to_string();
            let noted = end.get(key);
            counts.unless(!is_recorded || noted == Some(&found), || {
                let noted = noted.map_or("nothing", String::as_str);
                format!("{found} messages on {topic}; the end record says {noted}")
            });
        }
        let mut of_digest = Problems::default();
        let noted = end.get(CONTENT_DIGEST);
        of_digest.unless(noted == Some(&digest), || {
            let noted = noted.map_or("nothing", String::as_str);
            format!("it is {digest}; the end record says {noted}")
        });
        vec![
            Check::of(group, "counts", &counts, "as in the end record".to_owned()),
            Check::of(group, "content digest", &of_digest, digest),
        ]
    }
}

/// How many messages of view channels may be outstanding at a time.
const VIEWS_AHEAD: usize = 1000;

/// Whether the channels for viewers say the same as those of the table.
struct ViewCheck {
    views: Views,
    /// Views that must come: topic, sequence and bytes.
    expected: VecDeque<(&'static str, u32, Vec<u8>)>,
    problems: Problems,
    found: u64,
    /// Views that follow from no message that is there.
    unexpected: u64,
    /// Views that should be there.
    missing: u64,
    is_recorded: bool,
}

impl ViewCheck {
    fn new(recording: &Recording, scenario: &Scenario) -> Self {
        Self {
            views: Views::new(scenario, |topic| recording.has(topic)),
            expected: VecDeque::new(),
            problems: Problems::default(),
            found: 0,
            unexpected: 0,
            missing: 0,
            is_recorded: recording.channels().iter().any(|channel| channel.is_view()),
        }
    }

    fn expect(&mut self, message: &Message<'_>) {
        if !self.is_recorded {
            return;
        }
        let expected = &mut self.expected;
        self.views.take(message, |channel, sequence, data| {
            expected.push_back((view_channels()[channel].topic, sequence, data.to_vec()));
        });
        // Views stand right behind what they follow from: what is so far behind never comes.
        while self.expected.len() > VIEWS_AHEAD {
            self.expected.pop_front();
            self.missing += 1;
        }
    }

    fn take(&mut self, message: &Undecoded<'_>) {
        if !message.channel.is_view() {
            return;
        }
        self.found += 1;
        let is_it = |(topic, sequence, _): &(&str, u32, Vec<u8>)| {
            *topic == message.channel.topic && *sequence == message.sequence
        };
        let Some(position) = self.expected.iter().position(is_it) else {
            self.unexpected += 1;
            return;
        };
        self.missing += position as u64;
        let expected = self.expected.drain(..=position).next_back();
        let right = expected.is_some_and(|(_, _, data)| data == message.data);
        self.problems.unless(right, || {
            let (topic, sequence) = (&message.channel.topic, message.sequence);
            format!("{topic} message {sequence} is not what follows from the data")
        });
    }

    fn check(mut self, is_all_there: bool) -> Check {
        let group = Group::Telemetry;
        if !self.is_recorded {
            let finding = "there are none".to_owned();
            return Check::new(group, "views", Verdict::Skipped, finding);
        }
        // Where messages are lost, views are without them, or lost with them.
        let (unexpected, missing) = (self.unexpected, self.missing + self.expected.len() as u64);
        if is_all_there {
            self.problems.unless(unexpected == 0 && missing == 0, || {
                format!("{unexpected} follow from nothing, {missing} are missing")
            });
        }
        if !is_all_there && unexpected > 0 && self.problems.count == 0 {
            let finding = format!(
                "{} follow from the data, {unexpected} from nothing that is there",
                self.found - unexpected
            );
            return Check::new(group, "views", Verdict::Incomplete, finding);
        }
        let finding = format!("all {} follow from the data", self.found - unexpected);
        Check::of(group, "views", &self.problems, finding)
    }
}
