//! Values of fields in samples, without messages.

use crate::run::simulation::Sample;
use crate::telemetry::handle::NumberField;
use crate::telemetry::table::{SAMPLES, Source};

impl NumberField {
    /// The value of the field in a sample: the one that a message of the sample has. NaN for fields of other records
    /// (nutation cycles, events, impacts).
    pub fn of_sample(self, sample: &Sample) -> f64 {
        let Some(channel) = SAMPLES.get(self.topic().index()) else {
            return f64::NAN;
        };
        // A handle has its place among the numbers of a message, where a vector counts as three.
        let mut index = self.index();
        for field in channel.fields {
            let width = match field.source {
                Source::Number(_) => 1,
                Source::Vector(_) => 3,
                Source::Rotation(_) => 4,
                Source::Text(_) => 0,
            };
            if index < width {
                return match field.source {
                    Source::Number(get) => get(sample),
                    Source::Vector(get) => get(sample)[index],
                    Source::Rotation(get) => get(sample).coords[index],
                    Source::Text(_) => f64::NAN,
                };
            }
            index -= width;
        }
        f64::NAN
    }
}
