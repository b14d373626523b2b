//! Descriptions of signals on the command line.

use super::error::DataError;
use super::name::field_named;
use super::unit::split_number;
use crate::run::suggestion::{did_you_mean, similar_names};
use crate::telemetry::Topic;
use crate::telemetry::fields::{ACCELERATION, CENTER_OF_MASS, FREE_PEG, NumberField, POSE, STATE};
use crate::words::{Piece, sentence};
use thiserror::Error;

/// Standard deviation of a signal, as given by the user.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SigmaSpec {
    /// Not given.
    Estimate,
    /// A number with a unit, which may be empty.
    Number(f64, String),
    /// In a column.
    Column(String),
}

/// The description of a signal: `[FIELD=]SOURCE[:SIGMA]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalSpec {
    /// The field that is measured.
    pub field: NumberField,
    /// Name of the column, or topic and path.
    pub source: String,
    pub(super) sigma: SigmaSpec,
    /// Column of the signal if the colon belongs to its name: `Latest: Angle (rad)`.
    whole: Option<String>,
}

/// Why the description of a signal can't be used.
#[derive(Clone, Debug, PartialEq, Error)]
pub(super) enum SpecFlaw {
    #[error("unknown field {name}{}", match similar[..] {
        [] => format!("; fields: {known}"),
        _ => did_you_mean(similar),
    })]
    UnknownField {
        name: String,
        /// Similar ones: with their topics if the name has one, or else their paths.
        similar: Vec<String>,
        /// The fields that can be measured.
        known: String,
    },
    /// The standard deviation is not positive.
    #[error("the standard deviation {0} is not a positive number")]
    Sigma(String),
    #[error("a name is empty")]
    Empty,
}

impl SpecFlaw {
    /// The error of a description.
    pub(super) fn in_signal(&self, text: &str) -> DataError {
        DataError::new(format!("{text}: {self}")).with_remedy(sentence!(
            "describe signals as in {}",
            Piece::argument_with("signal", "theta=tilt (deg):2mrad")
        ))
    }
}

impl SignalSpec {
    /// Parses `theta="tilt (deg)":2mrad`, `theta:2mrad` or `/top/state.theta`.
    ///
    /// # Errors
    /// [`DataError`] for an unknown field or a standard deviation that is not positive.
    pub fn parse(text: &str) -> Result<Self, DataError> {
        Self::parse_parts(text).map_err(|flaw| flaw.in_signal(text))
    }

    fn parse_parts(text: &str) -> Result<Self, SpecFlaw> {
        let (rest, sigma) = split_sigma(text)?;
        // A name alone is both that of the field and that of the column.
        let (field, column) = rest.split_once('=').unwrap_or((rest, rest));
        let (field, source) = (field.trim(), unquoted(column));
        if field.is_empty() || source.is_empty() {
            return Err(SpecFlaw::Empty);
        }
        Ok(Self {
            whole: match &sigma {
                SigmaSpec::Estimate => None,
                SigmaSpec::Number(..) | SigmaSpec::Column(_) => text
                    .split_once('=')
                    .map(|(_, column)| unquoted(column).to_owned()),
            },
            ..Self::new(find_field(field)?, source, sigma)
        })
    }

    /// A field that is in a column, or at a topic and path, with this name.
    pub(super) fn new(field: NumberField, source: &str, sigma: SigmaSpec) -> Self {
        Self {
            field,
            source: source.to_owned(),
            sigma,
            whole: None,
        }
    }

    /// The description for which a name is known. A colon may belong to the name of a column, and is tried as a part of it
    /// first.
    pub(super) fn resolved(&self, is_known: impl Fn(&str) -> bool) -> Option<Self> {
        if let Some(whole) = self.whole.as_ref().filter(|whole| is_known(whole)) {
            return Some(Self::new(self.field, whole, SigmaSpec::Estimate));
        }
        is_known(&self.source).then(|| self.clone())
    }

