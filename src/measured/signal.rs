//! Measured signals, and their descriptions on the command line.

use super::column::{plain, without_data_set};
use super::error::DataError;
use super::place::Place;
use super::unit::{Dimension, split_number};
use crate::run::suggestion::{did_you_mean, similar_names};
use crate::telemetry::Topic;
use crate::telemetry::fields::{
    ACCELERATION, CENTER_OF_MASS, FREE_PEG, NumberField, POSE, STATE, pose, state,
};
use crate::words::{Piece, sentence};
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A measured quantity: values of a field at times.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// The measured field of the simulation.
    pub field: NumberField,
    /// Name of the column or topic.
    pub name: String,
    /// Index of the file. Each file has a clock.
    pub file: usize,
    /// Times on the clock of the file, s, ascending.
    pub times: Vec<f64>,
    /// Values in SI units.
    pub values: Vec<f64>,
    /// Standard deviation of each value.
    pub sigmas: Vec<f64>,
    /// Whether the standard deviation was not given, but has to be estimated.
    pub is_sigma_estimated: bool,
    /// The standard deviation as it was given.
    pub(crate) sigma: SigmaSpec,
    /// Whether the unit of the values was given, and not only taken for the SI unit.
    pub(crate) is_unit_known: bool,
    /// The column of times; `None` for recordings and arrays.
    pub(crate) clock: Option<Clock>,
    /// Rows without a value.
    pub missing: u64,
    /// Rows earlier than the row before them.
    pub out_of_order: u64,
    /// The lines of the values; `None` for recordings and arrays.
    pub lines: Option<Lines>,
}

/// A column of times.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Clock {
    pub name: String,
    /// Whether the unit of the times was given, and they were not only taken for seconds.
    pub is_unit_known: bool,
    /// Columns that are named like times, too.
    pub others: Vec<String>,
}

/// Lines of a text file, or rows of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lines {
    /// The file.
    pub path: PathBuf,
    /// The line of each value, from 1.
    pub numbers: Vec<u64>,
}

/// The signals that were found in a file.
pub(super) struct FileSignals {
    pub signals: Vec<Signal>,
    /// Names of all columns, or topics.
    pub known: Vec<String>,
}

/// Standard deviation of a signal, as given by the user.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SigmaSpec {
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
            field: find_field(field)?,
            source: source.to_owned(),
            whole: match &sigma {
                SigmaSpec::Estimate => None,
                SigmaSpec::Number(..) | SigmaSpec::Column(_) => text
                    .split_once('=')
                    .map(|(_, column)| unquoted(column).to_owned()),
            },
            sigma,
        })
    }

    /// The description if the colon belongs to the name of the column.
    pub(super) fn unsplit(&self) -> Option<Self> {
        let whole = self.whole.as_ref()?;
        Some(Self {
            field: self.field,
            source: whole.clone(),
            sigma: SigmaSpec::Estimate,
            whole: None,
        })
    }

    /// The description as it is parsed.
    pub(super) fn description(&self) -> String {
        describe(self.field, &self.source, &self.sigma)
    }

    /// Whether a signal is the one that is described.
    pub(super) fn describes(&self, signal: &Signal) -> bool {
        signal.field == self.field
            && (signal.name == self.source || self.whole.as_ref() == Some(&signal.name))
    }

    /// A column that is named like a field.
    pub(super) fn from_column(header: &str) -> Option<Self> {
        Self::from_name(header, plain(header))
    }

    /// A column that is named like a field, also within a data set.
    pub(super) fn from_data_set(header: &str) -> Option<Self> {
        Self::from_name(header, without_data_set(plain(header)))
    }

    fn from_name(header: &str, name: &str) -> Option<Self> {
        Some(Self {
            field: field_named(name)?,
            source: header.to_owned(),
            sigma: SigmaSpec::Estimate,
            whole: None,
        })
    }
}

/// The description of a signal, which is parsed to what it was made of.
fn describe(field: NumberField, source: &str, sigma: &SigmaSpec) -> String {
    let name = match find_field(field.path()) {
        Ok(found) if found == field => field.path().to_owned(),
        // Fields of several topics have this path.
        Ok(_) | Err(_) => field.to_string(),
    };
    match sigma {
        SigmaSpec::Estimate => format!("{name}={source}"),
        SigmaSpec::Number(number, unit) => format!("{name}={source}:{number}{unit}"),
        SigmaSpec::Column(column) => format!("{name}={source}:{column}"),
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
        None => Ok((rest, SigmaSpec::Column(sigma.trim_matches('"').to_owned()))),
    }
}

