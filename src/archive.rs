//! Recordings as files: writing, publishing, reading, replaying and verifying MCAP files.

#[cfg(feature = "sweep")]
pub(crate) mod caught;
pub(crate) mod container;
pub(crate) mod error;
pub mod format;
pub mod input;
pub mod memory;
pub mod pipeline;
pub mod provenance;
pub mod publish;
pub mod recording;
pub mod replay;
pub mod sink;
pub mod supplements;
pub mod verify;
pub mod writer;
