//! Slow motion of a contact patch under Coulomb–Contensou friction.

use std::f64::consts::PI;

/// Ratios of slip and rim speed in V. F. Zhuravlev's approximation: the force is `1/(1 + FORCE q)` and the torque
/// `q/(q + TORQUE)` of their bounds, with the rim speed `q` relative to the slip speed.
const FORCE: f64 = 8.0 / (3.0 * PI);
const TORQUE: f64 = 15.0 * PI / 16.0;

/// The motion of a contact patch whose friction has the direction of a load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PatchDirection {
    /// Slip speed relative to the speed of the patch.
    pub(crate) slip: f64,
    /// Rim speed relative to the speed of the patch.
    pub(crate) rim: f64,
}

impl PatchDirection {
    /// The direction in which a load moves a patch, from its force and torque relative to their bounds; both positive,
    /// and not both zero.
    ///
    /// The load is scaled to the limit of slow motion, `(1 − F)(1 − m) = (5/2) F m`.
    pub(crate) fn under_load(force: f64, torque: f64) -> Self {
        let (sum, product) = (force + torque, force * torque);
        // The positive root of that quadratic, without cancellation.
        let scale = 2.0 / (sum + (sum * sum + 6.0 * product).sqrt());
        let (force, torque) = (scale * force, scale * torque);
        // Of two equal ratios, that without cancellation.
        let (slip, rim) = if force > torque {
            (1.0 - torque, TORQUE * torque)
        } else {
            (FORCE * force, 1.0 - force)
        };
        let size = (slip * slip + rim * rim).sqrt();
        Self {
            slip: slip / size,
            rim: rim / size,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The friction of the resulting motion has the direction of the load again.
    #[test]
    fn friction_of_a_moving_patch_opposes_its_load() {
        for (force, torque) in [
            (1.0, 0.0),
            (0.0, 1.0),
            (0.3, 0.3),
            (1e-9, 0.7),
            (0.9, 1e-12),
            (1.4, 2.0),
        ] {
            let PatchDirection { slip, rim } = PatchDirection::under_load(force, torque);
            let friction = [slip / (slip + FORCE * rim), rim / (rim + TORQUE * slip)];
            let cross = friction[0] * torque - friction[1] * force;
            // Each quotient is rounded a few times.
            let largest = f64::max(force, torque);
            assert!(
                cross.abs() <= 1e-15 * largest,
                "{force} {torque}: {cross:e}"
            );
        }
    }
}
