//! Scenarios: parsed from TOML, validated, and written in canonical form.
//!
//! [`Values`] holds unvalidated keys and values. A [`Scenario`] is validated and uses the types of `physics`. Names,
//! units and ranges are defined only in the table [`KEYS`].

mod applicable;
mod check;
mod choice;
mod definition;
mod error;
mod file_stem;
mod key;
mod keys;
mod laws;
mod model;
mod parse;
mod presets;
mod schema;
mod stop;
mod values;

pub use applicable::{Allowed, ApplicableKey};
pub(crate) use choice::find_dissipation;
pub use choice::{FormulationKind, OnStick, SupportKind};
pub use definition::Scenario;
pub use error::{Hint, Problem, Requirement, ScenarioError};
pub(super) use key::short_number;
pub use key::{Key, Kind, Presence, Value};
pub use keys::{FORMAT, KEYS};
pub use laws::{LAWS, Law};
pub use presets::{PRESETS, Preset};
pub use schema::{SCHEMA_FILE, schema};
pub use stop::Stop;
pub use values::Values;
pub(crate) use values::find_key;
