//! The differences of one topic: its messages as they are paired, and the fields of the pairs summed up.

use super::derived::Derived;
use super::field::{FieldDifference, FieldTally, seconds};
use super::growth::{Envelope, Growth};
use super::lane::{Frontier, Given, Lane, Pair};
use super::parting::Parting;
use super::rule::Rule;
use super::time_map::TimeMap;
use super::tolerance::{Tolerances, full_name};
use crate::telemetry::Topic;
use crate::telemetry::fields::{NumberField, state};
use crate::telemetry::side::Side;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// How the differences of these fields grow is told.
const GROWING: [NumberField; 3] = [state::PHI, state::THETA, state::PSI];

/// A topic that both have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ChannelDifference {
    /// The topic.
    pub topic: String,
    /// Messages of A.
    pub messages_a: u64,
    /// Messages of B.
    pub messages_b: u64,
    /// Messages compared with each other.
    pub pairs: u64,
    /// Pairs that are the same to the last bit.
    pub identical: u64,
    /// Messages of A within the time of both that B has no counterpart for.
    pub only_in_a: u64,
    /// Messages of B within the time of both that A has no counterpart for.
    pub only_in_b: u64,
    /// Messages of A beyond the end of B, or before its start.
    pub beyond_in_a: u64,
    /// Messages of B beyond the end of A, or before its start.
    pub beyond_in_b: u64,
    /// Messages of both that were not paired, because their times went backward.
    pub out_of_order: u64,
    /// The first text that differs.
    pub texts: Option<TextDifference>,
    /// The topic's fields, with derived ones at the end.
    pub fields: Vec<FieldDifference>,
}

impl ChannelDifference {
    /// Whether there are no messages of the topic at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.messages_a + self.messages_b == 0
    }
}

/// Two texts that differ.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TextDifference {
    /// When, s.
    pub time: f64,
    /// A's text.
    pub a: String,
    /// B's text.
    pub b: String,
    /// How many texts differ.
    pub count: u64,
}

/// A topic under comparison.
#[derive(Debug)]
pub(super) struct ComparedTopic {
    /// The messages that wait to be paired.
    pub(super) lane: Lane,
    /// What is known of the pairs.
    pub(super) tally: TopicTally,
}

impl ComparedTopic {
    pub(super) fn new(topic: &str, rule: Rule) -> Self {
        Self {
            tally: TopicTally::new(topic, rule.is_interpolated()),
            lane: Lane::new(rule),
        }
    }

    /// Compares all pairs that are certain, and shows them with the differences of their fields.
    pub(super) fn drain(
        &mut self,
        frontiers: [Frontier; 2],
        map: &TimeMap,
        show: &mut impl FnMut(&Pair<'_>, &[f64]),
    ) {
        let Self { lane, tally } = self;
        let interpolated = lane.rule.finer().map(|finer| finer.side);
        lane.drain(frontiers, map, &mut |given| match (given, interpolated) {
            (Given::Pair(pair), _) => {
                tally.add(&pair);
                show(&pair, &tally.difference);
            }
            (Given::Estimate { field, error }, Some(side)) => {
                tally.add_estimate(side, field, error);
            }
            (Given::Estimate { .. }, None) => {}
        });
    }

    /// Whether any messages have been compared with each other.
    pub(super) fn has_pairs(&self) -> bool {
        self.tally.pairs > 0
    }

    /// What was found; `floor` gives the integrators' errors of fields.
    pub(super) fn report(&self, floor: &impl Fn(&str) -> Option<f64>) -> ChannelDifference {
        let Self { lane, tally } = self;
        let [beyond_in_a, beyond_in_b] = lane.lonely.map(|alone| alone.beyond(self.has_pairs()));
        let [alone_a, alone_b] = lane.lonely.map(|alone| alone.count);
        let [messages_a, messages_b] = lane.counts;
        ChannelDifference {
            topic: tally.topic.clone(),
            messages_a,
            messages_b,
            pairs: tally.pairs,
            identical: tally.identical,
            only_in_a: alone_a - beyond_in_a,
            only_in_b: alone_b - beyond_in_b,
            beyond_in_a,
            beyond_in_b,
            out_of_order: lane.out_of_order(),
            texts: tally.texts.clone(),
            fields: tally.report(floor),
        }
    }

    /// The fields that only one of the runs has. Without messages there are no fields, which says nothing about them.
    pub(super) fn fields_only_in(&self, side: Side) -> impl Iterator<Item = String> + '_ {
        let has_both = !self.lane.counts.contains(&0);
        self.tally.fields_only_in(side, has_both)
    }
}