    /// Whether a signal with this field and name is the one that is described.
    pub(super) fn describes(&self, field: NumberField, name: &str) -> bool {
        let is_named = name == self.source || self.whole.as_deref() == Some(name);
        field == self.field && is_named
    }
}

/// A name without spaces and quotes around it.
fn unquoted(name: &str) -> &str {
    name.trim().trim_matches('"')
}

/// Splits the standard deviation off. A colon within a name stays.
fn split_sigma(text: &str) -> Result<(&str, SigmaSpec), SpecFlaw> {
    let Some((rest, sigma)) = text.rsplit_once(':') else {
        return Ok((text, SigmaSpec::Estimate));
    };
    match split_number(sigma) {
        Some((number, _)) if number.is_nan() || number <= 0.0 || number.is_infinite() => {
            Err(SpecFlaw::Sigma(sigma.to_owned()))
        }
        Some((number, unit)) => Ok((rest, SigmaSpec::Number(number, unit.to_owned()))),
        None if sigma.is_empty() => Err(SpecFlaw::Sigma(sigma.to_owned())),
        None => Ok((rest, SigmaSpec::Column(unquoted(sigma).to_owned()))),
    }
}

/// The field with this name: `theta`, `/top/pose.omega_body.z`, or a name that columns have.
fn find_field(name: &str) -> Result<NumberField, SpecFlaw> {
    let lower = name.to_lowercase();
    let mut fields = measurable();
    field_named(name)
        .or_else(|| fields.find(|field| field.to_string() == lower || field.path() == lower))
        .ok_or_else(|| unknown_field(name))
}

fn unknown_field(name: &str) -> SpecFlaw {
    let (mut full, mut paths) = (Vec::new(), Vec::new());
    for field in measurable() {
        full.push(field.to_string());
        paths.push(field.path().to_owned());
    }
    let compared = if name.starts_with('/') { &full } else { &paths };
    let similar = similar_names(name, compared.iter().map(String::as_str));
    SpecFlaw::UnknownField {
        name: name.to_owned(),
        similar: similar.into_iter().map(str::to_owned).collect(),
        known: full.join(", "),
    }
}

/// The fields that can be measured: motion and position. They don't depend on the running integrals, which fits skip.
fn measurable() -> impl Iterator<Item = NumberField> {
    [STATE, POSE, ACCELERATION, FREE_PEG, CENTER_OF_MASS]
        .into_iter()
        .flat_map(Topic::numbers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::fields::{pose, state};

    #[test]
    fn parses_descriptions_of_signals() {
        let spec = SignalSpec::parse("theta=\"tilt (deg)\":2mrad").unwrap();
        assert_eq!(spec.field, state::THETA);
        assert_eq!(spec.source, "tilt (deg)");
        assert_eq!(spec.sigma, SigmaSpec::Number(2.0, "mrad".to_owned()));
        let spec = SignalSpec::parse("/top/pose.omega_body.z:0.05").unwrap();
        assert_eq!(spec.field, pose::OMEGA_BODY.z());
        assert_eq!(spec.source, "/top/pose.omega_body.z");
        let spec = SignalSpec::parse("phi=azimuth:sd").unwrap();
        assert_eq!(spec.sigma, SigmaSpec::Column("sd".to_owned()));
        for (text, reason) in [
            (
                "theta:0",
                "the standard deviation 0 is not a positive number",
            ),
            (
                "theta:-1mrad",
                "the standard deviation -1mrad is not a positive number",
            ),
            ("theta:", "is not a positive number"),
            ("thet", "unknown field thet (did you mean theta?)"),
            (
                "/top/state.thet",
                "unknown field /top/state.thet (did you mean /top/state.theta?)",
            ),
            ("=x", "a name is empty"),
        ] {
            let error = SignalSpec::parse(text).unwrap_err().to_string();
            assert!(error.contains(reason), "{text}: {error}");
        }
    }
}
