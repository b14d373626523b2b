//! Errors of fits.

use super::apart::Apart;
use super::failure::Failure;
use crate::measured::DataError;
use crate::run::scenario::ScenarioError;
use crate::run::simulation::{SimulationError, StopReason};
use crate::words::number::Digits;
use crate::words::{Number, Piece, Sentence, sentence};
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
    /// What is asked for can't be fitted, or the data can't determine it.
    #[error("{reason}")]
    Refused {
        /// The key of the scenario that is at fault, if it is a single one.
        key: Option<String>,
        /// What is wrong, and what can be done about it.
        reason: Sentence,
    },
    /// The model ends before the data.
    #[error("{}", self.sentence())]
    ModelEnds {
        /// End of the model, s.
        end: f64,
        /// Why it ends.
        reason: StopReason,
        /// End of the data, s.
        needed: f64,
        /// The time in the data until which a fit has succeeded, s.
        until: Option<f64>,
    },
    /// A motion takes many times the steps of that at the start.
    #[error("{}", self.sentence())]
    TooManySteps,
    /// Model and data don't meet.
    #[error("{}", self.sentence())]
    Apart {
        /// What was seen.
        seen: Apart,
        /// Whether a fit without what is at rest has succeeded.
        is_tried: bool,
    },
    /// A simulation failed.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

impl FitError {
    pub(super) fn refused(reason: Sentence) -> Self {
        Self::Refused { key: None, reason }
    }

    pub(super) fn of_key(path: &str, reason: Sentence) -> Self {
        Self::Refused {
            key: Some(path.to_owned()),
            reason,
        }
    }

    /// Whether the data were read and can determine the parameters, but no motion was found that follows them to their end.
    pub fn is_of_motion(&self) -> bool {
        matches!(
            self,
            Self::ModelEnds { .. } | Self::TooManySteps | Self::Apart { .. }
        )
    }

    /// Whether the data don't depend on a parameter of the law, so that another law may do.
    pub(super) fn is_of_law(&self) -> bool {
        matches!(self, Self::Refused { key: Some(key), .. } if key.starts_with("friction."))
    }

    /// The key of the scenario that is at fault, if it is a single one.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Scenario(error) => error.key.as_deref(),
            Self::Refused { key, .. } => key.as_deref(),
            Self::Data(_)
            | Self::ModelEnds { .. }
            | Self::TooManySteps
            | Self::Apart { .. }
            | Self::Simulation(_) => None,
        }
    }

    /// What is wrong, and what can be done about it.
    pub fn sentence(&self) -> Sentence {
        match self {
            Self::Data(error) => error.sentence(),
            Self::Scenario(error) => error.to_string().into(),
            Self::Refused { reason, .. } => reason.clone(),
            Self::ModelEnds { until, .. } => sentence!(
                "{}; start closer to the motion ({}){}",
                Failure::from(self).sentence(),
                Piece::argument("set"),
                match until {
                    Some(until) => sentence!(
                        ", or fit only the data before that ({})",
                        Piece::argument_with("until", until.to_string())
                    ),
                    None => Sentence::default(),
                }
            ),
            Self::Apart { seen, is_tried } => seen.sentence(*is_tried),
            Self::TooManySteps => Failure::TooManySteps.sentence(),
            Self::Simulation(error) => error.to_string().into(),
        }
    }
}

impl From<&FitError> for Failure {
    fn from(error: &FitError) -> Self {
        match error {
            FitError::ModelEnds {
                end,
                reason,
                needed,
                ..
            } => Self::ModelEnds {
                end: *end,
                reason: *reason,
                needed: *needed,
            },
            FitError::TooManySteps => Self::TooManySteps,
            FitError::Apart { seen, .. } => Self::Apart(*seen),
            other => Self::Error(other.to_string()),
        }
    }
}

impl From<Apart> for FitError {
    fn from(seen: Apart) -> Self {
        Self::Apart {
            seen,
            is_tried: false,
        }
    }
}

/// The error of a fit without anything that could change a signal.
pub(super) fn nothing_free() -> FitError {
    FitError::refused(sentence!(
        "nothing to fit: none of the free parameters changes any signal"
    ))
}

/// The error of fewer samples than can determine the parameters.
pub(super) fn too_few(samples: usize, parameters: usize) -> FitError {
    FitError::refused(sentence!(
        "{} can't determine {}: at least {} are needed",
        Piece::count(samples as u64, "sample"),
        Piece::count(parameters as u64, "parameter"),
        (parameters + 1).to_string()
    ))
}

/// The error of bounds or a profile of a key that is not free.
pub(super) fn not_free(name: &str, what: &'static str) -> FitError {
    let reason = sentence!(
        "{} is not free, so it can't have {}; add {} to {}",
        parameter(name),
        what,
        parameter(name),
        Piece::argument("free")
    );
    FitError::of_key(name, reason)
}

