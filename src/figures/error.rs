//! Errors of figures.

use super::plot::ticks::MAX_MAGNITUDE;
use std::fmt;

/// A sweep that can't be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FigureError {
    /// No run has a value along each axis.
    #[error("no run has a value for {x}{}", AlsoOf(y.as_deref()))]
    NoValues {
        /// The column on the x axis.
        x: String,
        /// The column on the y axis; `None` for curves.
        y: Option<String>,
    },
    /// A number that no axis can show.
    #[error("{column} = {value:e} in one run: values above {max:e} can't be drawn", max = MAX_MAGNITUDE)]
    TooLarge {
        /// The column of the number.
        column: String,
        /// The number.
        value: f64,
    },
    /// More curves than styles of lines.
    #[error(
        "{scenarios} scenarios, but at most {max} curves can be distinguished: select with --where scenario=NAME"
    )]
    TooManyCurves {
        /// The number of scenarios, each of which has a curve.
        scenarios: usize,
        /// The maximum number of curves.
        max: usize,
    },
    /// Several runs at one point of a curve.
    #[error("several runs of {scenario} have {x} = {x_value:?}: select with --where")]
    SamePoint {
        /// The scenario of the curve.
        scenario: String,
        /// The column on the x axis.
        x: String,
        /// The value of these runs.
        x_value: f64,
    },
    /// Several runs in one cell of a map.
    #[error("several runs have {x} = {x_value:?} and {y} = {y_value:?}: select with --where")]
    SameCell {
        /// The column on the x axis.
        x: String,
        /// The x value of these runs.
        x_value: f64,
        /// The column on the y axis.
        y: String,
        /// The y value of these runs.
        y_value: f64,
    },
}

/// The second column without a value, after the first.
struct AlsoOf<'a>(Option<&'a str>);

impl fmt::Display for AlsoOf<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(column) => write!(f, " and one of {column}"),
            None => Ok(()),
        }
    }
}
