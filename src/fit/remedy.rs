//! What can be done about errors and remarks of fits, in the terms of the interface that a user has. Errors themselves have
//! facts only.

use super::column::is_time;
use super::data_error::DataError;
use super::degeneracy::{Degeneracy, join_names, pronoun};
use super::error::{Cut, FitError, KeyError};
use super::unit::split_header;
use crate::telemetry::fields::state;
use thiserror::Error;

/// Where a fit is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interface {
    /// The command `toprise fit`, with options.
    Terminal,
    /// The web page, where only the file can be changed, and which parameters are fitted.
    Page,
    /// `toprise.fit` in Python, with arguments.
    Python,
}

/// An error with what can be done about it, in the terms of an interface.
#[derive(Debug, Error)]
#[error("{}", error.message(*interface))]
pub struct AdvisedError {
    #[source]
    error: FitError,
    interface: Interface,
}

impl FitError {
    /// The error with what can be done about it, in the terms of an interface.
    pub fn advised(self, interface: Interface) -> AdvisedError {
        AdvisedError {
            error: self,
            interface,
        }
    }

    /// The sentence of the error, with what can be done about it in the terms of an interface.
    pub fn message(&self, interface: Interface) -> String {
        match self.remedy() {
            Some(remedy) => format!("{self}; {}", remedy.words(interface)),
            None => self.to_string(),
        }
    }

    /// What can be done about the error, if its sentence does not say it for all interfaces.
    fn remedy(&self) -> Option<Remedy<'_>> {
        match self {
            Self::Data(error) => error.remedy(),
            Self::Key {
                reason: KeyError::NoValue,
                ..
            } => Some(Remedy::SetValue),
            Self::Key {
                reason: KeyError::NoFriction,
                ..
            } => Some(Remedy::ChooseLaw),
            Self::OutOfRange { .. } => Some(Remedy::ChooseTimes),
            Self::Gap { stray, cut, .. } => Some(Remedy::RemoveRows {
                rows: *stray,
                cut: *cut,
            }),
            Self::Inclination { name, .. } => Some(Remedy::StateUnit {
                path: state::THETA.path(),
                name,
                unit: "deg",
                si: "rad",
            }),
            Self::LikelyUnit {
                path,
                name,
                unit,
                si,
                ..
            } => Some(Remedy::StateUnit {
                path,
                name,
                unit,
                si,
            }),
            Self::LikelyTimeUnit {
                name,
                may_be_frames,
                ..
            } => Some(Remedy::StateTimeUnit {
                name,
                may_be_frames: *may_be_frames,
            }),
            Self::NoNoise { source_name, .. } => Some(Remedy::GiveNoise { source_name }),
            Self::NoDerivative { .. } | Self::Bounds { .. } => Some(Remedy::ChangeStart),
            Self::NotFree { name, .. } => Some(Remedy::Free { name }),

            Self::NotIdentifiable { degeneracies } => degeneracies.first().map(Remedy::Fix),
            Self::ModelEnds { end, .. } => Some(Remedy::EndEarlier {
                // A later end would be after that of the model.
                end: (end * 1e3).floor() / 1e3,
            }),
            Self::Scenario(_)
            | Self::Key {
                reason: KeyError::NoProperty | KeyError::NoFile | KeyError::OnlyClock,
                ..
            }
            | Self::UnknownLaw { .. }
            | Self::NothingFree
            | Self::Size { .. }
            | Self::FewWithin { .. }
            | Self::OffsetBounds { .. }
            | Self::OnlyStart { .. }
            | Self::TooFew { .. }
            | Self::TooManySteps
            | Self::Simulation(_)
            | Self::Optimiser(_) => None,
        }
    }
}

