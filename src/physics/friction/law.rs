//! Sliding friction laws and drilling torque.

use crate::physics::formula::{InvalidCoefficient, Program};
use crate::physics::math::{exp, tanh};
use std::f64::consts::PI;
use std::sync::Arc;

/// Above this multiple of the Stribeck velocity, e^(−ratio²) is below 1e-21.
const NEGLIGIBLE_RATIO: f64 = 7.0;

/// A sliding friction law: the force `f` as a function of slip velocity `v` and normal force `N`.
///
/// `k` is always the dimensionless coefficient of friction; speeds are in m/s. The force is opposite to the slip
/// velocity.
#[derive(Clone, Debug, PartialEq)]
pub enum FrictionLaw {
    /// No friction at all.
    None,
    /// Coulomb's law `f = −k N v / |v|` (the paper, section 2). At rest, |f| ≤ k N.
    Coulomb {
        /// Coefficient of friction `k`, dimensionless.
        k: f64,
    },
    /// Coulomb's law, smoothed around zero slip on the scale `v_ε`.
    Regularised {
        /// Coefficient of friction at speeds far above `v_ε`.
        k: f64,
        /// Scale of the slip speed `v_ε`, m/s.
        speed: f64,
        /// The function that replaces the jump.
        shape: Smoothing,
    },
    /// Viscous friction `f = −k N v / v_0` (N. M. Bou-Rabee, J. E. Marsden, L. A. Romero, SIAM J. Appl.
    /// Dyn. Syst. 3 (2004) 352).
    Viscous {
        /// Coefficient of friction at the speed `v_0`.
        k: f64,
        /// Speed `v_0` at which the force is `k N`, m/s.
        speed: f64,
    },
    /// Stribeck's law `f = −N (k + (k_s − k) e^(−(v/v_s)²) + c_v |v|) v / |v|` (B. Armstrong-Hélouvry, P. Dupont, C.
    /// Canudas de Wit, Automatica 30 (1994) 1083). At rest, |f| ≤ k_s N.
    Stribeck {
        /// Coefficient of kinetic friction `k`.
        k: f64,
        /// Coefficient of static friction `k_s`.
        static_k: f64,
        /// Stribeck's speed `v_s`, m/s.
        speed: f64,
        /// Slope of the viscous part `c_v`, s/m.
        slope: f64,
    },
    /// Coulomb's law integrated over a spinning contact patch (Coulomb–Contensou), in V. F. Zhuravlev's approximation
    /// (J. Appl. Math. Mech. 62 (1998) 705): `f = −k N v / (|v| + 8 a |ω_z′| / 3π)`, with the drilling torque of
    /// [`drilling_torque`].
    Contensou {
        /// Coefficient of friction in the patch.
        k: f64,
        /// Radius `a` of the contact patch, m.
        patch_radius: f64,
    },
    /// A person's own law `f = −μ(v) N v / |v|`. At rest, |f| ≤ k_s N.
    Formula {
        /// The coefficient of friction `μ(v)`.
        coefficient: Arc<Program>,
        /// Coefficient of static friction `k_s`; 0 if the law is smooth, `μ(0) = 0`.
        static_k: f64,
    },
}

/// The function that replaces the jump of Coulomb's law: `f = −k N g(|v|) v / |v|`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothing {
    /// `g = v / √(v² + v_ε²)`.
    SquareRoot,
    /// `g = tanh(v / v_ε)`.
    Tanh,
    /// `g = v / (v + v_ε)` (T. Ueda, K. Sasaki, S. Watanabe, SIAM J. Appl. Dyn. Syst. 4 (2005) 1159).
    Rational,
}

