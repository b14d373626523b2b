//! The rows of the table as values, for code that handles all channels alike.

use super::{CYCLES, Channel, EVENT, Field, IMPACT, SAMPLES, Source};
use crate::physics::dynamics::Support;
use crate::telemetry::Topic;
use crate::telemetry::table::channel::{ChannelInfo, Leaf};
use std::sync::OnceLock;

/// All channels, in table order.
pub fn channels() -> &'static [ChannelInfo] {
    static CHANNELS: OnceLock<Vec<ChannelInfo>> = OnceLock::new();
    CHANNELS.get_or_init(|| {
        let samples = SAMPLES.iter().map(|channel| info(channel, true));
        let cycles = CYCLES.iter().map(|channel| info(channel, false));
        let events = EVENT.iter().map(|channel| info(channel, false));
        let impacts = IMPACT.iter().map(|channel| info(channel, false));
        samples.chain(cycles).chain(events).chain(impacts).collect()
    })
}

fn info<S>(channel: &Channel<S>, is_sampled: bool) -> ChannelInfo {
    let (texts, numbers): (Vec<_>, Vec<_>) = channel
        .fields
        .iter()
        .partition(|field| matches!(field.source, Source::Text(_)));
    let mut numbers: Vec<Leaf> = numbers.into_iter().flat_map(leaves).collect();
    for field in channel.fields {
        // Names, because a row of the table can't refer to the handle of another one.
        if let Some(derivative) = field.derivative
            && let Some(number) = position(&numbers, field.name)
        {
            numbers[number].derivative = position(&numbers, derivative);
        }
    }
    ChannelInfo {
        topic: channel.topic,
        schema: channel.schema,
        meaning: channel.meaning,
        texts: texts.into_iter().flat_map(leaves).collect(),
        numbers,
        is_sampled,
        is_optional: channel.present.is_some(),
        is_free_peg_only: channel.is_free_peg_only,
    }
}

/// The place of the leaf at `path`.
fn position(leaves: &[Leaf], path: &str) -> Option<usize> {
    leaves.iter().position(|leaf| leaf.path == path)
}

/// The leaves of a field: one for a number or a text, one for each component of a vector or an orientation.
fn leaves<S>(field: &Field<S>) -> Vec<Leaf> {
    let components: &[&str] = match field.source {
        Source::Number(_) | Source::Text(_) => &[""],
        Source::Vector(_) => &[".x", ".y", ".z"],
        Source::Rotation(_) => &[".x", ".y", ".z", ".w"],
    };
    components
        .iter()
        .map(|component| Leaf {
            path: format!("{}{component}", field.name),
            quantity: field.quantity,
            unit: field.quantity.unit(),
            frame: field.frame,
            meaning: field.meaning,
            plot: field.plot,
            is_component: components.len() > 1,
            derivative: None,
        })
        .collect()
}

impl Topic {
    /// The topic with this name, for names known only at run time.
    pub fn find(name: &str) -> Option<Self> {
        Self::all().find(|topic| topic.name() == name)
    }

    /// All topics, in table order.
    pub fn all() -> impl ExactSizeIterator<Item = Self> {
        (0..channels().len()).map(Self::from_index)
    }

    /// The name, e.g. `/top/state`.
    pub fn name(self) -> &'static str {
        self.info().topic
    }

    /// The topics of runs with this support, in table order.
    pub fn all_with(support: Support) -> impl Iterator<Item = Self> {
        Self::all().filter(move |topic| support.is_free() || !topic.info().is_free_peg_only)
    }

    /// The channel.
    pub fn info(self) -> &'static ChannelInfo {
        &channels()[self.index()]
    }
}
