//! Metadata of a comparison, needed before its messages.

use crate::rerun::blueprint::charts::compares;
use crate::rerun::identity::{Geometry, Identity};
use crate::rerun::output::message::store;
use crate::rerun::plots::curves::Curves;
use crate::telemetry::arrows::scale::per_centimetre;
use crate::telemetry::fields::{NUTATION, POSE};
use crate::telemetry::proportions::Proportions;
use crate::telemetry::side::Side;
use rerun::StoreId;

/// The names of a recording of two runs, and the metadata of each.
#[derive(Debug, Clone, PartialEq)]
pub struct PairIdentity {
    /// Identifier: a viewer merges recordings that have the same.
    pub recording_id: String,
    /// The name that a viewer shows.
    pub name: String,
    /// The first run.
    pub a: Identity,
    /// The second run, from which the first is subtracted.
    pub b: Identity,
}

impl PairIdentity {
    /// One of the runs.
    pub(super) fn run(&self, side: Side) -> &Identity {
        match side {
            Side::A => &self.a,
            Side::B => &self.b,
        }
    }

    /// The store that a viewer keeps the recording in.
    pub(super) fn store(&self) -> StoreId {
        store(&self.name, &self.recording_id)
    }

    /// The name of a run; its letter, if both have the same name.
    pub(super) fn name_of(&self, side: Side) -> &str {
        match side {
            // Two recordings of one scenario have the same name.
            _ if self.a.name != self.b.name => &self.run(side).name,
            Side::A => "A",
            Side::B => "B",
        }
    }

    /// Whether there will be differences of a plot: both runs have it, row by row.
    pub(super) fn has_difference_of(&self, curves: Curves) -> bool {
        let Curves::Field(plot) = curves else {
            return false;
        };
        let topic = plot.topic();
        (topic.info().is_sampled || topic == NUTATION) && self.a.has(topic) && self.b.has(topic)
    }

    /// Whether there will be logarithms of these differences: the layout shows them, and the plot has one number. Rows
    /// with several numbers can't omit zeros.
    pub(super) fn has_magnitude_of(&self, curves: Curves) -> bool {
        self.has_difference_of(curves) && compares(curves) && curves.quantities().len() == 1
    }

    /// Whether the peg of one of them is free.
    pub(super) fn is_any_free(&self) -> bool {
        self.a.geometry.is_free || self.b.geometry.is_free
    }

    /// Geometry of the larger of the tops that are drawn, if any; free if one of them is.
    pub(super) fn common_geometry(&self) -> Option<Geometry> {
        let larger = [&self.a, &self.b]
            .into_iter()
            .filter(|run| run.has(POSE))
            .map(|run| run.geometry)
            // The table and the camera must have room for both.
            .max_by(|one, other| size(one).total_cmp(&size(other)))?;
        Some(Geometry {
            is_free: self.is_any_free(),
            ..larger
        })
    }

    /// A run whose friction forces are drawn to the same scale as those of the other; a comparison has no other arrows.
    pub(super) fn with_common_scale(&self, side: Side) -> Identity {
        let mut run = self.run(side).clone();
        // Lengths of arrows are compared by eye.
        let [a, b] = [&self.a, &self.b].map(|run| run.geometry.scales);
        run.geometry.scales.force = a.common_force(&b);
        run
    }

    /// Colour key of the runs, in Markdown.
    pub(super) fn key(&self) -> String {
        let force = self.with_common_scale(Side::A).geometry.scales.force;
        let arrows = if force > 0.0 {
            let scale = per_centimetre(force, "N");
            format!(" The arrows F are the friction forces; 1 cm is {scale}.")
        } else {
            String::new()
        };
        format!(
            "**A** is `{}`: blue, and the top in its own colours. **B** is `{}`: orange, and the orange top. \
             Differences are B − A.{arrows}\n\n",
            self.a.name, self.b.name
        )
    }
}

/// The size of a drawn top in m.
fn size(geometry: &Geometry) -> f64 {
    Proportions::new(&geometry.top).size()
}
