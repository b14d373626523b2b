//! Design: the rows per base.

use super::axis::Axis;
use super::sample::Sample;
use crate::run::scenario::Key;
use crate::sweep::error::{AxisProblem, SpecError, SweepError};
use crate::sweep::table::Table;
use std::path::Path;

/// Maximum number of rows (part numbers have six digits).
pub(super) const MAX_ROWS: u64 = 1_000_000_000;

/// Design of the rows of each base.
#[derive(Clone, Debug)]
pub enum Design {
    /// Every combination of the values of some axes; the last axis varies fastest.
    Grid(Vec<Axis>),
    /// Sampled points of some axes.
    Sample(Sample, Vec<Axis>),
    /// The rows of a table.
    Table(Table),
}

impl Design {
    /// The design defined by axes, a sample or a table.
    ///
    /// # Errors
    /// [`SweepError::Spec`] if they exclude each other.
    pub fn new(
        axes: Vec<Axis>,
        sample: Option<Sample>,
        table: Option<Table>,
    ) -> Result<Self, SweepError> {
        match (sample, table) {
            (None, None) => Ok(Self::Grid(axes)),
            (Some(sample), None) => Ok(Self::Sample(sample, axes)),
            (None, Some(table)) if axes.is_empty() => Ok(Self::Table(table)),
            (_, Some(_)) => Err(SpecError::TableWithAxes.into()),
        }
    }

    /// The keys that vary.
    pub(super) fn keys(&self) -> Vec<&'static Key> {
        match self {
            Self::Grid(axes) | Self::Sample(_, axes) => axes.iter().map(|axis| axis.key).collect(),
            Self::Table(table) => table.keys(),
        }
    }

    /// The file of the table.
    pub(super) fn file(&self) -> Option<&Path> {
        match self {
            Self::Table(table) => table.file(),
            Self::Grid(_) | Self::Sample(..) => None,
        }
    }

    /// The number of rows of each base.
    ///
    /// # Errors
    /// [`SweepError::Spec`] for axes that don't form a grid or a sample.
    pub(super) fn rows(&self) -> Result<u64, SweepError> {
        match self {
            Self::Grid(axes) => grid_size(axes),
            Self::Sample(sample, axes) => check_sample(axes).map(|()| sample.count),
            Self::Table(table) => Ok(table.rows()),
        }
    }

    /// Whether every row sets this key.
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
    let mut size: u64 = 1;
    for axis in axes {
        let count = axis
            .count()
            .ok_or_else(|| axis.invalid(AxisProblem::GridWithoutCount(axis.key.path)))?;
        // `Spec::new` refuses what is too large.
        size = size.saturating_mul(count);
    }
    Ok(size)
}

fn check_sample(axes: &[Axis]) -> Result<(), SweepError> {
    if axes.is_empty() {
        return Err(SpecError::SampleWithoutAxis.into());
    }
    match axes.iter().find(|axis| axis.is_counted_range()) {
        Some(axis) => Err(axis.invalid(AxisProblem::SampleWithCount)),
        None => Ok(()),
    }
}
