//! The arrows of the scene, each with its name beyond its tip.

use nalgebra::{UnitQuaternion, Vector3};
use rerun::archetypes::{Arrows3D, Points3D};
use rerun::{Color, Radius};

use crate::rerun::identity::Identity;
use crate::rerun::look::Look;
use crate::rerun::outlet::{Columns, Outlet};
use crate::rerun::palette;
use crate::rerun::scale;
use crate::rerun::track::Track;
use crate::telemetry::Message;
use crate::telemetry::fields::{CONTACT, VectorField, contact, momentum, torque};
use crate::telemetry::proportions::Proportions;

/// Time between two positions of a label, in ns.
const LABEL_NS: u64 = 10_000_000;

/// Name, colour and quantity of an arrow.
type Kind = (&'static str, u32, VectorField);

/// All kinds of arrows.
const KINDS: [Kind; 5] = [
    ("slip velocity", palette::SKY, contact::SLIP_WORLD),
    ("friction force", palette::ORANGE, contact::FRICTION_FORCE),
    ("gravity torque", palette::GREEN, torque::GRAVITY_BODY),
    ("friction torque", palette::VERMILION, FRICTION_TORQUE),
    ("angular momentum", palette::YELLOW, momentum::WORLD),
];

const FRICTION_TORQUE: VectorField = torque::FRICTION_BODY;

/// The only arrow drawn in a comparison: all arrows of both runs would hide the tops.
const COMPARED: VectorField = contact::FRICTION_FORCE;

/// The arrows that are drawn, with their scales, as numbers and as text. Without friction, its arrows have no length
/// and are omitted.
fn drawn(identity: &Identity, look: &Look) -> impl Iterator<Item = (Kind, f64, String)> {
    let scales = &identity.geometry.scales;
    let scales = [
        scales.slip,
        scales.force,
        scales.gravity_torque,
        scales.friction_torque,
        scales.momentum,
    ];
    let kinds = KINDS.into_iter().zip(scales);
    let drawn = kinds.filter(|((_, _, vector), scale)| {
        let is_shown = look.is_alone() || *vector == COMPARED;
        identity.has(vector.topic()) && *scale > 0.0 && is_shown
    });
    drawn.map(|(kind, scale)| (kind, scale, scale::legend(scale, kind.2.x().unit())))
}

/// Quantity per centimetre of each arrow, in Markdown.
pub(super) fn explanation(identity: &Identity, look: &Look) -> String {
    let mut text = "\n\n## Arrows\n\n| arrow | scale |\n| --- | --- |\n".to_owned();
    for ((name, ..), _, legend) in drawn(identity, look) {
        text += &format!("| {name} | {legend} |\n");
    }
    text
}

/// An arrow at the origin of a quantity, with a label beyond its tip. Short arrows have no label, because labels would
/// overlap.
pub(super) struct Arrow {
    vector: VectorField,
    /// Quantity per metre.
    scale: f64,
    /// Length of the shortest arrow with a label, m.
    shortest: f64,
    /// Distance by which the name is moved up from the tip, m.
    lift: f64,
    arrows: Track<[[f32; 3]; 2]>,
    labels: Track<Option<[f32; 3]>>,
    next_label_ns: u64,
}

impl Arrow {
    /// The arrows with data to draw; sends colours, thickness and names.
    pub(super) fn all(identity: &Identity, look: &Look, outlet: &mut Outlet) -> Vec<Self> {
        let size = Proportions::new(&identity.geometry.top).size();
        let mut arrows = Vec::new();
        for ((name, color, vector), scale, legend) in drawn(identity, look) {
            let entity = look.entity(&format!("scene/{}", name.replace(' ', "_")));
            let label = format!("{entity}/label");
            let color = Color::from_u32(look.color(color, 0));
            let radius = 0.017 * size * look.thickness();
            let arrow = Arrows3D::update_fields()
                .with_colors([color])
                .with_radii([Radius::new_scene_units(radius as f32)]);
            let text = format!("{} ({legend})", look.short_name(name));
            let named = Points3D::update_fields()
                .with_colors([color])
                .with_radii([Radius::new_ui_points(0.0)])
                .with_labels([text])
                .with_show_labels(true);
            outlet.send_static(entity.as_str(), &arrow);
            outlet.send_static(label.as_str(), &named);
            // Labels at the peg and on the table don't overlap.
            let lift = if is_at_contact(vector) { 0.0 } else { 0.13 };
            arrows.push(Self {
                vector,
                scale,
                shortest: 0.15 * size,
                lift: (lift + look.lift()) * size,
                arrows: Track::new(entity, arrow_columns, outlet),
                labels: Track::new(label, label_columns, outlet),
                next_label_ns: 0,
            });
        }
        arrows
    }

    /// Adds a row for a message of the arrow's channel. Orientation (world from body) is that of the last pose; the places
    /// are the centre of the peg and the point of contact, as they are drawn.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        orientation: Option<UnitQuaternion<f64>>,
        [peg, contact]: [Vector3<f64>; 2],
        outlet: &mut Outlet,
    ) {
        let (time_ns, vector) = (message.time_ns, self.vector);
        if message.topic() != vector.topic() {
            return;
        }
        let origin = if is_at_contact(vector) { contact } else { peg };
        let is_in_body_axes = vector.x().leaf().frame == "body";
        let own = vector.of(message);
        let vector = match orientation {
            _ if !is_in_body_axes => own,
            Some(orientation) => orientation * own,
            // Without a pose the directions of the body axes are unknown.
            None => return,
        };
        let vector = self.scale.recip() * vector;
        let arrow = [origin, vector].map(|part| part.cast::<f32>().into());
        self.arrows.push(outlet, time_ns, [arrow]);
        if time_ns < self.next_label_ns {
            return;
        }
        self.next_label_ns = time_ns.saturating_add(LABEL_NS);
        let length = vector.norm();
        let beyond = 1.0 + self.shortest / length.max(self.shortest);
        let place = origin + beyond * vector + self.lift * Vector3::z();
        let label = (length >= self.shortest).then(|| place.cast::<f32>().into());
        self.labels.push(outlet, time_ns, [label]);
    }
}

/// Whether an arrow begins at the point of contact, or the lowest point of a peg in the air; others begin at the centre of
/// the peg.
fn is_at_contact(vector: VectorField) -> bool {
    vector.topic() == CONTACT
}

fn arrow_columns(rows: &[[[f32; 3]; 2]]) -> Columns {
    let arrows = Arrows3D::update_fields()
        .with_origins(rows.iter().map(|[origin, _]| *origin))
        .with_vectors(rows.iter().map(|[_, vector]| *vector));
    Ok(arrows.columns_of_unit_batches()?.collect())
}

fn label_columns(rows: &[Option<[f32; 3]>]) -> Columns {
    let points = Points3D::update_fields().with_positions(rows.iter().copied().flatten());
    let lengths = rows.iter().map(|row| usize::from(row.is_some()));
    Ok(points.columns(lengths)?.collect())
}
