//! toprise simulates how a heavy symmetric top with a spherical peg rises under slipping friction, and
//! logs every state, every torque component and the slip velocity of the contact point into MCAP files
//! and a Rerun stream.
//!
//! ```
//! use toprise::scenario::Preset;
//! use toprise::simulation::{Record, Simulation};
//!
//! let mut values = Preset::find("paper")?.values()?;
//! values.set("stop.duration", "0.1")?;
//! let scenario = toprise::scenario::Scenario::new(values)?;
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
//! From the bottom up: [`math`], [`integrate`] and [`kinematics`]; [`friction`] and [`top`];
//! [`dynamics`], the equations of motion; [`scenario`], what defines a run; [`simulation`], the stream
//! of samples and events; [`telemetry`], the table of what is logged; [`sink`] and [`recording`],
//! writing and reading back; [`diff`], what differs between two runs; [`figures`], for print; [`cli`], the program.

pub mod cli;
pub mod convert;
pub mod course;
pub mod diff;
pub mod drawing;
pub mod dynamics;
pub mod explain;
pub mod figures;
pub mod friction;
pub mod integrate;
pub mod kinematics;
pub mod math;
pub(crate) mod phrase;
pub mod recording;
pub mod recover;
pub mod scenario;
pub mod simulation;
pub mod sink;
pub mod subject;
pub mod telemetry;
pub mod top;
pub mod verify;
pub mod view;
