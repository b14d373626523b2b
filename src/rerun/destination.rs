//! Where the chunks of a recording go: into a file, to a viewer, or to both.
//!
//! The file is what must survive: its errors are returned to the caller. The viewer is a guest:
//! whatever happens to it becomes a warning.

use std::fs::File;
use std::io::{BufWriter, IntoInnerError};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use rerun::external::re_log_encoding::{Encoder, rrd::EncodingOptions};
use rerun::external::re_log_types::{LogMsg, SetStoreInfo, StoreInfo, StoreSource};
use rerun::external::re_tuid::Tuid;
use rerun::log::{Chunk, ChunkId, RowId};
use rerun::{AsComponents, EntityPath, SerializedComponentColumn, StoreId, TimeColumn, TimePoint};

use super::RerunError;
use super::viewer::{Live, LiveDestination};

/// The timeline of every recording: simulation time as a duration in nanoseconds.
pub(super) const TIMELINE: &str = "sim_time";

/// Messages that may wait for a worker thread; at most about 200 kB each.
pub(super) const QUEUE: usize = 64;
/// Where a recording goes. With neither, nothing is kept.
#[derive(Debug, Default)]
pub struct Destinations {
    /// An empty file, opened for writing, for an `.rrd` recording.
    pub file: Option<File>,
    /// A viewer to feed.
    pub live: Option<Live>,
}

/// Hands out chunk identifiers that depend on nothing but their order.
#[derive(Debug)]
pub(super) struct Ids(u64);

impl Ids {
    /// Chunks that are the same for all destinations.
    pub(super) const RECORDING: Self = Self(0);
    /// Chunks of a paced run, cut for the viewer only.
    const LIVE: Self = Self(1 << 62);
    /// Chunks of the blueprint.
    pub(super) const BLUEPRINT: Self = Self(1 << 61);

    /// The next identifier; the rows of its chunk count up in the lower half.
    pub(super) fn next(&mut self) -> Tuid {
        self.0 += 1;
        Tuid::from_nanos_and_inc(self.0, 0)
    }
}

/// The message that opens a store.
pub(super) fn opening(store: &StoreId, ids: &mut Ids) -> LogMsg {
    let source = StoreSource::Other("toprise".to_owned());
    LogMsg::SetStoreInfo(SetStoreInfo {
        row_id: ids.next(),
        info: StoreInfo::new(store.clone(), source),
    })
}

/// One row of `components` at `time`.
pub(super) fn single_row(
    store: &StoreId,
    ids: &mut Ids,
    entity: impl Into<EntityPath>,
    time: TimePoint,
    components: &dyn AsComponents,
) -> Result<LogMsg, RerunError> {
    let id = ids.next();
    let chunk = Chunk::builder_with_id(ChunkId::from_tuid(id), entity)
        .with_serialized_batches(
            RowId::from_tuid(id),
            time,
            components.as_serialized_batches(),
        )
        .build()?;
    Ok(LogMsg::ArrowMsg(store.clone(), chunk.to_arrow_msg()?))
}

/// Numbers the chunks of one recording and passes them to its destinations.
pub(super) struct Outlet {
    store: StoreId,
    ids: Ids,
    live_ids: Ids,
    file: Option<FileDestination>,
    live: Option<LiveDestination>,
    warnings: Vec<String>,
}

impl Outlet {
    pub(super) fn open(store: StoreId, destinations: Destinations) -> Result<Self, RerunError> {
        let mut outlet = Self {
            store,
            ids: Ids::RECORDING,
            live_ids: Ids::LIVE,
            file: destinations.file.map(FileDestination::open).transpose()?,
            live: None,
            warnings: Vec::new(),
        };
        match destinations.live.map(|live| LiveDestination::open(&live)) {
            Some(Ok(live)) => outlet.live = Some(live),
            Some(Err(warning)) => outlet.warnings.push(warning),
            None => {}
        }
        let opening = opening(&outlet.store, &mut outlet.ids);
        outlet.send(&opening)?;
        Ok(outlet)
    }

    /// Whether there is a viewer, as far as is known.
    pub(super) fn is_live(&self) -> bool {
        self.live.is_some()
    }

    pub(super) fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    /// Sends what never changes in the course of the recording.
    pub(super) fn send_static(
        &mut self,
        entity: impl Into<EntityPath>,
        components: &dyn AsComponents,
    ) -> Result<(), RerunError> {
        let time = TimePoint::STATIC;
        let message = single_row(&self.store, &mut self.ids, entity, time, components)?;
        self.send(&message)
    }

