//! Errors of a Rerun recording.

use rerun::external::re_log_encoding::rrd::{CodecError, EncodeError};
use rerun::external::re_sdk_types::SerializationError;
use rerun::log::ChunkError;

use crate::archive::sink::SinkError;

/// The reason why a Rerun recording can't be written.
#[derive(Debug, thiserror::Error)]
pub enum RerunError {
    /// The system refused to write the file or to start a thread.
    #[error("cannot write the Rerun recording: {0}")]
    Io(#[from] std::io::Error),
    /// The encoder failed.
    #[error("cannot write the Rerun recording: {0}")]
    Encode(#[from] EncodeError),
    /// Rows do not form a chunk.
    #[error("cannot form a chunk of the Rerun recording: {0}")]
    Chunk(#[from] ChunkError),
    /// Values can't be serialized.
    #[error("cannot serialize for the Rerun recording: {0}")]
    Serialization(#[from] SerializationError),
    /// The encoder's thread panicked.
    #[error("the thread that writes the Rerun recording has died")]
    Worker,
}

impl From<CodecError> for RerunError {
    fn from(error: CodecError) -> Self {
        Self::Encode(error.into())
    }
}

impl From<RerunError> for SinkError {
    fn from(error: RerunError) -> Self {
        Self::Viewer(Box::new(error))
    }
}
