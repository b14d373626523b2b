//! Recordings to be damaged, and scenarios to be run.

use std::path::Path;
use toprise::archive::pipeline::McapSink;
use toprise::archive::publish::Existing;
use toprise::archive::sink::record_all;
use toprise::archive::verify::Report;
use toprise::archive::writer::Form;
use toprise::run::scenario::{Preset, Scenario};
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::{RunMessages, Topics};

/// A preset with some keys set otherwise.
pub fn scenario(preset: &str, overrides: &[(&str, &str)]) -> Scenario {
    let mut values = Preset::find(preset).unwrap().values().unwrap();
    for (key, value) in overrides {
        values.set(key, value).unwrap();
    }
    Scenario::new(values).unwrap()
}

/// A scenario's recording as bytes.
pub fn recorded(scenario: &Scenario, topics: &[&str], form: Form) -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    archive(&path, scenario, topics, form);
    std::fs::read(path).unwrap()
}

/// Records a scenario with these topics, all if there are none.
pub fn archive(path: &Path, scenario: &Scenario, topics: &[&str], form: Form) {
    let topics = match topics {
        [] => Topics::All,
        topics => Topics::named(topics).unwrap(),
    };
    let mut run = RunMessages::new(scenario, &topics).unwrap();
    let mut sink = McapSink::create(path, Existing::Keep, scenario, run.telemetry(), form).unwrap();
    let recorded = record_all(&mut run, &mut [&mut sink]).unwrap();
    assert!(recorded.error.is_none());
    sink.finish(&recorded.outcome.end).unwrap();
}

/// The difference between a recording and its scenario, run again, if there is one.
pub fn failure(report: &Report) -> Option<String> {
    report.difference.as_ref().map(ToString::to_string)
}

/// Every form of recording.
pub fn forms() -> impl Iterator<Item = Form> {
    let encodings = Encoding::ALL.into_iter();
    encodings.flat_map(|encoding| [true, false].map(|views| Form { encoding, views }))
}