    /// Sends rows everywhere.
    pub(super) fn send_rows(
        &mut self,
        entity: &EntityPath,
        times: &[i64],
        columns: Vec<SerializedComponentColumn>,
    ) -> Result<(), RerunError> {
        let id = self.ids.next();
        let message = self.rows(id, entity, times, columns)?;
        self.send(&message)
    }

    /// Sends rows to the file only: the viewer has them already.
    pub(super) fn file_rows(
        &mut self,
        entity: &EntityPath,
        times: &[i64],
        columns: Vec<SerializedComponentColumn>,
    ) -> Result<(), RerunError> {
        let id = self.ids.next();
        let message = self.rows(id, entity, times, columns)?;
        self.write_file(&message)
    }

    /// Sends rows to the viewer only: the file gets them later, in longer chunks.
    pub(super) fn live_rows(
        &mut self,
        entity: &EntityPath,
        times: &[i64],
        columns: Vec<SerializedComponentColumn>,
    ) -> Result<(), RerunError> {
        let id = self.live_ids.next();
        let message = self.rows(id, entity, times, columns)?;
        self.feed_viewer(&message);
        Ok(())
    }

    fn rows(
        &self,
        id: Tuid,
        entity: &EntityPath,
        times: &[i64],
        columns: Vec<SerializedComponentColumn>,
    ) -> Result<LogMsg, RerunError> {
        let time = TimeColumn::new_duration_nanos(TIMELINE, times.iter().copied());
        let chunk = Chunk::from_auto_row_ids(
            ChunkId::from_tuid(id),
            entity.clone(),
            std::iter::once((*time.timeline().name(), time)).collect(),
            columns
                .into_iter()
                .map(|column| (column.descriptor, column.list_array))
                .collect(),
        )?;
        Ok(LogMsg::ArrowMsg(self.store.clone(), chunk.to_arrow_msg()?))
    }

    pub(super) fn send(&mut self, message: &LogMsg) -> Result<(), RerunError> {
        self.feed_viewer(message);
        self.write_file(message)
    }

    fn write_file(&mut self, message: &LogMsg) -> Result<(), RerunError> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        if file.queue.send(message.clone()).is_ok() {
            return Ok(());
        }
        // The worker has ended early; joining it tells why.
        match self.file.take().map(FileDestination::finish) {
            Some(Err(error)) => Err(error),
            _ => Err(RerunError::Worker),
        }
    }

    fn feed_viewer(&mut self, message: &LogMsg) {
        let Some(live) = &self.live else {
            return;
        };
        if let Err(warning) = live.send(message.clone()) {
            self.warnings.push(warning);
            self.live = None;
        }
    }

    /// Completes all destinations; the file is handed back, and the warnings not taken yet.
    pub(super) fn finish(mut self) -> Result<(Option<File>, Vec<String>), RerunError> {
        let file = self.file.map(FileDestination::finish).transpose()?;
        if let Some(Err(warning)) = self.live.map(LiveDestination::finish) {
            self.warnings.push(warning);
        }
        Ok((file, self.warnings))
    }
}

/// A file, and the thread that encodes and compresses for it.
struct FileDestination {
    queue: SyncSender<LogMsg>,
    worker: JoinHandle<Result<File, RerunError>>,
}

impl FileDestination {
    fn open(file: File) -> Result<Self, RerunError> {
        let (queue, messages) = sync_channel(QUEUE);
        let worker = thread::Builder::new()
            .name("rrd encoder".to_owned())
            .spawn(move || encode(file, &messages))?;
        Ok(Self { queue, worker })
    }

    fn finish(self) -> Result<File, RerunError> {
        drop(self.queue);
        self.worker.join().map_err(|_| RerunError::Worker)?
    }
}

/// Encodes messages until there are no more, then adds the footer.
fn encode(file: File, messages: &Receiver<LogMsg>) -> Result<File, RerunError> {
    let version = rerun::build_info().version;
    let options = EncodingOptions::PROTOBUF_COMPRESSED;
    let mut encoder = Encoder::new_eager(version, options, BufWriter::new(file))?;
    for message in messages {
        encoder.append(&message)?;
    }
    encoder.finish()?;
    let buffer = encoder.into_inner()?;
    Ok(buffer.into_inner().map_err(IntoInnerError::into_error)?)
}
