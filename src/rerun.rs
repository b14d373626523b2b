//! Rerun recordings of runs: all channels, the 3D scene and a layout.
//!
//! [`RerunSink`] writes one run, [`ExplainedSink`] with the reason for its motion, [`PairSink`] two runs that are compared. Both are [`Stream`]s, which go into an
//! `.rrd` file, to a live viewer, or to both.
//!
//! Related numbers share an entity, `{topic}/{plot}`, with several instances and static names and colours; this is much
//! smaller and faster than one entity per number. Rows are collected into chunks of 4096 per entity. In a paced run a
//! flush sends the latest rows to the viewer; the file still receives them in full chunks, so pacing
//! doesn't change it.

mod blueprint;
mod entity;
mod error;
mod identity;
mod importer;
mod measurement;
mod output;
mod pair;
mod palette;
mod plots;
mod role;
mod scene;
mod streams;
mod style;

pub use self::error::{RerunError, ViewerError};
pub use self::identity::magnitude::Magnitudes;
pub use self::identity::{Geometry, Identity, Playback, StoreNames};
pub use self::importer::{ImportError, import};
pub use self::measurement::{MeasuredSignal, MeasuredValue, Measurement};
pub use self::output::Destinations;
pub use self::output::viewer::Live;
pub use self::pair::PairIdentity;
pub use self::streams::explained::ExplainedSink;
pub use self::streams::pair::PairSink;
pub use self::streams::run::RerunSink;
pub use self::streams::stream::Stream;
