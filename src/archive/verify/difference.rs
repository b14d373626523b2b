//! A difference that verification finds.

use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;

/// A difference between a recording and a new run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Difference {
    /// Topic, metadata record or attachment.
    pub place: String,
    /// Simulation time, s; absent outside of messages.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// Field or property; absent if all of it differs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field: Option<String>,
    /// The value in the file; absent if the file has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded: Option<String>,
    /// The value of the new run; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulated: Option<String>,
}

impl Difference {
    /// A difference outside of messages.
    pub(super) fn new(
        place: &str,
        field: &str,
        [recorded, simulated]: [Option<String>; 2],
    ) -> Self {
        Self {
            place: place.to_owned(),
            field: (!field.is_empty()).then(|| field.to_owned()),
            recorded,
            simulated,
            time: None,
        }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.place)?;
        if let Some(time) = &self.time {
            write!(f, " at t = {time} s")?;
        }
        if let Some(field) = &self.field {
            write!(f, ", {field}")?;
        }
        let [recorded, simulated] =
            [&self.recorded, &self.simulated].map(|value| value.as_deref().unwrap_or("none"));
        write!(f, ": recorded {recorded}, simulated {simulated}")
    }
}
