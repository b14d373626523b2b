//! The error of a scenario.

use super::key::{Key, Kind, short_number};
use crate::physics::formula::{FormulaError, InvalidCoefficient};
use crate::run::suggestion::did_you_mean;
use std::fmt;
use thiserror::Error;

/// Maximum length of a value quoted in an error, characters.
const MAX_EXCERPT_LENGTH: usize = 100;

/// Error of an invalid scenario: the key, its value and the problem.
#[derive(Clone, Debug, PartialEq, Error)]
pub struct ScenarioError {
    /// The key to change, as given. `None` if the scenario as a whole can't be read, or never stops.
    pub key: Option<String>,
    /// The value of the key in `--set` notation, truncated if it is long. `None` if the value is not the problem.
    pub value: Option<String>,
    /// The problem; boxed, because results with this error are returned everywhere.
    pub problem: Box<Problem>,
}

/// Error in a scenario, or in the value of a key.
#[derive(Clone, Debug, PartialEq)]
pub enum Problem {
    /// The text is not TOML.
    Syntax(String),
    /// There is no such preset.
    UnknownPreset {
        /// The requested name.
        name: String,
        /// Similar names.
        similar: Vec<&'static str>,
        /// All presets.
        presets: Vec<&'static str>,
    },
    /// There is no such key.
    UnknownKey {
        /// Similar keys.
        similar: Vec<&'static str>,
        /// The keys of the same section, or all.
        allowed: Vec<&'static str>,
    },
    /// The key can never have the value.
    NotAllowed {
        /// Allowed values.
        allowed: Kind,
        /// Unit; may be empty.
        unit: &'static str,
        /// The value that was probably meant.
        hint: Option<Hint>,
    },
    /// The key is set twice under different spellings.
    SetTwice,
    /// Required keys are not set.
    Missing {
        /// The missing keys, in table order.
        keys: Vec<&'static Key>,
        /// Typical values of the parameters of the friction law that they belong to.
        typical: Option<&'static str>,
    },
    /// The key applies only if another key has one of these values.
    Inapplicable {
        /// The other key.
        other: &'static str,
        /// The value of the other key.
        current: Option<String>,
        /// Values with which the key applies.
        needed: Vec<&'static str>,
    },
    /// The formula doesn't contain the name of the key.
    NotInFormula,
    /// The text is no formula.
    Formula {
        /// The problem and its place.
        error: FormulaError,
        /// Names similar to an unknown one.
        similar: Vec<&'static str>,
    },
    /// The formula has no coefficient of friction at a speed that the top may have.
    Coefficient(InvalidCoefficient),
    /// The coefficient of static friction is less than that of the formula at rest, or the formula has none.
    StaticFriction {
        /// The coefficient of the formula at rest.
        at_rest: f64,
    },
    /// The key requires values of other keys.
    Requires {
        /// The required values.
        requirements: Vec<Requirement>,
        /// The reason, unless the requirements speak for themselves.
        reason: Option<&'static str>,
    },
    /// The key and another one exclude each other.
    Excludes(&'static str),
    /// The centre of mass of a top with a fixed peg is not above the peg.
    NotAboveFixedPeg,
    /// The centre of mass of a tippe top is not inside its sphere, or is the peg's centre.
    OutsideSphere,
    /// The transverse moment is less than that of a point mass at the centre of mass.
    TooSmallMoment {
        /// `M l²`, kg m².
        offset: f64,
    },
    /// The axial moment is larger than that of a rigid body with this transverse moment.
    TooLargeMoment {
        /// Largest possible axial moment, kg m².
        limit: f64,
        /// Whether the limit follows from the transverse moment about the centre of mass.
        is_central: bool,
    },
    /// The Euler angles are singular at the start.
    SingularStart,
    /// A stop angle is already passed at the start.
    AlreadyPassed {
        /// Initial inclination, rad.
        theta: f64,
    },
    /// A tippe top has no stop angles.
    TippeTop,
    /// The friction law includes the torque of the key.
    AlreadyIncluded,
    /// The contact point never sticks with this friction.
    NeverSticks,
    /// No condition is certain to stop the run.
    Endless,
    /// More samples than can be numbered.
    TooManySamples {
        /// Duration of the run, s.
        duration: f64,
    },
}

/// The most keys that are listed beside similar ones.
const MAX_LISTED: usize = 16;

/// A value of another key that a key requires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Requirement {
    /// The key has this value.
    Word(&'static str, &'static str),
    /// The key is set to any value.
    Set(&'static str),
}

/// Probable meaning of a value that is not allowed.
#[derive(Clone, Debug, PartialEq)]
pub enum Hint {
    /// Similar words.
    Similar(Vec<&'static str>),
    /// A number written with a decimal comma: the number with a point.
    DecimalPoint(String),
    /// An angle in degrees.
    Degrees {
        /// The angle as given.
        text: String,
        /// The angle, rad.
        radians: f64,
    },
}

impl Problem {
    /// A value that the key can never have.
    pub(super) fn not_allowed(key: &Key, hint: Option<Hint>) -> Self {
        Self::NotAllowed {
            allowed: key.kind,
            unit: key.unit,
            hint,
        }
    }
}

impl Hint {
    /// Similar words, if there are any.
    pub(super) fn similar(words: Vec<&'static str>) -> Option<Self> {
        (!words.is_empty()).then_some(Self::Similar(words))
    }
}

impl ScenarioError {
    /// Problem of the scenario as a whole.
    pub(super) fn without_key(problem: Problem) -> Self {
        Self {
            key: None,
            value: None,
            problem: Box::new(problem),
        }
    }

