//! Errors of a Rerun recording.

use rerun::SpawnError;
use rerun::external::re_log_encoding::rrd::EncodeError;
use rerun::external::re_sdk_types::SerializationError;
use rerun::external::re_uri;
use rerun::log::ChunkError;
use rerun::sink::SinkFlushError;
use std::io;
use std::time::Duration;

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

/// The reason why a viewer shows nothing, or only part of a run.
#[derive(Debug, thiserror::Error)]
pub enum ViewerError {
    /// Not an address.
    #[error("{address:?} is not a valid Rerun viewer address: {reason}")]
    Address {
        /// The address.
        address: String,
        /// The error in it.
        reason: Box<re_uri::Error>,
    },
    /// Nothing listens at the address.
    #[error("no Rerun viewer at {address}: {reason}")]
    Absent {
        /// The address.
        address: String,
        /// The failure of the last attempt to connect.
        reason: io::Error,
    },
    /// No viewer is installed.
    #[error(
        "no executable `rerun` in PATH. Install the viewer with
    pip install rerun-sdk==0.36.3
or
    cargo install rerun-cli --version 0.36.3 --locked"
    )]
    NotInstalled,
    /// The viewer can't be started.
    #[error(transparent)]
    Spawn(SpawnError),
    /// The thread that sends to the viewer can't be started.
    #[error("cannot start a thread for the Rerun viewer: {0}")]
    Thread(io::Error),
    /// The connection broke while data was sent.
    #[error(
        "the connection to the Rerun viewer at {address} was lost (the connection broke); it shows only part of the run"
    )]
    Disconnected {
        /// The address.
        address: String,
    },
    /// The last messages did not arrive.
    #[error(
        "the connection to the Rerun viewer at {address} was lost ({reason}); it shows only part of the run"
    )]
    Flush {
        /// The address.
        address: String,
        /// The reason.
        reason: SinkFlushError,
    },
    /// The viewer stopped reading.
    #[error(
        "the Rerun viewer at {address} did not respond for {} s and was disconnected",
        patience.as_secs()
    )]
    Stalled {
        /// The address.
        address: String,
        /// The time for which it did not read.
        patience: Duration,
    },
    /// The viewer did not read the end in time.
    #[error(
        "the Rerun viewer at {address} did not accept the end of the recording within {} s",
        patience.as_secs()
    )]
    Unfinished {
        /// The address.
        address: String,
        /// The time that it had.
        patience: Duration,
    },
}

impl ViewerError {
    /// Whether the viewer was there, but went away before it had everything.
    pub fn is_loss(&self) -> bool {
        match self {
            Self::Disconnected { .. }
            | Self::Flush { .. }
            | Self::Stalled { .. }
            | Self::Unfinished { .. } => true,
            Self::Address { .. }
            | Self::Absent { .. }
            | Self::NotInstalled
            | Self::Spawn(_)
            | Self::Thread(_) => false,
        }
    }
}
