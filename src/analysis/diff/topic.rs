//! The comparison of the messages of one topic.

pub(super) mod derived;
pub(super) mod field;

use self::derived::Derived;
use self::field::{FieldDifference, FieldTally};
use super::tolerance::Tolerances;
use crate::run::time::seconds;
use crate::telemetry::fields::{NumberField, STATE};
use crate::telemetry::side::Side;
use crate::telemetry::{Message, Topic};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeSet;

/// A topic that both runs have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ChannelDifference {
    /// The topic.
    pub topic: String,
    /// Number of messages in A and in B.
    pub messages: [u64; 2],
    /// Messages compared with each other.
    pub pairs: u64,
    /// Pairs whose values are the same to the last bit.
    pub identical: u64,
    /// Pairs with different sequence numbers; 0 if the runs are sampled differently.
    pub other_sequences: u64,
    /// Unmatched messages of A and of B within the time span of the other run.
    pub unmatched: [u64; 2],
    /// Messages of A and of B beyond the end of the other run.
    pub beyond: [u64; 2],
    /// Messages of A and of B between the samples of the other run, which has fewer.
    pub between: [u64; 2],
    /// Time of the first unmatched message, s; absent if there is none.
    pub first_unmatched: Option<f64>,
    /// The first pair that differs by more than the tolerances.
    pub first: Option<FirstDifference>,
    /// The topic's fields, with derived ones at the end.
    pub fields: Vec<FieldDifference>,
}

/// The first pair of messages that differs by more than the tolerances.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FirstDifference {
    /// Simulation time, s.
    pub time: f64,
    /// The first field that differs there.
    pub field: String,
    /// A's value.
    pub a: String,
    /// B's value.
    pub b: String,
}

/// Statistics of the pairs of a topic.
#[derive(Clone, Debug)]
pub(super) struct TopicTally {
    topic: Topic,
    /// The fields that both have and that are not ignored.
    fields: Vec<(NumberField, FieldTally)>,
    /// Fields that only A and only B has.
    fields_only_in: [Vec<String>; 2],
    derived: Vec<Derived>,
    /// Whether sequence numbers are compared.
    has_sequences: bool,
    /// The result so far, without fields.
    pub(super) found: ChannelDifference,
    /// Pairs with different texts.
    other_texts: u64,
}

impl TopicTally {
    /// `missing` are the fields that A's and B's recordings lack.
    pub(super) fn new(
        topic: Topic,
        missing: &[BTreeSet<String>; 2],
        tolerances: &Tolerances,
        has_sequences: bool,
    ) -> Self {
        let mut fields = Vec::new();
        let mut fields_only_in = [Vec::new(), Vec::new()];
        for number in topic.numbers() {
            let name = number.to_string();
            match missing.each_ref().map(|missing| missing.contains(&name)) {
                _ if tolerances.ignores(&name) => {}
                [false, false] => {
                    let tolerance = tolerances.for_field(topic.name(), number.path());
                    fields.push((number, FieldTally::new(tolerance)));
                }
                [true, true] => {}
                [false, true] => fields_only_in[Side::A.index()].push(name),
                [true, false] => fields_only_in[Side::B.index()].push(name),
            }
        }
        let mut derived = if topic == STATE {
            Derived::of_state(tolerances)
        } else {
            Vec::new()
        };
        derived.retain(|derived| {
            derived
                .sources()
                .all(|source| fields.iter().any(|(field, _)| field == source))
        });
        Self {
            derived,
            topic,
            fields,
            fields_only_in,
            has_sequences,
            found: ChannelDifference {
                topic: topic.to_string(),
                ..ChannelDifference::default()
            },
            other_texts: 0,
        }
    }

    /// The fields that only one of the runs has.
    pub(super) fn only_in(&self, side: Side) -> &[String] {
        &self.fields_only_in[side.index()]
    }

    /// Counts a message.
    pub(super) fn count(&mut self, side: Side) {
        self.found.messages[side.index()] += 1;
    }

