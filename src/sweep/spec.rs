//! The spec of a sweep: which runs it consists of.

use super::axis::{Axis, find_key};
use super::error::SweepError;
use super::sample::{Method, Points, most_axes};
use super::table::Table;
use crate::archive::given;
use crate::run::scenario::{KEYS, Key, Value, Values};
use serde::de::{Deserializer, Error as _, Unexpected, Visitor};
use serde::{Deserialize, de};
use serde_json::{Map, Value as Json, json};
use std::fmt;
use std::path::{Path, PathBuf};

/// The most rows of a sweep: parts are numbered with six digits.
const MOST_ROWS: u64 = 1_000_000_000;

/// A scenario that runs of a sweep start from. Only with what a row changes need it be complete.
#[derive(Clone, Debug, PartialEq)]
pub struct Base {
    /// Its name in the table.
    pub name: String,
    /// Its keys and values.
    pub values: Values,
    /// The keys that were set beside the scenario.
    set: Vec<&'static str>,
}

impl Base {
    /// A scenario as it is.
    #[must_use]
    pub fn new(name: String, values: Values) -> Self {
        Self {
            name,
            values,
            set: Vec::new(),
        }
    }

    /// The preset of this name, or the scenario of the file or recording at this path, with some keys set otherwise.
    ///
    /// # Errors
    /// [`SweepError::Given`] if there is none, [`SweepError::Base`] if a key can't be set.
    pub fn open(word: &str, folder: &Path, set: &[(String, String)]) -> Result<Self, SweepError> {
        let wrong = |reason| SweepError::Base {
            name: word.to_owned(),
            reason,
        };
        let path = folder.join(word);
        let path: PathBuf = if path.is_file() { path } else { word.into() };
        let mut values = given::values(&path)?;
        let mut keys = Vec::new();
        for (key, value) in set {
            let key = find_key(key)?;
            values.set(key.path, value).map_err(wrong)?;
            if values.get(key.path).is_some() {
                keys.push(key.path);
            }
        }
        let name = match values.get("name") {
            Some(Value::Text(name)) => name.clone(),
            _ => word.to_owned(),
        };
        Ok(Self {
            name,
            values,
            set: keys,
        })
    }

    /// Its keys and values as JSON.
    fn to_json(&self) -> Json {
        let keys = KEYS.iter().filter_map(|key| {
            let value = match self.values.get(key.path)? {
                Value::Text(text) => json!(text),
                Value::Number(number) => json!(number),
            };
            Some((key.path.to_owned(), value))
        });
        Json::Object(keys.collect())
    }
}

/// How the rows of each base come about.
#[derive(Clone, Debug)]
pub enum Design {
    /// Every combination of the values of some axes; the last axis varies fastest.
    Grid(Vec<Axis>),
    /// Points chosen among the values of some axes.
    Sample {
        /// How many.
        count: u64,
        /// How they are chosen.
        method: Method,
        /// Which of many such choices; 0 is Sobol's sequence itself.
        seed: u64,
        /// The axes.
        axes: Vec<Axis>,
    },
    /// The rows of a table.
    Table(Table),
}

/// Which runs a sweep consists of.
#[derive(Clone, Debug)]
pub struct Spec {
    bases: Vec<Base>,
    design: Design,
    /// A run that takes more steps of the integrator than this has an error instead of an outcome.
    pub most_steps: Option<u64>,
    /// Conditions on rows whose runs are recorded; see [`Choice::parse`](super::Choice::parse). They change nothing of the
    /// table.
    pub keep: Vec<String>,
    /// The most runs that are recorded; none if all are for which the conditions hold, or none without conditions.
    pub record: Option<u64>,
    keys: Vec<&'static Key>,
    rows_per_base: u64,
    points: Option<Points>,
}

/// A spec as a file has it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    bases: Texts,
    #[serde(default, deserialize_with = "section")]
    set: toml::Table,
    #[serde(default, deserialize_with = "section")]
    over: toml::Table,
    sample: Option<SampleFile>,
    table: Option<String>,
    max_steps: Option<Count>,
    #[serde(default)]
    keep: Texts,
    record: Option<Count>,
}

