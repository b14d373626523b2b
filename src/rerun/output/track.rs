//! Buffers of rows that are sent as chunks.

use std::cell::RefCell;
use std::rc::Rc;

use rerun::external::re_log_types::EntityPath;

use crate::rerun::output::{ComponentColumns, Destination, Output, Pending};

/// Rows per chunk: as fast as larger chunks, and five times as fast as chunks of 100 rows.
const CHUNK_ROWS: usize = 4096;

/// The rows of one entity, which the output flushes.
pub(in crate::rerun) struct Track<R>(Rc<RefCell<PendingRows<R>>>);

/// Converts the values of some rows to components.
type Serialize<R> = dyn Fn(&[R]) -> ComponentColumns;

/// The rows of an entity that are not yet in the file.
struct PendingRows<R> {
    entity: EntityPath,
    times: Vec<i64>,
    /// Values, as many for each row.
    values: Vec<R>,
    /// Number of rows that the viewer has.
    shown: usize,
    columns: Box<Serialize<R>>,
}

impl<R: 'static> Track<R> {
    /// An empty track; `columns` creates its components.
    pub(in crate::rerun) fn new(
        entity: impl Into<EntityPath>,
        columns: impl Fn(&[R]) -> ComponentColumns + 'static,
        output: &mut Output,
    ) -> Self {
        let rows = Rc::new(RefCell::new(PendingRows {
            entity: entity.into(),
            times: Vec::with_capacity(CHUNK_ROWS),
            values: Vec::with_capacity(CHUNK_ROWS),
            shown: 0,
            columns: Box::new(columns),
        }));
        output.register(Rc::clone(&rows) as _);
        Self(rows)
    }

    /// Adds a row at a simulation time in ns, and sends a chunk if it is full.
    pub(in crate::rerun) fn push(
        &self,
        output: &mut Output,
        time_ns: u64,
        row: impl IntoIterator<Item = R>,
    ) {
        let mut rows = self.0.borrow_mut();
        // Saturates at 292 years.
        rows.times.push(i64::try_from(time_ns).unwrap_or(i64::MAX));
        rows.values.extend(row);
        if rows.times.len() == CHUNK_ROWS {
            rows.complete(output);
        }
    }
}

impl<R> PendingRows<R> {
    fn send(&self, to: Destination, start: usize, output: &mut Output) {
        let width = self.values.len() / self.times.len();
        let columns = (self.columns)(&self.values[start * width..]);
        output.send_rows(to, &self.entity, &self.times[start..], columns);
    }
}

impl<R> Pending for PendingRows<R> {
    fn show(&mut self, output: &mut Output) {
        if output.is_live() && self.shown < self.times.len() {
            self.send(Destination::Viewer, self.shown, output);
            self.shown = self.times.len();
        }
    }

    /// Sends all rows as one chunk: to the viewer too, unless it has some of them.
    fn complete(&mut self, output: &mut Output) {
        if self.times.is_empty() {
            return;
        }
        // A viewer keeps all that it is sent: it would have these rows twice.
        if self.shown == 0 {
            self.send(Destination::Both, 0, output);
        } else {
            self.show(output);
            self.send(Destination::File, 0, output);
        }
        self.times.clear();
        self.values.clear();
        self.shown = 0;
    }
}
