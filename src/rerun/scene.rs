//! The scene: the top on its table, arrows, and the paths of the symmetry axis and the contact point.
//!
//! World frame: z up, the table at z = 0, metres.

mod arrow;
mod body;
mod focus;
mod legend;
mod measured;
mod path;
mod shape;

use nalgebra::{UnitQuaternion, Vector3};
use rerun::ViewCoordinates;
use rerun::datatypes::Rgba32;

use self::arrow::Arrow;
use self::body::{BodyPose, body_columns};
use self::focus::Focus;
use self::legend::LegendRow;
use self::measured::MeasuredTop;
use self::path::Path;
use super::entity::{CONTACT_PATHS, STAGE, TRAIL_ABOVE, TRAIL_BELOW};
use super::identity::{Geometry, Identity};
use super::output::Output;
use super::output::track::Track;
use super::palette::{GREEN, GREY, PURPLE, SKY, VERMILION};
use super::role::Role;
use crate::run::simulation::Regime;
use crate::run::time::seconds;
use crate::telemetry::Message;
use crate::telemetry::fields::{CONTACT, POSE, contact, pose};
use crate::telemetry::proportions::Proportions;

/// The scene of one run, fed with the messages of several channels.
pub(super) struct Scene {
    top: Track<BodyPose>,
    measured: Option<MeasuredTop>,
    /// The path of the symmetry axis on a sphere around the peg, of this radius, m.
    trail: Path,
    trail_radius: f64,
    /// The projection onto the table, if the peg is fixed; below a travelling top it would cross the path of the
    /// contact point.
    below: Option<Path>,
    /// The path of the contact point of a free peg: where it slides, where it rolls or sticks, and below the peg where it
    /// flies.
    contact_path: Option<Path>,
    arrows: Vec<Arrow>,
    /// The place for the end of the run in the legend, and the words before it.
    end_row: LegendRow,
    role: Role,
    /// Target of the camera, if the peg is free.
    focus: Option<Focus>,
    /// Orientation (world from body) of the last pose.
    orientation: Option<UnitQuaternion<f64>>,
    /// Centre of the peg at the last pose, in the world frame, m.
    peg: Vector3<f64>,
    /// The contact point at its last message, in the world frame, m.
    contact: Vector3<f64>,
}

impl Scene {
    /// Sends bodies, colours and labels, and the static parts unless shared.
    pub(super) fn new(identity: &Identity, role: &Role, output: &mut Output) -> Self {
        let geometry = identity.geometry;
        let (is_alone, is_free) = (role.is_alone(), geometry.is_free);
        if is_alone {
            log_stage(&geometry, output);
        }
        let focus = is_free.then(|| Focus::new(&geometry, role, output));
        let proportions = Proportions::new(&geometry.top);
        let mut body = shape::top(&proportions.scaled(role.size()));
        if let Some(albedo) = role.albedo() {
            body = body.with_albedo_factor(Rgba32::from_u32(albedo));
        }
        output.send_static(role.entity("scene/top/body"), &body);
        let [latest, past] = TRAIL_ABOVE;
        let trail =
            Path::new(role, &[(latest, PURPLE)], 1.3, output).fading(role, past, PURPLE, output);
        let below = (!is_free).then(|| Path::new(role, &[(TRAIL_BELOW, PURPLE)], 1.0, output));
        let [slides, rolls, flies] = CONTACT_PATHS;
        let colors = [(slides, SKY), (rolls, GREEN), (flies, VERMILION)];
        let contact_path =
            (is_free && identity.has(CONTACT)).then(|| Path::new(role, &colors, 1.6, output));
        let arrows = Arrow::all(identity, role, output);
        log_path_names(identity, role, arrows.len(), output);
        Self {
            // The arrows, whose first row it takes, are then gone.
            end_row: LegendRow::new(identity, role, 0, "end", role.color(GREY, 0)),
            role: role.clone(),
            measured: identity
                .measurement
                .as_ref()
                .and_then(|measurement| MeasuredTop::new(measurement, &geometry, output)),
            top: Track::new(role.entity("scene/top"), body_columns, output),
            trail,
            // Just above the tip of the stem.
            trail_radius: 1.13 * proportions.tip,
            below,
            contact_path,
            arrows,
            focus,
            orientation: None,
            peg: geometry.top.peg_radius * Vector3::z(),
            contact: Vector3::zeros(),
        }
    }