/// A whole number from 1 on.
#[derive(Clone, Copy, Debug)]
struct Count(u64);

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let number = deserializer.deserialize_u64(Whole { least: 1 })?;
        Ok(Self(number))
    }
}

/// A whole number from 0 on.
fn whole<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    deserializer.deserialize_u64(Whole { least: 0 })
}

/// Takes whole numbers, and says so of others in words that are not Rust's.
struct Whole {
    least: u64,
}

impl Visitor<'_> for Whole {
    type Value = u64;

    fn expecting(&self, told: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(told, "a whole number from {} on", self.least)
    }

    fn visit_u64<E: de::Error>(self, number: u64) -> Result<u64, E> {
        if number < self.least {
            return Err(E::invalid_value(Unexpected::Unsigned(number), &self));
        }
        Ok(number)
    }

    fn visit_i64<E: de::Error>(self, number: i64) -> Result<u64, E> {
        match u64::try_from(number) {
            Ok(number) => self.visit_u64(number),
            Err(_) => Err(E::invalid_value(Unexpected::Signed(number), &self)),
        }
    }
}

/// A list of texts.
#[derive(Debug, Default, Deserialize)]
#[serde(try_from = "toml::Value")]
struct Texts(Vec<String>);

impl TryFrom<toml::Value> for Texts {
    type Error = &'static str;

    fn try_from(value: toml::Value) -> Result<Self, Self::Error> {
        let texts = value.as_array().map(|all| {
            let texts = all.iter().map(|text| text.as_str().map(str::to_owned));
            texts.collect::<Option<Vec<_>>>()
        });
        texts
            .flatten()
            .map(Self)
            .ok_or("must be a list of texts in quotes, as in [\"…\", \"…\"]")
    }
}

/// A section of keys and values.
fn section<'de, D: Deserializer<'de>>(deserializer: D) -> Result<toml::Table, D::Error> {
    match toml::Value::deserialize(deserializer)? {
        toml::Value::Table(table) => Ok(table),
        _ => Err(D::Error::custom("must be a section of keys and values")),
    }
}

/// How the points of a sample are chosen, by name.
fn method<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Method, D::Error> {
    match toml::Value::deserialize(deserializer)?.as_str() {
        Some("sobol") => Ok(Method::Sobol),
        Some("random") => Ok(Method::Random),
        _ => Err(D::Error::custom("must be \"sobol\" or \"random\"")),
    }
}

/// What a spec has that a scenario has not.
const SECTIONS: [&str; 8] = [
    "bases",
    "set",
    "over",
    "sample",
    "table",
    "max_steps",
    "keep",
    "record",
];

#[derive(Debug, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a section with count, method and seed"
)]
struct SampleFile {
    count: Count,
    #[serde(default, deserialize_with = "method")]
    method: Method,
    #[serde(default, deserialize_with = "whole")]
    seed: u64,
}

impl Spec {
    /// A sweep over these bases, the outermost axis.
    ///
    /// # Errors
    /// [`SweepError::Spec`] if bases, axes and sample don't fit together.
    pub fn new(
        bases: Vec<Base>,
        design: Design,
        most_steps: Option<u64>,
    ) -> Result<Self, SweepError> {
        let wrong = |reason: String| Err(SweepError::Spec(reason));
        if bases.is_empty() {
            return wrong("a sweep needs at least one preset or scenario file".to_owned());
        }
        if most_steps == Some(0) {
            return wrong("max_steps = 0: a run takes at least one step".to_owned());
        }
        let (keys, rows, points) = match &design {
            Design::Grid(axes) => (keys_of(axes), grid_size(axes)?, None),
            Design::Sample {
                count,
                method,
                seed,
                axes,
            } => {
                check_sample(axes, *method)?;
                let points = Points::new(*method, *seed, axes.len());
                (keys_of(axes), *count, Some(points))
            }
            Design::Table(table) => (table.keys(), table.rows(), None),
        };
        if let Some(twice) = (1..keys.len()).find(|i| {
            let same = |other: &&Key| other.path == keys[*i].path;
            keys[..*i].iter().any(same)
        }) {
            return wrong(format!("{} varies twice", keys[twice].path));
        }
        let always_varies = |set: &str| match &design {
            Design::Table(table) => table.always_has(set),
            Design::Grid(_) | Design::Sample { .. } => keys.iter().any(|key| key.path == set),
        };
        let mut set = bases.iter().flat_map(|base| &base.set);
        if let Some(key) = set.find(|key| always_varies(key)) {
            return wrong(format!(
                "{key} is set and varies too: what it is set to would have no effect"
            ));
        }
        let all = rows.checked_mul(bases.len() as u64);
        match all {
            Some(0) => wrong("there is nothing to run".to_owned()),
            Some(1..=MOST_ROWS) => Ok(Self {
                bases,
                design,
                most_steps,
                keep: Vec::new(),
                record: None,
                keys,
                rows_per_base: rows,
                points,
            }),
            _ => wrong(format!("more than {MOST_ROWS} runs")),
        }
    }

