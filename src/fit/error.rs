//! Errors of fits.

use super::data_error::DataError;
use super::degeneracy::{Degeneracy, pronoun};
use super::failure::Failure;
use super::parameter::is_offset;
use super::place::{Place, ValuePlace};
use crate::run::scenario::ScenarioError;
use crate::run::simulation::{SimulationError, StopReason};
use crate::telemetry::fields::state;
use crate::words::number::Digits;
use crate::words::{Number, Piece, Sentence, sentence};
use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;
use thiserror::Error;

/// Error of a fit.
#[derive(Debug, Error)]
pub enum FitError {
    /// The data can't be read.
    Data(#[from] DataError),
    /// A key can't be fitted, or a scenario is invalid.
    Scenario(#[from] ScenarioError),
    /// A key can't be fitted.
    Key {
        /// The key.
        name: String,
        /// The reason.
        reason: KeyError,
    },
    /// There is no such law.
    UnknownLaw {
        /// The name that no law has.
        name: String,
        /// The laws.
        known: String,
    },
    /// Bounds exclude the start, or each other.
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
    NotFree {
        /// The parameter.
        name: String,
        /// What it can't have.
        what: &'static str,
    },
    /// No parameter is free.
    NothingFree,
    /// A signal has no value in the time that is fitted.
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
    Inclination {
        /// Median of the values, rad if the unit is right.
        median: f64,
        /// Name of the column without its unit, or topic and path.
        name: String,
    },
    /// Values that agree with the motion at the start in another unit only.
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
    NoDerivative {
        /// The parameter.
        name: String,
    },
    /// A file's samples are too rare, or its times too long, for a comparison with the motion.
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
    OnlyStart {
        /// Number of samples.
        samples: usize,
        /// Time of the start, on the clock of the data, s.
        time: f64,
    },
    /// The data are too few.
    TooFew {
        /// Number of samples in the fit.
        samples: usize,
        /// Number of free parameters.
        parameters: usize,
    },
    /// Parameters can't be told apart.
    NotIdentifiable {
        /// The groups of parameters.
        degeneracies: Vec<Degeneracy>,
    },
    /// The model ends before the data.
    ModelEnds {
        /// End of the model, s.
        end: f64,
        /// Why it ends.
        reason: StopReason,
        /// End of the data, s.
        needed: f64,
    },
    /// A motion takes many times the steps of that at the start.
    TooManySteps,
    /// A simulation failed.
    Simulation(#[from] SimulationError),
    /// The optimiser refused its input.
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

/// Renders the sentence for readers of no particular interface.
impl Display for FitError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.sentence().fmt(f)
    }
}

impl FitError {
    /// What is wrong, and what can be done about it.
    #[allow(clippy::too_many_lines, reason = "a sentence for each error")]
    pub fn sentence(&self) -> Sentence {
        match self {
            Self::Data(error) => error.sentence(),
            Self::Scenario(error) => error.to_string().into(),
            Self::Simulation(error) => error.to_string().into(),
            Self::Optimiser(reason) => sentence!("the optimiser failed: {}", *reason),
            Self::Key { name, reason } => {
                sentence!("{} can't be fitted: {}", key(name), reason.sentence())
            }
            Self::UnknownLaw { name, known } => {
                sentence!("unknown law {}; laws: {}", name, known)
            }
            Self::Bounds {
                name,
                low,
                high,
                start,
            } => sentence!(
                "{}: the bounds {} to {} must contain the start, {}; {}",
                key(name),
                low.to_string(),
                high.to_string(),
                start.to_string(),
                change_start()
            ),
            Self::NotFree { name, what } => sentence!(
                "{} is not free, so it can't have {}; add {} to {}",
                key(name),
                *what,
                key(name),
                Piece::argument("free")
            ),
            Self::NothingFree => {
                sentence!("nothing to fit: none of the free parameters changes any signal")
            }
            Self::NoDerivative { name } => sentence!(
                "{}: no motion with a slightly larger or smaller value can be computed; {}",
                key(name),
                change_start()
            ),
            Self::NotIdentifiable { degeneracies } => not_identifiable(degeneracies),
            Self::ModelEnds { end, .. } => sentence!(
                "{}; start closer to the motion ({}), or fit only the data before that ({})",
                Failure::from(self).sentence(),
                Piece::argument("set"),
                // A later end would be after that of the model.
                Piece::argument_with("until", format!("{:.3}", (end * 1e3).floor() / 1e3))
            ),
            Self::TooManySteps => Failure::TooManySteps.sentence(),
            Self::OutOfRange {
                field,
                first,
                last,
                origin,
                until,
            } => sentence!(
                "{} has no value from t = {}{}: its times are {} to {}; see {} and {}",
                Piece::field(field.clone()),
                time(*origin),
                until.map_or_else(Sentence::default, |until| sentence!(" to {}", time(until))),
                bare_time(*first),
                time(*last),
                Piece::argument("start"),
                Piece::argument("until")
            ),
            Self::Gap {
                from,
                to,
                rest,
                stray,
                place,
                cut,
            } => {
                let them = pronoun(*stray);
                sentence!(
                    "the data have no values from t = {} to {}, and are only {} long without this gap; a time may be wrong ({} {}{}); remove {}, or leave {} out with {}",
                    bare_time(*from),
                    time(*to),
                    time(*rest),
                    Piece::count(*stray as u64, "row"),
                    cut.side(),
                    stray_place(*stray, place.as_ref()),
                    them,
                    them,
                    cut.argument()
                )
            }
            Self::Size {
                place,
                time: at,
                value,
                sigma,
            } => sentence!(
                "{}: the value {} at t = {}, with the standard deviation {}, is too large to be fitted: remove it",
                place.to_string(),
                format!("{value:e}"),
                time(*at),
                format!("{sigma:e}")
            ),
            Self::LikelyTimeUnit {
                path,
                name,
                duration,
                step,
                may_be_frames,
            } => sentence!(
                "{}the times in column {} have no unit: in s they span {} with a value every {}, in ms {}{}; write the unit after the name: {}, {} or {}{}",
                path.as_ref()
                    .map_or_else(Sentence::default, |path| sentence!(
                        "{}: ",
                        path.display().to_string()
                    )),
                name,
                time(*duration),
                time(*step),
                time(duration / 1e3),
                if *may_be_frames {
                    duration_of_frames(*duration)
                } else {
                    Sentence::default()
                },
                Piece::argument_with("time", format!("{name} (ms)")),
                Piece::argument_with("time", format!("{name} (us)")),
                Piece::argument_with("time", format!("{name} (s)")),
                if *may_be_frames {
                    "; divide frame numbers by the frame rate"
                } else {
                    ""
                }
            ),
            Self::FewWithin {
                name,
                most,
                samples,
                end,
            } => sentence!(
                "{}: at most {} of the {} of its file are within the motion (0 to {}) at once; are the times of both files in the unit that is stated, or else in s?",
                key(name),
                most.to_string(),
                Piece::count(*samples as u64, "sample"),
                time(*end)
            ),
            Self::OffsetBounds {
                name,
                bounds: [low, high],
                end,
                enough: [first, last],
            } => sentence!(
                "{}: no offset from {} to {} brings its file into the motion (0 to {}), but those from {} to {} do: change its bounds",
                key(name),
                bare_time(*low),
                time(*high),
                time(*end),
                bare_time(*first),
                time(*last)
            ),
            Self::OnlyStart { samples, time: at } => sentence!(
                "{} at t = {}, where the scenario starts, can't determine a motion: measure at several times",
                match samples {
                    1 => Piece::from("a single sample"),
                    _ => Piece::count(*samples as u64, "sample"),
                },
                time(*at)
            ),
            Self::Inclination { median, name } => sentence!(
                "most values of {} are above π (median {}), but an inclination in rad is not; {}",
                name,
                Piece::fixed(*median, 4, ""),
                state_unit(state::THETA.path(), name, "deg", "rad")
            ),
            Self::LikelyUnit {
                field,
                path,
                ratio,
                unit,
                si,
                name,
            } => sentence!(
                "{}: the values are about {} times those of the motion at the start; in {} they would agree with it; {}",
                Piece::field(field.clone()),
                Piece::fixed(*ratio, 0, ""),
                *unit,
                state_unit(path, name, unit, si)
            ),
            Self::NoNoise {
                field,
                source_name,
                value,
                unit,
            } => sentence!(
                "{}: all values are {}: they have no noise from which a standard deviation could be estimated; check the sensor, leave {} out, or give σ: {}",
                Piece::field(field.clone()),
                Piece::rounded(*value, 6, *unit),
                source_name,
                Piece::argument_with("signal", format!("{field}={source_name}:SIGMA"))
            ),
            Self::TooFew {
                samples,
                parameters,
            } => sentence!(
                "{} can't determine {}: at least {} are needed",
                Piece::count(*samples as u64, "sample"),
                Piece::count(*parameters as u64, "parameter"),
                (parameters + 1).to_string()
            ),
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
            } => Self::ModelEnds {
                end: *end,
                reason: *reason,
                needed: *needed,
            },
            FitError::TooManySteps => Self::TooManySteps,
            other => Self::Error(other.to_string()),
        }
    }
}

/// A parameter: a key of the scenario, or the offset of a clock.
fn key(name: &str) -> Piece {
    Piece::key(name.to_owned())
}

/// A time on the clock of the data to the microsecond, s.
fn time(seconds: f64) -> Piece {
    Piece::Number(Number::new(seconds, Digits::AtMostDecimals(6), "s"))
}

/// A time on the clock of the data before another one, which has the unit.
fn bare_time(seconds: f64) -> Piece {
    time(seconds).without_unit()
}

fn change_start() -> Sentence {
    sentence!(
        "change its start ({}) or its bounds ({})",
        Piece::argument("set"),
        Piece::argument("bound")
    )
}

/// How to state the unit of a column: the likely one, or the SI unit.
fn state_unit(path: &str, name: &str, unit: &str, si: &str) -> Sentence {
    let [likely, other] =
        [unit, si].map(|unit| Piece::argument_with("signal", format!("{path}={name} ({unit})")));
    sentence!(
        "write the unit after the name: {}; if they are in {}, {}",
        likely,
        si,
        other
    )
}

fn not_identifiable(degeneracies: &[Degeneracy]) -> Sentence {
    let clauses = Sentence::join(degeneracies.iter().map(Degeneracy::sentence), "; ");
    match degeneracies.first() {
        Some(first) => sentence!(
            "{}; fix {} (leave out of {} what is known)",
            clauses,
            first.fixed(),
            Piece::argument("free")
        ),
        None => clauses,
    }
}

/// Where stray rows are, after their number.
fn stray_place(stray: usize, place: Option<&Place>) -> Sentence {
    match place {
        Some(place) if stray == 1 => sentence!(": {}", place.to_string()),
        Some(place) => sentence!(", next to it {}", place.to_string()),
        None => Sentence::default(),
    }
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

    fn argument(self) -> Piece {
        match self {
            Self::Start(time) => Piece::argument_with("start", time.to_string()),
            Self::Until(time) => Piece::argument_with("until", time.to_string()),
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

impl KeyError {
    /// The reason, and what can be done about it.
    fn sentence(self) -> Sentence {
        let set = Piece::argument("set");
        match self {
            Self::NoValue => sentence!("{}; set one with {}", self.to_string(), set),
            Self::NoFriction => sentence!(
                "{}; choose a law with {}, e.g. {} = coulomb, {} = 0.03 and {} = full",
                self.to_string(),
                set,
                Piece::key("friction.law"),
                Piece::key("friction.k"),
                Piece::key("friction.dissipation")
            ),
            Self::NoProperty | Self::NoFile | Self::OnlyClock => self.to_string().into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Request, data, fit};
    use super::*;
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
        match data::read_bytes(Path::new("a.csv"), content, &[]) {
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
        let constant = format!("t (s),theta\n{frames}");
        for (name, preset, text, free, expected) in [
            (
                "no header",
                "full-coulomb",
                "0,0.5\n0.1,0.5\n",
                &["friction.k"][..],
                "no line names the 2 columns; write a first line that does, e.g. t,theta (deg)",
            ),
            (
                "no times",
                "full-coulomb",
                "frame,theta\n0,0.5\n",
                &["friction.k"],
                "name it with time, or add one",
            ),
            (
                "two columns of times",
                "full-coulomb",
                "Run 1: Time (s),Run 2: Time (s),theta\n0,0,0.5\n",
                &["friction.k"],
                "call one of them t, or choose with time",
            ),
            (
                "no field",
                "full-coulomb",
                "t,Winkel (°)\n0,0.5\n",
                &["friction.k"],
                "name the columns, e.g. signal = theta=Winkel (°)",
            ),
            (
                "degrees",
                "full-coulomb",
                &degrees,
                &["friction.k"],
                "signal = theta=tilt (deg); if they are in rad, signal = theta=tilt (rad)",
            ),
            (
                "frames",
                "full-coulomb",
                &times,
                &["friction.k"],
                "write the unit after the name: time = t (ms), time = t (us) or time = t (s); divide",
            ),
            (
                "no noise",
                "full-coulomb",
                &constant,
                &["friction.k"],
                "leave theta out, or give σ: signal = /top/state.theta=theta:SIGMA",
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
                "choose a law with set, e.g. friction.law = coulomb",
            ),
        ] {
            let message = error_of(preset, text, free).to_string();
            assert!(message.contains(expected), "{name}: {message}");
        }
    }
}
