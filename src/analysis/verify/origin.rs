//! What a recording says of itself beside its messages: header, metadata, attachments, channels; and what of that
//! nothing tells to be true.

use crate::archive::check::{Check, Group, Problems, Verdict};
use crate::archive::format::{
    ENCODING, END_RECORD, LIBRARY_PREFIX, RECOVERY_RECORD, RUN_RECORD, SCENARIO_ATTACHMENT,
    SCENARIO_DIGEST, STOP_REASON, TELEMETRY, TOPICS, VERSION, VIEWS, recorded_form, run_entries,
    scenario_attachment,
};
use crate::archive::recording::{Condition, FileChannel, NoScenario, Recording};
use crate::physics::dynamics::Support;
use crate::run::scenario::Scenario;
use crate::run::simulation::StopReason;
use crate::telemetry::encoding::Encoding;
use crate::telemetry::views::{Views, view_channels};
use crate::telemetry::{Topic, Version};
use std::collections::BTreeSet;

/// The metadata records of toprise, each of which a file has once at most.
const OUR_RECORDS: [&str; 3] = [RUN_RECORD, END_RECORD, RECOVERY_RECORD];

/// Checks what stands around the messages.
pub(super) fn check(
    recording: &Recording,
    scenario: &Result<Scenario, NoScenario>,
    version: &Version,
) -> Vec<Check> {
    vec![
        of_scenario(recording, scenario, version),
        of_header(recording),
        of_channels(recording, scenario.as_ref().ok()),
        of_schemas(recording, version),
    ]
}

/// Whether the scenario is there and fits what the recording says of it.
fn of_scenario(
    recording: &Recording,
    scenario: &Result<Scenario, NoScenario>,
    version: &Version,
) -> Check {
    let group = Group::Telemetry;
    let mut problems = Problems::default();
    for name in OUR_RECORDS {
        let count = recording.all_metadata().filter(|(n, _)| *n == name).count();
        problems.unless(count <= 1, || format!("{count} records are called {name}"));
    }
    let mut finding = String::new();
    match scenario {
        Ok(scenario) => {
            finding = format!("{}, digest {:.16}…", scenario.name(), scenario.digest());
            of_run_record(recording, scenario, version, &mut problems);
            of_attachment(recording, &mut problems);
        }
        Err(error) if recording.recovery().is_some() && problems.count == 0 => {
            return Check::new(group, "scenario", Verdict::Incomplete, error.to_string());
        }
        Err(error) => problems.add(|| error.to_string()),
    }
    Check::of(group, "scenario", &problems, finding)
}

/// Whether `toprise.run` says what follows from the scenario.
fn of_run_record(
    recording: &Recording,
    scenario: &Scenario,
    version: &Version,
    problems: &mut Problems,
) {
    let Some(run) = recording.run() else {
        problems.add(|| "the record toprise.run, which names its digest, is lost".to_owned());
        return;
    };
    let mut expected = run_entries(scenario);
    // The first version didn't say which it was, nor in which form it recorded.
    let is_first = version.number() == 1;
    if is_first {
        expected.remove(TELEMETRY);
    } else {
        expected.insert(TELEMETRY.to_owned(), version.number().to_string());
    }
    // What is said first is most telling: another digest is another scenario.
    let (digest, noted) = (&expected[SCENARIO_DIGEST], run.get(SCENARIO_DIGEST));
    problems.unless(noted.is_none_or(|noted| noted == digest), || {
        format!("its digest is {digest}, not {}", run[SCENARIO_DIGEST])
    });
    for (key, expected) in expected.iter().filter(|(key, _)| *key != VERSION) {
        let noted = run.get(key);
        problems.unless(noted == Some(expected), || match noted {
            Some(noted) => format!("toprise.run says that {key} is {noted}, not {expected}"),
            None => format!("toprise.run doesn't say what {key} is"),
        });
    }
    let form = recorded_form(run).and_then(|_| recording.form_entries());
    let form = form.filter(|_| !is_first);
    problems.unless(form.is_some() || is_first, || {
        format!(
            "toprise.run doesn't say what {ENCODING}, {VIEWS} and {TOPICS} are, or says it wrongly"
        )
    });
    for (key, noted) in run.iter().filter(|(key, _)| !expected.contains_key(*key)) {
        let right = form.as_ref().and_then(|form| form.get(key));
        problems.unless(right.is_none_or(|right| right == noted), || {
            format!("toprise.run says that {key} is {noted}, which the file is not")
        });
        let is_of_form = [ENCODING, VIEWS, TOPICS].contains(&key.as_str());
        problems.unless(is_of_form && !is_first, || {
            format!("toprise.run says that {key} is {noted}, which means nothing")
        });
    }
    let noted = run.get(VERSION).map_or("", String::as_str);
    problems.unless(is_version(noted), || {
        format!("toprise.run says that version is {noted:?}, which is none")
    });
    // A run that was cut off is as its simulation left it.
    let version = recording.library().strip_prefix(LIBRARY_PREFIX);
    let is_original = recording.condition() == Condition::Interrupted;
    problems.unless(!is_original || Some(noted) == version, || {
        "toprise.run names another version than the header of the file".to_owned()
    });
}

