//! An MCAP file as a container of records, written by any software: where they stand, past damaged parts.
//!
//! [`scan`] hops from record to record, [`layout`] keeps where the chunks, channels, metadata and attachments are,
//! and [`section`] gives the messages of a chunk.

pub(crate) mod channels;
pub(crate) mod layout;
pub(crate) mod loss;
pub(crate) mod record;
pub(crate) mod scan;
pub(crate) mod section;
pub(crate) mod source;
