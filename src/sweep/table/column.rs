//! A column of an input table.

use crate::run::scenario::Key;
use crate::sweep::cells::Cells;

/// The values of one key.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// The name in the file, which may differ from the path of the key.
    pub(super) name: String,
    pub(super) key: &'static Key,
    pub(super) cells: Cells,
}
