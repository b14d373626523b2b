//! The scene: the top on its table, arrows, and the trail of the symmetry axis.
//!
//! World frame: z up, the table at z = 0, metres.

use rerun::archetypes::{LineStrips3D, Transform3D};
use rerun::datatypes::Rgba32;
use rerun::{Color, Radius, SerializedComponentColumn, ViewCoordinates};

use super::arrow::{ARROWS, Arrow};
use super::blueprint::{STAGE, TRAIL_ABOVE, TRAIL_BELOW};
use super::destination::Outlet;
use super::look::Look;
use super::shape;
use super::track::{Rows, Track};
use super::{Geometry, Identity, RerunError, style};
use crate::telemetry::proportions::Proportions;
use crate::telemetry::{ChannelInfo, Message};

/// The topic without which there is no scene.
pub(super) const POSE: &str = "/top/pose";

/// Time between two pieces of the trail, in ns.
const PIECE_NS: u64 = 10_000_000;
/// Time between two points of a piece, in ns.
const POINT_NS: u64 = 1_000_000;

/// Three numbers of a channel that form a vector.
#[derive(Clone, Copy)]
pub(super) struct Vector([usize; 3]);

impl Vector {
    pub(super) fn find(channel: &ChannelInfo, name: &str) -> Option<Self> {
        Some(Self([
            leaf(channel, name, "x")?,
            leaf(channel, name, "y")?,
            leaf(channel, name, "z")?,
        ]))
    }

    pub(super) fn of(self, message: &Message<'_>) -> [f64; 3] {
        self.0.map(|leaf| message.numbers[leaf])
    }
}

fn leaf(channel: &ChannelInfo, name: &str, component: &str) -> Option<usize> {
    let matches = |path: &str| {
        path.strip_prefix(name)
            .and_then(|rest| rest.strip_prefix('.'))
            == Some(component)
    };
    channel.numbers.iter().position(|leaf| matches(&leaf.path))
}

/// The scene, fed with the messages of several channels.
pub(super) struct Scene {
    pose: Option<Pose>,
    arrows: Vec<Arrow>,
    /// Orientation (world from body; x, y, z, w) and centre of the peg, as last heard.
    orientation: Option<[f64; 4]>,
    peg: [f64; 3],
}

impl Scene {
    /// Looks up what the table of channels offers and sends everything that does not move.
    pub(super) fn new(
        identity: &Identity,
        look: &Look,
        channels: &[ChannelInfo],
        outlet: &mut Outlet,
    ) -> Result<Self, RerunError> {
        let geometry = &identity.geometry;
        let proportions = Proportions::new(&geometry.top);
        let place = |topic: &str| channels.iter().position(|channel| channel.topic == topic);
        let arrows = ARROWS
            .iter()
            .filter_map(|kind| Arrow::find(kind, channels, identity, look, &proportions))
            .collect();
        let pose = place(POSE).and_then(|at| Pose::find(at, &channels[at], look, &proportions));
        let scene = Self {
            pose,
            arrows,
            orientation: None,
            peg: [0.0, 0.0, geometry.top.peg_radius],
        };
        if look.is_alone() {
            furnish(geometry, &proportions, outlet)?;
        }
        dress(look, &proportions, outlet)?;
        scene
            .arrows
            .iter()
            .try_for_each(|arrow| arrow.dress(outlet))?;
        Ok(scene)
    }

    /// Takes from a message what the scene shows.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        outlet: &mut Outlet,
    ) -> Result<(), RerunError> {
        if let Some(pose) = &mut self.pose
            && pose.channel == message.channel
        {
            let orientation = pose.orientation.map(|leaf| message.numbers[leaf]);
            self.orientation = Some(orientation);
            self.peg = pose.position.of(message);
            return pose.write(message, orientation, self.peg, outlet);
        }
        let (orientation, peg) = (self.orientation, self.peg);
        self.arrows
            .iter_mut()
            .filter(|arrow| arrow.channel() == message.channel)
            .try_for_each(|arrow| arrow.write(message, orientation, peg, outlet))
    }

    /// Shows the viewer what it does not have yet.
    pub(super) fn show(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        for arrow in &mut self.arrows {
            arrow.show(outlet)?;
        }
        match &mut self.pose {
            Some(pose) => pose.show(outlet),
            None => Ok(()),
        }
    }

    /// Sends all that is left.
    pub(super) fn complete(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        for arrow in &mut self.arrows {
            arrow.complete(outlet)?;
        }
        match &mut self.pose {
            Some(pose) => pose.complete(outlet),
            None => Ok(()),
        }
    }
}

/// Sends what stands still: the table and the vertical. Two runs that are compared share them.
pub(super) fn furnish(
    geometry: &Geometry,
    proportions: &Proportions,
    outlet: &mut Outlet,
) -> Result<(), RerunError> {
    let radius = 2.1 * proportions.tip;
    let height = geometry.top.peg_radius + 1.5 * proportions.tip;
    outlet.send_static(STAGE, &ViewCoordinates::RIGHT_HAND_Z_UP())?;
    outlet.send_static("scene/table", &shape::table(radius))?;
    outlet.send_static("scene/table/marks", &shape::table_marks(radius))?;
    outlet.send_static("scene/vertical", &shape::vertical(height))
}

