//! The shape of a drawn top, which follows from its mechanics.

use crate::physics::top::Top;

/// Proportions of a drawn top, in metres: a spherical peg, a disc on a cone, a stem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proportions {
    /// Radius of the peg.
    pub peg: f64,
    /// Height of the disc's middle above the peg's centre.
    pub disc_height: f64,
    /// Radius of the disc.
    pub disc_radius: f64,
    /// Radius of the stem.
    pub stem_radius: f64,
    /// Height of the stem's tip above the peg's centre.
    pub tip: f64,
}

impl Proportions {
    /// The proportions of a top: its disc has the axial moment of inertia, at the height of the centre of mass.
    #[must_use]
    pub fn new(top: &Top) -> Self {
        let peg = top.peg_radius;
        let disc_height = top.center_distance.abs().max(peg);
        let disc_radius = (2.0 * top.axial_moment / top.mass).sqrt();
        Self {
            peg,
            disc_height,
            disc_radius,
            stem_radius: 0.07 * disc_radius,
            tip: disc_height + 0.9 * disc_radius,
        }
    }

    /// These proportions multiplied by a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            peg: factor * self.peg,
            disc_height: factor * self.disc_height,
            disc_radius: factor * self.disc_radius,
            stem_radius: factor * self.stem_radius,
            tip: factor * self.tip,
        }
    }

    /// Thickness of the disc.
    #[must_use]
    pub fn thickness(&self) -> f64 {
        0.2 * self.disc_radius
    }

    /// Radius of the cones where they meet the disc.
    #[must_use]
    pub fn shoulder(&self) -> f64 {
        0.45 * self.disc_radius
    }

    /// Radius of the lower cone where it meets the peg.
    #[must_use]
    pub fn neck(&self) -> f64 {
        0.72 * self.peg
    }
}
