//! The keys that apply to a scenario, and the values that they may have.
//!
//! Every answer comes from [`Scenario::new`]: a key or value is possible if the scenario that has it is accepted. So
//! there is one set of rules, and what is offered here is never refused there.

use super::definition::Scenario;
use super::error::{Problem, Requirement, ScenarioError};
use super::key::{EXAMPLE_FORMULA, Key, Kind, Presence, Value};
use super::keys::KEYS;
use super::parse::nanoseconds;
use super::presets::PRESETS;
use super::values::{Need, Values, find_key};
use std::sync::LazyLock;

/// A key that can be set in a scenario, given the other keys.
#[derive(Clone, Debug, PartialEq)]
pub struct ApplicableKey {
    /// The key.
    pub key: &'static Key,
    /// Whether the scenario is not valid without it.
    pub is_required: bool,
    /// The values that it may have.
    pub allowed: Allowed,
}

/// Values that a key may have, given the other keys.
#[derive(Clone, Debug, PartialEq)]
pub enum Allowed {
    /// Any text that the key allows.
    Text,
    /// These words. Other keys may have to change with them, as [`Values::change`] does.
    Words(Vec<&'static str>),
    /// The numbers in this closed interval (times: whole nanoseconds). A tippe top's centre distance of exactly 0 is
    /// inside the interval, but not valid.
    Range([f64; 2]),
}

impl Values {
    /// The keys that can be set, in table order, with the values that they may have if all other keys keep theirs.
    ///
    /// If the other keys contradict each other, so that no value would do, a key has its own range.
    pub fn applicable_keys(&self) -> Vec<ApplicableKey> {
        let is_valid = is_valid(self);
        KEYS.iter()
            .filter_map(|key| {
                Some(ApplicableKey {
                    key,
                    is_required: self.requires(key, is_valid),
                    allowed: self.allowed(key, is_valid)?,
                })
            })
            .collect()
    }

    /// Sets a key as [`Values::set`] does, then makes the others agree with it: adds keys that are now required, with
    /// usual values, removes those that no longer apply, and sets those that must have a certain value.
    ///
    /// A contradiction that has no obvious remedy is left for [`Scenario::new`] to report.
    ///
    /// # Errors
    /// As [`Values::set`].
    pub fn change(&mut self, path: &str, text: &str) -> Result<(), ScenarioError> {
        self.set(path, text)?;
        self.adapt(find_key(path)?);
        Ok(())
    }

    /// Makes the other keys agree with one that was changed.
    fn adapt(&mut self, changed: &Key) {
        // Each round settles a key for good, but a mistake here must not become an endless loop.
        for _ in KEYS {
            match Scenario::new(self.clone()) {
                Ok(_) => return,
                Err(error) => {
                    if !self.mend(changed, &error) {
                        return;
                    }
                }
            }
        }
    }

    /// Removes the cause of an error, but leaves the changed key alone. Returns whether anything was done.
    fn mend(&mut self, changed: &Key, error: &ScenarioError) -> bool {
        let path = error.key.as_deref().unwrap_or_default();
        match &*error.problem {
            Problem::Missing { keys, .. } => {
                let mut is_mended = false;
                for key in keys {
                    is_mended |= if key.path == changed.path {
                        self.remove_dependents(changed)
                    } else {
                        self.add_usual(key)
                    };
                }
                is_mended
            }
            Problem::Requires { requirements, .. } => {
                let mut is_mended = false;
                for requirement in requirements {
                    is_mended |= self.fulfil(changed, *requirement);
                }
                is_mended
            }
            Problem::Excludes(other) => {
                self.remove_unless(changed, path) || self.remove_unless(changed, other)
            }
            Problem::Inapplicable { .. }
            | Problem::NotInFormula
            | Problem::TippeTop
            | Problem::AlreadyIncluded
            | Problem::NeverSticks => self.remove_unless(changed, path),
            Problem::Endless => self.fulfil(changed, Requirement::Set("stop.duration")),
            Problem::Syntax(_)
            | Problem::Formula { .. }
            | Problem::Coefficient(_)
            | Problem::StaticFriction { .. }
            | Problem::UnknownPreset { .. }
            | Problem::UnknownKey { .. }
            | Problem::NotAllowed { .. }
            | Problem::SetTwice
            | Problem::NotAboveFixedPeg
            | Problem::OutsideSphere
            | Problem::TooSmallMoment { .. }
            | Problem::TooLargeMoment { .. }
            | Problem::SingularStart
            | Problem::AlreadyPassed { .. }
            | Problem::TooManySamples { .. } => false,
        }
    }