impl DataError {
    fn remedy(&self) -> Option<Remedy<'_>> {
        match self {
            Self::InFile { reason, .. } => reason.remedy(),
            Self::NoHeader { columns: 1, .. } => Some(Remedy::AddTimes),
            Self::NoHeader { .. } => Some(Remedy::WriteHeader),
            Self::NoTimes { .. } => Some(Remedy::NameTimes),
            Self::SeveralTimes { columns, .. } => Some(Remedy::ChooseTimesColumn {
                name: columns.first().map_or("t", String::as_str),
            }),
            Self::NoSignals { columns, .. } => Some(Remedy::NameFields {
                column: columns
                    .iter()
                    .find(|column| !is_time(column))
                    .map_or("COLUMN", String::as_str),
            }),
            Self::UnusedFile(_) => Some(Remedy::LeaveFileOut),
            Self::ChooseSignals { .. } => Some(Remedy::ChooseFields),
            Self::SameField { .. } => Some(Remedy::ChooseColumn),
            Self::Signal { .. } => Some(Remedy::DescribeSignal),
            #[cfg(feature = "sweep")]
            Self::Parquet { .. } => None,
            Self::Io { .. }
            | Self::Recording { .. }
            | Self::NoParquet { .. }
            | Self::Empty { .. }
            | Self::Width { .. }
            | Self::TooLong { .. }
            | Self::TooLarge { .. }
            | Self::Missing { .. }
            | Self::NotFound { .. }
            | Self::NotANumber { .. }
            | Self::Thousands { .. }
            | Self::Sigma { .. }
            | Self::Unit { .. }
            | Self::Timestamps { .. }
            | Self::Ambiguous { .. }
            | Self::Duplicate { .. }
            | Self::SameFile { .. }
            | Self::NoMember { .. }
            | Self::NoTimeColumn { .. }
            | Self::NoValues { .. } => None,
        }
    }
}

