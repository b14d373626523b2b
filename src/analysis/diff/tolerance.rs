//! Options of a comparison, and tolerances for comparing numbers.

use super::error::{DiffError, ToleranceProblem};
use schemars::JsonSchema;
use serde::Serialize;

/// Absolute and relative tolerance; satisfying either is sufficient. The default requires bit equality.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Tolerance {
    /// Absolute tolerance, in the unit of the field.
    pub abs: f64,
    /// Relative tolerance, relative to the larger magnitude.
    pub rel: f64,
}

impl Tolerance {
    /// Whether two numbers are equal within the tolerance. Two NaNs are equal.
    pub fn allows(&self, a: f64, b: f64) -> bool {
        if a == b || (a.is_nan() && b.is_nan()) {
            return true;
        }
        // An infinite magnitude would allow everything.
        if !(a.is_finite() && b.is_finite()) {
            return false;
        }
        let difference = (b - a).abs();
        difference <= self.abs || difference <= self.rel * a.abs().max(b.abs())
    }
}

/// A general tolerance, and tolerances of some of the fields.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tolerances {
    /// For fields that no pattern matches.
    pub general: Tolerance,
    /// Patterns of fields with their tolerances; the last match applies.
    pub fields: Vec<(String, Tolerance)>,
    /// Patterns of topics and fields that are ignored.
    pub ignored: Vec<String>,
}

impl Tolerances {
    /// Adds the tolerance of a pattern as on the command line: `PATTERN=1e-9`, or `PATTERN=abs:1e-9,rel:1e-6`.
    ///
    /// # Errors
    /// [`DiffError`] if the text is invalid.
    pub fn add(&mut self, text: &str) -> Result<(), DiffError> {
        let (pattern, bounds) = text
            .rsplit_once('=')
            .filter(|(pattern, _)| !pattern.is_empty())
            .ok_or_else(|| malformed(text, ToleranceProblem::NoPattern))?;
        let mut tolerance = Tolerance::default();
        for bound in bounds.split(',') {
            let (kind, value) = bound.split_once(':').unwrap_or(("abs", bound));
            match (kind.trim(), value.trim().parse::<f64>()) {
                ("abs", Ok(number)) => tolerance.abs = number,
                ("rel", Ok(number)) => tolerance.rel = number,
                _ => {
                    return Err(malformed(text, ToleranceProblem::Bounds));
                }
            }
        }
        self.fields.push((pattern.to_owned(), tolerance));
        self.check()
    }

    /// Checks that all tolerances are finite and not negative.
    ///
    /// # Errors
    /// [`DiffError`] naming the first that isn't.
    pub fn check(&self) -> Result<(), DiffError> {
        let general = ("the general tolerance", &self.general);
        let fields = self
            .fields
            .iter()
            .map(|(name, bound)| (name.as_str(), bound));
        for (name, bound) in std::iter::once(general).chain(fields) {
            for (kind, value) in [("abs", bound.abs), ("rel", bound.rel)] {
                if !(value >= 0.0 && value.is_finite()) {
                    let text = format!("{name}: {kind} = {value}");
                    return Err(malformed(&text, ToleranceProblem::OutOfRange));
                }
            }
        }
        Ok(())
    }

    /// The tolerance of a field.
    pub fn for_field(&self, topic: &str, field: &str) -> Tolerance {
        let name = full_name(topic, field);
        self.fields
            .iter()
            .rev()
            .find(|(pattern, _)| matches(pattern, &name))
            .map_or(self.general, |(_, tolerance)| *tolerance)
    }

    /// Whether a topic or field is ignored.
    pub fn ignores(&self, name: &str) -> bool {
        self.ignored.iter().any(|pattern| matches(pattern, name))
    }

    /// Whether any tolerance is set.
    pub(super) fn are_set(&self) -> bool {
        self.general != Tolerance::default() || !self.fields.is_empty()
    }

    /// Checks that each tolerance matches a field, and each ignored pattern a field or one of the other topics.
    ///
    /// # Errors
    /// [`DiffError`] with the first pattern that doesn't, and similar names.
    pub(super) fn check_names(
        &self,
        fields: &[String],
        other_topics: &[String],
    ) -> Result<(), DiffError> {
        for (pattern, _) in &self.fields {
            check_name(pattern, fields)?;
        }
        let names = [fields, other_topics].concat();
        for pattern in &self.ignored {
            check_name(pattern, &names)?;
        }
        Ok(())
    }
}

fn malformed(text: &str, problem: ToleranceProblem) -> DiffError {
    DiffError::Tolerance {
        text: text.to_owned(),
        problem,
    }
}

