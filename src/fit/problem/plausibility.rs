//! Signals that can't be what they are taken for: values in another unit, and values without noise.

use super::model::{Point, Problem};
use crate::fit::error::{FitError, time};
use crate::fit::statistics::rms;
use crate::measured::median_size;
use crate::measured::{Dimension, Signal, is_turning, split_header, unwrap};
use crate::telemetry::fields::state;
use crate::words::{Piece, Sentence, sentence};
use std::f64::consts::PI;

/// The least number of values from which a standard deviation is judged.
pub(in crate::fit) const FEWEST: usize = 10;

/// Refuses inclinations that are too large for radians, and signals without noise whose standard deviation is to be
/// estimated from it.
pub(in crate::fit) fn check_signals(problem: &Problem) -> Result<(), FitError> {
    for (index, signal) in problem.signals.iter().enumerate() {
        let mut values = Vec::new();
        for point in problem.points.iter().filter(|point| point.signal == index) {
            values.push(point.value);
        }
        check_inclination(problem, index, &values)?;
        if signal.is_sigma_estimated && values.len() >= FEWEST && is_constant(&values) {
            return Err(FitError::refused(no_noise(problem, index, values[0])));
        }
    }
    Ok(())
}

/// Whether all values are equal.
pub(in crate::fit) fn is_constant(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[0] == pair[1])
}

/// Refuses an inclination without a unit most of whose values are above π. A few may be outliers.
fn check_inclination(problem: &Problem, index: usize, values: &[f64]) -> Result<(), FitError> {
    /// Noise and errors of calibration of a top that hangs (θ = π) stay well below this; degrees are 57 times larger.
    const MAX_MEDIAN: f64 = 1.2 * PI;
    let median = median_size(values);
    let signal = &problem.signals[index];
    if signal.field == state::THETA && !signal.is_unit_known && median > MAX_MEDIAN {
        return Err(FitError::refused(sentence!(
            "most values of {} are above π (median {}), but an inclination in rad is not; {}",
            split_header(&signal.name).0.to_owned(),
            Piece::fixed(median, 4, ""),
            state_unit(problem, index, "deg", "rad")
        )));
    }
    Ok(())
}

/// Refuses times without a unit whose steps are too long for a top: they are frame numbers, or in milliseconds or less.
/// Simulations of such times would take hours.
pub(in crate::fit) fn check_steps(problem: &Problem) -> Result<(), FitError> {
    /// Time between values, s. Sensors and cameras take more than one in a second, and tops nutate faster.
    const MAX_STEP: f64 = 1.0;
    for signal in unitless(&problem.signals) {
        let times = times_of_file(problem, signal.file);
        if times.len() >= FEWEST && median_step(&times) >= MAX_STEP {
            return Err(likely_time_unit(signal, &times));
        }
    }
    Ok(())
}

/// Refuses times without a unit that span too long for a top.
pub(in crate::fit) fn check_span(problem: &Problem) -> Result<(), FitError> {
    /// Tops spin for minutes, s. More than a second of milliseconds would be longer.
    const MAX_DURATION: f64 = 1000.0;
    // The scenario starts with the first file, before or at its first value. Others may have been recorded for long.
    for signal in unitless(&problem.signals).filter(|signal| signal.file == 0) {
        let times = times_of_file(problem, 0);
        if times.last().is_some_and(|last| *last > MAX_DURATION) {
            return Err(likely_time_unit(signal, &times));
        }
    }
    Ok(())
}

/// The signals whose times have no unit.
fn unitless(signals: &[Signal]) -> impl Iterator<Item = &Signal> {
    signals.iter().filter(|signal| {
        let clock = signal.clock.as_ref();
        clock.is_some_and(|clock| !clock.is_unit_known)
    })
}

