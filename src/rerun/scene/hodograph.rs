//! The horizontal part of the angular momentum from above: its tip moves with the torques.
//!
//! In two dimensions, in percent of the greatest horizontal part: viewers draw very small lengths badly. Rerun's y axis
//! points down, so y is negated.

use nalgebra::Vector3;
use rerun::archetypes::{Arrows2D, LineStrips2D};
use rerun::{Color, Radius};
use std::f64::consts::TAU;

use crate::physics::math;
use crate::rerun::entity::{HODOGRAPH, HODOGRAPH_PATH};
use crate::rerun::identity::Identity;
use crate::rerun::output::track::Track;
use crate::rerun::output::{ComponentColumns, Output};
use crate::rerun::palette::{GREEN, PURPLE, VERMILION, YELLOW};
use crate::rerun::role::Role;
use crate::telemetry::arrows::scale::{Scales, round};
use crate::telemetry::arrows::snapshot::Snapshot;
use crate::telemetry::fields::{MOMENTUM, POSE, TORQUE};

/// The greatest horizontal part in the picture.
pub(in crate::rerun) const RADIUS: f64 = 100.0;

/// Length of the usual torques in the picture, relative to the greatest horizontal part.
const TORQUE_LENGTH: f64 = 0.4;

/// Number of rings around the centre.
const RINGS: u32 = 4;

/// The picture.
pub(super) struct Hodograph {
    momentum: Track<[[f32; 2]; 2]>,
    path: Track<[[f32; 2]; 2]>,
    /// The torques, with the times in s for which they are drawn: friction and weight.
    torques: Vec<(Track<[[f32; 2]; 2]>, f64)>,
    last: Option<[f32; 2]>,
    /// Lengths in the picture per kg m²/s.
    scale: f64,
}

/// Times in s in which the usual torques of friction and weight make a visible change.
fn times(scales: &Scales) -> [f64; 2] {
    let length = TORQUE_LENGTH * scales.horizontal_momentum;
    scales.usual_torques.map(|usual| round(length / usual))
}

impl Hodograph {
    /// Sends colours, names and rings; `None` if the run has no such picture.
    pub(super) fn new(identity: &Identity, role: &Role, output: &mut Output) -> Option<Self> {
        if !is_shown(identity) || !role.is_alone() {
            return None;
        }
        let scales = &identity.geometry.scales;
        output.send_static(format!("{HODOGRAPH}/rings"), &rings());
        let path = LineStrips2D::update_fields()
            .with_colors([Color::from_u32(PURPLE)])
            .with_radii([Radius::new_ui_points(0.8)]);
        output.send_static(HODOGRAPH_PATH, &path);
        let mut torques = Vec::new();
        let kinds = [("friction", "τ", VERMILION), ("gravity", "Mg", GREEN)];
        for ((name, label, color), time) in kinds.into_iter().zip(times(scales)) {
            if time > 0.0 {
                torques.push((arrow(name, label, color, 2.2, output), time));
            }
        }
        Some(Self {
            momentum: arrow("momentum", "L", YELLOW, 2.2, output),
            path: Track::new(HODOGRAPH_PATH, path_columns, output),
            torques,
            last: None,
            scale: RADIUS / scales.horizontal_momentum,
        })
    }

    /// Adds a row for a sample.
    pub(super) fn write(&mut self, snapshot: &Snapshot, output: &mut Output) {
        let tip = self.flat(snapshot.momentum);
        let torques = [snapshot.friction_torque, snapshot.weight_torque];
        if !tip.iter().all(|part| part.is_finite()) {
            return;
        }
        let time_ns = snapshot.time_ns;
        self.momentum.push(output, time_ns, [[[0.0; 2], tip]]);
        for ((track, time), torque) in self.torques.iter().zip(torques) {
            track.push(output, time_ns, [[tip, self.flat(*time * torque)]]);
        }
        if let Some(last) = self.last.replace(tip) {
            self.path.push(output, time_ns, [[last, tip]]);
        }
    }

    /// The horizontal part of an angular momentum in the picture.
    fn flat(&self, vector: Vector3<f64>) -> [f32; 2] {
        [vector.x, -vector.y].map(|part| (self.scale * part) as f32)
    }
}

/// The times for which the torques are drawn, as a sentence.
pub(super) fn legend(scales: &Scales) -> String {
    let mut text = " View from above: the torques are the change that they make".to_owned();
    for (name, time) in ["friction, τ,", "gravity, Mg,"]
        .into_iter()
        .zip(times(scales))
    {
        if time > 0.0 {
            text += &format!("; {name} in {time} s");
        }
    }
    text + "."
}

/// Whether a run has such a picture.
pub(in crate::rerun) fn is_shown(identity: &Identity) -> bool {
    let topics = [POSE, TORQUE, MOMENTUM];
    topics.into_iter().all(|topic| identity.has(topic))
        && identity.geometry.scales.horizontal_momentum > 0.0
}

fn arrow(
    name: &str,
    label: &str,
    color: u32,
    width: f32,
    output: &mut Output,
) -> Track<[[f32; 2]; 2]> {
    let entity = format!("{HODOGRAPH}/{}", name.replace(' ', "_"));
    let style = Arrows2D::update_fields()
        .with_colors([Color::from_u32(color)])
        .with_radii([Radius::new_ui_points(width)])
        .with_labels([label])
        .with_show_labels(true)
        .with_draw_order(10.0);
    output.send_static(entity.as_str(), &style);
    Track::new(entity, arrow_columns, output)
}

/// Rings around the centre, up to the greatest horizontal part.
fn rings() -> LineStrips2D {
    let ring = |ring: u32| {
        let radius = RADIUS * f64::from(ring) / f64::from(RINGS);
        (0..=64)
            .map(|step| math::sin_cos(TAU * f64::from(step) / 64.0))
            .map(|(sin, cos)| [(radius * cos) as f32, (radius * sin) as f32])
            .collect::<Vec<_>>()
    };
    LineStrips2D::new((1..=RINGS).map(ring))
        .with_colors([Color::from_u32(0x4A52_60FF)])
        .with_radii([Radius::new_ui_points(0.5)])
}

fn arrow_columns(rows: &[[[f32; 2]; 2]]) -> ComponentColumns {
    let arrows = Arrows2D::update_fields()
        .with_origins(rows.iter().map(|[origin, _]| *origin))
        .with_vectors(rows.iter().map(|[_, vector]| *vector));
    Ok(arrows.columns_of_unit_batches()?.collect())
}

fn path_columns(rows: &[[[f32; 2]; 2]]) -> ComponentColumns {
    let strips = LineStrips2D::update_fields().with_strips(rows.iter().copied());
    Ok(strips.columns_of_unit_batches()?.collect())
}
