//! Rows of pieces of a path.

use rerun::SerializedComponentColumn;
use rerun::archetypes::LineStrips3D;

use crate::rerun::error::RerunError;
use crate::rerun::track::Rows;

/// Rows of one piece of a path each, as points in the world frame, m.
#[derive(Default)]
pub(super) struct Strips(Vec<Vec<[f32; 3]>>);

impl Strips {
    /// Adds a row.
    pub(super) fn push(&mut self, piece: Vec<[f32; 3]>) {
        self.0.push(piece);
    }
}

impl Rows for Strips {
    fn columns(&self, start: usize) -> Result<Vec<SerializedComponentColumn>, RerunError> {
        let strips = LineStrips3D::update_fields().with_strips(self.0[start..].iter().cloned());
        Ok(strips.columns_of_unit_batches()?.collect())
    }

    fn clear(&mut self) {
        self.0.clear();
    }
}
