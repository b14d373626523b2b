//! Messages of a recording, as the SDK sends them, and their identifiers.

use rerun::external::re_log_types::{
    ApplicationId, LogMsg, SetStoreInfo, StoreInfo, StoreKind, StoreSource,
};
use rerun::external::re_tuid::Tuid;
use rerun::log::{Chunk, ChunkId, RowId};
use rerun::{AsComponents, EntityPath, SerializedComponentColumn, StoreId, TimeColumn, TimePoint};

use crate::rerun::error::RerunError;

/// Maximum number of characters of a recording's name used in its application ID, which may have 180.
const MAX_LETTERS: usize = 100;

/// The store of a recording. To a viewer, which keeps one layout for each application, recordings of different names are
/// different applications.
pub(in crate::rerun) fn store(name: &str, recording_id: &str) -> StoreId {
    let letters: String = name.chars().take(MAX_LETTERS).map(id_letter).collect();
    let application = ApplicationId::new_or_unknown(format!("toprise-{letters}"));
    StoreId::new(StoreKind::Recording, application, recording_id)
}

/// The letter, or a dash for one that viewers escape in identifiers.
fn id_letter(letter: char) -> char {
    if letter.is_ascii_alphanumeric() || "-_".contains(letter) {
        letter
    } else {
        '-'
    }
}

/// The timeline of every recording: simulation time as a duration in nanoseconds.
pub(in crate::rerun) const TIMELINE: &str = "sim_time";

/// Number of messages that may wait for a worker thread; each has at most about 200 kB.
pub(super) const QUEUE: usize = 64;

/// A counter of chunks, whose identifiers depend on nothing but their order.
#[derive(Debug)]
pub(in crate::rerun) struct Ids(u64);

impl Ids {
    // Ranges far apart, so that the identifiers of a recording never meet.

    /// For chunks that are the same for all destinations.
    pub(super) const RECORDING: Self = Self(0);
    /// For the chunks of the blueprint.
    pub(in crate::rerun) const BLUEPRINT: Self = Self(1 << 61);
    /// For changes to the blueprint made when the length of the run is known.
    pub(in crate::rerun) const BLUEPRINT_AT_END: Self = Self(3 << 60);
    /// For the chunks of a paced run that are cut for the viewer only.
    pub(super) const LIVE: Self = Self(1 << 62);

    /// The next identifier. Rows of the chunk are numbered in its lower half.
    pub(super) fn next(&mut self) -> Tuid {
        self.0 += 1;
        Tuid::from_nanos_and_inc(self.0, 0)
    }
}

/// The message that opens a store.
pub(in crate::rerun) fn opening(store: &StoreId, ids: &mut Ids) -> LogMsg {
    // The usual source, `RustSdk`, has the version of the compiler, which would make recordings of two builds differ.
    let source = StoreSource::Other("toprise".to_owned());
    LogMsg::SetStoreInfo(SetStoreInfo {
        row_id: ids.next(),
        info: StoreInfo::new(store.clone(), source),
    })
}

/// A chunk with one row of `components` at `time`.
pub(in crate::rerun) fn single_row(
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

/// A chunk with a row per time, in ns.
pub(super) fn rows(
    store: &StoreId,
    ids: &mut Ids,
    entity: &EntityPath,
    times: &[i64],
    columns: Vec<SerializedComponentColumn>,
) -> Result<LogMsg, RerunError> {
    let time = TimeColumn::new_duration_nanos(TIMELINE, times.iter().copied());
    let chunk = Chunk::from_auto_row_ids(
        ChunkId::from_tuid(ids.next()),
        entity.clone(),
        std::iter::once((*time.timeline().name(), time)).collect(),
        columns
            .into_iter()
            .map(|column| (column.descriptor, column.list_array))
            .collect(),
    )?;
    Ok(LogMsg::ArrowMsg(store.clone(), chunk.to_arrow_msg()?))
}
