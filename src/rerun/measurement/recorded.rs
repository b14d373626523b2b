//! The measured values in the recording of a fit.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::archive::recording::{Recording, Selection};
use crate::rerun::measurement::{MeasuredSignal, MeasuredValue, Measurement};
use crate::telemetry::fields::NumberField;
use crate::telemetry::supplement::{FIT_DATA, FIT_RESIDUAL};
use crate::telemetry::{Topic, Topics};

/// Maximum number of values that are shown: more than a camera takes in an hour.
const MAX_VALUES: usize = 1_000_000;

/// A message of [`FIT_DATA`].
#[derive(Deserialize)]
struct DataMessage {
    field: String,
    value: f64,
    sigma: f64,
}

/// A message of [`FIT_RESIDUAL`].
#[derive(Deserialize)]
struct ResidualMessage {
    field: String,
    residual: f64,
    held_out: f64,
}

impl Measurement {
    /// The measured values that a recording has in this selection's span of time, with a report on the fit in Markdown;
    /// `None` if it has none. Values whose residual is missing or unreadable are left out.
    ///
    /// Values of one field are one signal: messages don't have their source.
    pub fn from_recording(
        recording: &Recording,
        selection: &Selection,
        report: String,
    ) -> Option<Self> {
        let data = read::<DataMessage>(recording, selection, FIT_DATA);
        let residuals = read::<ResidualMessage>(recording, selection, FIT_RESIDUAL);
        let mut signals: Vec<MeasuredSignal> = Vec::new();
        for (sequence, (time_ns, data)) in data {
            let Some((residual_ns, residual)) = residuals.get(&sequence) else {
                continue;
            };
            let Some(field) = find_field(&data.field) else {
                continue;
            };
            if (*residual_ns, &residual.field) != (time_ns, &data.field) {
                continue;
            }
            let value = MeasuredValue {
                time_ns,
                value: data.value,
                sigma: data.sigma,
                residual: residual.residual,
                is_held_out: residual.held_out != 0.0,
            };
            match signals.iter_mut().find(|signal| signal.field == field) {
                Some(signal) => signal.values.push(value),
                None => signals.push(MeasuredSignal {
                    field,
                    source: data.field,
                    values: vec![value],
                }),
            }
        }
        for signal in &mut signals {
            // Sequence numbers follow the time, but for files that others have written.
            signal.values.sort_by_key(|value| value.time_ns);
        }
        (!signals.is_empty()).then_some(Self { signals, report })
    }
}

/// The messages of a topic with their times (ns), by their sequence numbers: the value and the residual of a point have
/// the same.
fn read<T: for<'a> Deserialize<'a>>(
    recording: &Recording,
    selection: &Selection,
    topic: &str,
) -> BTreeMap<u32, (u64, T)> {
    let mut messages = BTreeMap::new();
    let mut channels = recording.channels().iter();
    // Most recordings have no fit, and need not be read once more.
    if !channels.any(|channel| channel.topic == topic) {
        return messages;
    }
    let mut reader = recording.reader(Selection {
        topics: Topics::Only(vec![topic.to_owned()]),
        ..selection.clone()
    });
    while let Some(message) = reader.next_undecoded()
        && messages.len() < MAX_VALUES
    {
        if let Ok(row) = serde_json::from_slice(message.data) {
            messages.insert(message.sequence, (message.log_time, row));
        }
    }
    messages
}

/// The field with this name, such as `/top/state.theta`.
fn find_field(name: &str) -> Option<NumberField> {
    Topic::all()
        .flat_map(Topic::numbers)
        .find(|field| field.to_string() == name)
}