/// Whether the attachment with the scenario is the only one, and described as such.
fn of_attachment(recording: &Recording, problems: &mut Problems) {
    let attachments = recording.layout.attachments.iter();
    let ours: Vec<_> = attachments
        .filter(|attachment| attachment.name == SCENARIO_ATTACHMENT)
        .collect();
    problems.unless(ours.len() == 1, || {
        format!(
            "{} attachments are called {SCENARIO_ATTACHMENT}",
            ours.len()
        )
    });
    for attachment in ours {
        let expected = scenario_attachment(String::new());
        let header = recording
            .attachment(&attachment.place)
            .map(|(header, _)| header);
        problems.unless(
            header.is_ok_and(|found| {
                found.media_type == expected.media_type
                    && found.log_time == expected.log_time
                    && found.create_time == expected.create_time
            }),
            || format!("{SCENARIO_ATTACHMENT} has another media type or other times than it must"),
        );
    }
}

/// Whether a text is a version as cargo writes them: numbers between dots.
fn is_version(text: &str) -> bool {
    let is_number = |part: &str| part.parse::<u32>().is_ok_and(|n| n.to_string() == part);
    let numbers = text.split('.').filter(|part| is_number(part)).count();
    text == env!("CARGO_PKG_VERSION") || (numbers == 3 && text.split('.').count() == 3)
}

/// Whether the header of the file is one that toprise writes, or that of a program that has rewritten it.
fn of_header(recording: &Recording) -> Check {
    let mut problems = Problems::default();
    let (profile, library) = (&recording.layout.profile, recording.library());
    problems.unless(profile.is_empty(), || {
        format!("its header claims the profile {profile:?}, which toprise doesn't keep")
    });
    let version = library.strip_prefix(LIBRARY_PREFIX);
    problems.unless(version.is_none_or(is_version), || {
        format!("its header names {library:?}, which is no version of toprise")
    });
    let finding = format!("written by {library}");
    Check::of(Group::Telemetry, "header", &problems, finding)
}

/// Whether the channels are those that toprise writes, and which of them are missing.
fn of_channels(recording: &Recording, scenario: Option<&Scenario>) -> Check {
    let group = Group::Telemetry;
    let mut problems = Problems::default();
    let mut topics = BTreeSet::new();
    for channel in recording.channels() {
        let topic = &channel.topic;
        problems.unless(topics.insert(topic), || {
            format!("there are two channels {topic}")
        });
        problems.unless(channel.metadata.is_empty(), || {
            format!("{topic} has metadata, which channels of toprise have not")
        });
        problems.unless(channel.table.is_some() || channel.is_view(), || {
            format!("{topic} is no channel of toprise")
        });
        let is_own = match (scenario, channel.table) {
            (Some(scenario), Some(table)) => {
                scenario.model.support.is_free() || !table.info().is_of_free_peg
            }
            _ => true,
        };
        problems.unless(is_own, || format!("{topic} is a channel of free pegs"));
    }
    let encoding = recording.encoding();
    problems.unless(encoding.is_some() || recording.topics().is_empty(), || {
        "they are not all encoded as json, or all as protobuf".to_owned()
    });
    let views = scenario.map(|s| Views::new(s, |topic| recording.has(topic)));
    for (index, view) in view_channels().iter().enumerate() {
        let is_wanted = views.as_ref().is_none_or(|views| views.wants(index));
        problems.unless(
            is_wanted || !topics.iter().any(|topic| *topic == view.topic),
            || format!("{} follows from no channel", view.topic),
        );
    }
    let without = without(recording, scenario);
    if problems.count == 0 && !without.is_empty() {
        let named = recording.run().and_then(recorded_form);
        let is_recorded = |topic: &&String| match (&named, Topic::find(topic)) {
            (Some((_, _, topics)), Some(topic)) => topics.include(&topic),
            (named, _) => named.is_some(),
        };
        let dropped: Vec<_> = without.iter().filter(is_recorded).cloned().collect();
        if dropped.is_empty() {
            let finding = format!("without {}", without.join(", "));
            return Check::new(group, "channels", Verdict::Partial, finding);
        }
        let finding = format!("{}: recorded, but not there any more", dropped.join(", "));
        return Check::new(group, "channels", Verdict::Incomplete, finding);
    }
    let name = encoding.map_or("", Encoding::name);
    let finding = format!("all {}, as {name}", recording.channels().len());
    Check::of(group, "channels", &problems, finding)
}

