//! The arrows of the scene, each with its name beyond its tip.

use rerun::archetypes::{Arrows3D, Points3D};
use rerun::{Color, Radius, SerializedComponentColumn};

use super::destination::Outlet;
use super::look::Look;
use super::scene::{Vector, single};
use super::track::{Rows, Track};
use super::{Geometry, Identity, RerunError, style};
use crate::telemetry::proportions::Proportions;
use crate::telemetry::{ChannelInfo, Message};

/// Time between two positions of a label, in ns.
const LABEL_NS: u64 = 10_000_000;

/// Where an arrow begins.
#[derive(Clone, Copy)]
enum From {
    PegCenter,
    ContactPoint,
}

/// What an arrow shows. It is `length` times as long as the top is high when the quantity has the
/// size `scale`; without a scale, at its first sample.
pub(super) struct ArrowKind {
    entity: &'static str,
    label: &'static str,
    color: u32,
    topic: &'static str,
    vector: &'static str,
    in_body_axes: bool,
    from: From,
    length: f64,
    scale: fn(&Geometry) -> Option<f64>,
    unit: &'static str,
    /// Whether it is drawn where two runs are compared; all arrows of both would hide the tops.
    is_compared: bool,
}

/// All arrows. Friction's are left out when there is no friction.
pub(super) const ARROWS: [ArrowKind; 5] = [
    ArrowKind {
        entity: "scene/slip_velocity",
        label: "slip velocity",
        color: style::SKY,
        topic: "/top/contact",
        vector: "slip_world",
        in_body_axes: false,
        from: From::ContactPoint,
        length: 1.5,
        scale: |geometry| Some(geometry.slip_scale),
        unit: "m/s",
        is_compared: false,
    },
    ArrowKind {
        entity: "scene/friction_force",
        label: "friction force",
        color: style::ORANGE,
        topic: "/top/contact",
        vector: "friction_force",
        in_body_axes: false,
        from: From::ContactPoint,
        length: 1.4,
        scale: |geometry| Some(geometry.force_scale),
        unit: "N",
        is_compared: true,
    },
    ArrowKind {
        entity: "scene/gravity_torque",
        label: "gravity torque",
        color: style::GREEN,
        topic: "/top/torque",
        vector: "gravity_body",
        in_body_axes: true,
        from: From::PegCenter,
        length: 2.6,
        scale: |geometry| Some(geometry.top.gravity_moment().abs()),
        unit: "N m",
        is_compared: false,
    },
    ArrowKind {
        entity: "scene/friction_torque",
        label: "friction torque",
        color: style::VERMILLION,
        topic: "/top/torque",
        vector: "friction_body",
        in_body_axes: true,
        from: From::PegCenter,
        length: 1.5,
        scale: |geometry| Some(geometry.torque_scale),
        unit: "N m",
        is_compared: false,
    },
    ArrowKind {
        entity: "scene/angular_momentum",
        label: "angular momentum",
        color: style::YELLOW,
        topic: "/top/momentum",
        vector: "world",
        in_body_axes: false,
        from: From::PegCenter,
        length: 1.45,
        scale: |_| None,
        unit: "kg m²/s",
        is_compared: false,
    },
];

impl ArrowKind {
    /// Whether there is anything to draw: without friction its arrows have no length.
    fn exists(&self, identity: &Identity, look: &Look) -> bool {
        let scale = (self.scale)(&identity.geometry);
        identity.has_topic(self.topic)
            && scale.is_none_or(|scale| scale > 0.0)
            && (look.is_alone() || self.is_compared)
    }

    /// How far the label is moved up: what begins at the peg's centre gets its name above the
    /// tip, what lies on the table below.
    fn lift(&self, look: &Look, proportions: &Proportions) -> f64 {
        let lift = match self.from {
            From::PegCenter => 0.13,
            From::ContactPoint => 0.0,
        };
        (lift + look.lift()) * proportions.tip
    }
}

/// What the arrows mean and how long they are, in Markdown.
pub(super) fn explanation(identity: &Identity, look: &Look) -> String {
    let geometry = &identity.geometry;
    let height = Proportions::new(&geometry.top).tip;
    let mut text = "\n\n## Arrows\n\n| arrow | length |\n| --- | --- |\n".to_owned();
    for kind in ARROWS.iter().filter(|kind| kind.exists(identity, look)) {
        let size = match (kind.scale)(geometry) {
            Some(scale) => format!("{scale:.3e} {}", kind.unit),
            None => "its size at first".to_owned(),
        };
        let millimetres = 1e3 * kind.length * height;
        text += &format!("| {} | {millimetres:.0} mm for {size} |\n", kind.label);
    }
    text
}

/// One arrow: which numbers it draws, and its rows.
pub(super) struct Arrow {
    kind: &'static ArrowKind,
    look: Look,
    channel: usize,
    vector: Vector,
    contact_point: Option<Vector>,
    length: f64,
    /// Metres per unit of the quantity; taken from the first sample where no scale is known before.
    scale: Option<f64>,
    radius: f64,
    track: Track<Arrows>,
    label: Label,
}