/// A field that one of the runs has, or both.
#[derive(Clone, Debug)]
struct ComparedField {
    name: String,
    /// The field of the table that it is, if it is one.
    number: Option<NumberField>,
    /// Where it stands in the rows of A and of B.
    places: [Option<usize>; 2],
    /// Whether it has ever been a number in A and in B.
    is_seen: [bool; 2],
    tally: FieldTally,
}

impl ComparedField {
    fn is_common(&self) -> bool {
        self.places.iter().all(Option::is_some)
    }

    /// Its value in a row of one of the runs; NaN if it has none.
    fn of(&self, row: &[f64], side: Side) -> f64 {
        let value = self.places[side.index()].and_then(|place| row.get(place));
        value.copied().unwrap_or(f64::NAN)
    }
}

/// What is known of the pairs of a topic.
#[derive(Clone, Debug, Default)]
pub(super) struct TopicTally {
    topic: String,
    fields: Vec<ComparedField>,
    /// Where fields stand that have come up with the messages, by their names.
    known: BTreeMap<String, usize>,
    /// The fields that stand at the places of A's and B's rows, where they come up with the messages.
    at_places: [Vec<usize>; 2],
    /// Fields of the table that only A and only B has.
    alone: [Vec<String>; 2],
    derived: Vec<Derived>,
    /// How the differences of these fields grow.
    growing: Vec<(usize, Envelope)>,
    is_interpolated: bool,
    /// Whether both have all numbers of a channel of the table.
    pub(super) is_complete: bool,
    pub(super) pairs: u64,
    pub(super) identical: u64,
    texts: Option<TextDifference>,
    /// Whether the first texts of any pair differ: for events, what they are.
    kinds_differ: bool,
    /// Pairs of which only the texts differ.
    other_words: u64,
    /// Times of the first and the last pair, ns.
    pub(super) span: Option<(u64, u64)>,
    /// B − A of each field of the last pair.
    difference: Vec<f64>,
    /// The fields of the last pair in A and in B.
    rows: [Vec<f64>; 2],
}

impl TopicTally {
    fn new(topic: &str, is_interpolated: bool) -> Self {
        Self {
            topic: topic.to_owned(),
            is_interpolated,
            ..Self::default()
        }
    }

    /// Takes in the fields of a channel of the table, but for those that A's or B's version lacks.
    pub(super) fn add_table(
        &mut self,
        topic: Topic,
        missing: &[BTreeSet<String>; 2],
        tolerances: &Tolerances,
    ) {
        for number in topic.numbers() {
            let name = number.to_string();
            match [0, 1].map(|side| missing[side].contains(&name)) {
                [false, false] => {
                    if GROWING.contains(&number) {
                        let envelope = Envelope::default();
                        self.growing.push((self.fields.len(), envelope));
                    }
                    self.add_field(number.path(), Some(number), tolerances);
                }
                [true, true] => {}
                [is_in_b_only, _] => self.alone[usize::from(is_in_b_only)].push(name),
            }
        }
        let find = |number| {
            self.fields
                .iter()
                .position(|field| field.number == Some(number))
        };
        self.derived = Derived::of(topic, find);
        self.is_complete = self.fields.len() == topic.info().numbers.len();
    }

    /// Takes in a field that has come up in the rows of one run, behind those known so far.
    pub(super) fn learn(&mut self, side: Side, name: &str, tolerances: &Tolerances) {
        let field = match self.known.get(name) {
            Some(field) => *field,
            None => {
                self.known.insert(name.to_owned(), self.fields.len());
                self.add_field(name, None, tolerances)
            }
        };
        let at_places = &mut self.at_places[side.index()];
        self.fields[field].places[side.index()] = Some(at_places.len());
        at_places.push(field);
    }

    fn add_field(
        &mut self,
        name: &str,
        number: Option<NumberField>,
        tolerances: &Tolerances,
    ) -> usize {
        self.fields.push(ComparedField {
            name: name.to_owned(),
            number,
            places: [number.map(NumberField::index); 2],
            is_seen: [false; 2],
            tally: FieldTally::new(tolerances.of(&self.topic, name)),
        });
        self.fields.len() - 1
    }

    /// Notes which of the fields that have come up with the messages are numbers in a message of one run.
    pub(super) fn note_numbers(&mut self, side: Side, numbers: &[f64]) {
        for (number, field) in numbers.iter().zip(&self.at_places[side.index()]) {
            self.fields[*field].is_seen[side.index()] |= !number.is_nan();
        }
    }