    /// Problem of a key, whatever its value.
    pub(super) fn with_key(key: &str, problem: Problem) -> Self {
        Self {
            // A key may come from a file of any content.
            key: Some(excerpt(key)),
            ..Self::without_key(problem)
        }
    }

    /// Problem of the value of a key.
    pub(super) fn with_value(key: &str, value: &str, problem: Problem) -> Self {
        Self {
            value: Some(excerpt(value)),
            ..Self::with_key(key, problem)
        }
    }

    /// The error of a key that is set twice.
    pub fn set_twice(key: &Key) -> Self {
        Self::with_key(key.path, Problem::SetTwice)
    }

    /// The key to change; empty if there is none.
    fn path(&self) -> &str {
        self.key.as_deref().unwrap_or_default()
    }
}

/// A text truncated for a message.
pub(super) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(MAX_EXCERPT_LENGTH) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let (Some(key), Some(value)) = (&self.key, &self.value) {
            write!(f, "{key} = {value}: ")?;
        }
        let key = self.path();
        match &*self.problem {
            Problem::Syntax(message) => write!(f, "not valid TOML: {message}"),
            Problem::UnknownPreset {
                name,
                similar,
                presets,
            } => {
                write!(f, "unknown preset {name:?}{}", did_you_mean(similar))?;
                // The nearest names are enough: all of them are a long line.
                if similar.is_empty() {
                    write!(f, "; presets: {}", presets.join(", "))?;
                }
                write!(f, ". For a scenario file, give the path, e.g. ./{name}.toml")
            }
            Problem::UnknownKey { similar, allowed } => {
                write!(f, "unknown key {key}{}", did_you_mean(similar))?;
                // A group of keys is short; all keys say less than the nearest names.
                if similar.is_empty() || allowed.len() <= MAX_LISTED {
                    write!(f, "; allowed: {}", allowed.join(", "))?;
                }
                Ok(())
            }
            Problem::NotAllowed {
                allowed,
                unit,
                hint,
            } => write_not_allowed(f, *allowed, unit, hint.as_ref()),
            Problem::SetTwice => write!(f, "{key}: set twice, remove one"),
            Problem::Missing { keys, typical } => write_missing(f, keys, *typical),
            Problem::Inapplicable {
                other,
                current,
                needed,
            } => write_inapplicable(f, key, other, current.as_deref(), needed),
            Problem::NotInFormula => write!(
                f,
                "{key} is not in friction.formula: use {} there, or remove {key} (--set {key}=)",
                key.rsplit('.').next().unwrap_or(key)
            ),
            Problem::Formula { error, similar } => {
                write!(f, "{error}{}\n{}", did_you_mean(similar), error.excerpt())
            }
            Problem::Coefficient(error) => write!(f, "μ(v) {}", error.fault()),
            Problem::StaticFriction { at_rest } => write_static_friction(f, *at_rest),
            Problem::Requires {
                requirements,
                reason,
            } => write_requirements(f, requirements, *reason),
            Problem::Excludes(other) => write!(
                f,
                "conflicts with {other}: set the position of either the peg or the centre of mass"
            ),
            Problem::TooSmallMoment { offset } => write!(
                f,
                "must be more than {} kg m² = top.mass · top.center_distance² (parallel axis theorem)",
                short_number(*offset)
            ),
            Problem::TooLargeMoment { limit, is_central } => {
                write_too_large_moment(f, *limit, *is_central)
            }
            Problem::AlreadyPassed { theta } => write!(
                f,
                "the start, initial.theta = {}, is already beyond it",
                short_number(*theta)
            ),
            Problem::TooManySamples { duration } => write!(
                f,
                "must be larger: at most {} samples fit in stop.duration = {} s",
                u32::MAX,
                short_number(*duration)
            ),
            Problem::NotAboveFixedPeg => f.write_str(
                "must be a finite number > 0 (for a tippe top, which has a negative value, set support.kind = \"free\")",
            ),
            Problem::OutsideSphere => f.write_str(
                "must be > −top.peg_radius and not 0 (the centre of mass of a tippe top is inside its sphere)",
            ),
            Problem::SingularStart => f.write_str(
                "must be strictly between 0 and π with formulation = \"euler\"; \
                 use formulation = \"body\" for a vertical axis",
            ),
            Problem::TippeTop => f.write_str(
                "not applicable to a tippe top (top.center_distance < 0); use stop.duration",
            ),
            Problem::AlreadyIncluded => {
                f.write_str("friction.law = \"contensou\" already includes a drilling torque")
            }
            Problem::NeverSticks => f.write_str(
                "this friction law never sticks; use friction.law = \"coulomb\", \"stribeck\", \
                 \"contensou\", a formula with μ(0) > 0, or rolling.arm, with friction.dissipation = \"full\"",
            ),
            Problem::Endless => f.write_str(
                "the run would never stop: set stop.duration, stop.theta_risen or stop.theta_fallen (without friction: stop.duration)",
            ),
        }
    }
}

