//! Errors of fits.

use super::data_error::DataError;
use super::degeneracy::{Degeneracy, join_clauses};
use super::parameter::is_offset;
use super::place::{Place, ValuePlace};
use super::step_limit::MAX_RATIO;
use crate::run::scenario::ScenarioError;
use crate::run::simulation::SimulationError;
use crate::words::counted;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Error of a fit.
#[derive(Debug, Error)]
pub enum FitError {
    /// The data can't be read.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A key can't be fitted, or a scenario is invalid.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A key can't be fitted.
    #[error("{name} can't be fitted: {reason}")]
    Key {
        /// The key.
        name: String,
        /// The reason.
        reason: KeyError,
    },
    /// There is no such law.
    #[error("unknown law {name}; laws: {known}")]
    UnknownLaw {
        /// The name that no law has.
        name: String,
        /// The laws.
        known: String,
    },
    /// Bounds exclude the start, or each other.
    #[error("{name}: the bounds {low} to {high} must contain the start, {start}")]
    Bounds {
        /// The parameter.
        name: String,
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
        /// Start value.
        start: f64,
    },
    /// Bounds or a profile are asked for of a parameter that is not free.
    #[error("{name} is not free, so it can't have {what}")]
    NotFree {
        /// The parameter.
        name: String,
        /// What it can't have.
        what: &'static str,
    },
    /// No parameter is free.
    #[error("nothing to fit: none of the free parameters changes any signal")]
    NothingFree,
    /// A signal has no value in the time that is fitted.
    #[error("{field} has no value from t = {} s{}: its times are {} to {} s", short(*origin), until.map_or(String::new(), |until| format!(" to {} s", short(until))), short(*first), short(*last))]
    OutOfRange {
        /// The field.
        field: String,
        /// First time of the signal, s.
        first: f64,
        /// Last time of the signal, s.
        last: f64,
        /// Time at which the scenario starts, s.
        origin: f64,
        /// Time at which the fitted data end, s.
        until: Option<f64>,
    },
    /// The data have a gap that is long compared with all of them.
    #[error(
        "the data have no values from t = {} to {} s, and are only {} s long without this gap; a time may be wrong ({stray} {} {}{})",
        short(*from),
        short(*to),
        short(*rest),
        if *stray == 1 { "row" } else { "rows" },
        cut.side(),
        place.as_ref().map_or_else(String::new, |place| if *stray == 1 { format!(": {place}") } else { format!(", next to it {place}") })
    )]
    Gap {
        /// Last time before the gap, on the clock of the first file, s.
        from: f64,
        /// First time after the gap, s.
        to: f64,
        /// Time of the data without the gap, s.
        rest: f64,
        /// Number of times on the side with fewer of them.
        stray: usize,
        /// The line of that side that is next to the gap.
        place: Option<Place>,
        /// What leaves that side out.
        cut: Cut,
    },
    /// A value is too large for a sum of squares.
    #[error(
        "{place}: the value {value:e} at t = {} s, with the standard deviation {sigma:e}, is too large to be fitted: remove it",
        short(*time)
    )]
    Size {
        /// The value.
        place: ValuePlace,
        /// Time of the value, s.
        time: f64,
        /// The value, SI units.
        value: f64,
        /// Standard deviation of the value.
        sigma: f64,
    },
    /// Inclinations that are too large for radians.
    #[error(
        "most values of {name} are above π (median {median:.4}), but an inclination in rad is not"
    )]
    Inclination {
        /// Median of the values, rad if the unit is right.
        median: f64,
        /// Name of the column without its unit, or topic and path.
        name: String,
    },
    /// Values that agree with the motion at the start in another unit only.
    #[error(
        "{field}: the values are about {ratio:.0} times those of the motion at the start; in {unit} they would agree with it"
    )]
    LikelyUnit {
        /// The field.
        field: String,
        /// Name of the field without its topic.
        path: &'static str,
        /// Size of the values, relative to the motion.
        ratio: f64,
        /// The unit in which they agree.
        unit: &'static str,
        /// The SI unit, in which they were read.
        si: &'static str,
        /// Name of the column without its unit, or topic and path.
        name: String,
    },
    /// Times without a unit that are too long or too rare in seconds.
    #[error("{}", likely_time_unit(path.as_deref(), name, *duration, *step, *may_be_frames))]
    LikelyTimeUnit {
        /// The file.
        path: Option<PathBuf>,
        /// Name of the column of times.
        name: String,
        /// Time from the first to the last value, s.
        duration: f64,
        /// Usual time between values, s.
        step: f64,
        /// Whether all times are whole numbers.
        may_be_frames: bool,
    },
    /// All values of a signal are equal, and no standard deviation is given.
    #[error(
        "{field}: all values are {value} {unit}: they have no noise from which a standard deviation could be estimated"
    )]
    NoNoise {
        /// The field.
        field: String,
        /// Name of the column, or topic and path.
        source_name: String,
        /// The value, SI units.
        value: f64,
        /// Unit; may be empty.
        unit: &'static str,
    },
    /// No motion near the start of a parameter reaches the data.
    #[error("{name}: no motion with a slightly larger or smaller value can be computed")]
    NoDerivative {
        /// The parameter.
        name: String,
    },
    /// A file's samples are too rare, or its times too long, for a comparison with the motion.
    #[error(
        "{name}: at most {most} of the {samples} samples of its file are within the motion (0 to {} s) at once; are the times of both files in the unit that is stated, or else in s?",
        short(*end)
    )]
    FewWithin {
        /// The offset.
        name: String,
        /// Number of samples that some offset brings into the motion.
        most: usize,
        /// Number of samples.
        samples: usize,
        /// End of the motion, s.
        end: f64,
    },
    /// The bounds of an offset exclude all that bring a file into the motion.
    #[error(
        "{name}: no offset from {} to {} s brings its file into the motion (0 to {} s), but those from {} to {} s do: change its bounds",
        short(bounds[0]),
        short(bounds[1]),
        short(*end),
        short(enough[0]),
        short(enough[1])
    )]
    OffsetBounds {
        /// The offset.
        name: String,
        /// Its bounds, s.
        bounds: [f64; 2],
        /// End of the motion, s.
        end: f64,
        /// The lowest and the highest offset that bring enough samples into the motion, s.
        enough: [f64; 2],
    },
    /// All samples are at the start of the motion.
    #[error(
        "{} at t = {time} s, where the scenario starts, can't determine a motion: measure at several times",
        if *samples == 1 { "a single sample".to_owned() } else { counted(*samples as u64, "sample") }
    )]
    OnlyStart {
        /// Number of samples.
        samples: usize,
        /// Time of the start, on the clock of the data, s.
        time: f64,
    },
    /// The data are too few.
    #[error(
        "{} can't determine {}: at least {} are needed",
        counted(*samples as u64, "sample"),
        counted(*parameters as u64, "parameter"),
        parameters + 1
    )]
    TooFew {
        /// Number of samples in the fit.
        samples: usize,
        /// Number of free parameters.
        parameters: usize,
    },
    /// Parameters can't be told apart.
    #[error("{}", join_clauses(degeneracies))]
    NotIdentifiable {
        /// The groups of parameters.
        degeneracies: Vec<Degeneracy>,
    },
    /// The model ends before the data.
    #[error("the model ends at t = {end:.4} s ({reason}), the data at {needed:.4} s")]
    ModelEnds {
        /// End of the model, s.
        end: f64,
        /// Why it ends.
        reason: String,
        /// End of the data, s.
        needed: f64,
    },
    /// A motion takes many times the steps of that at the start.
    #[error(
        "no minimum was found: the motions that come closest to the data take more than {MAX_RATIO} times the integrator steps of that at the start"
    )]
    TooManySteps,
    /// A simulation failed.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The optimiser refused its input.
    #[error("the optimiser failed: {0}")]
    Optimiser(&'static str),
}