/// Names that columns have for fields, in lower case.
#[rustfmt::skip]
const NAMES: &[(&str, NumberField)] = &[
    ("theta", state::THETA), ("θ", state::THETA), ("tilt", state::THETA), ("inclination", state::THETA), ("nutation", state::THETA),
    ("phi", state::PHI), ("φ", state::PHI), ("ϕ", state::PHI), ("azimuth", state::PHI), ("precession", state::PHI),
    ("psi", state::PSI), ("ψ", state::PSI), ("spin angle", state::PSI),
    ("theta_dot", state::THETA_DOT), ("θ̇", state::THETA_DOT), ("dtheta/dt", state::THETA_DOT),
    ("phi_dot", state::PHI_DOT), ("φ̇", state::PHI_DOT), ("dphi/dt", state::PHI_DOT),
    ("psi_dot", state::PSI_DOT), ("ψ̇", state::PSI_DOT), ("dpsi/dt", state::PSI_DOT),
    ("omega_n", pose::OMEGA_BODY.z()), ("ω_n", pose::OMEGA_BODY.z()), ("axial rate", pose::OMEGA_BODY.z()),
    ("gyroscope z", pose::OMEGA_BODY.z()), ("gyro z", pose::OMEGA_BODY.z()), ("gyro_z", pose::OMEGA_BODY.z()), ("wz", pose::OMEGA_BODY.z()),
];

/// The field that a column of this name measures, if the name is one of those in use.
pub(super) fn field_named(name: &str) -> Option<NumberField> {
    let name = name.trim().to_lowercase();
    let named = NAMES.iter().find(|(known, _)| *known == name);
    named.map(|(_, field)| *field)
}

