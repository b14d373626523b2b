//! Signals that can't be what they are taken for: values in another unit, and values without noise.

use super::error::FitError;
use super::model::{Point, Problem};
use super::signal::Signal;
use super::statistics::{median_size, rms};
use super::unit::{Dimension, split_header};
use crate::telemetry::fields::state;
use std::f64::consts::PI;

/// The least number of values from which a standard deviation is judged.
pub(super) const FEWEST: usize = 10;

/// Refuses inclinations that are too large for radians, and signals without noise whose standard deviation is to be
/// estimated from it.
pub(super) fn check_signals(problem: &Problem) -> Result<(), FitError> {
    for (index, signal) in problem.signals.iter().enumerate() {
        let mut values = Vec::new();
        for point in problem.points.iter().filter(|point| point.signal == index) {
            values.push(point.value);
        }
        check_inclination(signal, &values)?;
        if signal.is_sigma_estimated && values.len() >= FEWEST && is_constant(&values) {
            return Err(FitError::NoNoise {
                field: signal.field.to_string(),
                source_name: signal.name.clone(),
                value: values[0],
                unit: signal.field.unit(),
            });
        }
    }
    Ok(())
}

/// Whether all values are equal.
pub(super) fn is_constant(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[0] == pair[1])
}

/// Refuses an inclination most of whose values are above π. A few may be outliers.
fn check_inclination(signal: &Signal, values: &[f64]) -> Result<(), FitError> {
    let median = median_size(values);
    if signal.field == state::THETA && median > PI {
        return Err(FitError::Inclination {
            median,
            name: split_header(&signal.name).0.to_owned(),
        });
    }
    Ok(())
}

/// Refuses signals that differ by a factor from the motion at the start, but agree with it in another usual unit.
pub(super) fn check_units(
    problem: &Problem,
    points: &[Point],
    predicted: &[f64],
) -> Result<(), FitError> {
    for (index, signal) in problem.signals.iter().enumerate() {
        let mut values = Vec::new();
        let mut motion = Vec::new();
        for (point, value) in points.iter().zip(predicted) {
            if point.signal == index {
                values.push(point.value);
                motion.push(*value);
            }
        }
        let size = rms(&motion);
        let dimension = Dimension::from_si(signal.field.unit());
        for (unit, factor) in dimension.mistakable() {
            if is_in_unit(&values, &motion, *factor) {
                return Err(FitError::LikelyUnit {
                    field: signal.field.to_string(),
                    ratio: rms(&values) / size,
                    unit,
                    si: signal.field.unit(),
                    name: split_header(&signal.name).0.to_owned(),
                });
            }
        }
    }
    Ok(())
}

/// Whether values are far from a motion, but near it when they are multiplied by a unit's size.
fn is_in_unit(values: &[f64], motion: &[f64], factor: f64) -> bool {
    /// Difference from the motion, in parts of its size, above which values are far from it. Those in rpm are 9.5 times
    /// too large, those in degrees 57 times.
    const FAR: f64 = 5.0;
    /// Difference below which they are near. A start that is right to 30 % is closer to the motion than the wrong unit.
    const NEAR: f64 = 0.3;
    let size = rms(motion);
    distance(values, motion, 1.0) > FAR * size && distance(values, motion, factor) < NEAR * size
}

/// Root mean square of the difference between values, multiplied by a factor, and a motion.
fn distance(values: &[f64], motion: &[f64], factor: f64) -> f64 {
    let mut differences = Vec::new();
    for (value, expected) in values.iter().zip(motion) {
        differences.push(factor * value - expected);
    }
    rms(&differences)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recognises_units_by_the_motion() {
        let motion = [0.1, 0.4, 0.7, 1.1];
        let degrees = PI / 180.0;
        for (name, scale, expected) in [
            ("degrees", 1.0 / degrees, true),
            ("degrees, start wrong by 20 %", 1.2 / degrees, true),
            ("radians", 1.0, false),
            ("radians, start wrong by a factor of 10", 10.0, false),
            ("another unit", 1000.0, false),
        ] {
            let values = motion.map(|value| value * scale);
            assert_eq!(is_in_unit(&values, &motion, degrees), expected, "{name}");
        }
        // No motion with which anything could be compared.
        assert!(!is_in_unit(&[30.0; 4], &[0.0; 4], degrees));
        assert!(!is_in_unit(&[], &[], degrees));
    }
}