/// The topics of toprise that a recording doesn't have. Views belong together: a file has all that follow from its
/// channels, or none if it was recorded without.
pub(super) fn without(recording: &Recording, scenario: Option<&Scenario>) -> Vec<String> {
    if recording.channels().is_empty() {
        return Vec::new();
    }
    let support = scenario.map_or(Support::FixedPeg, |scenario| scenario.model.support);
    let topics = Topic::all_with(support).filter(|topic| !recording.has(*topic));
    let mut without: Vec<_> = topics.map(|topic| topic.to_string()).collect();
    let has = |topic: &str| recording.channels().iter().any(|c| c.topic == topic);
    let named = recording.run().and_then(recorded_form);
    let has_views = named.is_some_and(|(_, views, _)| views)
        || recording.channels().iter().any(FileChannel::is_view);
    if let Some(scenario) = scenario.filter(|_| has_views) {
        let views = Views::new(scenario, |topic| recording.has(topic));
        let views = view_channels()
            .iter()
            .enumerate()
            .filter(|(index, _)| views.wants(*index));
        let missing = views.filter(|(_, view)| !has(view.topic));
        without.extend(missing.map(|(_, view)| view.topic.to_owned()));
    }
    without
}

/// Whether the channels have the schemas of the version of the telemetry, and no others are there.
fn of_schemas(recording: &Recording, version: &Version) -> Check {
    let mut problems = Problems::default();
    let number = version.number();
    for channel in recording.channels() {
        let (topic, encoding) = (&channel.topic, &channel.encoding);
        let is_known = channel.is_view() || Encoding::find(encoding).is_some();
        problems.unless(is_known, || {
            format!("{topic} is encoded as {encoding:?}, not json or protobuf")
        });
        let is_right = channel.is_of(version) && view_is_right(channel);
        problems.unless(is_right, || {
            format!("the schema of {topic} is not that of telemetry {number}")
        });
    }
    for schema in recording.layout.channels.unused_schemas() {
        problems.add(|| format!("the schema {:?} belongs to no channel", schema.name));
    }
    let finding = format!("those of telemetry {number}");
    Check::of(Group::Telemetry, "schemas", &problems, finding)
}

/// Whether a channel is described as the view that it is called, if it is called like one.
fn view_is_right(channel: &FileChannel) -> bool {
    let mut views = view_channels().iter();
    let Some(view) = views.find(|view| view.topic == channel.topic) else {
        return true;
    };
    let schema = channel.schema.as_deref();
    channel.encoding == "cdr"
        && schema.is_some_and(|schema| {
            schema.name == view.schema
                && schema.encoding == "ros2msg"
                && schema.data == view.definition.as_bytes()
        })
}

/// What a reader of the file sees and no check covers, in the words of its author or of others.
pub(super) fn not_covered(
    recording: &Recording,
    scenario: Option<&Scenario>,
    telemetry: &Version,
) -> Vec<String> {
    let mut found = Vec::new();
    found.extend(words(recording, scenario));
    if scenario.is_none() {
        found.push("what toprise.run says: the scenario is not there".to_owned());
    }
    let this = env!("CARGO_PKG_VERSION");
    let simulated = recording.run().and_then(|run| run.get(VERSION));
    let simulated = simulated.filter(|version| *version != this || !telemetry.is_current());
    if let Some(version) = simulated {
        let number = telemetry.number();
        found.push(match version == this {
            false => format!("that toprise {version} simulated it: this is {this}"),
            true => {
                format!("that toprise {version} simulated it: telemetry {number} is not its own")
            }
        });
    }
    let is_form_told = recording
        .run()
        .is_none_or(|run| recorded_form(run).is_some());
    if !is_form_told && !recording.channels().iter().any(FileChannel::is_view) {
        found.push("whether it was recorded with the channels for viewers".to_owned());
    }
    let library = recording.library();
    let is_told = library
        .strip_prefix(LIBRARY_PREFIX)
        .is_some_and(|version| version == this || simulated.is_some_and(|told| told == version));
    if !is_told {
        found.push(format!("that {library:?} wrote the file"));
    }
    let reason = recording.end().and_then(|end| end.get(STOP_REASON));
    if reason.is_some_and(|reason| reason == StopReason::Interrupted.name()) {
        found.push(
            "that it was interrupted, and the integrator's statistics up to there".to_owned(),
        );
    }
    if recording.recovery().is_some() {
        found.push("what was lost before it was recovered".to_owned());
    }
    for attachment in &recording.layout.attachments {
        if attachment.name != SCENARIO_ATTACHMENT {
            found.push(format!("the attachment {:?}", attachment.name));
        }
    }
    for (name, _) in recording.all_metadata() {
        if !OUR_RECORDS.contains(&name) {
            found.push(format!("the metadata {name:?}"));
        }
    }
    found
}

/// What the author of the scenario says in words that mean nothing to the simulation.
fn words(recording: &Recording, scenario: Option<&Scenario>) -> Option<String> {
    let scenario = scenario?;
    let is_ours = recording
        .scenario_text()
        .is_ok_and(|text| text == scenario.to_toml());
    let mut words = vec!["name"];
    if !scenario.description().is_empty() {
        words.push("description");
    }
    if !is_ours {
        words.push("comments");
    }
    let words = match words.as_slice() {
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
        [] => return None,
    };
    Some(format!("the scenario's {words}: the words of its author"))
}
