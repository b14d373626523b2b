//! The arrows of the scene, each with its name beyond its tip.

use nalgebra::{UnitQuaternion, Vector3};
use rerun::archetypes::{Arrows3D, Points3D};
use rerun::{Color, Radius, SerializedComponentColumn};

use crate::rerun::error::RerunError;
use crate::rerun::identity::{Geometry, Identity};
use crate::rerun::look::Look;
use crate::rerun::outlet::Outlet;
use crate::rerun::palette;
use crate::rerun::scale::{self, Scales};
use crate::rerun::track::{Collect, Flush, Rows, Track};
use crate::telemetry::Message;
use crate::telemetry::fields::{VectorField, contact, momentum, torque};
use crate::telemetry::proportions::Proportions;

/// Time between two positions of a label, in ns.
const LABEL_NS: u64 = 10_000_000;

/// Quantity and look of an arrow.
pub(super) struct ArrowKind {
    label: &'static str,
    color: u32,
    vector: VectorField,
    in_body_axes: bool,
    origin: Origin,
    /// Quantity per metre of it.
    scale: fn(&Scales) -> f64,
    /// Whether it is drawn where two runs are compared; all arrows of both would hide the tops.
    is_compared: bool,
}

/// The point where an arrow begins.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Origin {
    /// The centre of the peg.
    Peg,
    /// The point of contact, or the lowest point of a peg in the air.
    Contact,
}

/// All kinds of arrows.
pub(super) const ARROWS: [ArrowKind; 5] = [
    ArrowKind {
        label: "slip velocity",
        color: palette::SKY,
        vector: contact::SLIP_WORLD,
        in_body_axes: false,
        origin: Origin::Contact,
        scale: |scales| scales.slip,
        is_compared: false,
    },
    ArrowKind {
        label: "friction force",
        color: palette::ORANGE,
        vector: contact::FRICTION_FORCE,
        in_body_axes: false,
        origin: Origin::Contact,
        scale: |scales| scales.force,
        is_compared: true,
    },
    ArrowKind {
        label: "gravity torque",
        color: palette::GREEN,
        vector: torque::GRAVITY_BODY,
        in_body_axes: true,
        origin: Origin::Peg,
        scale: |scales| scales.gravity_torque,
        is_compared: false,
    },
    ArrowKind {
        label: "friction torque",
        color: palette::VERMILLION,
        vector: torque::FRICTION_BODY,
        in_body_axes: true,
        origin: Origin::Peg,
        scale: |scales| scales.friction_torque,
        is_compared: false,
    },
    ArrowKind {
        label: "angular momentum",
        color: palette::YELLOW,
        vector: momentum::WORLD,
        in_body_axes: false,
        origin: Origin::Peg,
        scale: |scales| scales.momentum,
        is_compared: false,
    },
];

impl ArrowKind {
    fn entity(&self) -> String {
        format!("scene/{}", self.label.replace(' ', "_"))
    }

    /// Whether there is anything to draw: without friction its arrows have no length.
    fn exists(&self, identity: &Identity, look: &Look) -> bool {
        identity.has(self.vector.topic())
            && (self.scale)(&identity.geometry.scales) > 0.0
            && (look.is_alone() || self.is_compared)
    }

    /// Quantity per centimetre of the arrow.
    fn legend(&self, geometry: &Geometry) -> String {
        scale::legend((self.scale)(&geometry.scales), self.vector.x().unit())
    }

    /// Distance by which the label is moved up from the tip, in m, so that labels at the peg and on the table don't meet.
    fn lift(&self, look: &Look, proportions: &Proportions) -> f64 {
        let lift = if self.origin == Origin::Peg {
            0.13
        } else {
            0.0
        };
        (lift + look.lift()) * proportions.size()
    }
}

/// Quantity per centimetre of each arrow, in Markdown.
pub(crate) fn explanation(identity: &Identity, look: &Look) -> String {
    let mut text = "\n\n## Arrows\n\n| arrow | scale |\n| --- | --- |\n".to_owned();
    for kind in ARROWS.iter().filter(|kind| kind.exists(identity, look)) {
        text += &format!("| {} | {} |\n", kind.label, kind.legend(&identity.geometry));
    }
    text
}

/// One arrow: what it shows, and its rows.
pub(super) struct Arrow {
    kind: &'static ArrowKind,
    look: Look,
    /// Metres per unit of the quantity.
    scale: f64,
    /// Its name and scale.
    text: String,
    radius: f64,
    track: Track<Arrows>,
    label: Label,
}

impl Arrow {
    /// The arrows for which there is anything to draw.
    pub(super) fn all(identity: &Identity, look: &Look) -> Vec<Self> {
        let kinds = ARROWS.iter().filter(|kind| kind.exists(identity, look));
        kinds
            .map(|kind| Self::new(kind, &identity.geometry, look))
            .collect()
    }