impl FitError {
    /// Whether the data were read and can determine the parameters, but no motion was found that follows them to their end.
    pub fn is_of_motion(&self) -> bool {
        matches!(self, Self::ModelEnds { .. } | Self::TooManySteps)
    }

    /// The key of the scenario that is at fault, if it is a single one.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Scenario(error) => error.key.as_deref(),
            // The offset of a clock is a parameter, but no key.
            Self::Key { name, .. }
            | Self::Bounds { name, .. }
            | Self::NotFree { name, .. }
            | Self::NoDerivative { name } => Some(name.as_str()).filter(|name| !is_offset(name)),
            Self::NotIdentifiable { degeneracies } => match &degeneracies[..] {
                [Degeneracy::Unseen { names }] if names.len() == 1 => Some(&names[0]),
                _ => None,
            },
            Self::Data(_)
            | Self::UnknownLaw { .. }
            | Self::NothingFree
            | Self::OutOfRange { .. }
            | Self::Gap { .. }
            | Self::Size { .. }
            | Self::Inclination { .. }
            | Self::LikelyUnit { .. }
            | Self::LikelyTimeUnit { .. }
            | Self::NoNoise { .. }
            | Self::FewWithin { .. }
            | Self::OffsetBounds { .. }
            | Self::OnlyStart { .. }
            | Self::TooFew { .. }
            | Self::ModelEnds { .. }
            | Self::TooManySteps
            | Self::Simulation(_)
            | Self::Optimiser(_) => None,
        }
    }
}