    /// Reads a spec from TOML. Files that it names are looked for in `folder`; keys are set in all its bases.
    ///
    /// # Errors
    /// As [`Spec::new`], [`Axis::parse`] and [`Base::open`]; [`SweepError::Spec`] for a text that is no spec.
    pub fn from_toml(
        text: &str,
        folder: &Path,
        set: &[(String, String)],
    ) -> Result<Self, SweepError> {
        let file: File = toml::from_str(text)
            .map_err(|error| SweepError::Spec(format!("not the spec of a sweep: {error}")))?;
        check_quotes("set", &file.set)?;
        check_quotes("over", &file.over)?;
        let own = file
            .set
            .iter()
            .map(|(key, value)| (key.clone(), plain(value)));
        let set: Vec<_> = own.chain(set.iter().cloned()).collect();
        let words = if file.bases.0.is_empty() {
            vec!["paper".to_owned()]
        } else {
            file.bases.0
        };
        let bases = words.iter().map(|word| Base::open(word, folder, &set));
        let axes = file.over.iter().map(|(key, value)| match value {
            toml::Value::Array(values) => {
                let values: Vec<String> = values.iter().map(plain).collect();
                Axis::of_list(key, &values)
            }
            value => Axis::parse(key, &plain(value)),
        });
        let axes = axes.collect::<Result<Vec<_>, _>>()?;
        let table = file.table.map(|path| Table::read(&folder.join(path)));
        let sample = file
            .sample
            .map(|sample| (sample.count.0, sample.method, sample.seed));
        let design = Design::of(axes, sample, table.transpose()?)?;
        let most_steps = file.max_steps.map(|count| count.0);
        let spec = Self::new(bases.collect::<Result<_, _>>()?, design, most_steps)?;
        Ok(Self {
            keep: file.keep.0,
            record: file.record.map(|count| count.0),
            ..spec
        })
    }

    /// Whether a TOML text is a spec rather than a scenario.
    #[must_use]
    pub fn is_spec(text: &str) -> bool {
        let table: Option<toml::Table> = text.parse().ok();
        table.is_some_and(|table| SECTIONS.iter().any(|name| table.contains_key(*name)))
    }

