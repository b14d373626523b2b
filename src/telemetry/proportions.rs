//! The drawn shape of a top, derived from its mechanical parameters.

use crate::physics::top::Top;

/// Proportions of a drawn top, m: a spherical peg, a disc on a cone, a stem.
///
/// A tippe top, whose centre of mass is below the centre of its peg, is drawn as a truncated ball with a stem that
/// reaches to the sphere, so that it stands on its stem after inverting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proportions {
    /// Whether it is drawn as a tippe top.
    pub is_ball: bool,
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
    pub fn new(top: &Top) -> Self {
        let peg = top.peg_radius;
        if top.center_distance < 0.0 {
            return Self {
                is_ball: true,
                peg,
                disc_height: 0.0,
                disc_radius: peg,
                stem_radius: 0.16 * peg,
                tip: peg,
            };
        }
        // A lower disc would sink into the peg.
        let disc_height = top.center_distance.abs().max(peg);
        // A disc of mass M and radius r has the axial moment M r²/2.
        let disc_radius = (2.0 * top.axial_moment / top.mass).sqrt();
        Self {
            is_ball: false,
            peg,
            disc_height,
            disc_radius,
            stem_radius: 0.07 * disc_radius,
            tip: disc_height + 0.9 * disc_radius,
        }
    }

    /// These proportions multiplied by a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            is_ball: self.is_ball,
            peg: factor * self.peg,
            disc_height: factor * self.disc_height,
            disc_radius: factor * self.disc_radius,
            stem_radius: factor * self.stem_radius,
            tip: factor * self.tip,
        }
    }

    /// The length scale of a scene.
    pub fn size(&self) -> f64 {
        if self.is_ball {
            2.0 * self.peg
        } else {
            self.tip
        }
    }

    /// Height of the truncation of a tippe top's ball above its centre.
    pub fn cut(&self) -> f64 {
        0.7 * self.peg
    }

    /// Thickness of the disc.
    pub fn thickness(&self) -> f64 {
        0.2 * self.disc_radius
    }

    /// Radius of the cones where they meet the disc.
    pub fn shoulder(&self) -> f64 {
        0.45 * self.disc_radius
    }

    /// Radius of the lower cone where it meets the peg.
    pub fn neck(&self) -> f64 {
        0.72 * self.peg
    }
}