    fn fulfil(&mut self, changed: &Key, requirement: Requirement) -> bool {
        match requirement {
            Requirement::Word(path, _) | Requirement::Set(path) if path == changed.path => false,
            Requirement::Word(path, word) => self.set_value(path, word).is_ok(),
            Requirement::Set(path) => find_key(path).is_ok_and(|key| self.add_usual(key)),
        }
    }

    /// Removes a key, and those that need it, unless it is the changed one.
    fn remove_unless(&mut self, changed: &Key, path: &str) -> bool {
        if path == changed.path || !self.has(path) {
            return false;
        }
        self.remove(path);
        if let Ok(key) = find_key(path) {
            self.remove_dependents(key);
        }
        true
    }

    /// Removes the keys that are allowed only with this one.
    fn remove_dependents(&mut self, key: &Key) -> bool {
        let mut is_removed = false;
        for dependent in KEYS {
            if dependent.presence == Presence::RequiredWithKey(key.path) && self.has(dependent.path)
            {
                self.remove(dependent.path);
                is_removed = true;
            }
        }
        is_removed
    }

    /// Sets a key to its usual value, unless it is set.
    fn add_usual(&mut self, key: &Key) -> bool {
        if self.has(key.path) {
            return false;
        }
        match usual_value(key) {
            Some(value) => {
                self.insert(key, value);
                true
            }
            None => false,
        }
    }

    /// A copy with one key set, and the keys added that it requires.
    fn completed_with(&self, key: &Key, value: Value) -> Self {
        let mut values = self.clone();
        values.insert(key, value);
        for dependent in KEYS {
            if dependent.presence == Presence::RequiredWithKey(key.path) {
                values.add_usual(dependent);
            }
        }
        values
    }

    /// Whether these values are not valid without a key; `is_valid` is whether they are with it.
    fn requires(&self, key: &Key, is_valid: bool) -> bool {
        if !is_valid || !self.has(key.path) {
            return self.need_now(key) == Need::Required;
        }
        let mut values = self.clone();
        values.remove(key.path);
        // They would be refused without it.
        values.remove_dependents(key);
        !self::is_valid(&values)
    }

    /// The values that a key may have; `None` if the key doesn't apply.
    fn allowed(&self, key: &Key, is_valid: bool) -> Option<Allowed> {
        match key.kind {
            Kind::Text | Kind::Name | Kind::Formula => {
                self.has_place_for(key).then_some(Allowed::Text)
            }
            Kind::Choice(words) => self.words(key, words).map(Allowed::Words),
            Kind::Any => self.range(key, [f64::MIN, f64::MAX], is_valid),
            Kind::Between(low, high) => self.range(key, [low, high], is_valid),
            Kind::Nanoseconds => self.range(key, [1e-9, 3600.0], is_valid),
        }
    }

    /// The words of a key with which the scenario is valid after [`Values::change`]; its own if there are none for
    /// another reason.
    fn words(&self, key: &Key, words: &'static [&'static str]) -> Option<Vec<&'static str>> {
        let possible: Vec<_> = words
            .iter()
            .copied()
            .filter(|word| {
                let mut values = self.clone();
                values.change(key.path, word).is_ok() && is_valid(&values)
            })
            .collect();
        if !possible.is_empty() {
            return Some(possible);
        }
        self.has_place_for(key).then(|| words.to_vec())
    }

    /// Whether a key has to be set, given the others. While a person still writes a formula, its parameters stay as they are.
    fn need_now(&self, key: &Key) -> Need {
        match self.formula() {
            Ok(formula) => self.need(key, formula.as_ref()),
            Err(_) if !matches!(key.presence, Presence::Parameter(_)) => self.need(key, None),
            Err(_) if self.has(key.path) => Need::Optional,
            Err(_) => Need::Excluded,
        }
    }

    /// Whether the table of keys allows a key, given the others.
    fn has_place_for(&self, key: &Key) -> bool {
        self.need_now(key) != Need::Excluded
    }

    /// The interval of numbers around the current value, or a usual one, with which the scenario is valid.
    fn range(&self, key: &Key, limits: [f64; 2], is_valid: bool) -> Option<Allowed> {
        if !self.has_place_for(key) {
            return None;
        }
        // The search needs a valid number to begin with.
        let current = self.optional_number(key.path).filter(|_| is_valid);
        let start = current.or_else(|| {
            candidates(key, limits)
                .into_iter()
                // Usual values first: they are nearly always valid.
                .find(|number| self::is_valid(&self.completed_with(key, Value::Number(*number))))
        });
        let Some(start) = start else {
            return self.range_without_example(key, limits, is_valid);
        };
        Some(Allowed::Range(limits.map(|limit| {
            last_valid(start, limit, key.kind, |number| {
                self::is_valid(&self.completed_with(key, Value::Number(number)))
            })
        })))
    }

    /// The range of a key for which no valid value was found: none if the others are valid without it, so that it is
    /// the key that doesn't fit.
    fn range_without_example(
        &self,
        key: &Key,
        limits: [f64; 2],
        is_valid: bool,
    ) -> Option<Allowed> {
        let is_refused = is_valid && !self.has(key.path);
        (!is_refused).then_some(Allowed::Range(limits))
    }
}

