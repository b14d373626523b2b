//! Everything that defines a run: read from TOML, checked, and written back in one canonical form.
//!
//! [`Values`] holds keys and values as a person writes them; [`Scenario`] is what has passed every
//! check and is turned into the types of the physics. The table of keys, [`KEYS`], is the only place
//! that has names, units and ranges.

mod definition;
mod error;
mod key;
mod keys;
mod laws;
mod model;
mod presets;
mod schema;
mod values;
mod words;

pub(crate) use definition::hex;
pub use definition::{Scenario, Stop};
pub use error::ScenarioError;
pub use key::{Key, Kind, Presence, Value};
pub use keys::{FORMAT, KEYS};
pub use laws::{LAWS, Law};
pub use presets::{PRESETS, Preset};
pub use schema::{SCHEMA_FILE, schema};
pub use values::Values;
pub use words::{FormulationKind, OnStick};