fn check_name(pattern: &str, names: &[String]) -> Result<(), DiffError> {
    /// Maximum number of similar names in the message.
    const MAX_SIMILAR: usize = 3;
    if names.iter().any(|name| matches(pattern, name)) {
        return Ok(());
    }
    let mut similar = names.to_vec();
    similar.sort();
    similar.dedup();
    similar.sort_by(|x, y| {
        strsim::jaro_winkler(pattern, y).total_cmp(&strsim::jaro_winkler(pattern, x))
    });
    similar.truncate(MAX_SIMILAR);
    Err(DiffError::NoField {
        pattern: pattern.to_owned(),
        similar,
    })
}

/// The name of a field with its topic, as in `/top/state.theta`, which patterns are matched with.
pub fn full_name(topic: &str, field: &str) -> String {
    format!("{topic}.{field}")
}

/// Whether a pattern matches a field, its topic or its parent object; `*` matches any characters.
fn matches(pattern: &str, name: &str) -> bool {
    let mut parts = pattern.split('*');
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = name.strip_prefix(first) else {
        return false;
    };
    let mut is_open = false;
    for part in parts {
        let Some(at) = rest.find(part) else {
            return false;
        };
        rest = &rest[at + part.len()..];
        is_open = true;
    }
    if is_open {
        // The text after the last `*` must match the end of the name.
        let last = pattern.rsplit('*').next().unwrap_or_default();
        return name.ends_with(last);
    }
    // `/top/state` matches its fields, but not `/top/state_estimate`.
    rest.is_empty() || rest.starts_with('.')
}

/// Options of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The differences that count as equal.
    pub tolerances: Tolerances,
    /// Whether to estimate integration errors by repeating the simulations with tighter tolerances.
    pub integration_error: bool,
    /// The topics to compare; all common topics if empty.
    pub topics: Vec<String>,
}

impl Options {
    /// Whether tolerances, topics or ignored fields limit what counts as a difference.
    pub(super) fn are_limited(&self) -> bool {
        let tolerances = &self.tolerances;
        tolerances.are_set() || !tolerances.ignored.is_empty() || !self.topics.is_empty()
    }
}

impl Default for Options {
    /// All topics, bit for bit, with integration errors.
    fn default() -> Self {
        Self {
            tolerances: Tolerances::default(),
            integration_error: true,
            topics: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_fields_objects_and_topics() {
        let field = "/top/torque.friction_body.x";
        for pattern in [
            field,
            "/top/torque",
            "/top/torque.friction_body",
            "*",
            "/top/*",
            "*.x",
            "/top/*.friction_*.x",
            "*friction*",
        ] {
            assert!(matches(pattern, field), "{pattern}");
        }
        for pattern in [
            "/top/tor",
            "/top/torque.friction",
            "*.y",
            "/top/*.friction_*.y",
            "theta",
            "",
        ] {
            assert!(!matches(pattern, field), "{pattern}");
        }
    }

    #[test]
    fn last_matching_pattern_applies() {
        let mut tolerances = Tolerances::default();
        tolerances.add("*=1").unwrap();
        tolerances.add("/a.x=rel:0.5").unwrap();
        assert_eq!(tolerances.for_field("/a", "y").abs, 1.0);
        let x = tolerances.for_field("/a", "x");
        assert_eq!((x.abs, x.rel), (0.0, 0.5));
    }

    #[test]
    fn rejects_malformed_tolerances() {
        for text in [
            "theta",
            "=1",
            "a=",
            "a=x",
            "a=-1",
            "a=inf",
            "a=abs:1,ulp:4",
            "a=foo:1",
        ] {
            let error = Tolerances::default().add(text).unwrap_err().to_string();
            assert!(
                error.contains(text.split('=').next().unwrap()),
                "{text}: {error}"
            );
        }
    }

    #[test]
    fn each_bound_suffices() {
        let exact = Tolerance::default();
        assert!(
            exact.allows(1.0, 1.0) && exact.allows(f64::NAN, f64::NAN) && exact.allows(0.0, -0.0)
        );
        assert!(!exact.allows(1.0, 1.0_f64.next_up()) && !exact.allows(1.0, f64::NAN));
        let rel = Tolerance { rel: 0.1, ..exact };
        assert!(rel.allows(-9.5, -10.0) && !rel.allows(8.9, 10.0));
        assert!(!rel.allows(1.0, f64::INFINITY) && !rel.allows(f64::NEG_INFINITY, f64::INFINITY));
        assert!(rel.allows(f64::INFINITY, f64::INFINITY));
        let abs = Tolerance { abs: 0.5, ..exact };
        assert!(abs.allows(0.0, 0.5) && !abs.allows(0.0, 0.6) && !abs.allows(0.0, f64::INFINITY));
    }
}
