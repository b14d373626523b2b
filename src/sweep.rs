//! Sweeps: the outcomes of many runs as a table in Parquet.
//!
//! A [`Spec`] defines the runs: bases, and keys that vary over a grid, a sample or the rows of a table. Row *i* depends
//! only on the spec and *i*. A *part* is [`Sweep::part_rows`] consecutive rows, about 10 s of work; its file depends only
//! on the spec and the part number: the bytes don't depend on threads, machines or interruptions. [`run`] computes what is missing and merges the
//! parts. [`values_of_row`] are those of the scenario of a row, which can be run again.

mod cells;
mod checksum;
mod counts;
mod effort;
mod error;
mod part;
mod reader;
mod reading;
mod row;
mod spec;
mod store;
mod table;
mod work;

pub use crate::archive::caught::is_catching;
pub use cells::{Cells, cells};
pub use counts::{Counts, RowError};
pub use error::{AxisProblem, CellError, FileProblem, SpecError, SweepError, TableError};
pub use part::Sweep;
pub use reading::{Columns, values_of_row};
pub use row::{Run, RunResult, Watch};
pub use spec::Spec;
pub use spec::axis::{Axis, column_name, find_key};
pub use spec::base::Base;
pub use spec::design::Design;
pub use spec::sample::{Method, Sample};
pub use store::parts_directory;
pub use table::Table;
pub use work::{Finished, Options, Shard, remaining_rows, run, threads};
