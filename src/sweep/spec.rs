//! Sweep specs.

pub(super) mod axis;
pub(super) mod base;
pub(super) mod change;
mod deserialize;
pub(super) mod design;
mod file;
pub(super) mod sample;
mod sobol;

use self::axis::Axis;
use self::base::Base;
use self::design::{Design, MAX_ROWS};
use self::sample::Points;
use super::error::{SpecError, SweepError, TableError};
use crate::run::scenario::{Key, Value};
use serde_json::{Map, Value as Json, json};
use std::collections::HashSet;
use std::path::Path;

/// The definition of a sweep.
#[derive(Clone, Debug)]
pub struct Spec {
    bases: Vec<Base>,
    design: Design,
    /// Maximum number of integrator steps per run.
    pub max_steps: Option<u64>,
    keys: Vec<&'static Key>,
    rows_per_base: u64,
    points: Points,
}

impl Spec {
    /// A sweep over these bases, the outermost axis.
    ///
    /// # Errors
    /// [`SweepError::Spec`] if bases, axes and sample are incompatible.
    pub fn new(
        bases: Vec<Base>,
        design: Design,
        max_steps: Option<u64>,
    ) -> Result<Self, SweepError> {
        if bases.is_empty() {
            return Err(SpecError::NoBase.into());
        }
        if max_steps == Some(0) {
            return Err(SpecError::NoSteps.into());
        }
        let rows_per_base = design.rows()?;
        let keys = design.keys();
        if let Some(key) = repeated(keys.iter().map(|key| key.path)) {
            return Err(match design.file() {
                Some(table) => SweepError::table(table, TableError::VariesTwice(key)),
                None => SpecError::VariesTwice(key).into(),
            });
        }
        let mut set = bases.iter().flat_map(|base| &base.set);
        if let Some(key) = set.find(|key| design.always_has(key)) {
            return Err(SpecError::SetAndVaried(key).into());
        }
        let points = match &design {
            Design::Sample(sample, axes) => Points::new(sample, axes.len()),
            Design::Grid(_) | Design::Table(_) => Points::default(),
        };
        match rows_per_base.checked_mul(bases.len() as u64) {
            Some(0) => Err(SpecError::Empty.into()),
            Some(1..=MAX_ROWS) => Ok(Self {
                bases,
                design,
                max_steps,
                keys,
                rows_per_base,
                points,
            }),
            Some(_) | None => Err(SpecError::TooMany(MAX_ROWS).into()),
        }
    }

    /// The number of rows.
    pub fn rows(&self) -> u64 {
        self.rows_per_base * self.bases.len() as u64
    }

    /// The keys that vary, in the order of their columns.
    pub fn keys(&self) -> &[&'static Key] {
        &self.keys
    }

    /// A name shared by several bases, if any.
    pub fn shared_name(&self) -> Option<&str> {
        repeated(self.bases.iter().map(|base| base.name.as_str()))
    }

    /// The files that it was read from: bases, and a table of runs.
    pub(super) fn inputs(&self) -> impl Iterator<Item = &Path> {
        let bases = self.bases.iter().filter_map(|base| base.file.as_deref());
        bases.chain(self.design.file())
    }

    /// The base of a row.
    pub(super) fn base(&self, row: u64) -> &Base {
        &self.bases[(row / self.rows_per_base) as usize]
    }

    /// The changes of a row: an optional value for each of [`Spec::keys`].
    pub(super) fn values(&self, row: u64) -> Vec<Option<Value>> {
        let row = row % self.rows_per_base;
        match &self.design {
            Design::Grid(axes) => {
                let mut rest = row;
                let mut values = vec![None; axes.len()];
                for (value, axis) in values.iter_mut().zip(axes).rev() {
                    // `Design::rows` has refused axes without a number of values.
                    if let Some(count) = axis.count() {
                        *value = Some(axis.at(rest % count));
                        rest /= count;
                    }
                }
                values
            }
            Design::Sample(_, axes) => {
                let numbered = axes.iter().enumerate();
                numbered
                    .map(|(i, axis)| Some(axis.sampled(self.points.at(row, i))))
                    .collect()
            }
            Design::Table(table) => table.row(row),
        }
    }

