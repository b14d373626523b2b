//! Measured signals.

use super::error::{DataError, Place};
use super::spec::{SigmaSpec, SignalSpec, SpecFlaw};
use super::unit::Dimension;
use crate::telemetry::fields::{NumberField, state};
use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

/// A measured quantity: values of a field at times.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// The measured field of the simulation.
    pub field: NumberField,
    /// Name of the column or topic.
    pub name: String,
    /// Index of the file.
    pub file: usize,
    /// Times on the clock of the file, s, ascending.
    pub times: Vec<f64>,
    /// Values in SI units. Angles are measured up to whole turns.
    pub values: Vec<f64>,
    /// Standard deviation of each value.
    pub sigmas: Vec<f64>,
    /// Whether the standard deviation was not given, but has to be estimated.
    pub is_sigma_estimated: bool,
    /// Rows without a value.
    pub missing: u64,
    /// Rows earlier than the row before them.
    pub out_of_order: u64,
    /// The lines of the values; `None` for recordings and arrays.
    pub lines: Option<Lines>,
}

/// Lines of a text file, or rows of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lines {
    /// The file.
    pub path: PathBuf,
    /// The line of each value, from 1.
    pub numbers: Vec<u64>,
}

/// A value of a signal.
#[derive(Clone, Copy, Debug)]
pub(super) struct SignalRow {
    pub time: f64,
    pub value: f64,
    /// The standard deviation, if the row has it.
    pub sigma: Option<f64>,
    /// The line in the file, from 1; 0 where there are no lines.
    pub line: u64,
}

impl Signal {
    /// Values of a field in SI units, all with one standard deviation. `None` stands for an unknown one, which is
    /// estimated. NaN is a missing value.
    ///
    /// # Errors
    /// [`DataError`] if the standard deviation is not positive, or a value is infinite.
    pub fn from_values(
        field: NumberField,
        times: &[f64],
        values: &[f64],
        sigma: Option<f64>,
    ) -> Result<Self, DataError> {
        let name = field.to_string();
        let sigma = match sigma {
            Some(sigma) if sigma > 0.0 && sigma.is_finite() => {
                SigmaSpec::Number(sigma, String::new())
            }
            Some(sigma) => return Err(SpecFlaw::Sigma(sigma.to_string()).in_signal(&name)),
            None => SigmaSpec::Estimate,
        };
        let mut rows = Vec::new();
        let mut missing = 0;
        for (at, (time, value)) in times.iter().zip(values).enumerate() {
            if time.is_infinite() || value.is_infinite() {
                let problem = format!("value {} is infinite", at + 1);
                return Err(DataError::new(problem).in_column(&name));
            }
            if time.is_nan() || value.is_nan() {
                missing += 1;
                continue;
            }
            rows.push(SignalRow {
                time: *time,
                value: *value,
                sigma: None,
                line: 0,
            });
        }
        let out_of_order = sort(&mut rows, |row| row.time);
        let spec = SignalSpec::new(field, &name, sigma);
        Ok(Self {
            missing,
            out_of_order,
            ..Self::new(&spec, 0, &rows)?
        })
    }

