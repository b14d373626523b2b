//! An axis of a sweep: a scenario key and its values.

use crate::physics::math::{exp, ln};
use crate::run::scenario::{self, KEYS, Key, ScenarioError, Value};
use crate::sweep::error::{AxisProblem, SweepError};

/// Maximum number of values of an axis.
const MAX_VALUES: u32 = 10_000_000;

/// A key with its values.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The key.
    pub key: &'static Key,
    /// The values as given; part of a sweep's identity.
    pub text: String,
    points: AxisPoints,
}

#[derive(Clone, Debug)]
enum AxisPoints {
    /// These values.
    List(Vec<Value>),
    /// From one number to another.
    Range(Range),
}

#[derive(Clone, Copy, Debug)]
struct Range {
    from: f64,
    to: f64,
    /// Number of values; `None` for samples.
    count: Option<u32>,
    /// Whether logarithms are evenly spaced rather than numbers.
    is_log: bool,
}

/// The key with this name: its path, or its name in tables.
///
/// # Errors
/// [`ScenarioError`] if there is none.
pub fn find_key(name: &str) -> Result<&'static Key, ScenarioError> {
    match KEYS.iter().find(|key| column_name(key) == name) {
        Some(key) => Ok(key),
        None => scenario::find_key(name),
    }
}

/// The name of a key's column: its path with `_` for the dots, which Spark and Rerun don't allow.
pub fn column_name(key: &Key) -> String {
    key.path.replace('.', "_")
}

impl Axis {
    /// Reads `a..b/N`, `a..b/Nlog`, `a..b` or `a..b/log` (for samples) or values separated by commas.
    ///
    /// # Errors
    /// [`SweepError::Scenario`] for an unknown key, [`SweepError::Axis`] for invalid values.
    pub fn parse(name: &str, text: &str) -> Result<Self, SweepError> {
        let key = find_key(name)?;
        match AxisPoints::parse(key, text) {
            Ok(points) => Ok(Self {
                key,
                text: text.to_owned(),
                points,
            }),
            Err(problem) => Err(SweepError::Axis {
                key,
                text: text.to_owned(),
                problem,
            }),
        }
    }

    /// The error for values that don't suit the sweep.
    pub(super) fn invalid(&self, problem: AxisProblem) -> SweepError {
        SweepError::Axis {
            key: self.key,
            text: self.text.clone(),
            problem,
        }
    }

    /// Number of values that a grid has along this axis; `None` if only a sample can choose them.
    pub fn count(&self) -> Option<u64> {
        match &self.points {
            AxisPoints::List(values) => Some(values.len() as u64),
            AxisPoints::Range(range) => range.count.map(u64::from),
        }
    }

    /// The value at a grid index, clamped to the last value.
    pub fn at(&self, index: u64) -> Value {
        match &self.points {
            AxisPoints::List(values) => values[index.min(values.len() as u64 - 1) as usize].clone(),
            AxisPoints::Range(range) => {
                let last = range.count.map_or(1, |count| u64::from(count) - 1);
                Value::Number(range.on_grid(index.min(last) as f64 / last as f64))
            }
        }
    }

    /// The value at a fraction, from 0 to below 1, of the axis.
    pub fn sampled(&self, fraction: f64) -> Value {
        match &self.points {
            AxisPoints::List(values) => self.at((fraction * values.len() as f64) as u64),
            AxisPoints::Range(range) => Value::Number(range.at(fraction)),
        }
    }

    /// Whether this is a range with a number of values, which a sample doesn't need.
    pub fn is_counted_range(&self) -> bool {
        matches!(&self.points, AxisPoints::Range(range) if range.count.is_some())
    }
}

impl AxisPoints {
    fn parse(key: &Key, text: &str) -> Result<Self, AxisProblem> {
        // A text, such as a description, may contain two dots.
        if !key.kind.is_text() && text.contains("..") {
            return parse_range(text).map(Self::Range);
        }
        split_list(text)
            .map(|item| parse_item(key, item.trim()))
            .collect::<Result<_, _>>()
            .map(Self::List)
    }
}

