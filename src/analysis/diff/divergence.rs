//! Where two runs that should be the same first differ, with the messages before and after.

use super::lane::Pair;
use crate::telemetry::payload::Value;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::VecDeque;

/// Messages before and after the first that differs.
const CONTEXT: usize = 3;
/// No more fields than these are shown of the first message that differs.
const SHOWN: usize = 8;

/// The first pair of messages that differ by more than the tolerances, among its neighbours.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Divergence {
    /// The topic.
    pub topic: String,
    /// The time of the first pair that differs, s.
    pub time: f64,
    /// The first fields that differ there.
    pub fields: Vec<FieldContext>,
    /// How many more fields differ there.
    pub more_fields: u64,
}

/// A field around the first difference.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FieldContext {
    /// The field.
    pub field: String,
    /// Up to three pairs before the first difference, that one, and up to three after.
    pub pairs: Vec<PairContext>,
}

/// A field in two messages.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PairContext {
    /// The time, s.
    pub time: f64,
    /// Whether this is the first difference.
    pub is_first: bool,
    /// A's value.
    pub a: String,
    /// B's value.
    pub b: String,
    /// The bits in which two doubles differ, as 16 hexadecimal digits; absent where they are the same, or no doubles.
    pub bits: Option<String>,
}

/// A pair that is kept.
#[derive(Clone, Debug, Default)]
struct Kept {
    time_ns: u64,
    numbers: [Vec<f64>; 2],
    values: [Vec<Value>; 2],
}

/// The last pairs of a topic until some after its first difference.
#[derive(Clone, Debug, Default)]
pub(super) struct Context {
    kept: VecDeque<Kept>,
    /// Where the first difference is among them.
    first: Option<usize>,
}

impl Context {
    /// Whether it needs no more pairs.
    pub(super) fn is_full(&self) -> bool {
        self.first
            .is_some_and(|first| self.kept.len() > first + CONTEXT)
    }

    /// Takes in the next pair; `is_equal` tells whether the topic has been equal up to here.
    pub(super) fn add(&mut self, pair: &Pair<'_>, is_equal: bool) {
        let mut kept = if self.first.is_none() && self.kept.len() > CONTEXT {
            self.kept.pop_front().unwrap_or_default()
        } else {
            Kept::default()
        };
        kept.time_ns = pair.time_ns;
        for (side, row) in [pair.a, pair.b].into_iter().enumerate() {
            kept.numbers[side].clear();
            kept.numbers[side].extend_from_slice(row);
            kept.values[side].clear();
            kept.values[side].extend_from_slice(pair.contents[side].values);
        }
        self.kept.push_back(kept);
        if self.first.is_none() && !is_equal {
            self.first = Some(self.kept.len() - 1);
        }
    }

    /// When the first difference was, ns.
    pub(super) fn time_ns(&self) -> Option<u64> {
        Some(self.kept.get(self.first?)?.time_ns)
    }

    /// The first difference; `fields` are the names of the fields with their places in A's and B's rows.
    pub(super) fn report<'f>(
        &self,
        topic: &str,
        fields: impl Iterator<Item = (&'f str, [usize; 2])>,
    ) -> Option<Divergence> {
        let first = self.first?;
        let found = self.kept.get(first)?;
        let differing: Vec<_> = fields.filter(|(_, at)| found.differs(*at)).collect();
        let context = |(name, at): &(&str, [usize; 2])| FieldContext {
            field: (*name).to_owned(),
            pairs: self
                .kept
                .iter()
                .enumerate()
                .map(|(place, kept)| kept.pair(*at, place == first))
                .collect(),
        };
        Some(Divergence {
            topic: topic.to_owned(),
            time: found.time_ns as f64 / 1e9,
            fields: differing.iter().take(SHOWN).map(context).collect(),
            more_fields: differing.len().saturating_sub(SHOWN) as u64,
        })
    }
}

impl Kept {
    fn number(&self, side: usize, at: usize) -> f64 {
        self.numbers[side].get(at).copied().unwrap_or(f64::NAN)
    }

    fn value(&self, side: usize, at: usize) -> Option<&Value> {
        self.values[side].get(at)
    }

    fn differs(&self, [a, b]: [usize; 2]) -> bool {
        match (self.value(0, a), self.value(1, b)) {
            (None, None) => self.number(0, a).to_bits() != self.number(1, b).to_bits(),
            (x, y) => x != y,
        }
    }

    fn pair(&self, [a, b]: [usize; 2], is_first: bool) -> PairContext {
        let bits = self.number(0, a).to_bits() ^ self.number(1, b).to_bits();
        let is_double = |side: usize, at: usize| {
            self.value(side, at)
                .is_none_or(|value| matches!(value, Value::Real(_)))
        };
        let are_doubles = is_double(0, a) && is_double(1, b);
        let text = |side: usize, at: usize| match self.value(side, at) {
            None => format!("{:?}", self.number(side, at)),
            Some(value) => value.to_string(),
        };
        PairContext {
            time: self.time_ns as f64 / 1e9,
            is_first,
            a: text(0, a),
            b: text(1, b),
            bits: (are_doubles && bits != 0).then(|| format!("{bits:016x}")),
        }
    }
}
