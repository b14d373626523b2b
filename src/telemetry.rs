//! The telemetry of a run: one table defines what is logged, and everything else follows from it.
//!
//! [`table`] declares each channel once: its topic, and for each field the name, quantity, frame, meaning and
//! where in a sample it comes from. From the table follow the messages, written and read ([`encoding`]: [`json`]
//! and [`protobuf`]), their schemas ([`schema`]), the content digest ([`digest`]), the MCAP channels and the Rerun
//! entities. [`fields`] names its topics and fields for the code that reads messages.
//!
//! Sinks see only [`Message`]s: rows of numbers and texts in the order of [`channels`].

mod channel;
mod decoding;
pub mod digest;
pub mod encoding;
pub mod fields;
mod handle;
pub mod json;
mod logging;
mod message;
pub mod proportions;
pub mod protobuf;
mod quantity;
pub mod schema;
pub mod side;
pub mod table;
mod topic;
pub mod views;
mod wire;

pub use self::channel::{ChannelInfo, Content, Leaf, Member};
pub use self::logging::{Telemetry, TelemetryError};
pub use self::message::{Message, Numbers};
pub use self::quantity::Quantity;
pub use self::table::channels;
pub use self::topic::{Topic, Topics, UnknownTopic};
