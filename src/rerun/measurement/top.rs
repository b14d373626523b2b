//! An orange top with the measured angles, over that of the run.

use nalgebra::Vector3;
use rerun::datatypes::Rgba32;

use super::{MeasuredPose, Measurement};
use crate::physics::kinematics::{Euler, world_from_body};
use crate::rerun::entity::MEASURED_TOP;
use crate::rerun::identity::Geometry;
use crate::rerun::output::Output;
use crate::rerun::output::track::Track;
use crate::rerun::palette::ORANGE;
use crate::rerun::role::GHOST;
use crate::rerun::scene::body::{BodyPose, body_columns};
use crate::rerun::scene::shape;
use crate::telemetry::Message;
use crate::telemetry::fields::{STATE, state};
use crate::telemetry::proportions::Proportions;

/// Size relative to the top of the run, so that it is visible around that one.
const SIZE: f64 = 1.015;

/// The measured top.
pub(in crate::rerun) struct MeasuredTop {
    track: Track<BodyPose>,
    poses: Vec<MeasuredPose>,
    /// Number of poses that have been written.
    written: usize,
    /// Time (ns) and ψ (rad) of the run at its last message.
    last: Option<(u64, f64)>,
}

impl MeasuredTop {
    /// Sends the body; `None` if θ and φ were not measured together.
    pub(in crate::rerun) fn new(
        measurement: &Measurement,
        geometry: &Geometry,
        output: &mut Output,
    ) -> Option<Self> {
        let poses = measurement.poses();
        if poses.is_empty() {
            return None;
        }
        let body = shape::top(&Proportions::new(&geometry.top).scaled(SIZE))
            .with_albedo_factor(Rgba32::from_u32(ORANGE & !0xFF | GHOST));
        output.send_static(format!("{MEASURED_TOP}/body"), &body);
        Some(Self {
            track: Track::new(MEASURED_TOP.to_owned(), body_columns, output),
            poses,
            written: 0,
            last: None,
        })
    }

    /// Adds the poses up to the time of a state of the run, around a peg at this place, m.
    pub(in crate::rerun) fn write(
        &mut self,
        message: &Message<'_>,
        peg: Vector3<f64>,
        output: &mut Output,
    ) {
        if message.topic() != STATE {
            return;
        }
        let now = (message.time_ns, state::PSI.of(message));
        let before = self.last.replace(now).unwrap_or(now);
        while let Some(pose) = self.poses.get(self.written)
            && pose.time_ns <= now.0
        {
            // The spin turns the top by a visible angle between two messages.
            let psi = pose
                .psi
                .unwrap_or_else(|| interpolate(before, now, pose.time_ns));
            let rotation = world_from_body(Euler {
                phi: pose.phi,
                theta: pose.theta,
                psi,
            });
            let quaternion = rotation.coords.cast::<f32>().into();
            let row = (peg.cast::<f32>().into(), quaternion);
            self.track.push(output, pose.time_ns, [row]);
            self.written += 1;
        }
    }
}

/// The value at a time (ns) on the line through two points.
fn interpolate(before: (u64, f64), after: (u64, f64), time_ns: u64) -> f64 {
    if after.0 <= before.0 {
        return after.1;
    }
    let part = time_ns.saturating_sub(before.0) as f64 / (after.0 - before.0) as f64;
    before.1 + part * (after.1 - before.1)
}
