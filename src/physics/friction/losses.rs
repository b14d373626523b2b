//! Losses independent of slip: rolling resistance, drilling friction, air drag.

use super::branch::{Branch, Rocking};
use super::law::drilling_torque;
use nalgebra::{Vector2, Vector3};

/// Horizontal angular velocities below this count as zero, rad/s.
pub(crate) const NO_ROLLING: f64 = 1e-9;

/// Rolling resistance, drilling and air drag. They can be combined with any sliding law and always act in full.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Losses {
    /// Arm `δ` of rolling resistance, m: the torque is `−δ N ω_⊥ / |ω_⊥|` (the paper's friction torque has this form
    /// with δ = k R). At rest, |M| ≤ δ N.
    pub rolling_arm: f64,
    /// Drilling friction of the contact patch.
    pub drilling: Drilling,
    /// Air drag.
    pub air: Air,
}

/// Drilling friction about the vertical, for zero slip: `−(3π/16) k N a sgn ω_z′` (pressure of Hertz; the limit v = 0
/// of V. F. Zhuravlev, J. Appl. Math. Mech. 62 (1998) 705). Without turning, `|M_z′| ≤ (3π/16) k N a`.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Drilling {
    /// Coefficient of friction in the patch, dimensionless.
    pub k: f64,
    /// Radius `a` of the contact patch, m.
    pub patch_radius: f64,
}

impl Drilling {
    /// The torque about the vertical, N m, at a rate (rad/s).
    #[inline]
    fn torque(&self, normal_force: f64, rate: f64) -> f64 {
        drilling_torque(self.k, self.patch_radius, normal_force, 0.0, rate)
    }

    /// The largest torque, N m.
    pub fn bound(&self, normal_force: f64) -> f64 {
        // Of any turning backward: the torque depends on the sense only.
        self.torque(normal_force, -1.0)
    }
}

/// Air drag: `−c_n w_n n − c_t w_t − c |w_n|^(1/2) w_n n`, with the angular velocity's part `w_n` along the symmetry
/// axis `n` and the rest `w_t` across it.
///
/// The last term is that of a disc with a laminar boundary layer (T. von Kármán, Z. Angew. Math. Mech.
/// 1 (1921) 233).
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Air {
    /// `c_n`, N m s.
    pub axial: f64,
    /// `c_t`, N m s.
    pub transverse: f64,
    /// `c`, N m s^(3/2).
    pub disc: f64,
}

impl Losses {
    /// The torque in N m, in any frame whose z axis is vertical, from the angular velocity (rad/s) and the direction of
    /// the symmetry axis in that frame. Excludes what holds a top at rest, which depends on the load.
    #[inline]
    pub fn torque(
        &self,
        normal_force: f64,
        omega: &Vector3<f64>,
        axis: &Vector3<f64>,
        branch: &Branch,
    ) -> Vector3<f64> {
        self.contact_torque(normal_force, omega, branch) + self.air.torque(omega, axis)
    }

    /// The torque of rolling resistance and drilling alone, N m, in any frame whose z axis is vertical.
    #[inline]
    pub fn contact_torque(
        &self,
        normal_force: f64,
        omega: &Vector3<f64>,
        branch: &Branch,
    ) -> Vector3<f64> {
        let turning = branch.turning.rate_of(omega.z);
        let drilling = self.drilling.torque(normal_force, turning);
        let rolling = self.rolling_resistance(normal_force, omega, branch.rocking);
        Vector3::new(-rolling.x, -rolling.y, drilling)
    }

    /// `δ N ω_⊥ / |ω_⊥|`, N m; 0 without rolling.
    #[inline]
    fn rolling_resistance(
        &self,
        normal_force: f64,
        omega: &Vector3<f64>,
        rocking: Rocking,
    ) -> Vector2<f64> {
        let rate = (omega.x * omega.x + omega.y * omega.y).sqrt();
        match rocking {
            // The rate is still too small to have a direction.
            Rocking::Starting(direction) if rate < NO_ROLLING => {
                self.rolling_arm * normal_force * direction.xy()
            }
            Rocking::Along(direction) => self.rolling_arm * normal_force * direction.xy(),
            Rocking::Any | Rocking::Starting(_) | Rocking::Breakaway if rate > 0.0 => {
                let per_rate = self.rolling_arm * normal_force / rate;
                Vector2::new(per_rate * omega.x, per_rate * omega.y)
            }
            // Held: what it has to be follows from the balance.
            Rocking::Any | Rocking::Starting(_) | Rocking::Breakaway | Rocking::Held => {
                Vector2::zeros()
            }
        }
    }

    /// Whether all losses are zero.
    #[inline]
    pub fn is_none(&self) -> bool {
        self.rolling_arm == 0.0 && !self.turns_about_vertical()
    }

    /// Whether a loss has a torque about the vertical.
    #[inline]
    pub fn turns_about_vertical(&self) -> bool {
        self.drilling.k != 0.0 || self.air != Air::default()
    }
}

impl Air {
    #[inline]
    pub(super) fn torque(&self, omega: &Vector3<f64>, axis: &Vector3<f64>) -> Vector3<f64> {
        let axial_rate = omega.dot(axis);
        // The transverse coefficient acts on all of ω, so the axial one has to make up for it along the axis.
        let along = self.axial + self.disc * axial_rate.abs().sqrt() - self.transverse;
        -self.transverse * omega - along * axial_rate * axis
    }
}
