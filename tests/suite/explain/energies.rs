//! Sentences about energy, and about phases that end with the run.

use super::facts;
use crate::support::{Folder, in_memory, scenario};
use toprise::analysis::explain::{Fact, explain};
use toprise::archive::pipeline::McapSink;
use toprise::archive::publish::Existing;
use toprise::archive::recording::Recording;
use toprise::archive::sink::Sink as _;
use toprise::archive::writer::Form;
use toprise::telemetry::Telemetry;
use toprise::telemetry::fields::ENERGY;

#[test]
fn names_impacts_after_the_last_sample() {
    let explanation = explain(&scenario("drop", &[("stop.duration", "0.0318")])).unwrap();
    let sentences: Vec<String> = facts(&explanation)
        .map(|fact| fact.sentence().to_string())
        .collect();
    let sentence =
        "The peg hit the table once, after the last sample; the impacts dissipated 0.005591 J.";
    assert!(
        sentences.iter().any(|found| found == sentence),
        "{sentences:#?}"
    );
}

#[test]
fn energy_with_a_forged_sample_is_not_constant() {
    let run = scenario("paper", &[("stop.duration", "1")]);
    let (mut messages, end) = in_memory(&run);
    let folder = Folder::new();
    let path = folder.at("run.mcap");
    let telemetry = Telemetry::default();
    let mut sink =
        McapSink::create(&path, Existing::Keep, &run, &telemetry, Form::default()).unwrap();
    let is_forged = |message: &&mut toprise::archive::memory::Owned| {
        message.as_message().topic() == ENERGY && message.time_ns == 500_000_000
    };
    let forged = messages.messages.iter_mut().find(is_forged).unwrap();
    forged.numbers.fill(99.0);
    for message in &messages.messages {
        sink.write(&message.as_message()).unwrap();
    }
    sink.finish(&end).unwrap();
    let explanation = explain(&Recording::open(&path).unwrap()).unwrap();
    let is_constant = |fact: &Fact| matches!(fact, Fact::EnergyConstant { .. });
    let is_unbalanced =
        |fact: &Fact| matches!(fact, Fact::EnergyImbalance { deviation } if *deviation > 1.0);
    assert!(!facts(&explanation).any(is_constant));
    assert!(facts(&explanation).any(is_unbalanced));
}

#[test]
fn rolling_ended_by_last_event_is_not_final() {
    // Rolling ends at 16.517 ms, and the peg lifts off at 16.631 ms.
    let overrides = [("friction.k", "10"), ("stop.duration", "0.01655")];
    let explanation = explain(&scenario("free-rolls", &overrides)).unwrap();
    assert!(!facts(&explanation).any(|fact| matches!(fact, Fact::Rolls { .. })));
    assert!(facts(&explanation).any(|fact| matches!(fact, Fact::RollsAtTimes { .. })));
}

#[test]
fn end_of_nutation_follows_the_last_mean() {
    let explanation = explain(&scenario("lifecycle", &[])).unwrap();
    let sentences: Vec<String> = facts(&explanation)
        .map(|fact| fact.sentence().to_string())
        .collect();
    let means = sentences
        .iter()
        .position(|s| s.ends_with("(last nutation)."))
        .unwrap();
    assert!(
        sentences[means + 1].starts_with("The nutation ended at"),
        "{sentences:#?}"
    );
}
