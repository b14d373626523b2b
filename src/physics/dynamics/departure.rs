//! Directions in which a contact point at rest begins to slip.

use super::motion::DEPARTING;
use super::reaction::FreeBody;
use crate::physics::integrate::zero;
use crate::physics::math::{cos, sin};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Number of trial directions for a beginning slip.
const DIRECTIONS: u32 = 48;

/// Maximum number of secant iterations for the departure direction.
const MAX_ITERATIONS: u32 = 8;
/// Tangent of the first trial rotation.
const FIRST_TURN: f64 = 1e-4;

impl FreeBody<'_> {
    /// The departure direction of a contact point that friction has just released: opposite to the holding force,
    /// rotated slightly so that the slip keeps its direction.
    #[cold]
    pub(super) fn release_direction(&self) -> Vector3<f64> {
        let held = self.held().friction.force;
        let against = -held / held.norm();
        let across = Vector3::new(-against.y, against.x, 0.0);
        let turn = Turn { against, across };
        let (mut before, mut by) = (0.0, FIRST_TURN);
        let (mut error_before, mut error) = (
            self.sideways_acceleration(&turn.by(before)),
            self.sideways_acceleration(&turn.by(by)),
        );
        // The secant method: the error is nearly linear in such small turns.
        for _ in 0..MAX_ITERATIONS {
            let next = by - error * (by - before) / (error - error_before);
            // Where both errors are equal, or the turn no longer changes, rounding is reached.
            if !next.is_finite() || next == by {
                break;
            }
            (before, error_before) = (by, error);
            (by, error) = (next, self.sideways_acceleration(&turn.by(next)));
        }
        turn.by(by)
    }

    /// The component of the acceleration of a departing contact point perpendicular to its direction, m/s².
    fn sideways_acceleration(&self, along: &Vector3<f64>) -> f64 {
        sideways(along, &self.slip_acceleration(&(DEPARTING * along)))
    }
}

/// The direction in which a contact point at rest begins to slip: a unit vector parallel to the acceleration that
/// it causes; if there are several, the one with the largest acceleration.
pub(super) fn departure(
    acceleration: impl Fn(&Vector3<f64>) -> Vector3<f64>,
) -> Option<Vector3<f64>> {
    let width = TAU / f64::from(DIRECTIONS);
    // The sideways acceleration changes its sign at each direction that the slip would keep.
    let mut best: Option<(f64, Vector3<f64>)> = None;
    let first = horizontal(0.0);
    let mut before = sideways(&first, &acceleration(&first));
    for piece in 0..DIRECTIONS {
        let start = width * f64::from(piece);
        let end = horizontal(start + width);
        let after = sideways(&end, &acceleration(&end));
        if (before > 0.0) != (after > 0.0) {
            let s = zero(before, after, |s| {
                let along = horizontal(start + s * width);
                sideways(&along, &acceleration(&along))
            });
            let along = horizontal(start + s * width);
            let strength = acceleration(&along).dot(&along);
            if strength > best.map_or(0.0, |(most, _)| most) {
                best = Some((strength, along));
            }
        }
        before = after;
    }
    best.map(|(_, along)| along)
}

/// A horizontal unit vector and the one to its left.
struct Turn {
    against: Vector3<f64>,
    across: Vector3<f64>,
}

impl Turn {
    /// The first vector, turned by an angle with this tangent.
    fn by(&self, tangent: f64) -> Vector3<f64> {
        (self.against + tangent * self.across).normalize()
    }
}

/// The horizontal unit vector at an angle, rad, lean frame.
fn horizontal(angle: f64) -> Vector3<f64> {
    Vector3::new(cos(angle), sin(angle), 0.0)
}

/// The horizontal component of a vector to the left of a unit vector.
fn sideways(along: &Vector3<f64>, vector: &Vector3<f64>) -> f64 {
    along.x * vector.y - along.y * vector.x
}