/// The times of a file, ascending. Its signals share its rows, but not each has a value in all of them.
fn times_of_file(problem: &Problem, file: usize) -> Vec<f64> {
    let mut times = Vec::new();
    for point in &problem.points {
        if problem.signals[point.signal].file == file {
            times.push(point.time);
        }
    }
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// The error of times without a unit that are too long or too rare in seconds.
fn likely_time_unit(signal: &Signal, times: &[f64]) -> FitError {
    let clock = signal.clock.as_ref().map_or("", |clock| &clock.name);
    let name = split_header(clock).0;
    let duration = match times {
        [first, .., last] => last - first,
        [_] | [] => 0.0,
    };
    let may_be_frames = signal.times.iter().all(|time| time.fract() == 0.0);
    let (frames, divide) = if may_be_frames {
        let divide = "; divide frame numbers by the frame rate";
        (duration_of_frames(duration), divide)
    } else {
        (Sentence::default(), "")
    };
    let path = match &signal.lines {
        Some(lines) => format!("{}: ", lines.path.display()),
        None => String::new(),
    };
    let [ms, us, s] =
        ["ms", "us", "s"].map(|unit| Piece::argument_with("time", format!("{name} ({unit})")));
    FitError::refused(sentence!(
        "{}the times in column {} have no unit: in s they span {} with a value every {}, in ms {}{}; write the unit into the header, or after the name: {}, {} or {}{}",
        path,
        name.to_owned(),
        time(duration),
        time(median_step(times)),
        time(duration / 1e3),
        frames,
        ms,
        us,
        s,
        divide
    ))
}

/// How long data last whose times are frame numbers.
fn duration_of_frames(frames: f64) -> Sentence {
    /// Frames per second of usual cameras.
    const FRAME_RATE: f64 = 30.0;
    sentence!(
        "; if they are frame numbers, at {} frames per second they span {}",
        FRAME_RATE.to_string(),
        Piece::rounded(frames / FRAME_RATE, 3, "s")
    )
}

/// How to state the unit of a signal: the likely one, or the SI unit.
fn state_unit(problem: &Problem, index: usize, unit: &str, si: &str) -> Sentence {
    let signal = &problem.signals[index];
    let name = split_header(&signal.name).0;
    let [likely, other] = [unit, si].map(|unit| {
        let description = signal.description(&format!("{name} ({unit})"));
        with_others(problem, index, description)
    });
    // Messages have no header.
    let place = match signal.clock {
        Some(_) => "into the header, or after the name",
        None => "after the name",
    };
    sentence!(
        "write the unit {}: {}; if they are in {}, {}",
        place,
        likely,
        si.to_owned(),
        other
    )
}

/// The argument that describes a signal anew. Signals that are named replace all that were found, so it names the others
/// as they are.
fn with_others(problem: &Problem, index: usize, description: String) -> Piece {
    let signal = &problem.signals[index];
    let mut others: Vec<String> = Vec::new();
    for other in &problem.signals {
        let text = other.description(&other.name);
        // A name stands for the columns of all files.
        let is_same = other.field == signal.field && other.name == signal.name;
        if !is_same && !others.contains(&text) {
            others.push(text);
        }
    }
    Piece::argument_with_all("signal", description, others)
}

/// What is wrong with a signal all values of which are equal.
fn no_noise(problem: &Problem, index: usize, value: f64) -> Sentence {
    let signal = &problem.signals[index];
    let (field, name) = (signal.field.to_string(), &signal.name);
    let with_sigma = format!("{field}={name}:SIGMA");
    sentence!(
        "{}: all values are {}: they have no noise from which a standard deviation could be estimated; check the sensor, leave {} out, or give σ: {}",
        Piece::field(field),
        Piece::rounded(value, 6, signal.field.unit()),
        name,
        with_others(problem, index, with_sigma)
    )
}

/// Median of the steps between ascending times; 0 for fewer than two.
fn median_step(times: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or_default()
}

/// Refuses signals without a unit that differ by a factor from the motion at the start, but agree with it in another usual unit.
pub(in crate::fit) fn check_units(
    problem: &Problem,
    points: &[Point],
    predicted: &[f64],
) -> Result<(), FitError> {
    for (index, signal) in problem.signals.iter().enumerate() {
        if signal.is_unit_known {
            continue;
        }
        let mut values = Vec::new();
        let mut motion = Vec::new();
        for (point, value) in points.iter().zip(predicted) {
            if point.signal == index {
                values.push(point.value);
                motion.push(*value);
            }
        }
        let dimension = Dimension::from_si(signal.field.unit());
        for (unit, factor) in dimension.mistakable() {
            if is_in_unit(&values, &motion, *factor, is_turning(signal.field)) {
                let field = signal.field;
                return Err(FitError::refused(sentence!(
                    "{}: the values are about {} times those of the motion at the start; in {} they would agree with it; {}",
                    Piece::field(field.to_string()),
                    Piece::fixed(rms(&values) / rms(&motion), 0, ""),
                    *unit,
                    state_unit(problem, index, unit, field.unit())
                )));
            }
        }
    }
    Ok(())
}

/// Whether values are far from a motion, but near it when they are multiplied by a unit's size. Angles that turn may be
/// measured within one turn of that unit, and from any zero.
fn is_in_unit(values: &[f64], motion: &[f64], factor: f64, is_turning: bool) -> bool {
    /// Difference from the motion, in parts of its size, above which values are far from it. Those in rpm are 9.5 times
    /// too large, those in degrees 57 times.
    const FAR: f64 = 5.0;
    /// Difference below which they are near. A start that is right to 30 % is closer to the motion than the wrong unit.
    const NEAR: f64 = 0.3;
    let mut as_read = values.to_vec();
    let mut in_unit: Vec<f64> = values.iter().map(|value| factor * value).collect();
    let mut motion = motion.to_vec();
    if is_turning {
        unwrap(&mut in_unit);
        for angles in [&mut as_read, &mut in_unit, &mut motion] {
            subtract_mean(angles);
        }
    }
    let size = rms(&motion);
    distance(&as_read, &motion) > FAR * size && distance(&in_unit, &motion) < NEAR * size
}

fn subtract_mean(values: &mut [f64]) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    for value in values {
        *value -= mean;
    }
}

