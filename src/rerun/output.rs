//! The destinations of the chunks of a recording: a file, a viewer, or both.
//!
//! They are independent. Viewer failures become warnings; a file error is returned by [`Output::finish`].

pub(super) mod message;
mod rrd;
pub(super) mod track;
pub(super) mod viewer;

use std::cell::RefCell;
use std::fs::File;
use std::rc::Rc;

use rerun::external::re_log_types::LogMsg;
use rerun::{AsComponents, EntityPath, SerializedComponentColumn, StoreId, TimePoint};

use self::message::{Ids, opening, rows, single_row};
use self::rrd::RrdFile;
use self::viewer::{Live, LiveDestination};
use super::error::{RerunError, ViewerError};

/// The destinations of a recording. With neither, nothing is kept.
#[derive(Debug, Default)]
pub struct Destinations {
    /// An empty file, opened for writing, for an `.rrd` recording.
    pub file: Option<File>,
    /// A viewer to send to.
    pub live: Option<Live>,
}

/// Destinations of a message.
#[derive(Clone, Copy)]
pub(super) enum Destination {
    /// The viewer only; the file gets the same rows later in longer chunks.
    Viewer,
    /// The file only; the viewer already has the rows.
    File,
    /// Both.
    Both,
}

/// Buffered rows.
pub(super) trait Pending {
    /// Sends those that the viewer does not have yet, to the viewer; the file gets them later, in longer chunks.
    fn show(&mut self, output: &mut Output);
    /// Sends all, to every destination that does not have them yet.
    fn complete(&mut self, output: &mut Output);
}

/// Components of rows.
pub(super) type ComponentColumns = Result<Vec<SerializedComponentColumn>, RerunError>;

/// Numbers the chunks of one recording and passes them to its destinations.
pub struct Output {
    pub(super) store: StoreId,
    ids: Ids,
    live_ids: Ids,
    file: Option<RrdFile>,
    /// The first error.
    failure: Option<RerunError>,
    live: Option<LiveDestination>,
    /// Warnings about the viewer that have not been taken yet.
    pub(super) warnings: Vec<ViewerError>,
    pending: Vec<Rc<RefCell<dyn Pending>>>,
}

impl Output {
    /// Opens a store in all destinations.
    pub(super) fn open(store: StoreId, destinations: Destinations) -> Self {
        let mut output = Self {
            store,
            ids: Ids::RECORDING,
            live_ids: Ids::LIVE,
            file: None,
            failure: None,
            live: None,
            warnings: Vec::new(),
            pending: Vec::new(),
        };
        match destinations.file.map(RrdFile::open) {
            Some(Ok(file)) => output.file = Some(file),
            Some(Err(error)) => output.fail(error),
            None => {}
        }
        match destinations.live.map(|live| LiveDestination::open(&live)) {
            Some(Ok(live)) => output.live = Some(live),
            Some(Err(warning)) => output.warnings.push(warning),
            None => {}
        }
        let opening = opening(&output.store, &mut output.ids);
        output.send_to(Destination::Both, Ok(opening));
        output
    }

    /// Registers rows that are sent later.
    pub(super) fn register(&mut self, rows: Rc<RefCell<dyn Pending>>) {
        self.pending.push(rows);
    }

    /// Sends waiting rows to the viewer.
    pub(super) fn show(&mut self) {
        // A copy of the list, because the rows borrow all of the output to send themselves.
        for rows in self.pending.clone() {
            rows.borrow_mut().show(self);
        }
    }

    /// Sends all waiting rows.
    pub(super) fn complete(&mut self) {
        for rows in self.pending.clone() {
            rows.borrow_mut().complete(self);
        }
    }

    /// Whether data is being sent to a viewer, as far as is known.
    pub(super) fn is_live(&self) -> bool {
        self.live.is_some()
    }

    /// Sends static components.
    pub(super) fn send_static(
        &mut self,
        entity: impl Into<EntityPath>,
        components: &dyn AsComponents,
    ) {
        let time = TimePoint::STATIC;
        let message = single_row(&self.store, &mut self.ids, entity, time, components);
        self.send_to(Destination::Both, message);
    }

    /// Sends rows of an entity, with their times in ns.
    pub(super) fn send_rows(
        &mut self,
        to: Destination,
        entity: &EntityPath,
        times: &[i64],
        columns: ComponentColumns,
    ) {
        let ids = match to {
            // The identifiers in a file must not depend on whether a viewer watches.
            Destination::Viewer => &mut self.live_ids,
            Destination::File | Destination::Both => &mut self.ids,
        };
        let message = columns.and_then(|columns| rows(&self.store, ids, entity, times, columns));
        self.send_to(to, message);
    }

    /// Sends the messages of a layout.
    pub(super) fn send_layout(
        &mut self,
        to: Destination,
        messages: Vec<Result<LogMsg, RerunError>>,
    ) {
        for message in messages {
            self.send_to(to, message);
        }
    }

    /// Sends a message to some of the destinations.
    fn send_to(&mut self, to: Destination, message: Result<LogMsg, RerunError>) {
        match (to, message) {
            (Destination::Viewer, Ok(message)) => self.feed_viewer(message),
            (Destination::File, Ok(message)) => self.write_file(message),
            (Destination::Both, Ok(message)) => {
                self.feed_viewer(message.clone());
                self.write_file(message);
            }
            (_, Err(error)) => self.fail(error),
        }
    }

    fn write_file(&mut self, message: LogMsg) {
        if let Some(file) = self.file.take_if(|file| !file.send(message)) {
            // The queue takes no more because its thread has ended; joining the thread returns the reason.
            self.fail(file.finish().err().unwrap_or(RerunError::Worker));
        }
    }

    fn feed_viewer(&mut self, message: LogMsg) {
        if let Some(live) = &self.live
            && let Err(warning) = live.send(message)
        {
            self.warnings.push(warning);
            self.live = None;
        }
    }

    /// Stores an error for [`Self::finish`] and stops writing the file.
    fn fail(&mut self, error: RerunError) {
        self.file = None;
        self.failure.get_or_insert(error);
    }

    /// Completes all destinations. Returns pending warnings.
    pub(super) fn finish(self) -> Result<Vec<ViewerError>, RerunError> {
        let file = match self.failure {
            Some(error) => Err(error),
            None => self.file.map_or(Ok(()), RrdFile::finish),
        };
        // The viewer gets its end even if the file has failed.
        let mut warnings = self.warnings;
        if let Some(Err(warning)) = self.live.map(LiveDestination::finish) {
            warnings.push(warning);
        }
        file.map(|()| warnings)
    }
}