/// A sentence about times whose unit is missing.
fn likely_time_unit(
    path: Option<&Path>,
    name: &str,
    duration: f64,
    step: f64,
    may_be_frames: bool,
) -> String {
    /// Frames per second of usual cameras.
    const FRAME_RATE: f64 = 30.0;
    let mut sentence = path.map_or_else(String::new, |path| format!("{}: ", path.display()));
    sentence += &format!(
        "the times in column {name} have no unit: in s they span {} s with a value every {} s, in ms {} s",
        short(duration),
        short(step),
        short(duration / 1e3)
    );
    if may_be_frames {
        sentence += &format!(
            "; if they are frame numbers, at {FRAME_RATE} frames per second they span {} s",
            rounded(duration / FRAME_RATE, 3)
        );
    }
    sentence
}

/// A number to the 15 digits that each double keeps of a decimal fraction.
fn short(number: f64) -> String {
    rounded(number, 15)
}

/// A number to this many digits, with an exponent if it is very large or small.
fn rounded(number: f64, digits: usize) -> String {
    let text = format!("{number:.*e}", digits - 1);
    let rounded: f64 = text.parse().unwrap_or(number);
    let size = rounded.abs();
    if size == 0.0 || (1e-6..1e15).contains(&size) {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}

/// What leaves out a part of the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cut {
    /// A start at this time of the data, s.
    Start(f64),
    /// An end at this time after the start, s.
    Until(f64),
}

impl Cut {
    /// The side of a gap that is left out.
    fn side(self) -> &'static str {
        match self {
            Self::Start(_) => "before it",
            Self::Until(_) => "after it",
        }
    }
}

/// Reason why a key can't be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum KeyError {
    /// It is a text, or of the simulation.
    #[error("it is not a property of the top, its friction or its start")]
    NoProperty,
    /// The scenario does not have it.
    #[error("the scenario has no value for it")]
    NoValue,
    /// The scenario has no friction.
    #[error("the scenario has no friction")]
    NoFriction,
    /// It is the offset of a file that there is not.
    #[error(
        "there is no file with this number; offset is that of the second file, offset.3 that of the third"
    )]
    NoFile,
    /// It is the offset of the only clock.
    #[error(
        "a time offset of all data together and a free start are the same motion; the offset of a second file is fitted without being named"
    )]
    OnlyClock,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prints_times_in_short_form() {
        for (time, expected) in [
            (0.7 + 1e-16, "0.7"),
            (0.1 + 0.2, "0.3"),
            (1_764_158_407.200_001, "1764158407.2"),
            (20_000.0, "20000"),
            (-5.0, "-5"),
            (0.0, "0"),
            (1e300, "1e300"),
            (2e-9, "2e-9"),
        ] {
            assert_eq!(short(time), expected);
        }
    }
}