impl Arrow {
    /// The arrow, if the table of channels has its numbers and there is anything to draw.
    pub(super) fn find(
        kind: &'static ArrowKind,
        channels: &[ChannelInfo],
        identity: &Identity,
        look: &Look,
        proportions: &Proportions,
    ) -> Option<Self> {
        let channel = channels
            .iter()
            .position(|channel| channel.topic == kind.topic)?;
        if !kind.exists(identity, look) {
            return None;
        }
        let length = kind.length * proportions.tip;
        let entity = look.entity(kind.entity);
        Some(Self {
            kind,
            look: look.clone(),
            channel,
            vector: Vector::find(&channels[channel], kind.vector)?,
            contact_point: match kind.from {
                From::PegCenter => None,
                From::ContactPoint => Some(Vector::find(&channels[channel], "contact_point")?),
            },
            length,
            scale: (kind.scale)(&identity.geometry).map(|scale| length / scale),
            radius: 0.017 * proportions.tip * look.thickness(),
            track: Track::new(entity.as_str(), Arrows::default()),
            label: Label::new(
                &entity,
                0.15 * proportions.tip,
                kind.lift(look, proportions),
            ),
        })
    }

    /// Sends colours, thickness and label.
    pub(super) fn dress(&self, outlet: &mut Outlet) -> Result<(), RerunError> {
        let entity = self.look.entity(self.kind.entity);
        let color = Color::from_u32(self.look.color(self.kind.color, 0));
        let arrow = Arrows3D::update_fields()
            .with_colors([color])
            .with_radii([Radius::new_scene_units(self.radius as f32)]);
        let label = Points3D::update_fields()
            .with_colors([color])
            .with_radii([Radius::new_ui_points(0.0)])
            .with_labels([self.look.name(self.kind.label)])
            .with_show_labels(true);
        outlet.send_static(entity.as_str(), &arrow)?;
        outlet.send_static(label_entity(&entity), &label)
    }

    /// The channel whose messages move the arrow.
    pub(super) fn channel(&self) -> usize {
        self.channel
    }

    /// Shows the viewer what it does not have yet.
    pub(super) fn show(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        self.track.show(outlet)?;
        self.label.track.show(outlet)
    }

    /// Sends all that is left.
    pub(super) fn complete(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        self.track.complete(outlet)?;
        self.label.track.complete(outlet)
    }

    /// Takes the arrow from a message of its channel; orientation (world from body) and centre of
    /// the peg are those of the last pose.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        orientation: Option<[f64; 4]>,
        peg: [f64; 3],
        outlet: &mut Outlet,
    ) -> Result<(), RerunError> {
        let mut vector = self.vector.of(message);
        if self.kind.in_body_axes {
            // Without a pose there is no telling where body axes point.
            let Some(orientation) = orientation else {
                return Ok(());
            };
            vector = rotate(orientation, vector);
        }
        let origin = self.contact_point.map_or(peg, |point| point.of(message));
        if self.scale.is_none() && norm(vector) > 0.0 {
            self.scale = Some(self.length / norm(vector));
        }
        let scale = self.scale.unwrap_or(0.0);
        let vector = vector.map(|x| scale * x);
        self.track.push(outlet, message.time_ns, |rows| {
            rows.origins.push(single(origin));
            rows.vectors.push(single(vector));
        })?;
        self.label.write(message.time_ns, origin, vector, outlet)
    }
}

/// The name of an arrow, a little beyond its tip. Short arrows go without, or all their names
/// would lie on top of each other.
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
        origin: [f64; 3],
        vector: [f64; 3],
        outlet: &mut Outlet,
    ) -> Result<(), RerunError> {
        if time_ns < self.next_ns {
            return Ok(());
        }
        self.next_ns = time_ns.saturating_add(LABEL_NS);
        let length = norm(vector);
        let beyond = 1.0 + self.shortest / length.max(self.shortest);
        let [x, y, z] = [0, 1, 2].map(|i| origin[i] + beyond * vector[i]);
        let place = [x, y, z + self.lift];
        let shown = length >= self.shortest;
        self.track.push(outlet, time_ns, |rows| {
            rows.0.push(shown.then(|| single(place)));
        })
    }
}

/// A position per row, or none.
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

/// Rotates a vector by a unit quaternion (x, y, z, w).
fn rotate([x, y, z, w]: [f64; 4], vector: [f64; 3]) -> [f64; 3] {
    let axis = [x, y, z];
    let twice = cross(axis, vector).map(|c| 2.0 * c);
    let again = cross(axis, twice);
    [0, 1, 2].map(|i| vector[i] + w * twice[i] + again[i])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn norm([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotating_by_a_quarter_turn_about_z_takes_x_to_y() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let turned = rotate([0.0, 0.0, half, half], [1.0, 0.0, 0.0]);
        assert!(turned[0].abs() < 1e-15 && (turned[1] - 1.0).abs() < 1e-15 && turned[2] == 0.0);
    }
}