    /// Makes a signal of rows in SI units that are sorted by time.
    pub(super) fn new(
        spec: &SignalSpec,
        file: usize,
        rows: &[SignalRow],
    ) -> Result<Self, DataError> {
        let values: Vec<f64> = rows.iter().map(|row| row.value).collect();
        let given = match &spec.sigma {
            SigmaSpec::Number(number, unit) => {
                let unit = Dimension::from_si(spec.field.unit())
                    .unit(unit)
                    .map_err(|error| error.in_column(&spec.source))?;
                Some(number * unit.map_or(1.0, |unit| unit.factor))
            }
            SigmaSpec::Estimate | SigmaSpec::Column(_) => None,
        };
        // An estimated deviation starts at the noise of the values, so that windows have a sensible χ².
        let fallback = given.unwrap_or_else(|| noise(&values, is_turning(spec.field)));
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
            is_sigma_estimated: spec.sigma == SigmaSpec::Estimate,
            missing: 0,
            out_of_order: 0,
            lines: None,
        })
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

    /// Whether values of another signal are between those of this one.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let ends = |signal: &Self| Some([*signal.times.first()?, *signal.times.last()?]);
        match (ends(self), ends(other)) {
            (Some([first, last]), Some([start, end])) => start <= last && first <= end,
            (Some(_) | None, _) => true,
        }
    }

    /// Adds a signal of the same field that does not overlap with this one.
    pub(crate) fn join(&mut self, other: Self) {
        let is_later = other.times.first() > self.times.first();
        let at = if is_later { self.times.len() } else { 0 };
        self.times.splice(at..at, other.times);
        self.values.splice(at..at, other.values);
        self.sigmas.splice(at..at, other.sigmas);
        self.missing += other.missing;
        self.out_of_order += other.out_of_order;
        // A place has one file.
        self.lines = None;
        if self.is_sigma_estimated {
            self.set_sigma(self.scatter());
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

    /// The noise of the values, from the scatter between neighbours.
    pub(crate) fn scatter(&self) -> f64 {
        noise(&self.values, self.is_turning())
    }

    /// Median time between values, s; `None` for fewer than two.
    pub(crate) fn period(&self) -> Option<f64> {
        let steps: Vec<f64> = self
            .times
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        // The median is that of the usual step, also with gaps.
        Some(median_size(&steps)).filter(|step| *step > 0.0)
    }

    /// The smallest standard deviation that the arithmetic allows: the error of the simulation, relative to the size of
    /// the values.
    pub(crate) fn rounding(&self) -> f64 {
        const RELATIVE_ERROR: f64 = 1e-10;
        let largest = self.values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        RELATIVE_ERROR * largest.max(f64::MIN_POSITIVE / RELATIVE_ERROR)
    }
}

/// Sorts rows by time; rows of the same time keep their order. Returns the number of rows that were earlier than the one
/// before them.
pub(super) fn sort<R>(rows: &mut [R], time: impl Fn(&R) -> f64) -> u64 {
    let is_early = |pair: &&[R]| time(&pair[1]) < time(&pair[0]);
    let out_of_order = rows.windows(2).filter(is_early).count() as u64;
    rows.sort_by(|a, b| time(a).total_cmp(&time(b)));
    out_of_order
}

/// Whether a field is an angle that turns without limit.
fn is_turning(field: NumberField) -> bool {
    [state::PHI, state::PSI].contains(&field)
}

/// A first estimate of the noise of a smooth signal: from third differences, in which a smooth motion nearly vanishes.
/// Angles go on to the nearest turn.
fn noise(values: &[f64], is_turning: bool) -> f64 {
    /// Standard deviation of (1, −3, 3, −1) · noise is √20 σ; the median of |x| is 0.6745 σ.
    const MEDIAN_PER_SIGMA: f64 = 0.6745 * 4.47213595499958;
    /// Standard deviation of the error of rounding, in units of the last digit.
    const ROUNDING: f64 = 0.288675134594813;
    let mut values = values.to_vec();
    for at in 1..values.len() {
        let step = values[at] - values[at - 1];
        if is_turning && step.abs() > PI {
            values[at] -= (step / TAU).round() * TAU;
        }
    }
    let differences: Vec<f64> = values
        .windows(4)
        .map(|v| v[3] - 3.0 * v[2] + 3.0 * v[1] - v[0])
        .collect();
    let mut estimate = median_size(&differences) / MEDIAN_PER_SIGMA;
    if estimate == 0.0 {
        // Rounded values may not differ at all.
        estimate = ROUNDING * resolution(&values);
    }
    let largest = values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    estimate.max(1e-6 * largest).max(f64::MIN_POSITIVE)
}

/// The smallest difference between values; 0 if they have only a few, which are states rather than rounded numbers.
fn resolution(values: &[f64]) -> f64 {
    const FEWEST: usize = 8;
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut smallest = f64::INFINITY;
    let mut distinct = 1;
    for pair in sorted.windows(2) {
        // Equal values after a conversion of units differ by rounding.
        let is_equal = (pair[1] - pair[0]) <= 1e-12 * pair[1].abs();
        if !is_equal {
            distinct += 1;
            smallest = smallest.min(pair[1] - pair[0]);
        }
    }
    if distinct >= FEWEST { smallest } else { 0.0 }
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
    fn noise_of_angles_ignores_turns() {
        let angles: Vec<f64> = (0..400)
            .map(|at| 0.3 * f64::from(at) + 1e-3 * f64::from(at * 7919 % 101 - 50) / 29.0)
            .collect();
        let wrapped: Vec<f64> = angles.iter().map(|angle| angle % TAU).collect();
        let [plain, wrapped] = [&angles, &wrapped].map(|values| noise(values, true));
        assert!((0.5e-3..4e-3).contains(&plain), "{plain}");
        assert!((wrapped / plain - 1.0).abs() < 1e-6, "{wrapped}");
    }

    #[test]
    fn noise_of_rounded_values_is_that_of_rounding() {
        let values: Vec<f64> = (0..400).map(|at| f64::from(at / 50)).collect();
        assert!((noise(&values, false) - 0.2887).abs() < 1e-3);
    }
}