/// The field with this name: `theta`, `/top/pose.omega_body.z` or one of [`NAMES`].
fn find_field(name: &str) -> Result<NumberField, SpecFlaw> {
    let known = field_named(name);
    let lower = name.to_lowercase();
    let mut fields = measurable();
    let exact = fields.find(|field| field.to_string() == lower || field.path() == lower);
    known.or(exact).ok_or_else(|| unknown_field(name))
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

/// A row of a table: time, value, and standard deviation if there is a column for it.
#[derive(Clone, Copy, Debug)]
pub(super) struct SignalRow {
    pub time: f64,
    pub value: f64,
    pub sigma: Option<f64>,
    /// The line in the file, from 1; 0 where there are no lines.
    pub line: u64,
}

impl Signal {
    /// Values of a field in SI units, all with one standard deviation. `None` stands for an unknown one, which is
    /// estimated.
    ///
    /// # Errors
    /// [`DataError`] if the standard deviation is not positive.
    pub fn from_values(
        field: NumberField,
        times: &[f64],
        values: &[f64],
        sigma: Option<f64>,
    ) -> Result<Self, DataError> {
        let spec = SignalSpec {
            field,
            source: field.to_string(),
            sigma: match sigma {
                Some(sigma) if sigma > 0.0 && sigma.is_finite() => {
                    SigmaSpec::Number(sigma, String::new())
                }
                Some(sigma) => {
                    let flaw = SpecFlaw::Sigma(sigma.to_string());
                    return Err(flaw.in_signal(&field.to_string()));
                }
                None => SigmaSpec::Estimate,
            },
            whole: None,
        };
        let mut rows = Vec::new();
        let mut missing = 0;
        for (time, value) in times.iter().zip(values) {
            if time.is_finite() && value.is_finite() {
                rows.push(SignalRow {
                    time: *time,
                    value: *value,
                    sigma: None,
                    line: 0,
                });
            } else {
                missing += 1;
            }
        }
        Self::new(&spec, 0, rows, missing, None)
    }

    /// Makes a signal from rows that are known to be in SI units: sorts them by time and unwraps angles. `path` is that of a file with lines.
    pub(super) fn new(
        spec: &SignalSpec,
        file: usize,
        mut rows: Vec<SignalRow>,
        missing: u64,
        path: Option<&Path>,
    ) -> Result<Self, DataError> {
        let out_of_order = rows
            .windows(2)
            .filter(|pair| pair[1].time < pair[0].time)
            .count() as u64;
        // Stable: rows of the same time keep their order.
        rows.sort_by(|a, b| a.time.total_cmp(&b.time));
        let mut values: Vec<f64> = rows.iter().map(|row| row.value).collect();
        if is_turning(spec.field) {
            unwrap(&mut values);
        }
        let given = match &spec.sigma {
            SigmaSpec::Number(number, unit) => {
                let dimension = Dimension::from_si(spec.field.unit());
                Some(number * dimension.factor(unit, &spec.source)?)
            }
            SigmaSpec::Estimate | SigmaSpec::Column(_) => None,
        };
        let is_sigma_estimated = spec.sigma == SigmaSpec::Estimate;
        // An estimated deviation starts at the noise of the values, so that windows have a sensible χ².
        let fallback = given.unwrap_or_else(|| noise(&values));
        Ok(Self {
            field: spec.field,
            name: spec.source.clone(),
            file,
            sigmas: rows
                .iter()
                .map(|row| row.sigma.unwrap_or(fallback))
                .collect(),
            times: rows.iter().map(|row| row.time).collect(),
            values,
            is_sigma_estimated,
            sigma: spec.sigma.clone(),
            is_unit_known: true,
            clock: None,
            missing,
            out_of_order,
            lines: path.map(|path| Lines {
                path: path.to_owned(),
                numbers: rows.iter().map(|row| row.line).collect(),
            }),
        })
    }

    /// The description with which the signal is read again, from a column of this name.
    pub(crate) fn description(&self, name: &str) -> String {
        describe(self.field, name, &self.sigma)
    }

    /// The line of a value; `None` where there are no lines.
    pub(crate) fn place(&self, at: usize) -> Option<Place> {
        let lines = self.lines.as_ref()?;
        Some(Place {
            path: Some(lines.path.clone()),
            line: Some(*lines.numbers.get(at)?),
            column: None,
        })
    }

    /// The place of a value in its file, or its field.
    pub(crate) fn value_place(&self, at: usize) -> String {
        match self.place(at) {
            Some(place) => Place {
                column: Some(self.name.clone()),
                ..place
            }
            .to_string(),
            None => self.field.to_string(),
        }
    }

    /// Sets one standard deviation for all values.
    pub(crate) fn set_sigma(&mut self, sigma: f64) {
        self.sigmas.fill(sigma);
    }

    /// Whether it is an angle that may turn.
    pub(crate) fn is_turning(&self) -> bool {
        is_turning(self.field)
    }

    /// Moves an angle by whole turns, so that its first value is nearest to `start`.
    pub(crate) fn turn_towards(&mut self, start: f64) {
        if let Some(first) = self.values.first().copied()
            && is_turning(self.field)
        {
            let turns = ((first - start) / TAU).round();
            for value in &mut self.values {
                *value -= turns * TAU;
            }
        }
    }

    /// Median time between values, s; `None` for fewer than two.
    pub(crate) fn period(&self) -> Option<f64> {
        let mut steps: Vec<f64> = self
            .times
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        // The median is that of the usual step, also with gaps.
        steps.sort_by(f64::total_cmp);
        steps
            .get(steps.len() / 2)
            .copied()
            .filter(|step| *step > 0.0)
    }

    /// The smallest standard deviation that the arithmetic allows: the error of the simulation, relative to the size of
    /// the values.
    pub(crate) fn rounding(&self) -> f64 {
        const RELATIVE_ERROR: f64 = 1e-10;
        let largest = self.values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        RELATIVE_ERROR * largest.max(f64::MIN_POSITIVE / RELATIVE_ERROR)
    }
}

/// Whether a field is an angle that turns without limit.
pub(crate) fn is_turning(field: NumberField) -> bool {
    [state::PHI, state::PSI].contains(&field)
}

/// Removes jumps of an angle that was measured within one turn. Values that span more than a turn are continuous
/// already.
pub(crate) fn unwrap(values: &mut [f64]) {
    /// A turn, with room for noise.
    const TURN: f64 = 1.05 * TAU;
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if high - low > TURN {
        return;
    }
    for at in 1..values.len() {
        let step = values[at] - values[at - 1];
        if step.abs() > PI {
            values[at] -= (step / TAU).round() * TAU;
        }
    }
}

/// A first estimate of the noise of a smooth signal: from third differences, in which a smooth motion nearly vanishes.
fn noise(values: &[f64]) -> f64 {
    /// Standard deviation of (1, −3, 3, −1) · noise is √20 σ; the median of |x| is 0.6745 σ.
    const MEDIAN_PER_SIGMA: f64 = 0.6745 * 4.47213595499958;
    let thirds: Vec<f64> = values
        .windows(4)
        .map(|v| v[3] - 3.0 * v[2] + 3.0 * v[1] - v[0])
        .collect();
    let estimate = median_size(&thirds) / MEDIAN_PER_SIGMA;
    let largest = values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    // Rounded values may not differ at all.
    estimate.max(1e-6 * largest).max(f64::MIN_POSITIVE)
}

/// Median of the absolute values; 0 for no values.
pub(crate) fn median_size(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.get(sizes.len() / 2).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn unwraps_angles_within_a_turn_only() {
        let mut wrapped = [3.0, -3.2, -3.0, 3.1];
        unwrap(&mut wrapped);
        for (found, expected) in wrapped.iter().zip([3.0, TAU - 3.2, TAU - 3.0, 3.1]) {
            assert!((found - expected).abs() < 1e-12, "{wrapped:?}");
        }
        let mut continuous = [0.0, 5.6, 11.2];
        unwrap(&mut continuous);
        assert_eq!(continuous, [0.0, 5.6, 11.2]);
    }
}