    /// Counts an unmatched message.
    pub(super) fn count_unmatched(
        &mut self,
        side: Side,
        time_ns: u64,
        is_between: bool,
        is_beyond: bool,
    ) {
        let found = &mut self.found;
        let counts = match (is_between, is_beyond) {
            (true, _) => &mut found.between,
            (false, true) => &mut found.beyond,
            (false, false) => &mut found.unmatched,
        };
        counts[side.index()] += 1;
        // Samples between those of the other run are expected.
        if !is_between {
            found.first_unmatched.get_or_insert(seconds(time_ns));
        }
    }

    /// Compares two messages. Returns B − A of their numbers; NaN where one lacks a number.
    pub(super) fn add(&mut self, a: &Message<'_>, b: &Message<'_>) -> Vec<f64> {
        self.found.pairs += 1;
        self.found.other_sequences += u64::from(self.has_sequences && a.sequence != b.sequence);
        let mut is_same = a.texts == b.texts;
        self.other_texts += u64::from(!is_same);
        for (number, tally) in &mut self.fields {
            let (x, y) = (number.of(a), number.of(b));
            let was_equal = tally.is_equal();
            tally.add(a.time_ns, x, y);
            is_same &= x.to_bits() == y.to_bits();
            if was_equal && !tally.is_equal() && self.found.first.is_none() {
                self.found.first = Some(FirstDifference {
                    time: seconds(a.time_ns),
                    field: number.path().to_owned(),
                    // The shortest text that parses to the same number.
                    a: format!("{x:?}"),
                    b: format!("{y:?}"),
                });
            }
        }
        self.found.identical += u64::from(is_same);
        for derived in &mut self.derived {
            derived.add(a, b);
        }
        self.note_texts(a, b);
        let numbers = a.numbers.iter().zip(b.numbers);
        numbers.map(|(a, b)| b - a).collect()
    }

    /// Records the first texts that differ.
    fn note_texts(&mut self, a: &Message<'_>, b: &Message<'_>) {
        if let Some((x, y)) = a.texts.iter().zip(b.texts).find(|(x, y)| x != y) {
            self.found.first.get_or_insert_with(|| FirstDifference {
                time: seconds(a.time_ns),
                field: "text".to_owned(),
                a: x.clone(),
                b: y.clone(),
            });
        }
    }

    /// Whether all pairs agree within the tolerances and in their texts.
    pub(super) fn is_equal(&self) -> bool {
        self.other_texts == 0 && self.fields.iter().all(|(_, tally)| tally.is_equal())
    }

    /// The topic.
    pub(super) fn name(&self) -> &'static str {
        self.topic.name()
    }

    /// Whether all messages are paired and their values bit-identical.
    pub(super) fn is_identical(&self) -> bool {
        self.found.identical == self.found.pairs && self.has_all_partners() && !self.is_thinned()
    }

    /// Whether all messages are paired, except extra samples of the finer run.
    pub(super) fn has_all_partners(&self) -> bool {
        self.found.unmatched == [0; 2] && self.found.beyond == [0; 2]
    }

    /// The number of unmatched messages of a run.
    pub(super) fn unmatched(&self, side: Side) -> u64 {
        self.found.unmatched[side.index()] + self.found.beyond[side.index()]
    }

    /// Whether one run is sampled more finely.
    pub(super) fn is_thinned(&self) -> bool {
        self.found.between != [0; 2]
    }

    /// The largest difference of each field and of each derived quantity, with its name.
    pub(super) fn largest(&self) -> impl Iterator<Item = (String, f64)> + '_ {
        let fields = self.fields.iter();
        let own = fields.map(|(number, tally)| (number.to_string(), tally.found.largest.abs()));
        let derived = self.derived.iter();
        own.chain(derived.map(|derived| (derived.full_name(), derived.largest())))
    }

    /// The differences of the topic; `integration_error` returns the error of a field.
    pub(super) fn report(
        &self,
        integration_error: &impl Fn(&str) -> Option<f64>,
    ) -> ChannelDifference {
        let mut fields = Vec::new();
        for (number, tally) in &self.fields {
            let error = integration_error(&number.to_string());
            fields.push(tally.report(number.path(), number.unit(), error));
        }
        for derived in &self.derived {
            fields.push(derived.report(integration_error(&derived.full_name())));
        }
        ChannelDifference {
            fields,
            ..self.found.clone()
        }
    }
}
