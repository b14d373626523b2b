//! Errors of formulas.

use std::fmt;
use std::ops::Range;
use thiserror::Error;

/// A coefficient of friction that no contact can have.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("μ(v) = {formula} {}", self.fault())]
pub struct InvalidCoefficient {
    /// The formula.
    pub formula: String,
    /// The slip speed, m/s.
    pub speed: f64,
    /// The coefficient at that speed.
    pub value: f64,
}

impl InvalidCoefficient {
    /// What is wrong, without the formula.
    pub fn fault(&self) -> String {
        let Self { speed, value, .. } = self;
        format!(
            "is {value} at v = {speed} m/s, but must be finite and not negative where the top slips"
        )
    }
}

/// The most characters of the formula that an error shows.
const MAX_SHOWN: usize = 70;

/// A text that is no formula: the problem and its place.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub struct FormulaError {
    /// What is wrong.
    pub problem: FormulaProblem,
    /// The part of the text around the place, on one line.
    shown: String,
    /// The characters of that part that are wrong.
    marked: Range<usize>,
}

/// Problem of a formula.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FormulaProblem {
    /// The text is longer than formulas may be, bytes.
    TooLong(usize),
    /// Parentheses or signs are nested deeper than they may be.
    TooDeep(usize),
    /// There is no such name.
    UnknownName(String),
    /// A character that formulas don't have.
    UnexpectedCharacter(char),
    /// A number that isn't one, or too large.
    NotANumber,
    /// An operand is missing: a number, a name or a parenthesis.
    NoOperand,
    /// An operator is missing: `2 v` is written `2*v`.
    NoOperator,
    /// A function without arguments, of this name.
    NoArguments(&'static str),
    /// This is missing, e.g. a closing parenthesis.
    Missing(&'static str),
    /// Speeds of points that don't increase, or points that are no finite numbers.
    UnorderedPoints,
    /// Points that depend on the slip speed.
    PointsDepend,
}

impl FormulaError {
    /// The problem of some bytes of a text.
    pub(super) fn new(text: &str, place: Range<usize>, problem: FormulaProblem) -> Self {
        let before = text[..place.start].chars().count();
        let length = text[place.start..place.end]
            .chars()
            .count()
            .clamp(1, MAX_SHOWN / 2);
        // Long texts are cut on both sides of the place.
        let skipped = (before + length).saturating_sub(MAX_SHOWN);
        let mut shown = String::new();
        for character in text.chars().skip(skipped).take(MAX_SHOWN) {
            // The mark stands below its place, which needs one line of visible characters.
            shown.push(if character.is_control() {
                ' '
            } else {
                character
            });
        }
        let start = before - skipped;
        Self {
            problem,
            shown,
            marked: start..start + length,
        }
    }
}

impl fmt::Display for FormulaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.problem)
    }
}

impl FormulaError {
    /// The formula, and a line with marks below the place.
    pub fn excerpt(&self) -> String {
        let (indent, marks) = (self.marked.start, "^".repeat(self.marked.len()));
        format!("  {}\n  {:indent$}{marks}", self.shown, "")
    }
}

impl fmt::Display for FormulaProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong(limit) => write!(f, "longer than {limit} bytes"),
            Self::TooDeep(limit) => write!(f, "nested more than {limit} deep"),
            Self::UnknownName(name) => write!(f, "unknown name {name}"),
            Self::UnexpectedCharacter('*') => f.write_str("a power is written x^y"),
            Self::UnexpectedCharacter(character) => write!(f, "unexpected {character:?}"),
            Self::NotANumber => f.write_str("not a finite number"),
            Self::NoOperand => f.write_str("expected a number, a name or a parenthesis"),
            Self::NoOperator => f.write_str("expected an operator: a product is written x*y"),
            Self::NoArguments(name) => write!(f, "{name} needs arguments in parentheses"),
            Self::Missing(text) => write!(f, "expected {text}"),
            Self::UnorderedPoints => {
                f.write_str("the points need finite numbers and increasing speeds")
            }
            Self::PointsDepend => f.write_str("a point must not depend on v"),
        }
    }
}
