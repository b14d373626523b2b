//! Values that can't be what they are taken for.

use super::model::Problem;
use crate::fit::error::{FitError, time};
use crate::measured::{FileReading, Signal, median_size};
use crate::telemetry::fields::state;
use crate::words::{Piece, Sentence, sentence};
use std::f64::consts::{PI, TAU};

/// The least number of values that are judged.
const FEWEST: usize = 10;

/// Refuses inclinations beyond 0 to π, steps of time above a second, data shorter than a nutation, and angles that turn by
/// more than once between two values: their unit is not what it was taken for.
pub(in crate::fit) fn check_ranges(
    problem: &Problem,
    signals: &[Signal],
    files: &[FileReading],
) -> Result<(), FitError> {
    for signal in signals {
        let file = &files[signal.file];
        if signal.field == state::THETA {
            check_inclination(signal, file)?;
        }
        if signal.is_turning() && file.assumes_unit_of(&signal.name) {
            check_turns(signal)?;
        }
        let clock = file.time().filter(|clock| clock.is_unit_assumed);
        if let Some(clock) = clock.filter(|_| signal.times.len() >= FEWEST) {
            check_times(problem, signal, &clock.column, &file.file)?;
        }
    }
    Ok(())
}

/// Refuses an inclination most of whose values are negative or above π. A few may be outliers, and noise.
fn check_inclination(signal: &Signal, file: &FileReading) -> Result<(), FitError> {
    /// Noise and errors of calibration of a top that is upright or hangs stay well within this, rad.
    const ROOM: f64 = 0.2;
    let mut sorted = signal.values.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    if (-ROOM..PI + ROOM).contains(&median) {
        return Ok(());
    }
    let remedy = if file.assumes_unit_of(&signal.name) && median > 0.0 {
        written(&signal.name, "deg", "degrees")
    } else {
        "is it an angle seen from the side, whose size is the inclination?".into()
    };
    Err(FitError::refused(sentence!(
        "{}: most values are {} (median {}), but an inclination is from 0 to π; {}",
        signal.value_place(0),
        if median < 0.0 { "negative" } else { "above π" },
        Piece::rounded(median, 4, "rad"),
        remedy
    )))
}

/// Refuses angles that turn more than once between two values.
fn check_turns(signal: &Signal) -> Result<(), FitError> {
    let step = median_step(&signal.values);
    if step <= TAU {
        return Ok(());
    }
    Err(FitError::refused(sentence!(
        "{}: read as rad, it turns by {} between two values; {}",
        signal.value_place(0),
        Piece::rounded(step, 3, "rad"),
        written(&signal.name, "deg", "degrees")
    )))
}

fn check_times(
    problem: &Problem,
    signal: &Signal,
    clock: &str,
    file: &str,
) -> Result<(), FitError> {
    /// Sensors and cameras take more than one value in a second, and tops nutate faster.
    const MAX_STEP: f64 = 1.0;
    let step = median_step(&signal.times);
    let [first, last] = [0, signal.times.len() - 1].map(|at| signal.times[at]);
    let nutation = problem.nutation_period();
    let remedy = if step >= MAX_STEP {
        sentence!(
            "{}; divide frame numbers by the frame rate",
            declared(clock)
        )
    } else if last - first < nutation {
        sentence!(
            "a nutation of this top takes {}; multiply days by 86400",
            time(nutation)
        )
    } else {
        return Ok(());
    };
    Err(FitError::refused(sentence!(
        "{}: column {} has no unit, and read as s, the data span {} with a value every {}; {}",
        file.to_owned(),
        clock.to_owned(),
        Piece::rounded(last - first, 3, "s"),
        Piece::rounded(step, 3, "s"),
        remedy
    )))
}

/// How the unit of the times is declared.
fn declared(clock: &str) -> Sentence {
    let [ms, us, s] =
        ["ms", "us", "s"].map(|unit| Piece::argument_with("time", format!("{clock} ({unit})")));
    sentence!("declare the unit: {}, {} or {}", ms, us, s)
}

/// How the unit of a signal is stated.
fn written(name: &str, unit: &'static str, units: &'static str) -> Sentence {
    sentence!(
        "if it is in {}, write {} into the header, or after the name in {}",
        units,
        format!("{name} ({unit})"),
        Piece::argument("signal")
    )
}

/// Median of the sizes of steps.
fn median_step(values: &[f64]) -> f64 {
    let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    median_size(&steps)
}
