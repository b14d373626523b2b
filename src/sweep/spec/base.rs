//! Base scenarios of a sweep.

use super::axis::find_key;
use crate::archive::input::Input;
use crate::run::scenario::{KEYS, Value, Values};
use crate::sweep::error::SweepError;
use serde_json::{Value as Json, json};
use std::path::{Path, PathBuf};

/// A base scenario. It may be incomplete if the rows set the missing keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Base {
    /// The name in the table.
    pub name: String,
    /// The keys and values.
    pub values: Values,
    /// The keys that were set in addition to the scenario.
    pub(super) set: Vec<&'static str>,
    /// The file that it was read from.
    pub(super) file: Option<PathBuf>,
}

impl Base {
    /// An unchanged scenario.
    pub fn new(name: String, values: Values) -> Self {
        Self {
            name,
            values,
            set: Vec::new(),
            file: None,
        }
    }

    /// The preset of this name, or the scenario of the file or recording at this path, with overrides.
    ///
    /// # Errors
    /// [`SweepError::Input`] if there is none, [`SweepError::Scenario`] if a key can't be set.
    pub fn open(word: &str, folder: &Path, set: &[(String, String)]) -> Result<Self, SweepError> {
        let path = folder.join(word);
        // A spec names files relative to its own folder. Any other word is left to `input`, which knows the presets.
        let path: PathBuf = if path.is_file() { path } else { word.into() };
        let mut values = Input::open(&path)?.values()?;
        let mut keys = Vec::new();
        for (key, value) in set {
            let key = find_key(key)?;
            values
                .set(key.path, value)
                .map_err(|source| SweepError::Base {
                    base: word.to_owned(),
                    source,
                })?;
            if values.get(key.path).is_some() {
                keys.push(key.path);
            }
        }
        let name = match values.get("name") {
            Some(Value::Text(name)) => name.clone(),
            Some(Value::Number(_)) | None => word.to_owned(),
        };
        Ok(Self {
            name,
            values,
            set: keys,
            file: path.is_file().then_some(path),
        })
    }

    /// The keys and values as JSON.
    pub(super) fn to_json(&self) -> Json {
        let keys = KEYS.iter().filter_map(|key| {
            let value = self.values.get(key.path)?;
            Some((key.path.to_owned(), json!(value)))
        });
        Json::Object(keys.collect())
    }
}
