//! Scenarios: parsed from TOML, validated, and written in canonical form.
//!
//! [`Values`] holds unvalidated keys and values. A [`Scenario`] is validated and uses the types of `physics`. Names,
//! units and ranges are defined only in the table [`KEYS`].

mod choice;
mod definition;
mod error;
mod key;
mod keys;
mod laws;
mod model;
mod presets;
mod schema;
mod values;

pub use choice::FormulationKind;
pub use definition::{Scenario, Stop};
pub use error::ScenarioError;
pub use key::{Key, Kind, Presence, Value};
pub use keys::{FORMAT, KEYS};
pub use laws::{LAWS, Law};
pub use presets::{PRESETS, Preset};
pub use schema::{SCHEMA_FILE, schema};
pub use values::Values;
#[cfg(feature = "sweep")]
pub(crate) use values::find_key;