/// The items of a list. Commas in parentheses separate the arguments of a formula's function.
fn split_list(text: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0_usize;
    text.split(move |character| {
        match character {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0 && character == ','
    })
}

impl Range {
    /// The number at a fraction of the range; both ends exactly.
    fn at(self, fraction: f64) -> f64 {
        let Self { from, to, .. } = self;
        if fraction <= 0.0 {
            from
        } else if fraction >= 1.0 {
            to
        } else if self.is_log {
            exp(ln(from) + fraction * (ln(to) - ln(from)))
        } else if (to - from).is_finite() {
            from + fraction * (to - from)
        } else {
            // The distance of the ends overflows, their weighted sum does not.
            (1.0 - fraction) * from + fraction * to
        }
    }

    /// The number at a fraction of the range, or the decimal that it is but for rounding: decades and steps such as 0.1
    /// are exact, so that a value can be a whole number of nanoseconds.
    fn on_grid(self, fraction: f64) -> f64 {
        let number = self.at(fraction);
        let decimal = rounded(number);
        // Each operation rounds by half an epsilon: of the logarithms, whose error is relative in the number, or of the
        // ends.
        let rounding = if self.is_log {
            2.0 * f64::EPSILON * (1.0 + ln(self.from).abs() + ln(self.to).abs()) * number
        } else {
            2.0 * f64::EPSILON * self.from.abs().max(self.to.abs())
        };
        if number.abs() <= rounding && !self.is_log {
            0.0
        } else if (decimal - number).abs() <= rounding {
            decimal
        } else {
            number
        }
    }
}

/// The number with 12 significant digits: numbers of grids that have more are no decimals that someone chose.
fn rounded(number: f64) -> f64 {
    format!("{number:.11e}").parse().unwrap_or(number)
}

/// Parses a value of a list.
fn parse_item(key: &Key, item: &str) -> Result<Value, AxisProblem> {
    if item.is_empty() {
        Err(AxisProblem::EmptyValue)
    } else if item.starts_with(['"', '\'']) {
        Err(AxisProblem::Quoted(item.to_owned()))
    } else if key.kind.is_text() {
        Ok(Value::Text(item.to_owned()))
    } else {
        parse_number(item).map(Value::Number)
    }
}

fn parse_number(text: &str) -> Result<f64, AxisProblem> {
    let word = text.trim();
    if word.is_empty() {
        return Err(AxisProblem::EmptyValue);
    }
    match word.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) | Err(_) => Err(AxisProblem::NotANumber(word.to_owned())),
    }
}

fn parse_range(text: &str) -> Result<Range, AxisProblem> {
    let (ends, steps) = match text.split_once('/') {
        Some((_, steps)) if steps.trim().is_empty() => return Err(AxisProblem::NoCount),
        Some((ends, steps)) => (ends, steps.trim()),
        None => (text, ""),
    };
    let (from, to) = ends.split_once("..").ok_or(AxisProblem::NotARange)?;
    let (count, is_log) = match steps.strip_suffix("log") {
        Some(count) => (count, true),
        None => (steps, false),
    };
    let range = Range {
        from: parse_number(from)?,
        to: parse_number(to)?,
        count: parse_count(count)?,
        is_log,
    };
    if is_log && !(range.from > 0.0 && range.to > 0.0) {
        return Err(AxisProblem::NotPositive);
    }
    Ok(range)
}