/// What can be done about an error or a remark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Remedy<'a> {
    /// Write a first line that names the columns.
    WriteHeader,
    /// Add a column of times.
    AddTimes,
    /// Name the column of times.
    NameTimes,
    /// Choose one of several columns of times, such as this one.
    ChooseTimesColumn { name: &'a str },
    /// Name the columns of fields, such as this one.
    NameFields { column: &'a str },
    /// Leave out a file without signals, or name its signals.
    LeaveFileOut,
    /// Choose the fields of a recording.
    ChooseFields,
    /// Choose one of two columns.
    ChooseColumn,
    /// Describe a signal as they are described.
    DescribeSignal,
    /// State the unit of a column: the likely one, or the SI unit.
    StateUnit {
        path: &'static str,
        name: &'a str,
        unit: &'static str,
        si: &'static str,
    },
    /// State the unit of a column of times.
    StateTimeUnit { name: &'a str, may_be_frames: bool },
    /// Choose the time that is fitted.
    ChooseTimes,
    /// Remove so many rows, or leave them out.
    RemoveRows { rows: usize, cut: Cut },
    /// Give the standard deviation of a signal without noise.
    GiveNoise { source_name: &'a str },
    /// Give a parameter another start.
    ChangeStart,
    /// Give a key of the scenario a value.
    SetValue,
    /// Let a parameter be fitted.
    Free { name: &'a str },
    /// Give the scenario friction.
    ChooseLaw,
    /// Fix parameters that can't be determined.
    Fix(&'a Degeneracy),
    /// Start closer to the motion.
    StartCloser,
    /// Leave out the data after this time, s.
    EndEarlier { end: f64 },
    /// Let outliers count less.
    CountOutliersLess,
}

impl Remedy<'_> {
    pub(super) fn words(self, interface: Interface) -> String {
        match interface {
            Interface::Terminal => self.for_terminal(),
            Interface::Page => self.for_page(),
            Interface::Python => self.for_python(),
        }
    }

    fn for_terminal(self) -> String {
        match self {
            Self::WriteHeader => {
                format!("{FIRST_LINE}, or use their numbers: --time 1 --signal theta=\"2 (deg)\"")
            }
            Self::AddTimes => ADD_TIMES.to_owned(),
            Self::NameTimes => format!("name it with --time, {OR_FRAMES}"),
            Self::ChooseTimesColumn { name } => format!("choose with --time {}", quoted(name)),
            Self::NameFields { column } => format!(
                "name the columns with --signal, e.g. --signal theta={}",
                quoted(column)
            ),
            Self::LeaveFileOut => "leave it out, or name its signals with --signal".to_owned(),
            Self::ChooseFields => format!(
                "choose the fields to fit, e.g. --signal {}:1mrad",
                state::THETA
            ),
            Self::ChooseColumn => "choose with --signal".to_owned(),
            Self::DescribeSignal => {
                "write --signal FIELD=COLUMN:SIGMA, e.g. theta=\"tilt (deg)\":2mrad".to_owned()
            }
            Self::StateUnit {
                path,
                name,
                unit,
                si,
            } => format!(
                "write the unit into the header, or --signal {path}=\"{name} ({unit})\"; if they are in {si}, \"{name} ({si})\""
            ),
            Self::StateTimeUnit {
                name,
                may_be_frames,
            } => format!(
                "write the unit into the header, or --time \"{name} (ms)\", \"{name} (us)\" or \"{name} (s)\"{}",
                divide(may_be_frames)
            ),
            Self::ChooseTimes => "see --start and --until".to_owned(),
            Self::RemoveRows { rows, cut } => {
                let option = match cut {
                    Cut::Start(time) => format!("--start {time}"),
                    Cut::Until(time) => format!("--until {time}"),
                };
                let them = pronoun(rows);
                format!("remove {them}, or leave {them} out with {option}")
            }
            Self::GiveNoise { source_name } => {
                format!("check the sensor, leave {source_name} out, or give σ (--signal)")
            }
            Self::ChangeStart => "change its start (--set) or its bounds (--bound)".to_owned(),
            Self::Free { name } => format!("add {name} to --free"),
            Self::SetValue => "set one with --set".to_owned(),
            Self::ChooseLaw => "choose a law, e.g. --set friction.law=coulomb --set friction.k=0.03 --set friction.dissipation=full".to_owned(),
            Self::Fix(degeneracy) => {
                format!("{} (leave out of --free what is known)", fix(degeneracy))
            }
            Self::StartCloser => format!("start closer to the motion (--set), {CHECK_DATA}"),
            Self::EndEarlier { end } => format!(
                "start closer to the motion (--set), or fit only the data before that (--until {end:.3})"
            ),
            Self::CountOutliersLess => "use --loss huber".to_owned(),
        }
    }

    fn for_page(self) -> String {
        // A person there changes the file, the sliders or the two fields of the panel.
        match self {
            Self::WriteHeader => FIRST_LINE.to_owned(),
            Self::AddTimes => ADD_TIMES.to_owned(),
            Self::NameTimes => {
                "call it t in the line that names the columns, e.g. t,theta (deg)".to_owned()
            }
            Self::ChooseTimesColumn { .. } => {
                "leave only one of them in the file, or call it t".to_owned()
            }
            Self::NameFields { column } => {
                let unit = match split_header(column).1 {
                    "" => "deg",
                    unit => unit,
                };
                format!(
                    "call the tilt theta and the azimuth phi in the line that names the columns, e.g. t,theta ({unit})"
                )
            }
            Self::LeaveFileOut | Self::ChooseFields => {
                "fit a table with the columns t and theta".to_owned()
            }
            Self::ChooseColumn => "leave only one of them in the file".to_owned(),
            Self::DescribeSignal => {
                "write how right the angles are as a number with a unit, e.g. 0.3 deg".to_owned()
            }
            Self::StateUnit { name, unit, si, .. } => format!(
                "write the unit into the line that names the columns: {name} ({unit}), or {name} ({si}) if it is that"
            ),
            Self::StateTimeUnit {
                name,
                may_be_frames,
            } => format!(
                "write the unit into the line that names the columns: {name} (ms), {name} (us) or {name} (s){}",
                divide(may_be_frames)
            ),
            Self::ChooseTimes => "check the times in the file".to_owned(),
            Self::RemoveRows { rows, .. } => format!("remove {} from the file", pronoun(rows)),
            Self::GiveNoise { source_name } => format!(
                "check the sensor, leave {source_name} out of the file, or say how right the angles are"
            ),
            Self::Free { name } => format!("fit {name}, too"),
            Self::ChangeStart | Self::SetValue => "give it another value on the page".to_owned(),
            Self::ChooseLaw => "switch friction on".to_owned(),
            Self::Fix(degeneracy) => format!(
                "{} (leave out of the parameters to find what is known)",
                fix(degeneracy)
            ),
            Self::StartCloser => format!("set the sliders closer to the motion, {CHECK_DATA}"),
            Self::EndEarlier { end } => format!(
                "set the sliders closer to the motion, or leave out the rows more than {end:.3} s after the first one"
            ),
            Self::CountOutliersLess => "leave out their rows".to_owned(),
        }
    }

    fn for_python(self) -> String {
        match self {
            Self::WriteHeader => format!(
                "{FIRST_LINE}, or use their numbers: time_column=\"1\", columns=[\"theta=2 (deg)\"]"
            ),
            Self::AddTimes => ADD_TIMES.to_owned(),
            Self::NameTimes => format!("name it with time_column, {OR_FRAMES}"),
            Self::ChooseTimesColumn { name } => format!("choose with time_column={name:?}"),
            Self::NameFields { column } => {
                format!("name the columns, e.g. columns=[\"theta={column}\"]")
            }
            Self::LeaveFileOut => "leave it out, or name its signals in columns".to_owned(),
            Self::ChooseFields => format!(
                "choose the fields to fit, e.g. columns=[\"{}:1mrad\"]",
                state::THETA
            ),
            Self::ChooseColumn => "choose with columns".to_owned(),
            Self::DescribeSignal => {
                "columns are written FIELD=COLUMN:SIGMA, e.g. \"theta=tilt (deg):2mrad\"".to_owned()
            }
            Self::StateUnit {
                path,
                name,
                unit,
                si,
            } => format!(
                "write the unit into the header, or columns=[\"{path}={name} ({unit})\"]; if they are in {si}, \"{name} ({si})\""
            ),
            Self::StateTimeUnit {
                name,
                may_be_frames,
            } => format!(
                "write the unit into the header, or time_column=\"{name} (ms)\", \"{name} (us)\" or \"{name} (s)\"{}",
                divide(may_be_frames)
            ),
            Self::ChooseTimes => "see start and until".to_owned(),
            Self::RemoveRows { rows, cut } => {
                let argument = match cut {
                    Cut::Start(time) => format!("start={time}"),
                    Cut::Until(time) => format!("until={time}"),
                };
                let them = pronoun(rows);
                format!("remove {them}, or leave {them} out with {argument}")
            }
            Self::GiveNoise { source_name } => format!(
                "check the sensor, leave {source_name} out, or give σ (sigma, or in columns)"
            ),
            Self::ChangeStart => "change its start (overrides) or its bounds".to_owned(),
            Self::Free { name } => format!("add {name} to free"),
            Self::SetValue => "set one in overrides".to_owned(),
            Self::ChooseLaw => "choose a law in overrides: friction.law, such as coulomb, friction.k and friction.dissipation".to_owned(),
            Self::Fix(degeneracy) => {
                format!("{} (leave out of free what is known)", fix(degeneracy))
            }
            Self::StartCloser => format!("start closer to the motion (overrides), {CHECK_DATA}"),
            Self::EndEarlier { end } => format!(
                "start closer to the motion (overrides), or fit only the data before that (until={end:.3})"
            ),
            Self::CountOutliersLess => "use loss=\"huber\"".to_owned(),
        }
    }
}

/// What else may be wrong if no motion follows the data.
const CHECK_DATA: &str = "or check what the columns measure, and in which units";

/// What can be done about a table without times.
const OR_FRAMES: &str = "or add one: the number of the frame divided by the frame rate";

/// What can be done about a table of one column.
const ADD_TIMES: &str = "write the times beside the values, e.g. t,theta (deg)";

/// What a table without names needs.
const FIRST_LINE: &str =
    "write a first line that does, e.g. t,theta (deg) or t,theta (deg),phi (deg)";

/// What to do about frame numbers, after what to do about other times.
fn divide(may_be_frames: bool) -> &'static str {
    if may_be_frames {
        "; divide frame numbers by the frame rate"
    } else {
        ""
    }
}

/// The parameters to fix.
fn fix(degeneracy: &Degeneracy) -> String {
    match degeneracy {
        Degeneracy::Unseen { names } => format!("fix {}", join_names(names)),
        Degeneracy::Combined { names, .. } => format!("fix {}", names.join(" or ")),
        Degeneracy::Together { .. } => "fix one of them".to_owned(),
        Degeneracy::Several { directions, .. } => format!("fix {directions} of them"),
    }
}

/// A name in quotes if a shell needs them.
fn quoted(name: &str) -> String {
    if name.contains(|c: char| !c.is_ascii_alphanumeric() && c != '_') {
        format!("\"{name}\"")
    } else {
        name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{data, fit};
    use super::*;
    use crate::fit::{Request, SignalSpec};
    use crate::run::scenario::Preset;
    use std::path::Path;

    /// The error of a fit to a table.
    fn error_of(text: &str, free: &[&str]) -> FitError {
        let scenario = Preset::find("full-coulomb").unwrap().scenario().unwrap();
        let content = text.as_bytes().to_vec();
        match data::read_bytes(Path::new("a.csv"), content, &[]) {
            Ok(data) => fit(&Request::new(scenario, data, free), &|_| {}).unwrap_err(),
            Err(error) => error.into(),
        }
    }

    #[test]
    fn words_remedies_for_each_interface() {
        let (mut degrees, mut frames) = (String::new(), String::new());
        for at in 0..20 {
            degrees += &format!("{},{}\n", f64::from(at) / 100.0, 28 + at % 2);
            frames += &format!("{at},0.5\n");
        }
        for (name, text, free, [terminal, page, python]) in [
            (
                "no header",
                "0,0.5\n0.1,0.5\n".to_owned(),
                "friction.k",
                [
                    "no line names the 2 columns; write a first line that does, e.g. t,theta (deg) or t,theta (deg),phi (deg), or use their numbers: --time 1",
                    "e.g. t,theta (deg) or t,theta (deg),phi (deg)",
                    "time_column=\"1\"",
                ],
            ),
            (
                "no times",
                "frame,theta\n0,0.5\n".to_owned(),
                "friction.k",
                ["--time", "call it t", "time_column"],
            ),
            (
                "two columns of times",
                "Run 1: Time (s),Run 2: Time (s),theta\n0,0,0.5\n".to_owned(),
                "friction.k",
                [
                    "--time \"Run 1: Time (s)\"",
                    "only one of them",
                    "time_column=\"Run 1: Time (s)\"",
                ],
            ),
            (
                "no field",
                "t,Winkel (°)\n0,0.5\n".to_owned(),
                "friction.k",
                [
                    "--signal theta=\"Winkel (°)\"",
                    "e.g. t,theta (°)",
                    "columns=[\"theta=Winkel (°)\"]",
                ],
            ),
            (
                "degrees",
                format!("t,tilt\n{degrees}"),
                "friction.k",
                [
                    "--signal theta=\"tilt (deg)\"",
                    "columns: tilt (deg), or tilt (rad)",
                    "columns=[\"theta=tilt (deg)\"]",
                ],
            ),
            (
                "frames",
                format!("t,theta\n{frames}"),
                "friction.k",
                [
                    "--time \"t (ms)\"",
                    "columns: t (ms)",
                    "time_column=\"t (ms)\"",
                ],
            ),
            (
                "no noise",
                format!("t (s),theta\n{frames}"),
                "friction.k",
                ["(--signal)", "how right the angles are", "(sigma,"],
            ),
            (
                "a wrong time",
                "t,theta\n0,0.5\n0.1,0.4\n0.2,0.5\n0.3,0.4\n900,0.5\n".to_owned(),
                "friction.k",
                ["--until 0.35", "from the file", "until=0.35"],
            ),
            (
                "not determined",
                "t,theta\n0,0.5\n0.1,0.4\n0.2,0.5\n0.3,0.4\n0.4,0.5\n".to_owned(),
                "friction.k,top.peg_radius",
                [
                    "fix friction.k or top.peg_radius (leave out of --free",
                    "parameters to find",
                    "out of free",
                ],
            ),
        ] {
            let free: Vec<&str> = free.split(',').collect();
            let error = error_of(&text, &free);
            for (interface, expected) in [
                (Interface::Terminal, terminal),
                (Interface::Page, page),
                (Interface::Python, python),
            ] {
                let message = error.message(interface);
                assert!(message.contains(expected), "{name}: {message}");
                let names_options = message.contains("--");
                assert_eq!(names_options, interface == Interface::Terminal, "{message}");
            }
        }
    }

    #[test]
    fn tops_without_friction_need_a_law() {
        let scenario = Preset::find("frictionless").unwrap().scenario().unwrap();
        let content = b"t,theta\n0,0.5\n0.1,0.4\n".to_vec();
        let data = data::read_bytes(Path::new("a.csv"), content, &[]).unwrap();
        let request = Request::new(scenario, data, &["friction.k"]);
        let error = fit(&request, &|_| {}).unwrap_err();
        for (interface, expected) in [
            (Interface::Terminal, "--set friction.law=coulomb"),
            (Interface::Page, "switch friction on"),
            (Interface::Python, "choose a law in overrides"),
        ] {
            let message = error.message(interface);
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn describes_signals_as_each_interface_does() {
        let error = FitError::from(SignalSpec::parse("theta:0").unwrap_err());
        let message = error.message(Interface::Terminal);
        assert!(message.contains("--signal FIELD=COLUMN"), "{message}");
        let message = error.message(Interface::Page);
        assert!(message.contains("e.g. 0.3 deg"), "{message}");
    }
}
