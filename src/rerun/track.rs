//! Rows that wait until there are enough of them for a chunk.

use rerun::external::re_log_types::EntityPath;
use rerun::{Scalars, SerializedComponentColumn, TextLog};

use super::error::RerunError;
use super::outlet::{Outlet, To};

/// Rows of one chunk: enough that the cost per chunk doesn't matter, few enough to bound memory.
const CHUNK_ROWS: usize = 4096;

/// Which of the waiting rows are sent, and where.
#[derive(Clone, Copy)]
pub enum Flush {
    /// Those that the viewer does not have yet, to the viewer; the file gets them later, in longer chunks.
    Viewer,
    /// All, to every destination that does not have them yet.
    All,
}

/// A collection of rows that wait until they are sent.
pub trait Collect {
    /// Sends waiting rows.
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush);
}

/// The content of a recording, with its layout.
pub trait Content: Collect {
    /// Changes the layout when the duration is known, s.
    fn change_layout(&self, duration: f64, outlet: &mut Outlet);
}

impl<C: Collect> Collect for Option<C> {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        if let Some(collected) = self {
            collected.flush(outlet, flush);
        }
    }
}

impl<C: Collect> Collect for Vec<C> {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        for collected in self {
            collected.flush(outlet, flush);
        }
    }
}

/// Rows of components of an entity.
pub(super) trait Rows {
    /// The components of the rows from `start` on.
    fn columns(&self, start: usize) -> Result<Vec<SerializedComponentColumn>, RerunError>;
    /// Removes all rows, and keeps their memory for the next ones.
    fn clear(&mut self);
}

/// The rows of one entity that are not yet in the file.
pub(super) struct Track<R> {
    entity: EntityPath,
    times: Vec<i64>,
    /// Number of rows that the viewer has.
    shown: usize,
    rows: R,
}

impl<R: Rows> Track<R> {
    /// A track without rows; `rows` determines their kind.
    pub(super) fn new(entity: impl Into<EntityPath>, rows: R) -> Self {
        Self {
            entity: entity.into(),
            times: Vec::with_capacity(CHUNK_ROWS),
            shown: 0,
            rows,
        }
    }

    /// Adds the row that `fill` writes, at a simulation time in ns, and sends a chunk if it is full.
    pub(super) fn push(&mut self, outlet: &mut Outlet, time_ns: u64, fill: impl FnOnce(&mut R)) {
        // A duration of 292 years is beyond any run; saturating keeps the order.
        self.times.push(i64::try_from(time_ns).unwrap_or(i64::MAX));
        fill(&mut self.rows);
        if self.times.len() == CHUNK_ROWS {
            self.complete(outlet);
        }
    }

    fn show(&mut self, outlet: &mut Outlet) {
        if outlet.is_live() && self.shown < self.times.len() {
            self.send(To::Viewer, self.shown, outlet);
            self.shown = self.times.len();
        }
    }

    /// Sends all rows as one chunk: to the viewer too, unless it has some of them.
    fn complete(&mut self, outlet: &mut Outlet) {
        if self.times.is_empty() {
            return;
        }
        if self.shown == 0 {
            self.send(To::Both, 0, outlet);
        } else {
            self.show(outlet);
            self.send(To::File, 0, outlet);
        }
        self.times.clear();
        self.shown = 0;
        self.rows.clear();
    }

    fn send(&self, to: To, start: usize, outlet: &mut Outlet) {
        let columns = self.rows.columns(start);
        outlet.send_rows(to, &self.entity, &self.times[start..], columns);
    }
}

impl<R: Rows> Collect for Track<R> {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        match flush {
            Flush::Viewer => self.show(outlet),
            Flush::All => self.complete(outlet),
        }
    }
}

/// Rows of numbers: those of one plot.
pub(super) struct Numbers {
    width: usize,
    values: Vec<f64>,
}

impl Numbers {
    /// No rows yet, of `width` numbers each.
    pub(super) fn new(width: usize) -> Self {
        Self {
            width,
            values: Vec::with_capacity(width * CHUNK_ROWS),
        }
    }

    /// Adds a row.
    pub(super) fn extend(&mut self, row: impl Iterator<Item = f64>) {
        self.values.extend(row);
    }
}

impl Rows for Numbers {
    fn columns(&self, start: usize) -> Result<Vec<SerializedComponentColumn>, RerunError> {
        let values = &self.values[start * self.width..];
        let lengths = std::iter::repeat_n(self.width, values.len() / self.width);
        let scalars = Scalars::new(values.iter().copied());
        Ok(scalars.columns(lengths)?.collect())
    }

    fn clear(&mut self) {
        self.values.clear();
    }
}

/// Rows of a log: a sentence each.
#[derive(Default)]
pub(super) struct Texts(Vec<String>);

impl Texts {
    /// Adds a row.
    pub(super) fn push(&mut self, text: String) {
        self.0.push(text);
    }
}

impl Rows for Texts {
    fn columns(&self, start: usize) -> Result<Vec<SerializedComponentColumn>, RerunError> {
        let texts = self.0[start..].iter().map(String::as_str);
        let log = TextLog::update_fields().with_many_text(texts);
        Ok(log.columns_of_unit_batches()?.collect())
    }

    fn clear(&mut self) {
        self.0.clear();
    }
}