/// Parses the number of values of a range; samples have none.
fn parse_count(text: &str) -> Result<Option<u32>, AxisProblem> {
    if text.is_empty() {
        return Ok(None);
    }
    match text.parse() {
        Ok(count) if (2..=MAX_VALUES).contains(&count) => Ok(Some(count)),
        Ok(_) | Err(_) => Err(AxisProblem::WrongCount {
            text: text.to_owned(),
            most: MAX_VALUES,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(axis: &Axis) -> Vec<f64> {
        let values = (0..axis.count().unwrap()).map(|i| match axis.at(i) {
            Value::Number(number) => number,
            Value::Text(text) => panic!("{text}"),
        });
        values.collect()
    }

    #[test]
    fn ranges_have_their_ends_exactly() {
        let linear = Axis::parse("initial.psi_dot", "60..200/8").unwrap();
        assert_eq!(
            numbers(&linear),
            [60.0, 80.0, 100.0, 120.0, 140.0, 160.0, 180.0, 200.0]
        );
        let log = Axis::parse("friction_k", "0.001..0.1/3log").unwrap();
        let [first, middle, last] = numbers(&log)[..] else {
            panic!("three values");
        };
        assert_eq!((first, last), (0.001, 0.1));
        assert_eq!(middle, 0.01);
        let list = Axis::parse("friction.k", "0.03, 0.01").unwrap();
        assert_eq!(numbers(&list), [0.03, 0.01]);
        let words = Axis::parse("friction.law", "viscous,coulomb").unwrap();
        assert_eq!(words.at(1), Value::Text("coulomb".to_owned()));
        let formulas = Axis::parse("friction.formula", "k*tanh(v/a), min(k, a*v)").unwrap();
        assert_eq!(formulas.count(), Some(2));
        assert_eq!(formulas.at(1), Value::Text("min(k, a*v)".to_owned()));
        let down = Axis::parse("initial.phi", "1..-1/3").unwrap();
        assert_eq!(numbers(&down), [1.0, 0.0, -1.0]);
        let wide = Axis::parse("initial.phi", "-1e308..1e308/3").unwrap();
        assert_eq!(numbers(&wide), [-1e308, 0.0, 1e308]);
    }

    #[test]
    fn decades_and_decimal_steps_are_exact() {
        let grid = |text: &str| numbers(&Axis::parse("sampling.period", text).unwrap());
        assert_eq!(grid("1e-4..1e-1/4log"), [1e-4, 1e-3, 1e-2, 1e-1]);
        assert_eq!(
            grid("1e2..1e-6/9log"),
            [1e2, 1e1, 1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6]
        );
        assert_eq!(
            grid("0.001..0.008/8"),
            [0.001, 0.002, 0.003, 0.004, 0.005, 0.006, 0.007, 0.008]
        );
        assert_eq!(grid("-0.3..0.3/7"), [-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3]);
        // Others keep all digits: √10 and 1/3.
        let root = grid("1..10/3log")[1];
        assert!(
            (root - 10_f64.sqrt()).abs() <= 2.0 * f64::EPSILON,
            "{root:?}"
        );
        assert_eq!(grid("0..1/4")[1], 1.0 / 3.0);
    }

    #[test]
    fn rejects_empty_and_quoted_values() {
        for (list, part) in [
            ("a,,b", "a value is empty"),
            ("a,", "a value is empty"),
            ("", "a value is empty"),
            ("'a,b',c", "'a: don't quote words"),
            ("\"a", "\"a: don't quote words"),
        ] {
            let message = Axis::parse("description", list).unwrap_err().to_string();
            assert!(message.contains(part), "{list}: {message}");
        }
    }

    #[test]
    fn samples_lie_on_the_axis() {
        let axis = Axis::parse("friction.k", "0.01..1/log").unwrap();
        assert_eq!(axis.count(), None);
        assert_eq!(axis.sampled(0.0), Value::Number(0.01));
        let list = Axis::parse("friction.law", "viscous,coulomb").unwrap();
        assert_eq!(list.sampled(0.49), Value::Text("viscous".to_owned()));
        assert_eq!(list.sampled(0.5), Value::Text("coulomb".to_owned()));
    }

    #[test]
    fn rejects_invalid_values() {
        for (key, text) in [
            ("friction.k", ""),
            ("friction.k", "0.1,,0.2"),
            ("friction.k", "fast"),
            ("friction.k", "inf"),
            ("friction.k", "0..1/1"),
            ("friction.k", "0..1/"),
            ("friction.k", "0..1/-3"),
            ("friction.k", "0..1/3log"),
            ("friction.k", "0.1..nan/3"),
            ("friction.k", "0.1../3"),
            ("friction.l", "0.1"),
            ("friction-k", "0.1"),
        ] {
            assert!(Axis::parse(key, text).is_err(), "{key}={text}");
        }
        let error = Axis::parse("friction.kk", "1").unwrap_err().to_string();
        assert!(error.contains("friction.k"), "{error}");
    }

    #[test]
    fn names_in_tables_are_unique() {
        for key in KEYS {
            assert_eq!(find_key(&column_name(key)).unwrap().path, key.path);
            assert_eq!(find_key(key.path).unwrap().path, key.path);
        }
    }
}
