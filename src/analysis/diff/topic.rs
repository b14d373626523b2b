//! The differences of one topic: its messages as they are paired, and the fields of the pairs summed up.

use super::derived::Derived;
use super::divergence::{Context, Divergence};
use super::field::{FieldDifference, FieldTally, errors, seconds};
use super::growth::{Envelope, Growth};
use super::item::Content;
use super::lane::{Frontier, Given, Lane, Pair};
use super::parting::Parting;
use super::rule::Rule;
use super::time_map::TimeMap;
use super::times::MessageTimes;
use super::tolerance::{Tolerances, full_name};
use crate::telemetry::Topic;
use crate::telemetry::fields::{NumberField, state};
use crate::telemetry::payload::Value;
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
    /// Pairs with the same values that are written in other bytes.
    pub other_bytes: u64,
    /// Pairs with other publish times.
    pub other_publish_times: u64,
    /// Pairs with other sequence numbers.
    pub other_sequences: u64,
    /// Messages of A within the time of both that B has no counterpart for.
    pub only_in_a: u64,
    /// Messages of B within the time of both that A has no counterpart for.
    pub only_in_b: u64,
    /// Messages of A beyond the end of B, or before its start.
    pub beyond_in_a: u64,
    /// Messages of B beyond the end of A, or before its start.
    pub beyond_in_b: u64,
    /// Those of A that come before the first of B.
    pub before_in_a: u64,
    /// Those of B that come before the first of A.
    pub before_in_b: u64,
    /// When the first message of A is that B has no counterpart for, s; absent if there is none.
    pub first_alone_in_a: Option<f64>,
    /// When the first message of B is that A has no counterpart for, s; absent if there is none.
    pub first_alone_in_b: Option<f64>,
    /// Messages of A between those of B, which were compared with none as they are.
    pub between_in_a: u64,
    /// Messages of B between those of A, which were compared with none as they are.
    pub between_in_b: u64,
    /// When the messages are in A; only for files that toprise did not write.
    pub times_a: Option<MessageTimes>,
    /// When the messages are in B; only for files that toprise did not write.
    pub times_b: Option<MessageTimes>,
    /// The first text that differs, or another value that is no number.
    pub texts: Option<TextDifference>,
    /// Pairs of which all or parts were compared byte by byte.
    pub compared_bytes: u64,
    /// The first of those that differ.
    pub bytes: Option<BytesDifference>,
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
    /// The field; empty for messages of the telemetry table.
    pub field: String,
    /// A's text; long ones from shortly before they differ.
    pub a: String,
    /// B's text; long ones from shortly before they differ.
    pub b: String,
    /// How many texts differ.
    pub count: u64,
}