    /// The number of rows.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows_per_base * self.bases.len() as u64
    }

    /// The keys that vary, in the order of their columns.
    #[must_use]
    pub fn keys(&self) -> &[&'static Key] {
        &self.keys
    }

    /// A name that several bases have, so that the table doesn't tell their runs apart.
    #[must_use]
    pub fn shared_name(&self) -> Option<&str> {
        let mut names = self.bases.iter().map(|base| base.name.as_str()).enumerate();
        let is_earlier = |(index, name): &(usize, &str)| {
            self.bases[..*index].iter().any(|base| base.name == *name)
        };
        names.find(is_earlier).map(|(_, name)| name)
    }

    /// The bases, the outermost axis.
    pub(super) fn bases(&self) -> impl Iterator<Item = &Base> {
        self.bases.iter()
    }

    /// The base of a row.
    pub(super) fn base(&self, row: u64) -> &Base {
        &self.bases[(row / self.rows_per_base) as usize]
    }

    /// What a row changes in its base: a value, or none, for each of [`Spec::keys`].
    pub(super) fn values(&self, row: u64) -> Vec<Option<Value>> {
        let row = row % self.rows_per_base;
        match &self.design {
            Design::Grid(axes) => {
                let mut rest = row;
                let mut values: Vec<_> = axes
                    .iter()
                    .rev()
                    .map(|axis| {
                        let count = axis.count().unwrap_or(1);
                        let value = axis.at(rest % count);
                        rest /= count;
                        Some(value)
                    })
                    .collect();
                values.reverse();
                values
            }
            Design::Sample { axes, .. } => {
                let at = |dimension| {
                    let points = self.points.as_ref();
                    points.map_or(0.0, |points| points.at(row, dimension))
                };
                let axes = axes.iter().enumerate();
                axes.map(|(i, axis)| Some(axis.sampled(at(i)))).collect()
            }
            Design::Table(table) => table.row(row),
        }
    }

    /// All that decides about the bytes of the table: what tells this sweep from another.
    #[must_use]
    pub fn to_json(&self) -> Json {
        let axes = |axes: &[Axis]| {
            let entry = |axis: &Axis| (axis.key.path.to_owned(), json!(axis.text));
            Json::Object(axes.iter().map(entry).collect())
        };
        let bases = |base: &Base| (base.name.clone(), base.to_json());
        let mut spec = Map::new();
        let mut put = |name: &str, value| spec.insert(name.to_owned(), value);
        put("format", json!("toprise-sweep-1"));
        put("toprise", json!(env!("CARGO_PKG_VERSION")));
        put("runs", json!(self.rows()));
        let all: Vec<Json> = self
            .bases
            .iter()
            .map(bases)
            .map(|(name, values)| json!({"name": name, "scenario": values}))
            .collect();
        put("bases", Json::Array(all));
        match &self.design {
            Design::Grid(grid) => {
                put("over", axes(grid));
            }
            Design::Sample {
                count,
                method,
                seed,
                axes: over,
            } => {
                put("over", axes(over));
                put(
                    "sample",
                    json!({"count": count, "method": method, "seed": seed}),
                );
            }
            Design::Table(table) => {
                put("table", json!({"sha256": table.digest()}));
            }
        }
        put("max_steps", json!(self.most_steps));
        Json::Object(spec)
    }
}

impl Design {
    /// The design that axes, a sample (count, method, seed) or a table make.
    ///
    /// # Errors
    /// [`SweepError::Spec`] if they exclude each other.
    pub fn of(
        axes: Vec<Axis>,
        sample: Option<(u64, Method, u64)>,
        table: Option<Table>,
    ) -> Result<Self, SweepError> {
        match (sample, table) {
            (None, None) => Ok(Self::Grid(axes)),
            (Some((count, method, seed)), None) => Ok(Self::Sample {
                count,
                method,
                seed,
                axes,
            }),
            (None, Some(table)) if axes.is_empty() => Ok(Self::Table(table)),
            (_, Some(_)) => Err(SweepError::Spec(
                "a table says all that varies: leave the axes and the sample out".to_owned(),
            )),
        }
    }
}

/// Refuses keys that were written without quotes: their dots make tables of them.
fn check_quotes(section: &str, entries: &toml::Table) -> Result<(), SweepError> {
    let inner = entries.iter().find_map(|(name, value)| {
        let (inner, _) = value.as_table()?.iter().next()?;
        Some(format!("{name}.{inner}"))
    });
    match inner {
        Some(key) => Err(SweepError::Spec(format!(
            "[{section}] {key}: a key with a dot needs quotes, as in \"{key}\" = …"
        ))),
        None => Ok(()),
    }
}

/// What differs first between the specs of two sweeps, as words; none if they are equal.
pub(super) fn change(before: &Json, now: &Json) -> Option<String> {
    changed("", before, now)
}

