//! toprise simulates how a heavy symmetric top with a spherical peg rises under slipping friction, and
//! logs every state, every torque component and the slip velocity of the contact point into MCAP files
//! and a Rerun stream.
//!
//! ```
//! use toprise::run::scenario::Preset;
//! use toprise::run::simulation::{Record, Simulation};
//!
//! let mut values = Preset::find("paper")?.values()?;
//! values.set("stop.duration", "0.1")?;
//! let scenario = toprise::run::scenario::Scenario::new(values)?;
//! let mut samples = 0;
//! for record in Simulation::new(&scenario)? {
//!     if let Record::Sample(sample) = record? {
//!         samples += 1;
//!         assert!(sample.angles.theta > 0.49);
//!     }
//! }
//! assert_eq!(samples, 101);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Eight rooms, each of which uses only those before it: [`physics`], the mechanics; [`run`], scenarios and their
//! simulation; [`telemetry`], the table of what is logged; [`archive`], recordings as files; [`analysis`], what is
//! asked of runs; `sweep`, tables of many runs (feature `sweep`); `rerun`, the stream for the Rerun viewer (feature `rerun`); [`cli`], the program.

#![forbid(unsafe_code)]

pub mod analysis;
pub mod archive;
pub mod cli;
pub mod physics;
#[cfg(feature = "rerun")]
pub mod rerun;
pub mod run;
#[cfg(feature = "sweep")]
pub mod sweep;
pub mod telemetry;