/// Sends the body of the top in its own axes, and how its trails are drawn.
fn dress(look: &Look, proportions: &Proportions, outlet: &mut Outlet) -> Result<(), RerunError> {
    let body = shape::top(&proportions.scaled(look.size()));
    let body = match look.albedo() {
        Some(albedo) => body.with_albedo_factor(Rgba32::from_u32(albedo)),
        None => body,
    };
    outlet.send_static(look.entity("scene/top/body"), &body)?;
    outlet.send_static(look.entity(TRAIL_ABOVE), &trail_style(look, 1.3))?;
    outlet.send_static(look.entity(TRAIL_BELOW), &trail_style(look, 1.0))
}

fn trail_style(look: &Look, width: f32) -> LineStrips3D {
    LineStrips3D::update_fields()
        .with_colors([Color::from_u32(look.color(style::PURPLE, 0))])
        .with_radii([Radius::new_ui_points(width)])
}

/// The moving top and the trail of its axis.
struct Pose {
    channel: usize,
    orientation: [usize; 4],
    axis: Vector,
    position: Vector,
    track: Track<Poses>,
    trail: Trail,
}

impl Pose {
    fn find(
        channel: usize,
        info: &ChannelInfo,
        look: &Look,
        proportions: &Proportions,
    ) -> Option<Self> {
        let component = |name| leaf(info, "orientation", name);
        let orientation = [
            component("x")?,
            component("y")?,
            component("z")?,
            component("w")?,
        ];
        Some(Self {
            channel,
            orientation,
            axis: Vector::find(info, "axis")?,
            position: Vector::find(info, "peg_position")?,
            track: Track::new(look.entity("scene/top"), Poses::default()),
            trail: Trail::new(look, 1.13 * proportions.tip),
        })
    }

    fn write(
        &mut self,
        message: &Message<'_>,
        orientation: [f64; 4],
        peg: [f64; 3],
        outlet: &mut Outlet,
    ) -> Result<(), RerunError> {
        self.track.push(outlet, message.time_ns, |rows| {
            rows.quaternions.push(orientation.map(|x| x as f32));
            rows.translations.push(single(peg));
        })?;
        self.trail
            .write(message.time_ns, peg, self.axis.of(message), outlet)
    }

    fn show(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        self.track.show(outlet)?;
        self.trail.above.show(outlet)?;
        self.trail.below.show(outlet)
    }

    fn complete(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        self.track.complete(outlet)?;
        self.trail.above.complete(outlet)?;
        self.trail.below.complete(outlet)
    }
}

#[derive(Default)]
struct Poses {
    translations: Vec<[f32; 3]>,
    quaternions: Vec<[f32; 4]>,
}

impl Rows for Poses {
    fn columns(&self, start: usize) -> Result<Vec<SerializedComponentColumn>, RerunError> {
        let quaternions = self.quaternions[start..].iter();
        let transform = Transform3D::update_fields()
            .with_many_translation(self.translations[start..].iter().copied())
            .with_many_quaternion(quaternions.map(|q| rerun::Quaternion::from_xyzw(*q)));
        Ok(transform.columns_of_unit_batches()?.collect())
    }

    fn clear(&mut self) {
        self.translations.clear();
        self.quaternions.clear();
    }
}

/// The path of the symmetry axis on a sphere around the peg, and its projection onto the table.
///
/// Each row is one short piece; the blueprint shows all pieces up to the time cursor. So the size
/// of a recording grows linearly with its length, and the cursor moves along the whole path.
struct Trail {
    radius: f64,
    above: Track<Pieces>,
    below: Track<Pieces>,
    piece: Vec<[f32; 3]>,
    next_point_ns: u64,
    next_piece_ns: u64,
}

impl Trail {
    fn new(look: &Look, radius: f64) -> Self {
        let track = |path| Track::new(look.entity(path), Pieces::default());
        Self {
            radius,
            above: track(TRAIL_ABOVE),
            below: track(TRAIL_BELOW),
            piece: Vec::new(),
            next_point_ns: 0,
            next_piece_ns: PIECE_NS,
        }
    }

    fn write(
        &mut self,
        time_ns: u64,
        peg: [f64; 3],
        axis: [f64; 3],
        outlet: &mut Outlet,
    ) -> Result<(), RerunError> {
        if time_ns < self.next_point_ns {
            return Ok(());
        }
        self.next_point_ns = time_ns.saturating_add(POINT_NS);
        let [x, y, z] = [0, 1, 2].map(|i| peg[i] + self.radius * axis[i]);
        let point = single([x, y, z]);
        self.piece.push(point);
        if time_ns < self.next_piece_ns || self.piece.len() < 2 {
            return Ok(());
        }
        self.next_piece_ns = time_ns.saturating_add(PIECE_NS);
        // Each piece begins where the one before it ended.
        let piece = std::mem::replace(&mut self.piece, vec![point]);
        self.below
            .push(outlet, time_ns, |rows| rows.0.push(projected(&piece)))?;
        self.above.push(outlet, time_ns, |rows| rows.0.push(piece))
    }
}

fn projected(piece: &[[f32; 3]]) -> Vec<[f32; 3]> {
    piece.iter().map(|[x, y, _]| [*x, *y, 0.0]).collect()
}

#[derive(Default)]
struct Pieces(Vec<Vec<[f32; 3]>>);

impl Rows for Pieces {
    fn columns(&self, start: usize) -> Result<Vec<SerializedComponentColumn>, RerunError> {
        let strips = LineStrips3D::update_fields().with_strips(self.0[start..].iter().cloned());
        Ok(strips.columns_of_unit_batches()?.collect())
    }

    fn clear(&mut self) {
        self.0.clear();
    }
}

/// Rerun's scenes are single precision.
pub(super) fn single(vector: [f64; 3]) -> [f32; 3] {
    vector.map(|x| x as f32)
}
