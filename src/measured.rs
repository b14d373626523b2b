//! Measured motions: the signals of tables and recordings.
//!
//! [`read`] finds columns and topics by their names, and turns their values into SI units. Each [`Signal`] has the times
//! and values of a field of the simulation, with standard deviations, and knows the lines that they come from.

mod cell;
mod column;
mod data;
mod delimiter;
mod error;
mod header;
#[cfg(feature = "sweep")]
mod parquet_table;
mod place;
mod recorded;
mod signal;
mod table;
mod text_table;
mod unit;

pub use data::{Data, read, read_bytes};
pub use error::DataError;
pub use place::Place;
#[cfg(test)]
pub(crate) use signal::Clock;
pub use signal::{Lines, Signal, SignalSpec};
pub(crate) use signal::{is_turning, median_size, unwrap};
pub(crate) use unit::{Dimension, split_header};
