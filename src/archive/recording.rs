//! Reading recordings back.
//!
//! [`Recording::open`] finds out where everything is in a file, past whatever is damaged, and what
//! kind of file it is. [`Recording::reader`] gives its messages with the very bits that were written,
//! [`Recording::series`] single quantities, [`Overview`] lists what is in it.
//!
//! ```no_run
//! use toprise::archive::recording::Recording;
//! use toprise::telemetry::fields::state;
//!
//! let recording = Recording::open("recordings/paper.mcap".as_ref())?;
//! let theta = recording.series(state::THETA)?;
//! println!("{} {} at {} ns", theta.values[0], theta.field.unit(), theta.times_ns[0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod condition;
mod file;
mod order;
mod overview;
mod reader;
mod series;

pub use self::condition::Condition;
pub use self::file::Recording;
pub use self::order::Misplaced;
pub use self::overview::{ChannelOverview, EventOverview, Overview};
pub use self::reader::{Reader, Selection, Undecoded};
pub use self::series::{Columns, Series, SeriesError};
pub use crate::archive::container::channels::{FileChannel, FileSchema};
pub use crate::archive::container::loss::{Loss, Span};
pub use crate::archive::error::{MessageError, NoScenario, RecordingError};
pub use crate::archive::format::Entries;
