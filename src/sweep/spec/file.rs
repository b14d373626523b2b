//! Sweep specs in TOML.

use super::Spec;
use super::axis::Axis;
use super::base::Base;
use super::deserialize::{section, some_count, texts};
use super::design::Design;
use super::sample::Sample;
use crate::sweep::error::{AxisProblem, SpecError, SweepError};
use crate::sweep::table::Table;
use serde::Deserialize;
use std::path::Path;

/// Top-level keys of a spec.
const SECTIONS: [&str; 6] = ["bases", "set", "over", "sample", "table", "max_steps"];

/// A spec as written in a file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default, deserialize_with = "texts")]
    bases: Vec<String>,
    #[serde(default, deserialize_with = "section")]
    set: toml::Table,
    #[serde(default, deserialize_with = "section")]
    over: toml::Table,
    sample: Option<Sample>,
    table: Option<String>,
    #[serde(default, deserialize_with = "some_count")]
    max_steps: Option<u64>,
}

impl Spec {
    /// Reads a spec from TOML. Files that it names are looked for in `folder`; keys are set in all its bases.
    ///
    /// # Errors
    /// As [`Spec::new`], [`Axis::parse`] and [`Base::open`]; [`SweepError::Spec`] if the text is not a spec.
    pub fn from_toml(
        text: &str,
        folder: &Path,
        set: &[(String, String)],
    ) -> Result<Self, SweepError> {
        // Type errors name the key; syntax errors name the line.
        let table: toml::Table = text.parse().map_err(|error| syntax_error(&error))?;
        let file: File = table.try_into().map_err(|error| syntax_error(&error))?;
        check_quotes("set", &file.set)?;
        check_quotes("over", &file.over)?;
        let mut overrides: Vec<_> = file
            .set
            .iter()
            .map(|(key, value)| (key.clone(), to_argument(value)))
            .collect();
        overrides.extend_from_slice(set);
        let words = if file.bases.is_empty() {
            vec!["paper".to_owned()]
        } else {
            file.bases
        };
        let axes = file
            .over
            .iter()
            .map(|(key, value)| parse_axis(key, value))
            .collect::<Result<_, _>>()?;
        let table = match file.table {
            Some(path) => Some(Table::read(&folder.join(path))?),
            None => None,
        };
        let design = Design::new(axes, file.sample, table)?;
        let bases = words
            .iter()
            .map(|word| Base::open(word, folder, &overrides))
            .collect::<Result<_, _>>()?;
        Self::new(bases, design, file.max_steps)
    }

    /// Whether a TOML text is a spec rather than a scenario.
    pub fn is_spec(text: &str) -> bool {
        let table: Option<toml::Table> = text.parse().ok();
        table.is_some_and(|table| SECTIONS.iter().any(|name| table.contains_key(*name)))
    }
}

/// An axis as written in a file: a text as on the command line, or a list of values.
fn parse_axis(key: &str, value: &toml::Value) -> Result<Axis, SweepError> {
    let toml::Value::Array(items) = value else {
        return Axis::parse(key, &to_argument(value));
    };
    let items: Vec<String> = items.iter().map(to_argument).collect();
    let axis = Axis::parse(key, &items.join(","))?;
    if axis.count() == Some(items.len() as u64) {
        Ok(axis)
    } else {
        Err(axis.invalid(AxisProblem::ListInList))
    }
}

fn syntax_error(error: &toml::de::Error) -> SpecError {
    SpecError::Syntax(error.to_string().trim().to_owned())
}

/// Rejects unquoted keys with dots, which TOML reads as tables.
fn check_quotes(section: &'static str, entries: &toml::Table) -> Result<(), SweepError> {
    let inner = entries.iter().find_map(|(name, value)| {
        let (inner, _) = value.as_table()?.iter().next()?;
        Some(format!("{name}.{inner}"))
    });
    match inner {
        Some(key) => Err(SpecError::UnquotedKey { section, key }.into()),
        None => Ok(()),
    }
}

/// A value in command-line notation.
fn to_argument(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        // TOML's own formatting may print many zeros.
        toml::Value::Float(number) => format!("{number:?}"),
        value => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::spec::change::change;

    #[test]
    fn file_and_command_line_define_equal_specs() {
        let text = r#"
            bases = ["paper"]
            max_steps = 1000
            [set]
            "stop.duration" = 2.5
            [over]
            "friction.k" = "0.01..0.1/4log"
            "initial.psi_dot" = [100, 150.5]
        "#;
        assert!(Spec::is_spec(text));
        assert!(!Spec::is_spec("name = \"a\"\n[top]\nmass = 1"));
        let read = Spec::from_toml(text, Path::new("."), &[]).unwrap();
        let set = [("stop.duration".to_owned(), "2.5".to_owned())];
        let bases = vec![Base::open("paper", Path::new("."), &set).unwrap()];
        let axes = [
            ("friction.k", "0.01..0.1/4log"),
            ("initial.psi_dot", "100,150.5"),
        ];
        let axes = axes.map(|(key, text)| Axis::parse(key, text).unwrap());
        let built = Spec::new(bases, Design::Grid(axes.to_vec()), Some(1000)).unwrap();
        assert_eq!(change(&read.to_json(), &built.to_json()), None);
        let message = |text: &str| {
            let error = Spec::from_toml(text, Path::new("."), &[]).unwrap_err();
            error.to_string()
        };
        let names = SECTIONS.map(|name| format!("`{name}`")).join(", ");
        let all = format!("unknown field `ovr`, expected one of {names}");
        assert!(message("ovr = 1").contains(&all), "{}", message("ovr = 1"));
        assert_eq!(
            message("[over]\nfriction.k = [0.1]"),
            "[over] friction.k: a key with a dot needs quotes, as in \"friction.k\" = …"
        );
        assert!(message("[set]\nstop.duration = 2").contains("\"stop.duration\" = …"));
    }

    #[test]
    fn errors_of_files_are_plain() {
        for (text, part) in [
            ("max_steps = 0", "must be a whole number of at least 1"),
            ("max_steps = 1e3", "must be a whole number of at least 1"),
            ("max_steps = -1", "must be a whole number of at least 1"),
            ("bases = [1]", "must be a list of strings"),
            ("bases = \"paper\"", "must be a list of strings"),
            ("set = 1", "must be a section"),
            ("over = []", "must be a section"),
            ("sample = 10", "expected a section with count"),
            ("sample.count = 0", "must be a whole number of at least 1"),
            (
                "sample = { count = 9, seed = -1 }",
                "must be a whole number of at least 0",
            ),
            (
                "[over]\ndescription = [\"a, b\"]",
                "description=a, b: each item of a list must be one value, without commas",
            ),
            (
                "sample = { count = 9, method = \"x\" }",
                "must be \"sobol\" or \"random\"",
            ),
            ("sample.count = 9", "at least one axis, e.g. friction.k = "),
        ] {
            let message = Spec::from_toml(text, Path::new(""), &[]).unwrap_err();
            let message = message.to_string();
            assert!(message.contains(part), "{text}: {message}");
            for word in [
                "u64", "nonzero", "sequence", "map", "struct", "variant", "--",
            ] {
                assert!(!message.contains(word), "{text}: {message}");
            }
        }
        let text = "set.\"friction.k\" = 0.2\n[over]\n\"friction.k\" = [0.1, 1]";
        let message = Spec::from_toml(text, Path::new("."), &[]).unwrap_err();
        assert!(
            message.to_string().contains("both set and varied"),
            "{message}"
        );
    }
}