    /// The fields with their topic, as patterns name them.
    pub(super) fn names(&self) -> impl Iterator<Item = String> + '_ {
        let fields = self.fields.iter();
        fields.map(|field| full_name(&self.topic, &field.name))
    }

    fn fields_only_in(&self, side: Side, has_both: bool) -> impl Iterator<Item = String> + '_ {
        let (mine, others) = (side.index(), side.other().index());
        let is_alone =
            move |field: &&ComparedField| has_both && field.is_seen[mine] && !field.is_seen[others];
        let seen = self.fields.iter().filter(is_alone);
        let seen = seen.map(|field| full_name(&self.topic, &field.name));
        self.alone[mine].iter().cloned().chain(seen)
    }

    fn add(&mut self, pair: &Pair<'_>) {
        self.pairs += 1;
        let first = self.span.map_or(pair.time_ns, |(first, _)| first);
        self.span = Some((first, pair.time_ns));
        let mut is_same = true;
        self.difference.clear();
        for field in &mut self.fields {
            let (a, b) = (field.of(pair.a, Side::A), field.of(pair.b, Side::B));
            field.tally.add(pair.time_ns, a, b);
            self.difference.push(b - a);
            is_same &= a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        }
        if !self.add_texts(pair) {
            self.other_words += u64::from(is_same);
            is_same = false;
        }
        self.identical += u64::from(is_same);
        if is_same {
            return;
        }
        for (field, envelope) in &mut self.growing {
            envelope.add(pair.time_ns, self.difference[*field]);
        }
        if self.derived.is_empty() {
            return;
        }
        for (side, row) in [(Side::A, pair.a), (Side::B, pair.b)] {
            let values = self.fields.iter().map(|field| field.of(row, side));
            self.rows[side.index()].clear();
            self.rows[side.index()].extend(values);
        }
        let [a, b] = &self.rows;
        for derived in &mut self.derived {
            derived.add(pair.time_ns, a, b);
        }
    }

    /// Compares the texts of a pair, and tells whether they are the same.
    fn add_texts(&mut self, pair: &Pair<'_>) -> bool {
        let Some((a, b)) = pair.texts else {
            return true;
        };
        self.kinds_differ |= a.first() != b.first();
        let Some((a, b)) = a.iter().zip(b).find(|(a, b)| a != b) else {
            return true;
        };
        let first = self.texts.get_or_insert_with(|| TextDifference {
            time: seconds(pair.time_ns),
            a: a.clone(),
            b: b.clone(),
            count: 0,
        });
        first.count += 1;
        false
    }

    /// Takes in how large the error of interpolating the field at a place of one run can be.
    fn add_estimate(&mut self, side: Side, place: usize, error: f64) {
        let is_there = |field: &&mut ComparedField| field.places[side.index()] == Some(place);
        for field in self.fields.iter_mut().filter(is_there) {
            field.tally.add_interpolation_error(error);
        }
    }

    /// The largest difference of each field, with its topic.
    pub(super) fn largest(&self) -> impl Iterator<Item = (String, f64)> + '_ {
        let fields = self.fields.iter();
        self.names().zip(fields.map(|field| field.tally.largest()))
    }

    /// Whether all pairs agree within the tolerances, and in their texts.
    pub(super) fn is_equal(&self) -> bool {
        let mut fields = self.fields.iter().filter(|field| field.is_common());
        !self.kinds_differ && self.other_words == 0 && fields.all(|field| field.tally.is_equal())
    }

    fn report(&self, floor: &impl Fn(&str) -> Option<f64>) -> Vec<FieldDifference> {
        // Numbers of different events have nothing to do with each other.
        let fields = if self.kinds_differ {
            &[][..]
        } else {
            &self.fields
        };
        let fields = fields.iter().filter(|field| field.is_common());
        let own = fields.map(|field| {
            let unit = field.number.map_or("", NumberField::unit);
            let mut found = field.tally.report(&field.name, unit, self.is_interpolated);
            found.floor = floor(&full_name(&self.topic, &field.name));
            found.is_below_floor = found
                .floor
                .is_some_and(|floor| found.largest != 0.0 && found.largest.abs() <= floor);
            found
        });
        own.chain(self.derived.iter().map(Derived::report))
            .collect()
    }

    /// When the fields parted.
    pub(super) fn partings(&self, floor: &impl Fn(&str) -> Option<f64>) -> Vec<Parting> {
        let parting = |field: &ComparedField| {
            let name = full_name(&self.topic, &field.name);
            let floor = floor(&name).unwrap_or(0.0);
            Parting::find(name, field.number, &field.tally, floor)
        };
        self.fields.iter().filter_map(parting).collect()
    }

    /// How the differences of the angles grew.
    pub(super) fn growths(&self) -> Vec<Growth> {
        let growth = |(field, envelope): &(usize, Envelope)| {
            envelope.law(full_name(&self.topic, &self.fields[*field].name))
        };
        self.growing.iter().filter_map(growth).collect()
    }
}
