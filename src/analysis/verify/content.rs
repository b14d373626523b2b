//! The messages, one by one: as their schemas say, at their times, in sequence, counted.

use super::physics::Physics;
use super::reproduction::Reproduction;
use crate::archive::check::{Check, Group, Problems, Verdict};
use crate::archive::format::{CONTENT_DIGEST, COUNTS, SAMPLE_PERIOD, STEPS};
use crate::archive::recording::{Condition, Recording, Selection, Undecoded};
use crate::run::scenario::Scenario;
use crate::telemetry::digest::ContentDigest;
use crate::telemetry::encoding::Encoder;
use crate::telemetry::views::{Views, view_channels};
use crate::telemetry::{Message, Version, channels};
use std::collections::{BTreeSet, VecDeque};

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
pub(super) fn check(
    recording: &Recording,
    scenario: Option<&Scenario>,
    version: &Version,
    options: Options,
    progress: &dyn Fn(u64),
) -> Vec<Check> {
    let mut checks = Vec::new();
    let mut content = Content::new(recording, scenario, version.clone());
    let steps = recording.end().and_then(|end| end.get(STEPS)?.parse().ok());
    let mut physics = scenario.map(|s| Physics::new(s, steps));
    let mut reproduction = match scenario {
        Some(scenario) if options.reproduce => {
            Some(Reproduction::new(recording, scenario, version.clone()))
        }
        _ => None,
    };
    let mut views = scenario.map(|s| ViewCheck::new(recording, s, version));
    let mut reader = recording.reader(Selection::default());
    while let Some((raw, decoded)) = reader.next_both() {
        content.take_raw(&raw);
        match decoded {
            Some(Ok(message)) => {
                content.take(&message, &raw);
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
            Some(Err(error)) => content.messages.add(|| error.to_string()),
            None => {
                if let Some(views) = &mut views {
                    views.take(&raw);
                }
            }
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

/// What is seen of the messages.
struct Content {
    messages: Problems,
    times: Problems,
    sequence: Problems,
    counts: Vec<Count>,
    digest: ContentDigest,
    version: Version,
    /// Encodes the messages again; none if they don't all have the same encoding.
    encoder: Option<Encoder>,
    encoded: Vec<u8>,
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
    fn new(recording: &Recording, scenario: Option<&Scenario>, version: Version) -> Self {
        let run = recording.run();
        let noted = run.and_then(|run| run.get(SAMPLE_PERIOD)?.parse().ok());
        let of_scenario = || scenario.map(|scenario| scenario.sample_period_ns);
        Self {
            messages: Problems::default(),
            times: Problems::default(),
            sequence: Problems::default(),
            counts: vec![Count::default(); channels().len()],
            digest: ContentDigest::default(),
            encoder: recording
                .encoding()
                .map(|encoding| Encoder::of(encoding, version.channels())),
            version,
            encoded: Vec::new(),
            period_ns: noted.or_else(of_scenario),
            last_ns: 0,
            total: 0,
        }
    }

    /// Takes a message of any channel, as it stands in the file.
    fn take_raw(&mut self, raw: &Undecoded<'_>) {
        let place = || {
            let (topic, seconds) = (&raw.channel.topic, raw.log_time as f64 / 1e9);
            format!("{topic} message {} at {seconds} s", raw.sequence)
        };
        self.times.unless(self.last_ns <= raw.log_time, || {
            format!("{}: it stands behind a later one", place())
        });
        self.last_ns = raw.log_time;
        self.times.unless(raw.publish_time == raw.log_time, || {
            let seconds = raw.publish_time as f64 / 1e9;
            format!("{}: its publish time is {seconds} s", place())
        });
    }

    /// Takes a decoded message of the table.
    fn take(&mut self, message: &Message<'_>, raw: &Undecoded<'_>) {
        self.total += 1;
        let message = &self.version.narrowed(message);
        self.digest.update(message);
        let info = &channels()[message.channel];
        let (topic, time, number) = (info.topic, message.time_ns, message.sequence);
        let place = || format!("{topic} message {number} at {} s", time as f64 / 1e9);
        let finite = message.numbers.iter().all(|number| number.is_finite());
        self.messages.unless(finite, || {
            format!("{}: not all of its numbers are finite", place())
        });
        if let Some(encoder) = &self.encoder {
            self.encoded.clear();
            encoder.encode(message, &mut self.encoded);
            let is_it = raw.data == self.encoded;
            self.messages.unless(is_it, || {
                format!("{}: it is not written as toprise writes it", place())
            });
        }
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
            Check::of(group, "messages", &self.messages, messages),
            Check::of(group, "times", &self.times, times),
            self.sequence_check(recording, lost),
        ];
        checks.extend(self.end_checks(recording));
        checks
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
    /// The topics of views that have a channel.
    recorded: BTreeSet<&'static str>,
    /// Views that must come.
    expected: VecDeque<ExpectedView>,
    problems: Problems,
    found: u64,
    /// Views that follow from no message that is there.
    unexpected: u64,
    /// Views that should be there.
    missing: u64,
    /// Whether some don't stand right behind what they follow from.
    is_late: bool,
}

/// A message of a view channel that follows from the data.
struct ExpectedView {
    topic: &'static str,
    sequence: u32,
    time_ns: u64,
    data: Vec<u8>,
}

impl ViewCheck {
    fn new(recording: &Recording, scenario: &Scenario, version: &Version) -> Self {
        let has = |topic| recording.has(topic);
        Self {
            views: Views::of_version(version.number(), scenario, has),
            expected: VecDeque::new(),
            problems: Problems::default(),
            found: 0,
            unexpected: 0,
            missing: 0,
            is_late: false,
            recorded: view_channels()
                .iter()
                .map(|view| view.topic)
                .filter(|topic| recording.channels().iter().any(|c| c.topic == *topic))
                .collect(),
        }
    }

    fn expect(&mut self, message: &Message<'_>) {
        if self.recorded.is_empty() {
            return;
        }
        self.is_late |= !self.expected.is_empty();
        let (expected, recorded) = (&mut self.expected, &self.recorded);
        self.views.take(message, |channel, sequence, data| {
            let topic = view_channels()[channel].topic;
            if !recorded.contains(topic) {
                return;
            }
            expected.push_back(ExpectedView {
                topic,
                sequence,
                time_ns: message.time_ns,
                data: data.to_vec(),
            });
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
        let is_it = |expected: &ExpectedView| {
            expected.topic == message.channel.topic && expected.sequence == message.sequence
        };
        let Some(position) = self.expected.iter().position(is_it) else {
            self.unexpected += 1;
            return;
        };
        self.missing += position as u64;
        let expected = self.expected.drain(..=position).next_back();
        let right = expected.is_some_and(|expected| {
            expected.data == message.data && expected.time_ns == message.log_time
        });
        self.problems.unless(right, || {
            let (topic, sequence) = (&message.channel.topic, message.sequence);
            format!("{topic} message {sequence} is not what follows from the data")
        });
    }

    fn check(mut self, is_all_there: bool) -> Check {
        let group = Group::Telemetry;
        if self.recorded.is_empty() {
            let finding = "there are none".to_owned();
            return Check::new(group, "views", Verdict::Skipped, finding);
        }
        // Where messages are lost, views are without them, or lost with them.
        let (unexpected, missing) = (self.unexpected, self.missing + self.expected.len() as u64);
        if is_all_there {
            self.problems.unless(unexpected == 0 && missing == 0, || {
                format!("{unexpected} follow from nothing, {missing} are missing")
            });
            self.problems.unless(!self.is_late, || {
                "some don't stand right behind what they follow from".to_owned()
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