/// Two messages, compared byte by byte, that differ.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BytesDifference {
    /// When, s.
    pub time: f64,
    /// The first byte that differs, from 0.
    pub offset: u64,
    /// The length of A's; absent if there is nothing in A to be compared byte by byte.
    pub length_a: Option<u64>,
    /// The length of B's; absent if there is nothing in B to be compared byte by byte.
    pub length_b: Option<u64>,
    /// How many pairs differ.
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
                tally.add_context(&pair);
                show(&pair, &tally.difference);
            }
            (Given::Estimate { field, error }, Some(side)) => {
                tally.add_estimate(side, field, error);
            }
            (Given::Estimate { .. }, None) => {}
        });
    }

    /// Whether both have the same messages, to the last bit.
    pub(super) fn is_same(&self) -> bool {
        let alone = self.lane.lonely.iter().map(|alone| alone.count);
        self.tally.identical == self.tally.pairs && alone.sum::<u64>() == 0
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
        let [first_a, first_b] = lane.lonely.map(|alone| alone.first_ns.map(seconds));
        ChannelDifference {
            topic: tally.topic.clone(),
            messages_a,
            messages_b,
            pairs: tally.pairs,
            identical: tally.identical,
            other_bytes: tally.other_bytes,
            other_publish_times: tally.other_publish_times,
            other_sequences: tally.other_sequences,
            only_in_a: alone_a - beyond_in_a,
            only_in_b: alone_b - beyond_in_b,
            beyond_in_a,
            beyond_in_b,
            before_in_a: lane.lonely[0].before(self.has_pairs()),
            before_in_b: lane.lonely[1].before(self.has_pairs()),
            first_alone_in_a: first_a,
            first_alone_in_b: first_b,
            between_in_a: lane.between[0],
            between_in_b: lane.between[1],
            times_a: None,
            times_b: None,
            texts: tally.texts.clone(),
            compared_bytes: tally.compared_bytes,
            bytes: tally.bytes.clone(),
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
    /// Whether any message of A and of B has had it.
    is_seen: [bool; 2],
    /// Whether its differences don't count.
    is_ignored: bool,
    tally: FieldTally,
}

impl ComparedField {
    /// Whether both have it, and it counts.
    fn is_compared(&self) -> bool {
        !self.is_ignored && self.places.iter().all(Option::is_some)
    }

    /// Its value in a row of one of the runs; NaN if it has none.
    fn of(&self, row: &[f64], side: Side) -> f64 {
        let value = self.places[side.index()].and_then(|place| row.get(place));
        value.copied().unwrap_or(f64::NAN)
    }

    /// Its exact value in a row of one of the runs.
    fn value<'v>(&self, row: &'v [Value], side: Side) -> &'v Value {
        let value = self.places[side.index()].and_then(|place| row.get(place));
        value.unwrap_or(&Value::Absent)
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
    /// The pairs around the first that differ by more than the tolerances.
    context: Context,
    /// How the differences of these fields grow.
    growing: Vec<(usize, Envelope)>,
    is_interpolated: bool,
    /// Whether its messages are those of a channel of the table.
    is_of_table: bool,
    /// Whether both have all numbers of a channel of the table.
    pub(super) is_complete: bool,
    pub(super) pairs: u64,
    pub(super) identical: u64,
    other_bytes: u64,
    other_publish_times: u64,
    other_sequences: u64,
    /// Whether messages must have the same sequence numbers.
    counts_sequences: bool,
    /// Whether any messages that are compared byte by byte are of different encodings: then equal bytes say nothing.
    encodings_differ: bool,
    texts: Option<TextDifference>,
    compared_bytes: u64,
    bytes: Option<BytesDifference>,
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

    /// Counts other sequence numbers as a difference: in a recording of toprise they say which sample a message is.
    pub(super) fn count_sequences(&mut self) {
        self.counts_sequences = true;
    }

    /// Takes in the fields of a channel of the table, but for those that A's or B's version lacks.
    pub(super) fn add_table(
        &mut self,
        topic: Topic,
        missing: &[BTreeSet<String>; 2],
        tolerances: &Tolerances,
    ) {
        self.is_of_table = true;
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
                .position(|field| !field.is_ignored && field.number == Some(number))
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
            is_ignored: tolerances.ignores(&full_name(&self.topic, name)),
            tally: FieldTally::new(tolerances.of(&self.topic, name)),
        });
        self.fields.len() - 1
    }

    /// Notes which of the fields that have come up with the messages a message of one run has.
    pub(super) fn note_values(&mut self, side: Side, values: &[Value]) {
        for (value, field) in values.iter().zip(&self.at_places[side.index()]) {
            self.fields[*field].is_seen[side.index()] |= !value.is_absent();
        }
    }

    /// The fields with their topic, as patterns name them.
    pub(super) fn names(&self) -> impl Iterator<Item = String> + '_ {
        let fields = self.fields.iter();
        fields.map(|field| full_name(&self.topic, &field.name))
    }

    fn fields_only_in(&self, side: Side, has_both: bool) -> impl Iterator<Item = String> + '_ {
        let (mine, others) = (side.index(), side.other().index());
        let is_alone = move |field: &&ComparedField| {
            has_both && !field.is_ignored && field.is_seen[mine] && !field.is_seen[others]
        };
        let seen = self.fields.iter().filter(is_alone);
        let seen = seen.map(|field| full_name(&self.topic, &field.name));
        self.alone[mine].iter().cloned().chain(seen)
    }

    fn add(&mut self, pair: &Pair<'_>) {
        self.pairs += 1;
        let first = self.span.map_or(pair.time_ns, |(first, _)| first);
        self.span = Some((first, pair.time_ns));
        let [a, b] = pair.contents;
        if !self.is_of_table || a.rest.is_some() || b.rest.is_some() {
            // Messages that don't fit the table have no numbers, and so no differences.
            self.difference.clear();
            self.difference.resize(self.fields.len(), f64::NAN);
            let is_same = self.add_contents(pair.time_ns, a, b);
            self.identical += u64::from(is_same);
            self.note_writing(a, b, is_same);
            return;
        }
        let mut is_same = true;
        self.difference.clear();
        for field in &mut self.fields {
            let (a, b) = (field.of(pair.a, Side::A), field.of(pair.b, Side::B));
            self.difference.push(b - a);
            if field.is_ignored {
                continue;
            }
            field.tally.add(pair.time_ns, a, b);
            is_same &= a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        }
        if !self.add_texts(pair) {
            self.other_words += u64::from(is_same);
            is_same = false;
        }
        self.identical += u64::from(is_same);
        self.note_writing(a, b, is_same);
        if is_same {
            for derived in &mut self.derived {
                derived.add_identical(pair.time_ns);
            }
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

    /// Keeps the pair if it is near the first difference.
    fn add_context(&mut self, pair: &Pair<'_>) {
        if !self.context.is_full() {
            let is_equal = self.is_equal();
            self.context.add(pair, is_equal);
        }
    }

    /// When a pair first differed by more than the tolerances, ns.
    pub(super) fn first_divergence(&self) -> Option<u64> {
        self.context.time_ns()
    }

    /// The first pair that differs by more than the tolerances, among its neighbours.
    pub(super) fn divergence(&self) -> Option<Divergence> {
        let fields = self.fields.iter().filter(|field| !field.is_ignored);
        let places = fields
            .filter_map(|field| Some((field.name.as_str(), [field.places[0]?, field.places[1]?])));
        self.context.report(&self.topic, places)
    }

    /// Compares two messages of others field by field, and what they say beyond their fields byte by byte. Tells whether
    /// they are the same.
    fn add_contents(&mut self, time_ns: u64, a: Content<'_>, b: Content<'_>) -> bool {
        let mut is_same = true;
        for field in self.fields.iter_mut().filter(|field| !field.is_ignored) {
            let (x, y) = (
                field.value(a.values, Side::A),
                field.value(b.values, Side::B),
            );
            let is_same_field = field.tally.add_values(time_ns, x, y);
            is_same &= is_same_field;
            if !(is_same_field || x.is_number() && y.is_number()) {
                let first = self.texts.get_or_insert_with(|| {
                    let [a, b] = excerpts([x, y].map(ToString::to_string));
                    TextDifference {
                        time: seconds(time_ns),
                        field: field.name.clone(),
                        a,
                        b,
                        count: 0,
                    }
                });
                first.count += 1;
            }
        }
        self.add_bytes(time_ns, a.rest, b.rest) && is_same
    }

    /// Notes in what the files have two messages otherwise, beside what these say.
    fn note_writing(&mut self, a: Content<'_>, b: Content<'_>, is_same: bool) {
        let (Some(x), Some(y)) = (a.written, b.written) else {
            return;
        };
        self.other_bytes += u64::from(is_same && x.bytes != y.bytes);
        self.other_publish_times += u64::from(x.publish_time != y.publish_time);
        self.other_sequences += u64::from(x.sequence != y.sequence);
        let are_bytes = a.rest.is_some() && b.rest.is_some();
        self.encodings_differ |= are_bytes && x.encoding != y.encoding;
    }

    fn add_bytes(&mut self, time_ns: u64, a: Option<&[u8]>, b: Option<&[u8]>) -> bool {
        self.compared_bytes += u64::from(a.is_some() || b.is_some());
        if a == b {
            return true;
        }
        let first = self.bytes.get_or_insert_with(|| {
            let [x, y] = [a, b].map(Option::unwrap_or_default);
            let same = x.iter().zip(y).take_while(|(x, y)| x == y);
            let length = |bytes: Option<&[u8]>| bytes.map(|bytes| bytes.len() as u64);
            BytesDifference {
                time: seconds(time_ns),
                offset: same.count() as u64,
                length_a: length(a),
                length_b: length(b),
                count: 0,
            }
        });
        first.count += 1;
        false
    }

    /// Compares the texts of a pair, and tells whether they are the same.
    fn add_texts(&mut self, pair: &Pair<'_>) -> bool {
        // There are no texts between two messages.
        if self.is_interpolated {
            return true;
        }
        let [a, b] = pair.contents.map(|content| content.texts);
        self.kinds_differ |= a.first() != b.first();
        let Some((a, b)) = a.iter().zip(b).find(|(a, b)| a != b) else {
            return true;
        };
        let first = self.texts.get_or_insert_with(|| TextDifference {
            time: seconds(pair.time_ns),
            field: String::new(),
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
        let mut fields = self.fields.iter().filter(|field| field.is_compared());
        let is_said_otherwise = self.kinds_differ
            || self.other_words > 0
            || (self.counts_sequences && self.other_sequences > 0)
            || self.bytes.is_some()
            || self.encodings_differ;
        !is_said_otherwise && fields.all(|field| field.tally.is_equal())
    }

    fn report(&self, floor: &impl Fn(&str) -> Option<f64>) -> Vec<FieldDifference> {
        // Numbers of different events have nothing to do with each other.
        let fields = if self.kinds_differ {
            &[][..]
        } else {
            &self.fields
        };
        let fields = fields.iter().filter(|field| field.is_compared());
        let own = fields.map(|field| {
            let unit = field.number.map_or("", NumberField::unit);
            let mut found = field.tally.report(&field.name, unit, self.is_interpolated);
            found.floor = floor(&full_name(&self.topic, &field.name));
            found.errors = errors(found.floor, found.interpolation_error, found.scale);
            // Also a zero and a negative zero.
            let differs = found.first_different.is_some() && found.not_numbers == 0;
            found.is_below_floor = found
                .errors
                .is_some_and(|errors| differs && found.largest.abs() <= errors);
            found
        });
        own.chain(self.derived.iter().map(Derived::report))
            .collect()
    }

    /// When the fields parted.
    pub(super) fn partings(&self, floor: &impl Fn(&str) -> Option<f64>) -> Vec<Parting> {
        let parting = |field: &ComparedField| {
            let name = full_name(&self.topic, &field.name);
            let errors = self.errors(field, floor).unwrap_or(0.0);
            Parting::find(name, field.number, &field.tally, errors)
        };
        self.fields.iter().filter_map(parting).collect()
    }

    /// What the difference of a field may be owed to beside the motions.
    fn errors(&self, field: &ComparedField, floor: &impl Fn(&str) -> Option<f64>) -> Option<f64> {
        let interpolation = self
            .is_interpolated
            .then(|| field.tally.interpolation_error());
        let floor = floor(&full_name(&self.topic, &field.name));
        errors(floor, interpolation, field.tally.scale())
    }

    /// How the differences of the angles grew, as far as they are larger than their errors.
    pub(super) fn growths(&self, floor: &impl Fn(&str) -> Option<f64>) -> Vec<Growth> {
        let growth = |(field, envelope): &(usize, Envelope)| {
            let field = &self.fields[*field];
            let errors = self.errors(field, floor).unwrap_or(0.0);
            envelope.law(full_name(&self.topic, &field.name), errors)
        };
        self.growing.iter().filter_map(growth).collect()
    }
}

/// Two texts that differ; long ones from shortly before they do, and no longer than this in characters.
fn excerpts(texts: [String; 2]) -> [String; 2] {
    const LONGEST: usize = 200;
    const BEFORE: usize = 20;
    let [a, b] = &texts;
    let same = a.chars().zip(b.chars()).take_while(|(x, y)| x == y).count();
    texts.map(|text| {
        if text.chars().count() <= LONGEST {
            return text;
        }
        let start = same.saturating_sub(BEFORE);
        let opening = if start > 0 { "…" } else { "" };
        let shown: String = text.chars().skip(start).take(LONGEST).collect();
        format!("{opening}{shown}…")
    })
}
