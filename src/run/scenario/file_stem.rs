//! Names of recordings.

use super::definition::Scenario;
use super::key::Value;
use super::values::Values;

/// Maximum length of a file stem with changed keys.
const MAX_LENGTH: usize = 60;

impl Scenario {
    /// File stem of a recording: `name` with the keys appended that differ from `base`, e.g. `paper_k0.02`.
    ///
    /// If it is too long, the start of the scenario digest replaces the changes.
    pub fn file_stem(&self, name: &str, base: &Values) -> String {
        let mut stem = name.to_owned();
        for (key, value) in self.changes(base) {
            let key = key.short_name();
            stem += &match value {
                None => format!("_no-{key}"),
                Some(Value::Number(number)) => format!("_{key}{number}"),
                Some(Value::Text(word)) => format!("_{key}-{word}"),
            };
        }
        // File systems limit names, and lists of names get unreadable before; the digest still tells them apart.
        if stem != name && stem.len() > MAX_LENGTH {
            return format!("{name}_{:.8}", self.digest());
        }
        stem
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::scenario::Preset;

    fn stem(changes: &[(&str, &str)]) -> String {
        let base = Preset::find("paper").unwrap().values().unwrap();
        let mut values = base.clone();
        for (key, value) in changes {
            values.set(key, value).unwrap();
        }
        let scenario = Scenario::new(values).unwrap();
        scenario.file_stem("paper", &base)
    }

    #[test]
    fn appends_changed_and_removed_keys() {
        assert_eq!(stem(&[]), "paper");
        assert_eq!(stem(&[("friction.k", "0.02")]), "paper_k0.02");
        assert_eq!(stem(&[("stop.theta_risen", "")]), "paper_no-theta_risen");
        let full = [("friction.dissipation", "full")];
        assert_eq!(stem(&full), "paper_dissipation-full");
    }

    #[test]
    fn replaces_long_lists_of_changes_by_the_digest() {
        let changes = [
            ("friction.dissipation", "full"),
            ("integrator.relative_tolerance", "1e-11"),
            ("stop.duration", "5"),
        ];
        let stem = stem(&changes);
        assert_eq!(stem.len(), "paper_".len() + 8);
        assert!(stem.len() <= MAX_LENGTH);
    }
}