fn is_valid(values: &Values) -> bool {
    Scenario::new(values.clone()).is_ok()
}

/// The values of all presets, in their order: parsed once, because the keys of a scenario are asked for with each
/// movement of a slider.
static PRESET_VALUES: LazyLock<Vec<Values>> = LazyLock::new(|| {
    PRESETS
        .iter()
        .filter_map(|preset| preset.values().ok())
        .collect()
});

/// The value that a key has when it is added: that of the first preset that has it, or the first word, or the middle of
/// the typical range.
fn usual_value(key: &Key) -> Option<Value> {
    if let Some(value) = PRESET_VALUES.iter().find_map(|values| values.get(key.path)) {
        return Some(value.clone());
    }
    match (key.kind, key.typical) {
        (Kind::Formula, _) => Some(Value::Text(EXAMPLE_FORMULA.to_owned())),
        (Kind::Choice(words), _) => words.first().map(|word| Value::Text((*word).to_owned())),
        (_, Some(range)) => Some(Value::Number(middle(key, range))),
        (_, None) => None,
    }
}

/// The middle of a typical range: rounded, because people read it.
fn middle(key: &Key, [low, high]: [f64; 2]) -> f64 {
    let middle = if key.is_logarithmic() {
        (low * high).sqrt()
    } else {
        f64::midpoint(low, high)
    };
    format!("{middle:.0e}").parse().unwrap_or(middle)
}

/// Numbers with which to try whether a key applies.
fn candidates(key: &Key, limits: [f64; 2]) -> Vec<f64> {
    let mut candidates = Vec::new();
    if let Some(Value::Number(usual)) = usual_value(key) {
        candidates.push(usual);
    }
    for [low, high] in key.typical.into_iter().chain([limits]) {
        candidates.extend([low, high, f64::midpoint(low, high)]);
    }
    candidates
}

/// The valid number nearest to `limit`, from a valid one on, by bisection. Each condition of a scenario bounds a number
/// on one side, so that the valid numbers have no gaps.
fn last_valid(start: f64, limit: f64, kind: Kind, is_valid: impl Fn(f64) -> bool) -> f64 {
    if is_valid(limit) {
        return limit;
    }
    let (mut valid, mut invalid) = (rank(start, kind), rank(limit, kind));
    while valid.abs_diff(invalid) > 1 {
        let middle = i64::midpoint(valid, invalid);
        if is_valid(number_of_rank(middle, kind)) {
            valid = middle;
        } else {
            invalid = middle;
        }
    }
    number_of_rank(valid, kind)
}

/// The place of a number among the numbers that a key may have: neighbours differ by 1.
fn rank(number: f64, kind: Kind) -> i64 {
    if kind == Kind::Nanoseconds {
        return nanoseconds(number).map_or(0, |count| count as i64);
    }
    // The bit patterns of positive doubles are in the order of the numbers.
    let size = number.abs().to_bits() as i64;
    if number.is_sign_negative() {
        -size
    } else {
        size
    }
}

/// The number of a rank.
fn number_of_rank(rank: i64, kind: Kind) -> f64 {
    if kind == Kind::Nanoseconds {
        return rank as f64 / 1e9;
    }
    let size = f64::from_bits(rank.unsigned_abs());
    if rank < 0 { -size } else { size }
}
