//! Directions in which a contact point at rest begins to slip.

use crate::physics::integrate::zero;
use crate::physics::math::{cos, sin};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Number of trial directions for a beginning slip.
const DIRECTIONS: u32 = 48;

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

/// The horizontal unit vector at an angle, rad, lean frame.
fn horizontal(angle: f64) -> Vector3<f64> {
    Vector3::new(cos(angle), sin(angle), 0.0)
}

/// The horizontal component of a vector to the left of a unit vector.
fn sideways(along: &Vector3<f64>, vector: &Vector3<f64>) -> f64 {
    along.x * vector.y - along.y * vector.x
}
