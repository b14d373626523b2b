//! Section d of a report: the signals, point by point.

use super::field::{FieldDifference, seconds};
use super::growth::Growth;
use super::parting::Parting;
use super::rule::Rule;
use super::topic::{ChannelDifference, ComparedTopic};
use schemars::JsonSchema;
use serde::Serialize;

/// Section d: the signals.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Signals {
    /// What was compared with what.
    pub alignment: String,
    /// The first time at which both have a signal, s.
    pub from: f64,
    /// The last time at which both have a signal, s.
    pub to: f64,
    /// The common topics.
    pub channels: Vec<ChannelDifference>,
    /// The fields in the order in which they parted.
    pub parted: Vec<Parting>,
    /// How the difference of the angles grew.
    pub growth: Vec<Growth>,
}

impl Signals {
    /// Puts the topics together; `floor` gives the integrators' errors of fields.
    pub(super) fn new<'t>(
        alignment: &str,
        topics: impl Iterator<Item = &'t ComparedTopic>,
        floor: &impl Fn(&str) -> Option<f64>,
    ) -> Self {
        let mut signals = Self {
            alignment: alignment.to_owned(),
            ..Self::default()
        };
        let mut span: Option<(u64, u64)> = None;
        for topic in topics {
            signals.channels.push(topic.report(floor));
            if let Some((first, last)) = topic.tally.span {
                let (from, to) = span.unwrap_or((first, last));
                span = Some((from.min(first), to.max(last)));
            }
            signals.growth.extend(topic.tally.growths(floor));
            // Events and cycles are there only afterwards.
            if topic.lane.rule != Rule::SameSequence {
                signals.parted.extend(topic.tally.partings(floor));
            }
        }
        signals.parted.sort_by(|x, y| {
            let times = x.time.total_cmp(&y.time);
            times.then_with(|| x.kind.cmp(&y.kind))
        });
        if let Some((first, last)) = span {
            (signals.from, signals.to) = (seconds(first), seconds(last));
        }
        signals
    }

    /// How many fields differ and have known errors, and how many of them differ by no more than those.
    #[must_use]
    pub fn at_floor(&self) -> (usize, usize) {
        let judged =
            |field: &&FieldDifference| field.first_different.is_some() && field.errors.is_some();
        let fields = || self.fields().map(|(_, field)| field);
        let below = fields().filter(|field| field.is_below_floor).count();
        (fields().filter(judged).count(), below)
    }

    /// How many fields differ.
    #[must_use]
    pub fn differing(&self) -> usize {
        let own = self.fields().filter(|(_, field)| !field.is_derived);
        own.filter(|(_, field)| field.first_different.is_some())
            .count()
    }

    /// Whether any field was interpolated.
    #[must_use]
    pub fn is_interpolated(&self) -> bool {
        self.fields()
            .any(|(_, field)| field.interpolation_error.is_some())
    }

    /// The fields of all topics, each with its topic.
    pub fn fields(&self) -> impl Iterator<Item = (&str, &FieldDifference)> {
        self.channels.iter().flat_map(|channel| {
            let fields = channel.fields.iter();
            fields.map(|field| (channel.topic.as_str(), field))
        })
    }
}
