//! Sweeps: the outcomes of many runs as a table in Parquet.
//!
//! A [`Spec`] says which runs: bases, and keys that vary over a grid, a sample or the rows of a table. Row *i* depends on
//! the spec and on *i* alone. A *part* is [`PART_ROWS`] consecutive rows, and its file a pure function of the spec and its
//! number; so whoever computes parts, on however many threads and machines and after however many interruptions, gets
//! the same bytes. [`run`] computes what is missing and merges the parts. [`Recordings`] are those of runs that a
//! [`Choice`] finds in the table.

mod axis;
mod cells;
mod choice;
mod counts;
mod directory;
mod error;
mod part;
mod reading;
mod recordings;
mod row;
mod sample;
mod seal;
mod sobol;
mod spec;
mod store;
mod table;
mod work;

pub use axis::{Axis, column_name, find_key};
pub use cells::{Cells, cells};
pub use choice::Choice;
pub use counts::{Counts, RowError};
pub use error::SweepError;
pub use part::{PART_ROWS, Sweep};
pub use reading::Columns;
pub use recordings::{Recorded, Recordings, check_recordings, recordings_directory};
pub use row::{Run, RunResult, Watch, is_in_row};
pub use sample::Method;
pub use spec::{Base, Design, Spec};
pub use store::parts_directory;
pub use table::Table;
pub use work::{Finished, Options, Shard, left_to_do, run};