    /// Everything that determines the bytes of the table, which identifies the sweep.
    pub fn to_json(&self) -> Json {
        let bases: Vec<_> = self
            .bases
            .iter()
            .map(|base| json!({"name": base.name, "scenario": base.to_json()}))
            .collect();
        let mut spec = json!({
            "format": "toprise-sweep-2",
            // Another version may compute other bits, so its parts must not be merged with those of this one.
            "toprise": env!("CARGO_PKG_VERSION"),
            "runs": self.rows(),
            "bases": bases,
        });
        match &self.design {
            Design::Grid(axes) => spec["over"] = axes_to_json(axes),
            Design::Sample(sample, axes) => {
                spec["over"] = axes_to_json(axes);
                spec["sample"] = json!(sample);
            }
            Design::Table(table) => spec["table"] = json!({"sha256": table.digest()}),
        }
        spec["max_steps"] = json!(self.max_steps);
        spec
    }
}

/// The values of axes by their keys.
fn axes_to_json(axes: &[Axis]) -> Json {
    let mut object = Map::new();
    for axis in axes {
        object.insert(axis.key.path.to_owned(), json!(axis.text));
    }
    Json::Object(object)
}

/// The first duplicate name.
fn repeated<'a>(mut names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let mut seen = HashSet::new();
    names.find(|name| !seen.insert(*name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::spec::sample::{Method, Sample};

    const SAMPLE: Sample = Sample {
        count: 10,
        method: Method::Sobol,
        seed: 0,
    };

    fn paper() -> Vec<Base> {
        vec![Base::open("paper", Path::new("."), &[]).unwrap()]
    }

    #[test]
    fn last_axis_varies_fastest_and_bases_slowest() {
        let mut bases = paper();
        bases.push(Base::open("viscous", Path::new("."), &[]).unwrap());
        let axes = [("friction.k", "0.1,0.2"), ("initial.psi_dot", "1,2,3")];
        let axes = axes.map(|(key, text)| Axis::parse(key, text).unwrap());
        let spec = Spec::new(bases, Design::Grid(axes.to_vec()), None).unwrap();
        assert_eq!(spec.rows(), 12);
        let numbers = |row| {
            let values = spec.values(row).into_iter();
            values
                .map(|value| match value {
                    Some(Value::Number(number)) => number,
                    other => panic!("{other:?}"),
                })
                .collect::<Vec<_>>()
        };
        assert_eq!(numbers(0), [0.1, 1.0]);
        assert_eq!(numbers(1), [0.1, 2.0]);
        assert_eq!(numbers(3), [0.2, 1.0]);
        assert_eq!(numbers(6), [0.1, 1.0]);
        assert_eq!(spec.base(5).name, "paper");
        assert_eq!(spec.base(6).name, "viscous");
    }

    #[test]
    fn rejects_contradictory_specs() {
        let axis = |key: &str, text: &str| Axis::parse(key, text).unwrap();
        let sample = |axes| Design::Sample(SAMPLE, axes);
        for (design, part) in [
            (Design::Grid(vec![axis("friction.k", "0.1..1")]), "a..b/10"),
            (
                Design::Grid(vec![axis("friction.k", "0.1,1"), axis("friction_k", "1")]),
                "twice",
            ),
            (
                sample(vec![axis("friction.k", "0.1..1/5")]),
                "without a number",
            ),
            (sample(vec![]), "at least one axis"),
            (
                Design::Grid(vec![
                    axis("friction.k", "0..1/1000000"),
                    axis("initial.phi", "0..1/1000000"),
                ]),
                "more than",
            ),
        ] {
            let error = Spec::new(paper(), design, None).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
        assert!(Spec::new(Vec::new(), Design::Grid(Vec::new()), None).is_err());
    }

    #[test]
    fn rejects_keys_both_set_and_varied() {
        let set = [("friction_k".to_owned(), "0.2".to_owned())];
        let bases = || {
            let plain = paper().into_iter();
            plain
                .chain([Base::open("viscous", Path::new("."), &set).unwrap()])
                .collect()
        };
        let axes = || vec![Axis::parse("friction.k", "0.1,1").unwrap()];
        for design in [Design::Grid(axes()), Design::Sample(SAMPLE, axes())] {
            let message = Spec::new(bases(), design, None).unwrap_err().to_string();
            assert!(
                message.contains("friction.k is both set and varied"),
                "{message}"
            );
        }
        // A removed key is set to null.
        let removed = [("friction.k".to_owned(), String::new())];
        let base = Base::open("paper", Path::new("."), &removed).unwrap();
        assert!(Spec::new(vec![base], Design::Grid(axes()), None).is_ok());
    }
}
