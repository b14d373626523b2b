//! The legend of the scene: the names of its arrows and paths in rows below the top.
//!
//! Names beside the tips of arrows would lie across each other and the top.

use rerun::archetypes::Points3D;
use rerun::{Color, Radius};

use crate::rerun::identity::Identity;
use crate::rerun::output::track::Track;
use crate::rerun::output::{ComponentColumns, Output};
use crate::rerun::role::Role;
use crate::telemetry::proportions::Proportions;

/// Height of the first row above the table, and of each row above the next one, in heights of the top. The rows are on the
/// vertical through the peg, so that they stay below each other when the view is turned.
const HIGH_VIEW: [f64; 2] = [-0.5, 0.17];
/// The same in a view that has half of the window's height, where a height of the top is fewer points.
const LOW_VIEW: [f64; 2] = [-0.25, 0.24];

/// A row of the legend.
pub(super) struct LegendRow {
    entity: String,
    place: [f32; 3],
    color: Color,
}

impl LegendRow {
    /// The row with this index. `name` is that of its entity.
    pub(super) fn new(
        identity: &Identity,
        role: &Role,
        index: usize,
        name: &str,
        color: u32,
    ) -> Self {
        let height = Proportions::new(&identity.geometry.top).size();
        let row = (role.first_legend_row() + index) as f64;
        let [first, step] = if role.is_alone() && identity.measurement.is_none() {
            HIGH_VIEW
        } else {
            LOW_VIEW
        };
        Self {
            // A free peg takes the legend along, as it does the camera.
            entity: role.entity(&format!("scene/focus/legend/{}", name.replace(' ', "_"))),
            place: [0.0, 0.0, (height * (first - step * row)) as f32],
            color: Color::from_u32(color),
        }
    }

    /// Sends a text that stays.
    pub(super) fn send(&self, text: &str, output: &mut Output) {
        let label = self.label(text).with_positions([self.place]);
        output.send_static(self.entity.as_str(), &label);
    }

    /// Sends a text that is shown at some times: those at which the track has a place.
    pub(super) fn open(
        &self,
        part: &str,
        text: &str,
        output: &mut Output,
    ) -> Track<Option<[f32; 3]>> {
        let entity = format!("{}/{part}", self.entity);
        output.send_static(entity.as_str(), &self.label(text));
        Track::new(entity, columns, output)
    }

    /// The place of the row, relative to the table below the peg, m.
    pub(super) fn place(&self) -> [f32; 3] {
        self.place
    }

    fn label(&self, text: &str) -> Points3D {
        Points3D::update_fields()
            .with_colors([self.color])
            // Rerun draws text in a scene only as the label of a point: this one can't be seen.
            .with_radii([Radius::new_ui_points(0.0)])
            .with_labels([text])
            .with_show_labels(true)
    }
}

fn columns(rows: &[Option<[f32; 3]>]) -> ComponentColumns {
    let points = Points3D::update_fields().with_positions(rows.iter().copied().flatten());
    let lengths = rows.iter().map(|row| usize::from(row.is_some()));
    Ok(points.columns(lengths)?.collect())
}
