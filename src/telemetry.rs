//! The telemetry of a run: recorded channels, defined in one table.
//!
//! [`table`] declares each channel once: its topic and, for each field, the name, quantity, frame, description and
//! source in a sample. Messages and their encodings ([`encoding`]: [`json`] and [`protobuf`]), schemas ([`schema`]),
//! the content digest ([`digest`]), MCAP channels and Rerun entities are derived from it. [`fields`] has typed handles
//! of its topics and fields for code that reads messages.
//!
//! [`RunMessages`] simulates a run and yields its messages. Sinks receive only [`Message`]s: rows of numbers and texts in the order of [`channels`].

pub mod arrows;
pub mod digest;
pub mod encoding;
mod event;
pub mod fields;
mod handle;
mod logging;
mod message;
pub mod proportions;
pub mod side;
mod stream;
pub mod supplement;
pub mod table;
mod topic;
pub mod views;

pub use self::encoding::{json, protobuf, schema};
pub use self::event::event_sentence;
pub(crate) use self::event::event_state;
pub use self::logging::{Telemetry, TelemetryError};
pub use self::message::{Message, Numbers};
pub use self::stream::{RunError, RunMessages};
pub use self::table::channel::{ChannelInfo, Content, Leaf, Member};
pub use self::table::channels;
pub use self::table::quantity::Quantity;
pub use self::topic::{Topic, Topics, UnknownTopic};
