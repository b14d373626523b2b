//! Low-level reading of MCAP files from any writer, tolerating damage.
//!
//! [`scan`] walks the records, [`layout`] stores the positions of chunks, channels, metadata and attachments, and
//! [`section`] reads the messages of a chunk.

pub(crate) mod attachment;
pub(crate) mod channels;
pub(crate) mod checksum;
pub(crate) mod layout;
pub(crate) mod loss;
pub(crate) mod lz4;
pub(crate) mod record;
pub(crate) mod scan;
pub(crate) mod section;
pub(crate) mod source;
mod zstd;
