//! Reading recordings back.
//!
//! [`Recording::open`] scans a file, tolerating damage, and classifies it. [`Recording::reader`] returns its messages
//! bit-exactly; [`Overview`] lists the content.
//!
//! ```no_run
//! use toprise::archive::recording::{Recording, Selection};
//! use toprise::telemetry::fields::{STATE, state};
//!
//! let recording = Recording::open("recordings/paper.mcap".as_ref())?;
//! let mut reader = recording.reader(Selection::default());
//! while let Some(message) = reader.next().transpose()? {
//!     if message.topic() == STATE {
//!         println!("{} rad at {} ns", state::THETA.of(&message), message.time_ns);
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod batch;
mod clock;
mod condition;
mod content;
mod contradiction;
mod digest;
mod file;
mod loader;
mod missing;
mod order;
mod overview;
mod reader;
mod selection;
mod statistics;
mod windows;

pub use self::clock::Relogged;
pub use self::condition::Condition;
pub(crate) use self::content::ContentCheck;
pub use self::content::Undecodable;
pub use self::file::Recording;
pub use self::missing::Missing;
pub use self::order::Misplaced;
pub use self::overview::{AttachmentOverview, ChannelOverview, EventOverview, Overview};
pub use self::reader::{Reader, Undecoded};
pub use self::selection::Selection;
pub use self::statistics::StatisticsFault;
pub use crate::archive::container::channels::{FileChannel, FileSchema};
pub use crate::archive::container::loss::{Loss, Losses};
pub use crate::archive::error::{MessageError, RecordingError};
pub use crate::archive::format::Entries;