fn changed(path: &str, before: &Json, now: &Json) -> Option<String> {
    let inner = |name: &str| {
        if path.is_empty() {
            name.to_owned()
        } else {
            format!("{path}.{name}")
        }
    };
    match (before, now) {
        (Json::Object(old), Json::Object(new)) => {
            let names = new.keys().chain(old.keys());
            // The number of runs follows from the rest, which says more.
            let (last, first): (Vec<_>, Vec<_>) = names.partition(|name| *name == "runs");
            let mut all = first.into_iter().chain(last);
            let differing = all.find_map(|name| {
                let of = |map: &Map<String, Json>| map.get(name).cloned().unwrap_or_default();
                changed(&inner(name), &of(old), &of(new))
            });
            let order = || {
                let same = old.keys().eq(new.keys());
                (!same).then(|| format!("the order of {path}"))
            };
            differing.or_else(order)
        }
        (Json::Array(old), Json::Array(new)) if old.len() == new.len() => {
            let pairs = old.iter().zip(new).enumerate();
            pairs
                .into_iter()
                .find_map(|(i, (old, new))| changed(&format!("{path}[{i}]"), old, new))
        }
        (Json::Array(old), Json::Array(new)) => Some(format!(
            "{path} had {} entries there, and {} here",
            old.len(),
            new.len()
        )),
        (old, new) if old == new => None,
        (Json::Null, new) => Some(format!("{path} = {new} is new")),
        (old, Json::Null) => Some(format!("{path} = {old} is gone")),
        (old, new) => Some(format!("{path} = {old} there, and {new} here")),
    }
}

fn keys_of(axes: &[Axis]) -> Vec<&'static Key> {
    axes.iter().map(|axis| axis.key).collect()
}

/// The number of points of a grid.
fn grid_size(axes: &[Axis]) -> Result<u64, SweepError> {
    axes.iter().try_fold(1_u64, |size, axis| {
        let count = axis.count().ok_or_else(|| {
            let Axis { key, text, .. } = axis;
            let name = key.path;
            SweepError::Spec(format!(
                "{name}={text}: a grid needs the number of values, as in {name}=a..b/10 or a..b/10log; a sample does not"
            ))
        })?;
        size.checked_mul(count)
            .filter(|size| *size <= MOST_ROWS)
            .ok_or_else(|| SweepError::Spec(format!("more than {MOST_ROWS} runs")))
    })
}

fn check_sample(axes: &[Axis], method: Method) -> Result<(), SweepError> {
    let wrong = |reason: String| Err(SweepError::Spec(reason));
    if axes.is_empty() {
        return wrong("a sample needs at least one axis, as in friction.k = 0.01..1".to_owned());
    }
    if axes.len() > most_axes(method) {
        return wrong(format!(
            "{} axes are more than the {} that this method has",
            axes.len(),
            most_axes(method)
        ));
    }
    match axes.iter().find(|axis| axis.is_counted_range()) {
        Some(Axis { key, text, .. }) => wrong(format!(
            "{}={text}: a sample has its own number of values; write a..b or a..b/log",
            key.path
        )),
        None => Ok(()),
    }
}