    /// Adds what a message contains for the scene.
    pub(super) fn write(&mut self, message: &Message<'_>, output: &mut Output) {
        if message.topic() == POSE {
            self.write_pose(message, output);
        }
        if message.topic() == CONTACT {
            self.contact = contact::CONTACT_POINT.of(message);
            if let Some(path) = &mut self.contact_path
                && let Some(regime) = Regime::from_code(contact::REGIME.of(message))
            {
                let kind = match regime {
                    Regime::Slipping => 0,
                    Regime::Sticking => 1,
                    Regime::Flying => 2,
                };
                path.write(message.time_ns, kind, self.contact, output);
            }
        }
        if let Some(measured) = &mut self.measured {
            measured.write(message, self.peg, output);
        }
        for arrow in &mut self.arrows {
            arrow.write(message, self.orientation, [self.peg, self.contact], output);
        }
    }

    /// Marks the end of the run at this time, ns, in a recording that goes on: no arrow stays, and the legend has the time.
    pub(super) fn end(&mut self, time_ns: u64, output: &mut Output) {
        let after_ns = time_ns.saturating_add(1);
        for arrow in &mut self.arrows {
            arrow.remove(after_ns, output);
        }
        let text = self
            .role
            .short_name(&format!("ended at {:.4} s", seconds(time_ns)));
        let place = self.end_row.place();
        self.end_row
            .open("time", &text, output)
            .push(output, after_ns, [Some(place)]);
    }

    fn write_pose(&mut self, message: &Message<'_>, output: &mut Output) {
        let time_ns = message.time_ns;
        // A unit quaternion when it was recorded: normalising would only add a rounding error.
        let orientation = UnitQuaternion::new_unchecked(pose::ORIENTATION.of(message));
        self.orientation = Some(orientation);
        self.peg = pose::PEG_POSITION.of(message);
        // Rerun draws in single precision.
        let translation = self.peg.cast::<f32>().into();
        let quaternion = orientation.coords.cast::<f32>().into();
        self.top.push(output, time_ns, [(translation, quaternion)]);
        let point = self.peg + self.trail_radius * pose::AXIS.of(message);
        self.trail.write(time_ns, 0, point, output);
        if let Some(below) = &mut self.below {
            below.write(time_ns, 0, Vector3::new(point.x, point.y, 0.0), output);
        }
        if let Some(focus) = &mut self.focus {
            focus.write(time_ns, self.peg, output);
        }
    }
}

/// Names the paths in the legend, below the rows of the arrows.
fn log_path_names(identity: &Identity, role: &Role, arrows: usize, output: &mut Output) {
    let has_contact_path = identity.geometry.is_free && identity.has(CONTACT);
    let (row, text, color) = match (role.is_alone(), has_contact_path) {
        (true, true) => (
            arrows,
            "paths: axis pink, contact blue (slides), green (rolls), red (flies)",
            GREY,
        ),
        (true, false) => (arrows, "path of the symmetry axis", PURPLE),
        // Below the arrows of both runs, in one view or in two.
        (false, true) => (arrows + 1, "paths of the axis and the contact", GREY),
        (false, false) => (arrows + 1, "path of the symmetry axis", PURPLE),
    };
    let row = LegendRow::new(identity, role, row, "path", role.color(color, 0));
    row.send(&role.short_name(text), output);
}

/// Sends the static parts: the table and, for a fixed peg, the vertical.
pub(super) fn log_stage(geometry: &Geometry, output: &mut Output) {
    let size = Proportions::new(&geometry.top).size();
    output.send_static(STAGE, &ViewCoordinates::RIGHT_HAND_Z_UP());
    // A free peg needs a larger table.
    let (rings, table) = if geometry.is_free {
        (20, 14.0 * size)
    } else {
        (5, 2.1 * size)
    };
    output.send_static("scene/table", &shape::table(table));
    output.send_static("scene/table/marks", &shape::table_marks(table, rings));
    if !geometry.is_free {
        focus::send_vertical(geometry, "scene/focus/vertical".to_owned(), output);
    }
}

/// The scales of the arrows and the colours of the paths of a free peg, in Markdown.
pub(super) fn explanation(identity: &Identity, role: &Role) -> String {
    let mut text = arrow::explanation(identity, role);
    // Where two runs are compared, all paths of a run are in shades of its colour.
    if identity.geometry.is_free && role.is_alone() {
        text += "\n\n## Paths\n\nOf the symmetry axis: pink. Of the contact point: blue where it slides, green where it \
                 rolls or sticks, vermilion where the peg is in the air.\n";
    }
    text
}
