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

//! On WebAssembly there is no [`cli`], and files can't be read or written: [`archive::writer`] writes into memory.

#![forbid(unsafe_code)]

#[cfg(all(target_arch = "x86", not(target_feature = "sse2")))]
compile_error!(
    "the x87 unit keeps more digits than a double has, so recordings would not have the bytes that they have elsewhere: \
     build for a target with SSE2, such as i686-unknown-linux-gnu"
);

#[cfg(all(feature = "sweep", target_endian = "big"))]
compile_error!(
    "on a big-endian machine the parquet crate writes files that can't be read: build without the feature `sweep` \
     (--no-default-features)"
);

pub mod analysis;
pub mod archive;
#[cfg(not(target_family = "wasm"))]
pub mod cli;
pub mod physics;
#[cfg(feature = "rerun")]
pub mod rerun;
pub mod run;
#[cfg(feature = "sweep")]
pub mod sweep;
pub mod telemetry;