/// A parameter: a key of the scenario, or the offset of a clock.
pub(super) fn parameter(name: &str) -> Piece {
    Piece::key(name.to_owned())
}

/// A time on the clock of the data to the microsecond, s.
pub(super) fn time(seconds: f64) -> Piece {
    Piece::Number(Number::new(seconds, Digits::AtMostDecimals(6), "s"))
}

/// A time on the clock of the data before another one, which has the unit.
pub(super) fn bare_time(seconds: f64) -> Piece {
    time(seconds).without_unit()
}

/// What helps a parameter whose start is wrong.
pub(super) fn change_start() -> Sentence {
    sentence!(
        "change its start ({}) or its bounds ({})",
        Piece::argument("set"),
        Piece::argument("bound")
    )
}

#[cfg(test)]
mod tests {
    use super::super::{Request, fit};
    use super::*;
    use crate::measured;
    use crate::run::scenario::Preset;
    use std::path::Path;

    #[test]
    fn prints_times_in_short_form() {
        for (seconds, expected) in [
            (0.7 + 1e-16, "0.7"),
            (0.1 + 0.2, "0.3"),
            (1_764_158_407.2, "1764158407.2"),
            (20_000.0, "20000"),
            (-5.0, "−5"),
            (0.0, "0"),
            (1e300, "1.000000e300"),
        ] {
            assert_eq!(bare_time(seconds).to_string(), expected);
        }
    }

    /// The error of a fit to a table.
    fn error_of(preset: &str, text: &str, free: &[&str]) -> FitError {
        let scenario = Preset::find(preset).unwrap().scenario().unwrap();
        let content = text.as_bytes().to_vec();
        match measured::read_bytes(Path::new("a.csv"), content, &[]) {
            Ok(data) => fit(&Request::new(scenario, data, free), &|_| {}).unwrap_err(),
            Err(error) => error.into(),
        }
    }

    #[test]
    fn errors_name_a_remedy() {
        let (mut degrees, mut frames) = (String::new(), String::new());
        for at in 0..20 {
            degrees += &format!("{},{}\n", f64::from(at) / 100.0, 28 + at % 2);
            frames += &format!("{at},0.5\n");
        }
        let degrees = format!("t,tilt\n{degrees}");
        let times = format!("t,theta\n{frames}");
        for (name, preset, text, free, expected) in [
            (
                "no header",
                "full-coulomb",
                "0,0.5\n0.1,0.5\n",
                &["friction.k"][..],
                "understood as “0 | 0.5”, “0.1 | 0.5”; write a first line such as t,theta (deg)",
            ),
            (
                "no times",
                "full-coulomb",
                "frame,theta\n0,0.5\n",
                &["friction.k"],
                "theta (deg),phi (deg), or see time, delimiter and decimal",
            ),
            (
                "two columns of times",
                "full-coulomb",
                "Run 1: Time (s),Run 2: Time (s),theta\n0,0,0.5\n",
                &["friction.k"],
                "choose one, e.g. time = Run 1: Time (s)",
            ),
            (
                "no field",
                "full-coulomb",
                "t,Winkel (°)\n0,0.5\n",
                &["friction.k"],
                "name the columns to read, e.g. signal = theta=Winkel (°)",
            ),
            (
                "degrees",
                "full-coulomb",
                &degrees,
                &["friction.k"],
                "if it is in degrees, write tilt (deg) into the header, or after the name in signal",
            ),
            (
                "frames",
                "full-coulomb",
                &times,
                &["friction.k"],
                "declare the unit: time = t (ms), time = t (us) or time = t (s); divide frame numbers",
            ),
            (
                "a wrong time",
                "full-coulomb",
                "t,theta\n0,0.5\n0.1,0.4\n0.2,0.5\n0.3,0.4\n900,0.5\n",
                &["friction.k"],
                "remove it, or leave it out with until = 0.35",
            ),
            (
                "not determined",
                "full-coulomb",
                "t,theta\n0,0.5\n0.1,0.4\n0.2,0.5\n0.3,0.4\n0.4,0.5\n",
                &["friction.k", "top.peg_radius"],
                "fix friction.k or top.peg_radius (leave out of free what is known)",
            ),
            (
                "no friction",
                "frictionless",
                "t,theta\n0,0.5\n0.1,0.4\n",
                &["friction.k"],
                "choose a law, e.g. with set = friction.law=coulomb, friction.k=0.03, friction.dissipation=full",
            ),
        ] {
            let message = error_of(preset, text, free).to_string();
            assert!(message.contains(expected), "{name}: {message}");
        }
    }
}
