//! The telemetry of a run: recorded channels, defined in one table.
//!
//! [`table`] declares each channel once: its topic and, for each field, the name, quantity, frame, description and
//! source in a sample. Messages and their encodings ([`encoding`]: [`json`] and [`protobuf`]), schemas ([`schema`]),
//! the content digest ([`digest`]), MCAP channels and Rerun entities are derived from it. [`fields`] has typed handles
//! of its topics and fields for code that reads messages.
//!
//! [`RunMessages`] simulates a run and yields its messages. Sinks receive only [`Message`]s: rows of numbers and texts in the order of [`channels`].

mod channel;
mod decoding;
pub mod digest;
pub mod encoding;
mod event;
pub mod fields;
mod frame;
mod handle;
pub mod json;
mod logging;
mod message;
pub mod proportions;
pub mod protobuf;
mod quantity;
mod sampled;
pub mod schema;
pub mod side;
mod stream;
pub mod supplement;
pub mod table;
mod template;
mod topic;
pub mod views;
mod wire;

pub use self::channel::{ChannelInfo, Content, Leaf, Member};
pub use self::event::event_sentence;
pub(crate) use self::event::event_state;
pub use self::logging::{Telemetry, TelemetryError};
pub use self::message::{Message, Numbers};
pub use self::quantity::Quantity;
pub use self::stream::{RunError, RunMessages};
pub use self::table::channels;
pub use self::topic::{Topic, Topics, UnknownTopic};
