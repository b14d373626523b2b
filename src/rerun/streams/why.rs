//! The argument for the rise, or for the inversion of a tippe top, at the time cursor: step by step, with the numbers of the
//! run.

use nalgebra::Vector3;
use rerun::archetypes::Arrows3D;
use rerun::{Color, Radius, TextDocument};

use crate::physics::math;
use crate::rerun::entity::{WHY, WHY_GHOST};
use crate::rerun::identity::{Geometry, Identity};
use crate::rerun::output::track::Track;
use crate::rerun::output::{ComponentColumns, Output};
use crate::rerun::plots::torque_along_horizontal;
use crate::rerun::scene::arrow_columns;
use crate::telemetry::arrows::snapshot::Snapshot;
use crate::telemetry::fields::{CONTACT, MOMENTUM, POSE, TORQUE};
use crate::telemetry::proportions::Proportions;
use crate::words::number::{pair, significant};

/// Time between two texts, ns.
const STEP_NS: u64 = 100_000_000;

/// The colour of the angular momentum one second later: pale yellow.
const LATER: u32 = 0xF8F2_A0FF;

/// Time for which the torque of friction acts in the argument, s.
const LATER_TIME: f64 = 1.0;

/// Whether a run has the argument: friction acts on the contact point.
pub(in crate::rerun) fn has_why(identity: &Identity) -> bool {
    let topics = [POSE, TORQUE, CONTACT, MOMENTUM];
    topics.into_iter().all(|topic| identity.has(topic)) && identity.geometry.scales.force > 0.0
}

/// The argument.
pub(super) struct Why {
    texts: Track<String>,
    ghost: Track<[[f32; 3]; 2]>,
    geometry: Geometry,
    is_ball: bool,
    /// The first sample of the argument.
    first: Option<Snapshot>,
    next_ns: u64,
}

impl Why {
    /// Sends the style of the arrow.
    pub(super) fn new(identity: &Identity, output: &mut Output) -> Self {
        let geometry = identity.geometry;
        let radius = 0.012 * Proportions::new(&geometry.top).size();
        let style = Arrows3D::update_fields()
            .with_colors([Color::from_u32(LATER)])
            .with_radii([Radius::new_scene_units(radius as f32)])
            // Below the label of L, which is at the same place.
            .with_labels(["\nL + τ · 1 s"])
            .with_show_labels(true);
        output.send_static(WHY_GHOST, &style);
        Self {
            texts: Track::new(WHY, text_columns, output),
            ghost: Track::new(WHY_GHOST, arrow_columns, output),
            geometry,
            is_ball: Proportions::new(&geometry.top).is_ball,
            first: None,
            next_ns: 0,
        }
    }

    /// Adds the argument for a sample, if the last one is old enough.
    pub(super) fn write(&mut self, snapshot: &Snapshot, output: &mut Output) {
        let later = snapshot.momentum + LATER_TIME * snapshot.friction_torque;
        if snapshot.time_ns < self.next_ns || !later.norm().is_finite() {
            return;
        }
        self.next_ns = snapshot.time_ns.saturating_add(STEP_NS);
        let first = *self.first.get_or_insert(*snapshot);
        let mut text = self.torque(snapshot);
        text += &if self.is_ball {
            inversion(&first, snapshot, later)
        } else {
            rise(snapshot, later)
        };
        self.texts.push(output, snapshot.time_ns, [text]);
        let arrow = later / self.geometry.scales.momentum;
        let row = [snapshot.origin, arrow].map(|part| part.cast::<f32>().into());
        self.ghost.push(output, snapshot.time_ns, [row]);
    }

    /// The steps to the torque, in Markdown.
    fn torque(&self, snapshot: &Snapshot) -> String {
        let point = if self.geometry.is_free {
            "centre of mass"
        } else {
            "centre of the peg"
        };
        format!(
            "1. **v**: the contact point slips at {} m/s.\n\
             2. **F**: friction acts against the slip, with {} mN.\n\
             3. **r × F = τ**: about the {point}, r is {} mm long and the torque of friction {} mN m.",
            three(snapshot.slip.norm()),
            three(1e3 * snapshot.friction.norm()),
            three(1e3 * (snapshot.contact - snapshot.origin).norm()),
            three(1e3 * snapshot.friction_torque.norm()),
        )
    }
}

/// The steps from the torque to the rise.
fn rise(snapshot: &Snapshot, later: Vector3<f64>) -> String {
    let along = torque_along_horizontal(snapshot);
    let effect = if along < 0.0 {
        "against the horizontal part of L, which it shortens"
    } else {
        "along the horizontal part of L, which it does not shorten"
    };
    let axis = snapshot.axis;
    let theta = math::atan2(math::hypot(axis.x, axis.y), axis.z);
    let angle = math::atan2(
        axis.cross(&snapshot.momentum).norm(),
        axis.dot(&snapshot.momentum),
    );
    format!(
        " {} mN m of it act {effect}.\n\
         4. **L + τ · 1 s**: L is {} (yellow). Friction alone would make it {} in a second (pale).\n\
         5. **The axis** is {} rad from L, and inclined by θ = {} rad. The axis of a fast top follows L.\n",
        three(1e3 * along.abs()),
        parts(snapshot.momentum),
        parts(later),
        three(angle),
        three(theta),
    )
}

/// The steps from the torque to the inversion of a tippe top. Jellett's integral is L · r.
fn inversion(first: &Snapshot, snapshot: &Snapshot, later: Vector3<f64>) -> String {
    let [jellett_at_start, jellett] =
        [first, snapshot].map(|sample| sample.momentum.dot(&(sample.contact - sample.origin)));
    let [axial_at_start, axial] =
        [first, snapshot].map(|sample| 1e6 * sample.momentum.dot(&sample.axis));
    let horizontal = snapshot.horizontal_momentum().norm();
    let height = 1e3 * (snapshot.center.z - snapshot.peg.z);
    let side = if height < 0.0 { "below" } else { "above" };
    format!(
        " It is perpendicular to r, so **L · r** (Jellett's integral) stays: {} % of that at the start.\n\
         4. **L + τ · 1 s**: L is {} (yellow). Friction alone would make it {} in a second (pale). But τ goes around with \
         the axis: L stays near the vertical, from which it is {} rad now.\n\
         5. **The axis** turns over: the part of L along it was {} µN m s at the start and is {} µN m s now. The centre \
         of mass (grey) is {} mm {side} the centre of the ball (white), and the energy for its rise comes from the rotation.\n",
        three(1e2 * jellett / jellett_at_start),
        parts(snapshot.momentum),
        parts(later),
        three(math::atan2(horizontal, snapshot.momentum.z)),
        three(axial_at_start),
        three(axial),
        three(height.abs()),
    )
}

/// A number with three significant digits.
fn three(value: f64) -> String {
    significant(value, 3)
}

/// The parts of an angular momentum, in the words of the web page.
fn parts(momentum: Vector3<f64>) -> String {
    let horizontal = math::hypot(momentum.x, momentum.y);
    let [horizontal, vertical] = pair([1e3 * horizontal, 1e3 * momentum.z], 4);
    format!("horizontal {horizontal}, vertical {vertical} mN m s")
}

fn text_columns(rows: &[String]) -> ComponentColumns {
    let texts = TextDocument::update_fields()
        .with_many_text(rows.iter().map(String::as_str))
        .with_many_media_type(rows.iter().map(|_| rerun::MediaType::markdown()));
    Ok(texts.columns_of_unit_batches()?.collect())
}