/// Root mean square of the difference between values and a motion.
fn distance(values: &[f64], motion: &[f64]) -> f64 {
    let mut differences = Vec::new();
    for (value, expected) in values.iter().zip(motion) {
        differences.push(value - expected);
    }
    rms(&differences)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::problem::model::Loss;
    use crate::measured::Clock;
    use crate::run::scenario::Preset;
    use std::f64::consts::TAU;

    #[test]
    fn refuses_times_that_cannot_be_seconds() {
        let scenario = Preset::find("full-coulomb").unwrap().scenario().unwrap();
        for (name, file, count, step, is_unitless, expected) in [
            (
                "frames",
                0,
                501,
                1.0,
                true,
                Some("at 30 frames per second they span 16.7 s"),
            ),
            (
                "every other frame",
                0,
                51,
                2.0,
                true,
                Some("in s they span 100 s with a value every 2 s, in ms 0.1 s"),
            ),
            (
                "milliseconds",
                0,
                501,
                10.0,
                true,
                Some("in s they span 5000 s with a value every 10 s, in ms 5 s"),
            ),
            (
                "long",
                0,
                2003,
                0.5,
                true,
                Some("in s they span 1001 s with a value every 0.5 s"),
            ),
            (
                "frames of the second file",
                1,
                501,
                1.0,
                true,
                Some("divide frame numbers by the frame rate"),
            ),
            (
                "a second file that began long before",
                1,
                2003,
                0.5,
                true,
                None,
            ),
            ("seconds", 0, 501, 0.01, true, None),
            ("few", 0, 9, 1.0, true, None),
            ("stated", 0, 501, 1.0, false, None),
        ] {
            let times: Vec<f64> = (0..count).map(|at| step * f64::from(at)).collect();
            let values = vec![0.5; times.len()];
            let signal = Signal::from_values(state::THETA, &times, &values, Some(1e-3)).unwrap();
            let signal = Signal {
                file,
                clock: Some(Clock {
                    name: "t".to_owned(),
                    is_unit_known: !is_unitless,
                    others: Vec::new(),
                }),
                ..signal
            };
            let problem =
                Problem::new(&scenario, Vec::new(), vec![signal], Loss::Squares, 0.0).unwrap();
            let checked = check_steps(&problem).and_then(|()| check_span(&problem));
            let error = checked.err();
            let error = error.map(|error| error.to_string());
            match (&error, expected) {
                (None, None) => {}
                (Some(message), Some(part)) => {
                    assert!(message.contains(part), "{name}: {message}");
                    assert!(message.contains(" or time = t (s)"), "{name}: {message}");
                }
                (Some(_) | None, Some(_) | None) => panic!("{name}: {error:?}"),
            }
        }
    }

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
            assert_eq!(
                is_in_unit(&values, &motion, degrees, false),
                expected,
                "{name}"
            );
        }
        // No motion with which anything could be compared.
        for is_turning in [false, true] {
            assert!(!is_in_unit(&[30.0; 4], &[0.0; 4], degrees, is_turning));
            assert!(!is_in_unit(&[], &[], degrees, is_turning));
        }
    }

    #[test]
    fn recognises_wrapped_angles_in_degrees() {
        let motion: Vec<f64> = (0..200).map(|at| 0.05 * f64::from(at)).collect();
        for (name, zero) in [("the same zero", 0.0), ("another zero", 2.0)] {
            let wrapped: Vec<f64> = motion
                .iter()
                .map(|angle| ((angle + zero + PI).rem_euclid(TAU) - PI).to_degrees())
                .collect();
            assert!(is_in_unit(&wrapped, &motion, PI / 180.0, true), "{name}");
        }
    }
}
