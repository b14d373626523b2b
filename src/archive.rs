//! Recordings as files: writing, publishing, reading, checking, converting, recovering and replaying MCAP files.

pub mod check;
pub(crate) mod container;
pub(crate) mod container_check;
pub mod convert;
pub(crate) mod error;
pub mod format;
pub mod given;
pub mod memory;
pub mod publish;
pub mod recording;
pub mod recover;
pub mod replay;
pub mod sink;
pub mod writer;
