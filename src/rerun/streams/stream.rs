//! Rerun recordings that are being written.

use rerun::{EntityPath, RecordingInfo, StoreId};

use crate::rerun::error::{RerunError, ViewerError};
use crate::rerun::output::{Destinations, Output};

/// A Rerun recording that is being written: its content, and where it goes.
///
/// Writing never fails, so other sinks are not affected. [`Self::take_warnings`] returns problems with the
/// viewer, [`Self::finish`] errors of the file.
pub struct Stream<C> {
    pub(super) content: C,
    pub(super) output: Output,
    /// Time of the latest message, ns.
    pub(super) end_ns: u64,
}

/// The content of a recording.
pub trait StreamContent {
    /// Adds content derived from the whole run, up to the last message, and sends all pending rows.
    fn finish(&mut self, end_ns: u64, output: &mut Output);
}

impl<C: StreamContent> Stream<C> {
    /// Opens the destinations, and sends the name and the static content.
    pub(super) fn open(
        store: StoreId,
        name: &str,
        destinations: Destinations,
        content: impl FnOnce(&mut Output) -> C,
    ) -> Self {
        let mut output = Output::open(store, destinations);
        // Viewers show it instead of the identifier.
        let name = RecordingInfo::update_fields().with_name(name);
        output.send_static(EntityPath::properties(), &name);
        Self {
            content: content(&mut output),
            output,
            end_ns: 0,
        }
    }

    /// Whether data is being sent to a viewer, as far as is known.
    pub fn is_live(&self) -> bool {
        self.output.is_live()
    }

    /// Viewer warnings since the last call, including a missing viewer.
    pub fn take_warnings(&mut self) -> Vec<ViewerError> {
        std::mem::take(&mut self.output.warnings)
    }

    /// Sends all remaining data and completes the file with its footer.
    ///
    /// Returns pending warnings. An unresponsive viewer is disconnected after a few seconds.
    ///
    /// # Errors
    /// The first [`RerunError`]; the file then holds what was written before.
    pub fn finish(mut self) -> Result<Vec<ViewerError>, RerunError> {
        self.content.finish(self.end_ns, &mut self.output);
        self.output.finish()
    }
}