    fn new(kind: &'static ArrowKind, geometry: &Geometry, look: &Look) -> Self {
        let proportions = Proportions::new(&geometry.top);
        let entity = look.entity(&kind.entity());
        let shortest = 0.15 * proportions.size();
        Self {
            kind,
            look: look.clone(),
            scale: (kind.scale)(&geometry.scales).recip(),
            text: format!(
                "{} ({})",
                look.short_name(kind.label),
                kind.legend(geometry)
            ),
            radius: 0.017 * proportions.size() * look.thickness(),
            track: Track::new(entity.as_str(), Arrows::default()),
            label: Label::new(&entity, shortest, kind.lift(look, &proportions)),
        }
    }

    /// Sends colours, thickness and label.
    pub(super) fn dress(&self, outlet: &mut Outlet) {
        let entity = self.look.entity(&self.kind.entity());
        let color = Color::from_u32(self.look.color(self.kind.color, 0));
        let arrow = Arrows3D::update_fields()
            .with_colors([color])
            .with_radii([Radius::new_scene_units(self.radius as f32)]);
        let label = Points3D::update_fields()
            .with_colors([color])
            .with_radii([Radius::new_ui_points(0.0)])
            .with_labels([self.text.as_str()])
            .with_show_labels(true);
        outlet.send_static(entity.as_str(), &arrow);
        outlet.send_static(label_entity(&entity), &label);
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
        if message.topic() != self.kind.vector.topic() {
            return;
        }
        let own = self.kind.vector.of(message);
        let vector = match orientation {
            _ if !self.kind.in_body_axes => own,
            Some(orientation) => orientation * own,
            // Without a pose the directions of the body axes are unknown.
            None => return,
        };
        let origin = match self.kind.origin {
            Origin::Peg => peg,
            Origin::Contact => contact,
        };
        let vector = self.scale * vector;
        self.track.push(outlet, message.time_ns, |rows| {
            rows.origins.push(origin.cast::<f32>().into());
            rows.vectors.push(vector.cast::<f32>().into());
        });
        self.label.write(message.time_ns, origin, vector, outlet);
    }
}

impl Collect for Arrow {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        self.track.flush(outlet, flush);
        self.label.track.flush(outlet, flush);
    }
}

/// The name of an arrow, a little beyond its tip. Short arrows go without: their names would lie on top of each other.
struct Label {
    shortest: f64,
    lift: f64,
    next_ns: u64,
    track: Track<Positions>,
}

fn label_entity(arrow: &str) -> String {
    format!("{arrow}/label")
}

impl Label {
    fn new(arrow: &str, shortest: f64, lift: f64) -> Self {
        Self {
            shortest,
            lift,
            next_ns: 0,
            track: Track::new(label_entity(arrow), Positions::default()),
        }
    }

    fn write(
        &mut self,
        time_ns: u64,
        origin: Vector3<f64>,
        vector: Vector3<f64>,
        outlet: &mut Outlet,
    ) {
        if time_ns < self.next_ns {
            return;
        }
        self.next_ns = time_ns.saturating_add(LABEL_NS);
        let length = vector.norm();
        let beyond = 1.0 + self.shortest / length.max(self.shortest);
        let place = origin + beyond * vector + self.lift * Vector3::z();
        let shown = length >= self.shortest;
        self.track.push(outlet, time_ns, |rows| {
            rows.0.push(shown.then(|| place.cast::<f32>().into()));
        });
    }
}

/// Rows of a position, or of none.
#[derive(Default)]
struct Positions(Vec<Option<[f32; 3]>>);

impl Rows for Positions {
    fn columns(&self, start: usize) -> Result<Vec<SerializedComponentColumn>, RerunError> {
        let rows = &self.0[start..];
        let points = Points3D::update_fields().with_positions(rows.iter().copied().flatten());
        let lengths = rows.iter().map(|row| usize::from(row.is_some()));
        Ok(points.columns(lengths)?.collect())
    }

    fn clear(&mut self) {
        self.0.clear();
    }
}

/// Rows of an arrow.
#[derive(Default)]
struct Arrows {
    origins: Vec<[f32; 3]>,
    vectors: Vec<[f32; 3]>,
}

impl Rows for Arrows {
    fn columns(&self, start: usize) -> Result<Vec<SerializedComponentColumn>, RerunError> {
        let arrows = Arrows3D::update_fields()
            .with_origins(self.origins[start..].iter().copied())
            .with_vectors(self.vectors[start..].iter().copied());
        Ok(arrows.columns_of_unit_batches()?.collect())
    }

    fn clear(&mut self) {
        self.origins.clear();
        self.vectors.clear();
    }
}
