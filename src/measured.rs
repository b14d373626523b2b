//! Measured motions: the signals of tables and recordings.
//!
//! What a table means is declared, in its header or by arguments, not guessed. [`read`] finds columns and topics by their
//! names, and turns their values into SI units. Each [`Signal`] has the times and values of a field of the simulation, with
//! standard deviations, and knows the lines that they come from. A [`FileReading`] has what was read of a file, what was
//! assumed, and what was left out.

mod data;
mod error;
mod layout;
mod member;
mod name;
mod number;
#[cfg(feature = "sweep")]
mod parquet_table;
mod reading;
mod recorded;
mod rows;
mod signal;
mod spec;
mod table;
mod text;
mod unit;

pub use data::{Data, read, read_bytes};
pub use error::{DataError, Place};
pub use layout::{Decimal, Delimiter, Layout, LayoutError};
pub use reading::{ColumnReading, FileReading, SkipReason, SkippedRows};
pub(crate) use signal::median_size;
pub use signal::{Lines, Signal};
pub use spec::SignalSpec;