/// A value as it would stand on the command line.
fn plain(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        // TOML's own text of it may have rows of zeros.
        toml::Value::Float(number) => format!("{number:?}"),
        value => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> Vec<Base> {
        vec![Base::open("paper", Path::new("."), &[]).unwrap()]
    }

    fn grid(axes: &[(&str, &str)]) -> Spec {
        let axes = axes
            .iter()
            .map(|(key, text)| Axis::parse(key, text).unwrap());
        Spec::new(paper(), Design::Grid(axes.collect()), None).unwrap()
    }

    #[test]
    fn the_last_axis_varies_fastest_and_bases_slowest() {
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
    fn a_file_says_what_the_command_line_does() {
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
        let told = |text: &str| {
            let error = Spec::from_toml(text, Path::new("."), &[]).unwrap_err();
            error.to_string()
        };
        let names = SECTIONS.map(|name| format!("`{name}`")).join(", ");
        let all = format!("unknown field `ovr`, expected one of {names}");
        assert!(told("ovr = 1").contains(&all), "{}", told("ovr = 1"));
        assert_eq!(
            told("[over]\nfriction.k = [0.1]"),
            "[over] friction.k: a key with a dot needs quotes, as in \"friction.k\" = …"
        );
        assert!(told("[set]\nstop.duration = 2").contains("\"stop.duration\" = …"));
    }

    #[test]
    fn what_is_wrong_in_a_file_is_told_in_plain_words() {
        for (text, part) in [
            ("record = 0", "expected a whole number from 1 on"),
            ("max_steps = 0", "expected a whole number from 1 on"),
            ("max_steps = 1e3", "expected a whole number from 1 on"),
            ("max_steps = -1", "expected a whole number from 1 on"),
            ("keep = \"run > 1\"", "must be a list of texts"),
            ("keep = [1]", "must be a list of texts"),
            ("bases = \"paper\"", "must be a list of texts"),
            ("set = 1", "must be a section"),
            ("over = []", "must be a section"),
            ("sample = 10", "expected a section with count"),
            ("sample.count = 0", "expected a whole number from 1 on"),
            (
                "sample = { count = 9, seed = -1 }",
                "expected a whole number from 0 on",
            ),
            (
                "sample = { count = 9, method = \"x\" }",
                "must be \"sobol\" or \"random\"",
            ),
            ("sample.count = 9", "at least one axis, as in friction.k"),
        ] {
            let told = Spec::from_toml(text, Path::new(""), &[]).unwrap_err();
            let told = told.to_string();
            assert!(told.contains(part), "{text}: {told}");
            for word in [
                "u64", "nonzero", "sequence", "map", "struct", "variant", "--",
            ] {
                assert!(!told.contains(word), "{text}: {told}");
            }
        }
        let none = Spec::new(paper(), Design::Grid(Vec::new()), Some(0)).unwrap_err();
        assert!(none.to_string().contains("at least one step"), "{none}");
    }

    #[test]
    fn what_changed_is_named() {
        let before = grid(&[("friction.k", "0.1,0.2")]).to_json();
        let told = |axes: &[(&str, &str)]| change(&before, &grid(axes).to_json());
        assert_eq!(told(&[("friction.k", "0.1,0.2")]), None);
        assert_eq!(
            told(&[("friction.k", "0.1,0.3")]).unwrap(),
            "over.friction.k = \"0.1,0.2\" there, and \"0.1,0.3\" here"
        );
        assert_eq!(told(&[]).unwrap(), "over.friction.k = \"0.1,0.2\" is gone");
        let set = [("top.mass".to_owned(), "0.2".to_owned())];
        let bases = vec![Base::open("paper", Path::new("."), &set).unwrap()];
        let axes = vec![Axis::parse("friction.k", "0.1,0.2").unwrap()];
        let heavier = Spec::new(bases, Design::Grid(axes), None).unwrap();
        assert_eq!(
            change(&before, &heavier.to_json()).unwrap(),
            "bases[0].scenario.top.mass = 0.11 there, and 0.2 here"
        );
    }

    #[test]
    fn what_does_not_fit_together_is_refused() {
        let axis = |key: &str, text: &str| Axis::parse(key, text).unwrap();
        let sample = |axes| Design::of(axes, Some((10, Method::Sobol, 0)), None).unwrap();
        for (design, part) in [
            (Design::Grid(vec![axis("friction.k", "0.1..1")]), "a..b/10"),
            (
                Design::Grid(vec![axis("friction.k", "0.1,1"), axis("friction_k", "1")]),
                "twice",
            ),
            (sample(vec![axis("friction.k", "0.1..1/5")]), "own number"),
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
    fn a_key_that_varies_is_not_set_too() {
        let set = [("friction_k".to_owned(), "0.2".to_owned())];
        let bases = || {
            let plain = paper().into_iter();
            plain
                .chain([Base::open("viscous", Path::new("."), &set).unwrap()])
                .collect()
        };
        let axes = || vec![Axis::parse("friction.k", "0.1,1").unwrap()];
        for design in [
            Design::Grid(axes()),
            Design::of(axes(), Some((10, Method::Sobol, 0)), None).unwrap(),
        ] {
            let told = Spec::new(bases(), design, None).unwrap_err().to_string();
            assert!(told.contains("friction.k is set and varies too"), "{told}");
        }
        let text = "set.\"friction.k\" = 0.2\n[over]\n\"friction.k\" = [0.1, 1]";
        let told = Spec::from_toml(text, Path::new("."), &[]).unwrap_err();
        assert!(told.to_string().contains("varies too"), "{told}");
        // A key that is removed is set to nothing.
        let removed = [("friction.k".to_owned(), String::new())];
        let base = Base::open("paper", Path::new("."), &removed).unwrap();
        assert!(Spec::new(vec![base], Design::Grid(axes()), None).is_ok());
    }
}
