//! toprise simulates a heavy symmetric top with a spherical peg and sliding friction, and records states, torques and
//! slip velocities to MCAP files and Rerun.
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
//! Twelve modules: [`words`] (sentences as values), [`physics`] (mechanics), [`run`] (scenarios, simulation),
//! [`telemetry`] (channels, encodings), [`archive`] (recordings, verify), [`analysis`] (diff, explain), `sweep` (tables of
//! runs; feature `sweep`), `measured` (signals of tables and recordings; feature `fit`), `fit` (friction from measured
//! motions; feature `fit`), `rerun` (Rerun viewer; feature `rerun`), [`figures`] (drawings for print), `cli` (the program;
//! feature `cli`). Each uses only those before it; `analysis`, `sweep`, `fit` and `rerun` don't use each other.
//!
//! On WebAssembly there is no file access: [`archive::writer`] writes to memory.

#![forbid(unsafe_code)]
// docs.rs names the feature that each module needs.
#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(all(target_arch = "x86", not(target_feature = "sse2")))]
compile_error!(
    "x87 floating point has excess precision, so recordings would not be reproducible: \
     build for a target with SSE2, such as i686-unknown-linux-gnu"
);

#[cfg(all(feature = "sweep", target_endian = "big"))]
compile_error!(
    "the parquet crate writes unreadable files on big-endian machines: build without the feature `sweep` \
     (--no-default-features --features cli)"
);

pub mod analysis;
pub mod archive;
#[cfg(feature = "cli")]
pub mod cli;
pub mod figures;
#[cfg(feature = "fit")]
pub mod fit;
#[cfg(feature = "fit")]
pub mod measured;
pub mod physics;
#[cfg(feature = "rerun")]
pub mod rerun;
pub mod run;
#[cfg(feature = "sweep")]
pub mod sweep;
pub mod telemetry;
pub mod words;
