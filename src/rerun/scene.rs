//! The scene: the top on its table, arrows, and the paths of the symmetry axis and the contact point.
//!
//! World frame: z up, the table at z = 0, metres.

mod arrow;
pub(super) mod body;
mod focus;
mod hodograph;
mod path;
pub(super) mod shape;

use nalgebra::Vector3;
use rerun::archetypes::Points3D;
use rerun::datatypes::Rgba32;
use rerun::{Color, Radius, ViewCoordinates};

use self::arrow::ArrowTrack;
pub(super) use self::arrow::arrow_columns;
use self::body::{BodyPose, body_columns};
use self::focus::Focus;
use self::hodograph::Hodograph;
pub(super) use self::hodograph::{RADIUS, is_shown as has_hodograph};
use self::path::Path;
use super::entity::{CONTACT_PATHS, STAGE, TRAIL_ABOVE, TRAIL_BELOW};
use super::identity::{Geometry, Identity};
use super::measurement::top::MeasuredTop;
use super::output::track::Track;
use super::output::{ComponentColumns, Output};
use super::role::Role;
use crate::rerun::palette::{GREEN, GREY, PURPLE, SKY, VERMILION, WHITE};
use crate::run::simulation::Regime;
use crate::run::time::seconds;
use crate::telemetry::Message;
use crate::telemetry::arrows::SampleArrows;
use crate::telemetry::arrows::snapshot::Snapshot;
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
    arrows: Vec<ArrowTrack>,
    hodograph: Option<Hodograph>,
    next_arrows_ns: u64,
    geometry: Geometry,
    /// The note that the run has ended.
    end_note: Track<String>,
    role: Role,
    /// The origin of the view, if the peg is free.
    focus: Option<Focus>,
    /// Centre of the peg at the last pose, in the world frame, m.
    peg: Vector3<f64>,
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
        let body = shape::top(&proportions.scaled(role.size()))
            .with_albedo_factor(Rgba32::from_u32(role.albedo()));
        output.send_static(role.entity("scene/top/body"), &body);
        if is_alone {
            log_centers(&geometry, output);
        }
        let [latest, past] = TRAIL_ABOVE;
        let trail =
            Path::new(role, &[(latest, PURPLE)], 1.3, output).fading(role, past, PURPLE, output);
        let below = (!is_free).then(|| Path::new(role, &[(TRAIL_BELOW, PURPLE)], 1.0, output));
        let [slides, rolls, flies] = CONTACT_PATHS;
        let colors = [(slides, SKY), (rolls, GREEN), (flies, VERMILION)];
        let contact_path =
            (is_free && identity.has(CONTACT)).then(|| Path::new(role, &colors, 1.6, output));
        let end = role.entity("scene/focus/end");
        output.send_static(end.as_str(), &note(&geometry));
        Self {
            arrows: ArrowTrack::all(identity, role, output),
            hodograph: Hodograph::new(identity, role, output),
            next_arrows_ns: 0,
            geometry,
            end_note: Track::new(end, note_columns, output),
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
            focus,
            peg: geometry.top.peg_radius * Vector3::z(),
        }
    }

    /// Adds what a message contains for the scene.
    pub(super) fn write(&mut self, message: &Message<'_>, output: &mut Output) {
        if message.topic() == POSE {
            self.write_pose(message, output);
        }
        if message.topic() == CONTACT
            && let Some(path) = &mut self.contact_path
            && let Some(regime) = Regime::from_code(contact::REGIME.of(message))
        {
            let kind = match regime {
                Regime::Slipping => 0,
                Regime::Sticking => 1,
                Regime::Flying => 2,
            };
            let point = contact::CONTACT_POINT.of(message);
            path.write(message.time_ns, kind, point, output);
        }
        if let Some(measured) = &mut self.measured {
            measured.write(message, self.peg, output);
        }
    }

    /// Adds the arrows of a sample.
    pub(super) fn write_snapshot(&mut self, snapshot: &Snapshot, output: &mut Output) {
        if snapshot.time_ns < self.next_arrows_ns {
            return;
        }
        self.next_arrows_ns = snapshot.time_ns.saturating_add(ARROW_NS);
        let height = Proportions::new(&self.geometry.top).size();
        let drawn = SampleArrows::new(snapshot, &self.geometry.scales, height);
        for track in &mut self.arrows {
            if let Some(arrow) = drawn.get(track.arrow) {
                track.write(snapshot.time_ns, &arrow, output);
            }
        }
        if let Some(hodograph) = &mut self.hodograph {
            hodograph.write(snapshot, output);
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
            .name(&format!("ended at {:.4} s", seconds(time_ns)));
        self.end_note.push(output, after_ns, [text]);
    }

    fn write_pose(&mut self, message: &Message<'_>, output: &mut Output) {
        let time_ns = message.time_ns;
        self.peg = pose::PEG_POSITION.of(message);
        // Rerun draws in single precision.
        let translation = self.peg.cast::<f32>().into();
        let quaternion = pose::ORIENTATION.of(message).coords.cast::<f32>().into();
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

/// Time between two rows of arrows, ns.
const ARROW_NS: u64 = 4_000_000;

/// Marks the centre of mass in the body, and the centre of the peg: that of the ball of a tippe top.
fn log_centers(geometry: &Geometry, output: &mut Output) {
    let points = Points3D::new([[0.0, 0.0, geometry.top.center_distance as f32], [0.0; 3]])
        .with_colors([GREY, WHITE].map(Color::from_u32))
        .with_radii([Radius::new_ui_points(3.0)]);
    output.send_static("/scene/top/centers", &points);
}

fn note_columns(rows: &[String]) -> ComponentColumns {
    let notes = Points3D::update_fields().with_labels(rows.iter().map(String::as_str));
    Ok(notes.columns_of_unit_batches()?.collect())
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

/// A note above the top, whose text is not sent.
fn note(geometry: &Geometry) -> Points3D {
    let height = 1.75 * Proportions::new(&geometry.top).size();
    Points3D::new([[0.0, 0.0, height as f32]])
        .with_colors([Color::from_u32(GREY)])
        // Rerun draws text in a scene only as the label of a point: this one can't be seen.
        .with_radii([Radius::new_ui_points(0.0)])
        .with_show_labels(true)
}

/// The arrows of the scene with their scales, and the paths of a run that is alone, in Markdown.
pub(super) fn legend(identity: &Identity) -> String {
    let mut text = arrow::legend(identity);
    text +=
        "\nPoints: centre of mass grey, centre of the peg white. Pink: path of the symmetry axis.";
    if identity.geometry.is_free {
        text += " Path of the contact point: blue where it slides, green where it rolls or sticks, vermilion where the \
                 peg is in the air.";
    }
    if has_hodograph(identity) {
        text += &hodograph::legend(&identity.geometry.scales);
    }
    text
}