fn write_inapplicable(
    f: &mut fmt::Formatter<'_>,
    key: &str,
    other: &str,
    current: Option<&str>,
    needed: &[&str],
) -> fmt::Result {
    match current {
        Some(value) => write!(f, "{key} does not apply with {other} = {value:?}")?,
        None => write!(f, "{key} does not apply without {other}")?,
    }
    let needed = needed.join(" or ");
    write!(
        f,
        ": set {other} = {needed}, or remove {key} (--set {key}=)"
    )
}

fn write_static_friction(f: &mut fmt::Formatter<'_>, at_rest: f64) -> fmt::Result {
    if at_rest == 0.0 {
        return f.write_str(
            "friction.formula is 0 at v = 0, so there is no static friction: remove it (--set friction.static_k=)",
        );
    }
    let at_rest = short_number(at_rest);
    write!(
        f,
        "must be at least the value of friction.formula at v = 0, which is {at_rest}"
    )
}

fn write_not_allowed(
    f: &mut fmt::Formatter<'_>,
    allowed: Kind,
    unit: &str,
    hint: Option<&Hint>,
) -> fmt::Result {
    write!(f, "must be {allowed}")?;
    if !unit.is_empty() {
        write!(f, " [{unit}]")?;
    }
    match hint {
        None => Ok(()),
        Some(Hint::Similar(words)) => f.write_str(&did_you_mean(words)),
        Some(Hint::DecimalPoint(number)) => write!(f, ", with a decimal point, e.g. {number}"),
        Some(Hint::Degrees { text, radians }) => write!(f, " ({text} is {radians:.4} rad)"),
    }
}

fn write_too_large_moment(f: &mut fmt::Formatter<'_>, limit: f64, is_central: bool) -> fmt::Result {
    let formula = if is_central {
        "2 · (top.transverse_moment − top.mass · top.center_distance²), twice the transverse moment about the centre of mass"
    } else {
        "2 · top.transverse_moment"
    };
    let limit = short_number(limit);
    write!(
        f,
        "must be at most {limit} kg m² = {formula} (limit for a rigid body)"
    )
}

fn write_missing(f: &mut fmt::Formatter<'_>, keys: &[&Key], typical: Option<&str>) -> fmt::Result {
    f.write_str("missing: ")?;
    for (index, key) in keys.iter().enumerate() {
        let comma = if index == 0 { "" } else { ", " };
        let (path, meaning, unit, kind) = (key.path, key.meaning, key.in_unit(), key.kind);
        write!(f, "{comma}{path} ({meaning}{unit}: {kind})")?;
    }
    match typical {
        Some(typical) => write!(f, "; typical values: {typical}"),
        None => Ok(()),
    }
}

fn write_requirements(
    f: &mut fmt::Formatter<'_>,
    requirements: &[Requirement],
    reason: Option<&str>,
) -> fmt::Result {
    f.write_str("requires ")?;
    for (index, requirement) in requirements.iter().enumerate() {
        let comma = if index == 0 { "" } else { ", " };
        match requirement {
            Requirement::Word(key, word) => write!(f, "{comma}{key} = \"{word}\"")?,
            Requirement::Set(key) => write!(f, "{comma}{key}")?,
        }
    }
    match reason {
        Some(reason) => write!(f, ", because {reason}"),
        None => Ok(()),
    }
}
