//! Errors of a Rerun recording.

use rerun::external::re_log_encoding::rrd::EncodeError;
use rerun::external::re_sdk_types::SerializationError;
use rerun::log::ChunkError;

/// The reason why a Rerun recording can't be written.
#[derive(Debug, thiserror::Error)]
pub enum RerunError {
    /// The file can't be written, or a thread can't be started.
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
    #[error("the thread that writes the Rerun recording panicked")]
    Worker,
}
