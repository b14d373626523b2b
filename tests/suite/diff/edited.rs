//! Recordings that other software has edited.

use super::*;
use toprise::analysis::diff::Dependence;
use toprise::analysis::explain::explain;

/// The events after an extra one keep their partners, and the extra one has none.
#[test]
fn extra_event_keeps_other_matches() {
    let folder = Folder::new();
    let run = scenario("drop", &[("stop.duration", "1")]);
    let whole = recorded(&folder, "a.mcap", &run, Encoding::Json);
    let more = edited(&folder, "b.mcap", &run, |messages| {
        let is_event = |message: &Owned| message.channel == EVENTS.index();
        let first = messages.iter().position(is_event).unwrap();
        let extra = Owned {
            time_ns: 100_000_000,
            ..messages[first].clone()
        };
        let at = messages.partition_point(|message| message.time_ns <= extra.time_ns);
        messages.insert(at, extra);
        let events = messages.iter_mut().filter(|message| is_event(message));
        for (sequence, event) in (0..).zip(events) {
            event.sequence = sequence;
        }
    });
    for (runs, unmatched) in [([&whole, &more], [0, 1]), ([&more, &whole], [1, 0])] {
        let report = compare(runs[0], runs[1], &quick()).unwrap();
        assert_eq!(report.verdict, Verdict::Different);
        let events = channel(&report, "/events");
        assert_eq!(events.unmatched, unmatched);
        assert_eq!(events.identical, events.pairs);
        assert_eq!(events.pairs, *events.messages.iter().min().unwrap());
        assert_eq!(events.first_unmatched, Some(0.1));
    }
}

/// Other software may number messages anew: what is missing is found by times and counts.
#[test]
fn renumbered_messages_are_not_missing() {
    let folder = Folder::new();
    let run = scenario("drop", &[("stop.duration", "1")]);
    let whole = explain(&run).unwrap();
    for (name, number) in [("zero", 0_u32), ("from 7", 7)] {
        let renumbered = rewritten(&folder, &format!("{name}.mcap"), &run, |message| {
            message.sequence = message.sequence.wrapping_mul(u32::from(number > 0)) + number;
        });
        let explanation = explain(&renumbered).unwrap();
        assert!(!explanation.events.is_empty(), "{name}");
        assert_eq!(explanation, whole, "{name}");
        let report = compare(&renumbered, &run, &quick()).unwrap();
        let end = finding(&report, "ends").unwrap();
        assert_eq!(end.difference, Some(0.0), "{name}");
    }
}

/// The shift of a rise by nutation is known where the nutations were not recorded.
#[test]
fn ripple_of_the_rise_does_not_need_recorded_nutations() {
    let folder = Folder::new();
    let runs = ["paper", "full-coulomb"].map(|name| {
        let run = scenario(name, &[]);
        let path = folder.at(format!("{name}.mcap"));
        let topics = ["/top/state", "/top/energy", "/events"];
        archive(&path, &run, &topics, Form::default()).unwrap();
        (run, Recording::open(&path).unwrap())
    });
    let recorded = compare(&runs[0].1, &runs[1].1, &Options::default()).unwrap();
    let end = finding(&recorded, "ends").unwrap();
    let whole = compare(&runs[0].0, &runs[1].0, &Options::default()).unwrap();
    let expected = finding(&whole, "ends").unwrap();
    assert_eq!(end, expected);
    let [Dependence::Nutation { change }] = end.dependences[..] else {
        panic!("{end:?}");
    };
    assert!(change > 0.01, "{end:?}");
}
