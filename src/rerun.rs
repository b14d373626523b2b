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
mod comparison;
mod entities;
mod entity;
mod error;
mod events;
mod explained;
mod identity;
mod importer;
mod magnitude;
mod measured;
mod measurement;
mod message;
mod outline;
mod output;
mod pair;
mod palette;
mod plots;
mod preview;
mod properties;
mod recorded_fit;
mod role;
mod rrd;
mod scale;
mod scene;
mod sink;
mod style;
mod track;
mod viewer;

pub use self::comparison::PairSink;
pub use self::entities::RerunSink;
pub use self::error::{RerunError, ViewerError};
pub use self::explained::ExplainedSink;
pub use self::identity::{Geometry, Identity, Playback, StoreNames};
pub use self::importer::{ImportError, import};
pub use self::magnitude::Magnitudes;
pub use self::measurement::{MeasuredSignal, MeasuredValue, Measurement};
pub use self::output::Destinations;
pub use self::pair::PairIdentity;
pub use self::sink::Stream;
pub use self::viewer::Live;
