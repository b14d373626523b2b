//! Design of the rows of each base.

use super::axis::Axis;
use super::error::SweepError;
use super::sample::Sample;
use super::table::Table;
use crate::run::scenario::Key;

/// The most rows of a sweep: parts are numbered with six digits.
pub(super) const MOST_ROWS: u64 = 1_000_000_000;

/// Design of the rows of each base.
#[derive(Clone, Debug)]
pub enum Design {
    /// Every combination of the values of some axes; the last axis varies fastest.
    Grid(Vec<Axis>),
    /// Points chosen among the values of some axes.
    Sample(Sample, Vec<Axis>),
    /// The rows of a table.
    Table(Table),
}

impl Design {
    /// The design that axes, a sample or a table make.
    ///
    /// # Errors
    /// [`SweepError::Spec`] if they exclude each other.
    pub fn of(
        axes: Vec<Axis>,
        sample: Option<Sample>,
        table: Option<Table>,
    ) -> Result<Self, SweepError> {
        match (sample, table) {
            (None, None) => Ok(Self::Grid(axes)),
            (Some(sample), None) => Ok(Self::Sample(sample, axes)),
            (None, Some(table)) if axes.is_empty() => Ok(Self::Table(table)),
            (_, Some(_)) => Err(SweepError::Spec(
                "a table defines all that varies: leave the axes and the sample out".to_owned(),
            )),
        }
    }

    /// The keys that vary.
    pub(super) fn keys(&self) -> Vec<&'static Key> {
        match self {
            Self::Grid(axes) | Self::Sample(_, axes) => axes.iter().map(|axis| axis.key).collect(),
            Self::Table(table) => table.keys(),
        }
    }

    /// The number of rows of each base.
    ///
    /// # Errors
    /// [`SweepError::Spec`] for axes that make no grid or sample.
    pub(super) fn rows(&self) -> Result<u64, SweepError> {
        match self {
            Self::Grid(axes) => grid_size(axes),
            Self::Sample(sample, axes) => check_sample(sample, axes).map(|()| sample.count),
            Self::Table(table) => Ok(table.rows()),
        }
    }

    /// Whether each row has a value for this key, so that none is left to the base.
    pub(super) fn always_has(&self, key: &str) -> bool {
        match self {
            Self::Grid(axes) | Self::Sample(_, axes) => {
                axes.iter().any(|axis| axis.key.path == key)
            }
            Self::Table(table) => table.always_has(key),
        }
    }
}

/// The number of points of a grid.
fn grid_size(axes: &[Axis]) -> Result<u64, SweepError> {
    axes.iter().try_fold(1_u64, |size, axis| {
        let count = axis.count().ok_or_else(|| {
            let Axis { key, text, .. } = axis;
            let name = key.path;
            SweepError::Spec(format!(
                "{name}={text}: a grid needs the number of values, as in {name}=a..b/10 or a..b/10log; a sample does not"
            ))
        })?;
        size.checked_mul(count)
            .filter(|size| *size <= MOST_ROWS)
            .ok_or_else(|| SweepError::Spec(format!("more than {MOST_ROWS} runs")))
    })
}

fn check_sample(sample: &Sample, axes: &[Axis]) -> Result<(), SweepError> {
    let wrong = |reason: String| Err(SweepError::Spec(reason));
    if axes.is_empty() {
        return wrong("a sample needs at least one axis, as in friction.k = 0.01..1".to_owned());
    }
    let (count, most) = (axes.len(), sample.method.most_axes());
    if count > most {
        return wrong(format!(
            "{count} axes are more than the {most} that this method has"
        ));
    }
    match axes.iter().find(|axis| axis.is_counted_range()) {
        Some(Axis { key, text, .. }) => wrong(format!(
            "{}={text}: a sample has its own number of values; write a..b or a..b/log",
            key.path
        )),
        None => Ok(()),
    }
}