impl FrictionLaw {
    /// Friction force per slip velocity, N s/m: `|f| / |v|` at a slip speed above 0 (m/s), with the angular
    /// velocity `drilling` about the vertical (rad/s) under a normal force (N).
    #[inline]
    pub fn resistance(&self, slip_speed: f64, drilling: f64, normal_force: f64) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Coulomb { k } => k * normal_force / slip_speed,
            Self::Regularised { k, speed, shape } => {
                k * normal_force * shape.per_speed(slip_speed, speed)
            }
            Self::Viscous { k, speed } => k * normal_force / speed,
            Self::Stribeck {
                k,
                static_k,
                speed,
                slope,
            } => {
                let ratio = slip_speed / speed;
                // Beyond this, the exponential is below rounding.
                let excess = if ratio < NEGLIGIBLE_RATIO {
                    (static_k - k) * exp(-ratio * ratio)
                } else {
                    0.0
                };
                let coefficient = k + excess + slope * slip_speed;
                coefficient * normal_force / slip_speed
            }
            Self::Contensou { k, patch_radius } => {
                let rim_speed = patch_radius * drilling.abs();
                k * normal_force / (slip_speed + 8.0 / (3.0 * PI) * rim_speed)
            }
            Self::Formula {
                ref coefficient, ..
            } => coefficient.at(slip_speed) * normal_force / slip_speed,
        }
    }

    /// Coefficient of friction μ = |f|/N at a slip speed above 0 (m/s), with the angular velocity `drilling` about the
    /// vertical (rad/s).
    pub fn coefficient(&self, slip_speed: f64, drilling: f64) -> f64 {
        self.resistance(slip_speed, drilling, 1.0) * slip_speed
    }

    /// Upper bound of the friction force at a slip speed (m/s) and normal force (N), N.
    pub fn bound(&self, slip_speed: f64, normal_force: f64) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Coulomb { k } | Self::Regularised { k, .. } | Self::Contensou { k, .. } => {
                k * normal_force
            }
            Self::Viscous { k, speed } => k * normal_force * slip_speed / speed,
            Self::Stribeck {
                k, static_k, slope, ..
            } => (k.max(static_k) + slope * slip_speed) * normal_force,
            Self::Formula {
                ref coefficient,
                static_k,
            } => coefficient.at(slip_speed).max(static_k) * normal_force,
        }
    }

    /// Upper bound of |f|/N over all slip speeds; infinite if it grows with the slip speed, or may do so.
    pub fn largest_coefficient(&self) -> f64 {
        match *self {
            Self::None | Self::Viscous { k: 0.0, .. } => 0.0,
            Self::Coulomb { k } | Self::Regularised { k, .. } | Self::Contensou { k, .. } => k,
            Self::Stribeck {
                k,
                static_k,
                slope: 0.0,
                ..
            } => k.max(static_k),
            Self::Formula {
                ref coefficient,
                static_k,
            } => coefficient
                .constant()
                .map_or(f64::INFINITY, |k| k.max(static_k)),
            Self::Viscous { .. } | Self::Stribeck { .. } => f64::INFINITY,
        }
    }

    /// Maximum static friction force on a top that turns about the vertical at a rate (rad/s), N; 0 where the law is
    /// smooth. A contact patch that doesn't turn has Coulomb's law.
    #[inline]
    pub fn static_bound_at(&self, normal_force: f64, turning_rate: f64) -> f64 {
        if let Self::Contensou { k, .. } = *self
            // A patch that turns has no discontinuity at zero slip: the rim always slips.
            && turning_rate == 0.0
        {
            return k * normal_force;
        }
        self.static_bound(normal_force)
    }

    /// Margin of the friction that holds the contact point, N, for the required force (N) and torque about the vertical
    /// (N m); negative if it yields.
    ///
    /// Coulomb–Contensou friction holds within the forces and torques of its limit of slow motion. With the force `F` and
    /// the torque `m` relative to their bounds, that is where `(1 − F)(1 − m) > (5/2) F m`.
    #[inline]
    pub fn holding_margin(&self, normal_force: f64, force: f64, torque: f64) -> f64 {
        let Self::Contensou { k, patch_radius } = *self else {
            return self.static_bound(normal_force) - force;
        };
        let bound = k * normal_force;
        let relative = force / bound;
        let drilling = drilling_torque(k, patch_radius, normal_force, 0.0, 1.0);
        let turning = (torque / drilling).abs();
        let rest = (1.0 - relative) * (1.0 - turning);
        // Beyond both bounds, both factors are negative.
        let signed_rest = if relative > 1.0 { -rest.abs() } else { rest };
        bound * (signed_rest - 2.5 * relative * turning)
    }

    /// Maximum static friction force, N, whatever the rate about the vertical; 0 for smooth laws.
    #[inline]
    pub fn static_bound(&self, normal_force: f64) -> f64 {
        match *self {
            Self::Coulomb { k } => k * normal_force,
            Self::Stribeck { static_k, .. } | Self::Formula { static_k, .. } => {
                static_k * normal_force
            }
            Self::None
            | Self::Regularised { .. }
            | Self::Viscous { .. }
            | Self::Contensou { .. } => 0.0,
        }
    }

    /// Checks the law at a slip speed, m/s.
    ///
    /// # Errors
    /// If a formula has no coefficient of friction there.
    #[inline]
    pub fn check(&self, slip_speed: f64) -> Result<(), InvalidCoefficient> {
        let Self::Formula { coefficient, .. } = self else {
            return Ok(());
        };
        coefficient.check(slip_speed)
    }

    /// Whether there is no friction force at any slip.
    pub fn is_none(&self) -> bool {
        self.largest_coefficient() == 0.0
    }
}

impl Smoothing {
    /// `g(v) / v` in s/m.
    #[inline]
    fn per_speed(self, slip_speed: f64, scale: f64) -> f64 {
        match self {
            Self::SquareRoot => 1.0 / (slip_speed * slip_speed + scale * scale).sqrt(),
            Self::Tanh => tanh(slip_speed / scale) / slip_speed,
            Self::Rational => 1.0 / (slip_speed + scale),
        }
    }
}

/// Torque about the vertical, N m, of a contact patch of radius `a` (m) with Hertzian pressure that spins with `ω`
/// (rad/s) and slips (m/s): `−(3π/16) k N a · a ω / (a |ω| + 15π |v| / 16)` (V. F. Zhuravlev, J. Appl. Math. Mech. 62
/// (1998) 705). Without slip it is that of pure drilling.
#[inline]
pub fn drilling_torque(k: f64, a: f64, normal_force: f64, slip_speed: f64, omega: f64) -> f64 {
    let rim_velocity = a * omega;
    // Written as a quotient of speeds, which is exactly ±1 for pure drilling.
    let speed = rim_velocity.abs() + 15.0 * PI / 16.0 * slip_speed;
    if speed > 0.0 {
        -3.0 * PI / 16.0 * k * normal_force * a * (rim_velocity / speed)
    } else {
        0.0
    }
}
