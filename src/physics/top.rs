//! The rigid body: a heavy symmetric top with a spherical peg.

use crate::physics::kinematics::{Euler, Tilt};
use crate::physics::math::{cos, sin_cos};
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};

/// A symmetric top whose peg is a sphere, on a horizontal table, in uniform gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Top {
    /// Mass `M`, kg.
    pub mass: f64,
    /// Transverse moment of inertia `I_x = I_y` about the centre of the peg, kg m².
    pub transverse_moment: f64,
    /// Axial moment of inertia `I_z`, about the symmetry axis, kg m².
    pub axial_moment: f64,
    /// Distance `l` from the centre of the peg to the centre of mass, m.
    pub center_distance: f64,
    /// Radius `R` of the peg, m.
    pub peg_radius: f64,
    /// Acceleration of gravity `g`, m/s².
    pub gravity: f64,
}

/// The two rates of regular precession, rad/s (Klein and Sommerfeld, The Theory of the Top).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrecessionRoots {
    /// The slow root.
    pub slow: f64,
    /// The fast root (almost independent of gravity).
    pub fast: f64,
}

impl PrecessionRoots {
    /// The roots of `quadratic φ̇² − spin φ̇ + constant = 0`, if they are real and finite.
    pub(super) fn new(quadratic: f64, spin: f64, constant: f64) -> Option<Self> {
        let discriminant = spin * spin - 4.0 * quadratic * constant;
        if discriminant < 0.0 {
            return None;
        }
        // The sum without cancellation; the other root follows from the product of the two.
        let half_sum = 0.5 * (spin + discriminant.sqrt().copysign(spin));
        let roots = Self {
            slow: constant / half_sum,
            fast: half_sum / quadratic,
        };
        (roots.slow.is_finite() && roots.fast.is_finite()).then_some(roots)
    }
}

impl Top {
    /// Weight `M g`, N.
    #[inline]
    pub fn weight(&self) -> f64 {
        self.mass * self.gravity
    }

    /// Largest torque of gravity, `M g l`, N m.
    #[inline]
    pub fn gravity_moment(&self) -> f64 {
        self.mass * self.gravity * self.center_distance
    }

    /// Moment of inertia about the centre of mass across the symmetry axis, `I_x − M l²`, kg m².
    #[inline]
    pub fn central_moment(&self) -> f64 {
        self.transverse_moment - self.mass * self.center_distance * self.center_distance
    }

    /// The smallest principal moment of inertia about the centre of mass, kg m².
    pub fn least_moment(&self) -> f64 {
        let (axial, central) = (self.axial_moment, self.central_moment());
        if axial < central { axial } else { central }
    }

    /// The top with its moments of inertia about the centre of mass instead of the peg's centre.
    #[inline]
    pub fn about_center(&self) -> Self {
        Self {
            transverse_moment: self.central_moment(),
            ..*self
        }
    }

    /// Torque of gravity about the peg's centre in the lean frame, N m: `M g l sin θ` about the line
    /// of nodes (the paper's equation (5)).
    #[inline]
    pub fn gravity_torque(&self, tilt: &Tilt) -> Vector3<f64> {
        Vector3::new(0.0, self.gravity_moment() * tilt.sin, 0.0)
    }

    /// Speed of the contact point over the table, m/s.
    #[inline]
    pub fn slip_speed(&self, tilt: &Tilt) -> f64 {
        let slip = tilt.slip_velocity(self.peg_radius);
        (slip.x * slip.x + slip.y * slip.y).sqrt()
    }

    /// Contribution of a torque about the peg's centre (node frame, N m) to θ̈, φ̈ and ψ̈, rad/s².
    ///
    /// Upright, only φ̈ + ψ̈ is defined, and φ̈ is taken as 0.
    #[inline]
    pub fn euler_accelerations(&self, torque: &Vector3<f64>, tilt: &Tilt) -> Euler {
        let phi = if tilt.is_upright() {
            0.0
        } else {
            torque.y / (self.transverse_moment * tilt.sin)
        };
        Euler {
            phi,
            theta: torque.x / self.transverse_moment,
            psi: torque.z / self.axial_moment - phi * tilt.cos,
        }
    }

    /// Moment of inertia about the vertical through the peg's centre, kg m², given sine and cosine of θ.
    #[inline]
    pub fn vertical_moment(&self, sin: f64, cos: f64) -> f64 {
        self.transverse_moment * sin * sin + self.axial_moment * cos * cos
    }

    /// The least energy on the table with this Jellett's integral `J`, J, for sine and cosine of θ; zero potential as in
    /// [`Top::potential_energy`].
    ///
    /// `J = L·a` with `a = l n + R z′`, so the energy of the rotation, `L·𝕀⁻¹L/2`, is at least `J²/(2 a·𝕀a)`.
    pub fn least_energy(&self, jellett: f64, sin: f64, cos: f64) -> f64 {
        0.5 * jellett * jellett / self.jellett_moment(sin, cos) + self.gravity_moment() * cos
    }

    /// The moment `a·𝕀a`, kg m⁴, of the vector `a = l n + R z′` whose product with the angular momentum is Jellett's
    /// integral, for sine and cosine of θ.
    pub fn jellett_moment(&self, sin: f64, cos: f64) -> f64 {
        let across = self.peg_radius * sin;
        let along = self.center_distance + self.peg_radius * cos;
        self.central_moment() * across * across + self.axial_moment * along * along
    }

    /// The radicand of Routh's integral of a rolling top, kg² m⁴, for sine and cosine of θ; see
    /// [`Model::routh`](crate::physics::dynamics::Model::routh).
    pub fn rolling_moments(&self, sin: f64, cos: f64) -> f64 {
        let (central, axial) = (self.central_moment(), self.axial_moment);
        let reach = self.center_distance + self.peg_radius * cos;
        let lean = self.peg_radius * sin;
        central * axial + self.mass * axial * reach * reach + self.mass * central * lean * lean
    }

    /// Angular momentum in the lean frame, kg m²/s, of a top that rotates rigidly about the vertical with `omega`
    /// rad/s.
    #[inline]
    pub fn turning_momentum(&self, tilt: &Tilt, omega: f64) -> Vector3<f64> {
        let product = (self.axial_moment - self.transverse_moment) * tilt.sin * tilt.cos;
        omega * Vector3::new(product, 0.0, self.vertical_moment(tilt.sin, tilt.cos))
    }

    /// Angular velocity in the lean frame, rad/s, of a top that does not turn about the vertical, from the horizontal
    /// components of its angular momentum (kg m²/s).
    #[inline]
    pub fn rocking_rate(&self, momentum_lean: &Vector3<f64>, sin: f64, cos: f64) -> Vector3<f64> {
        let across = self.transverse_moment * cos * cos + self.axial_moment * sin * sin;
        Vector3::new(
            momentum_lean.x / across,
            momentum_lean.y / self.transverse_moment,
            0.0,
        )
    }

    /// The angular acceleration in the lean frame, rad/s², for a torque (N m) in that frame.
    pub fn angular_acceleration(&self, torque: &Vector3<f64>, tilt: &Tilt) -> Vector3<f64> {
        let axis = tilt.axis();
        let momentum = tilt.node_to_lean(&self.angular_momentum_node(tilt));
        let net = torque - tilt.omega_lean.cross(&momentum);
        let excess = 1.0 / self.axial_moment - 1.0 / self.transverse_moment;
        net / self.transverse_moment + excess * net.dot(&axis) * axis
    }

    /// The torque in the lean frame, N m, of a top that rotates rigidly about the vertical, with the component
    /// `vertical` (N m) about the vertical.
    #[inline]
    pub fn turning_torque(&self, tilt: &Tilt, vertical: f64) -> Vector3<f64> {
        let omega = tilt.omega_lean.z;
        let change =
            self.turning_momentum(tilt, vertical / self.vertical_moment(tilt.sin, tilt.cos));
        let carried = omega * self.turning_momentum(tilt, omega).x;
        change + Vector3::new(0.0, carried, 0.0)
    }

    /// Angular momentum about the peg's centre in the node frame, kg m²/s.
    pub fn angular_momentum_node(&self, tilt: &Tilt) -> Vector3<f64> {
        let omega = tilt.omega_node();
        Vector3::new(
            self.transverse_moment * omega.x,
            self.transverse_moment * omega.y,
            self.axial_moment * omega.z,
        )
    }

    /// Kinetic energy, J.
    pub fn kinetic_energy(&self, tilt: &Tilt) -> f64 {
        let omega = tilt.omega_node();
        0.5 * (self.transverse_moment * (omega.x * omega.x + omega.y * omega.y)
            + self.axial_moment * omega.z * omega.z)
    }

    /// Potential energy `M g l cos θ`, J; zero at the height of the peg's centre.
    pub fn potential_energy(&self, tilt: &Tilt) -> f64 {
        self.gravity_moment() * tilt.cos
    }

    /// The rates of regular precession (θ̈ = 0) at this inclination and spin rate ψ̇: the roots of
    /// `(I_x − I_z) cos θ φ̇² − I_z ψ̇ φ̇ + M g l = 0`.
    ///
    /// `None` if they are not real or the fast root is infinite.
    pub fn precession_roots(&self, tilt: &Tilt) -> Option<PrecessionRoots> {
        let quadratic = (self.transverse_moment - self.axial_moment) * tilt.cos;
        let spin = self.axial_moment * tilt.rates.psi;
        PrecessionRoots::new(quadratic, spin, self.gravity_moment())
    }

    /// The inclination of regular precession with these angular momenta about the vertical, L_z′, and about the axis,
    /// L_n, kg m²/s: that of least energy, about which the axis nutates; in rad.
    ///
    /// The energy without its part in θ̇ is `(L_z′ − L_n u)²/(2 I_x (1 − u²)) + M g l u` with u = cos θ (H. Goldstein,
    /// *Classical Mechanics*, section 5.7). It is a convex function of u and has one minimum, which is at the vertical
    /// if a strong top stands upright.
    pub fn regular_inclination(&self, vertical: f64, axial: f64) -> f64 {
        let gravity = self.gravity_moment() * self.transverse_moment;
        let [mut least, mut greatest] = [0.0, PI];
        loop {
            let middle = 0.5 * (least + greatest);
            if middle <= least || middle >= greatest {
                return middle;
            }
            let (sin, cos) = sin_cos(middle);
            let square = sin * sin;
            let slope =
                (vertical - axial * cos) * (axial - vertical * cos) - gravity * square * square;
            // Energy decreases with θ up to the minimum.
            if slope < 0.0 {
                least = middle;
            } else {
                greatest = middle;
            }
        }
    }

    /// The period of nutation without friction, s, given a state and the extremes of θ, rad: exact for any amplitude.
    /// `None` if the motion is not periodic.
    ///
    /// With u = cos θ the motion is u̇² = β (u − u₁)(u − u₂)(u − u₃), β = 2 M g l/I_x, where u₁ and u₂ are the given
    /// extremes, and the sum of the roots follows from the conserved energy and axial angular momentum. The period is
    /// 2π over the arithmetic-geometric mean of √(β (u₃ − u₁)) and √(β (u₃ − u₂)). For equal extremes both
    /// are the angular frequency of small nutations.
    pub fn nutation_period(&self, tilt: &Tilt, [least, greatest]: [f64; 2]) -> Option<f64> {
        let (lower, upper) = (cos(greatest), cos(least));
        let gravity = 2.0 * self.gravity_moment() / self.transverse_moment;
        let axial = self.nutation_frequency(tilt.axial_rate());
        let omega = tilt.omega_node();
        // β (u₁ + u₂ + u₃): 2 E/I_x without the axial part, and (L_n/I_x)².
        let sum = omega.x * omega.x + omega.y * omega.y + gravity * tilt.cos + axial * axial;
        let squares = [
            sum - gravity * (2.0 * lower + upper),
            sum - gravity * (lower + 2.0 * upper),
        ];
        if !squares.iter().all(|square| *square > 0.0) {
            return None;
        }
        let [mut arithmetic, mut geometric] = squares.map(f64::sqrt);
        // Converges quadratically.
        while (arithmetic - geometric).abs() > 1e-8 * arithmetic {
            (arithmetic, geometric) = (
                0.5 * (arithmetic + geometric),
                (arithmetic * geometric).sqrt(),
            );
        }
        Some(TAU / arithmetic).filter(|period| period.is_finite())
    }

    /// Angular frequency of small nutations of a fast top, rad/s, for the rate of rotation about the axis, ψ̇ + φ̇ cos θ
    /// (rad/s): `I_z (ψ̇ + φ̇ cos θ) / I_x`, the angular momentum about the axis over I_x (H. Goldstein, *Classical
    /// Mechanics*, section 5.7). It has the sign of the rate.
    pub fn nutation_frequency(&self, axial_rate: f64) -> f64 {
        self.axial_moment * axial_rate / self.transverse_moment
    }

    /// `|a| / sqrt(4 M g l / I_x)` with `a = I_z (ψ̇ + φ̇ cos θ) / I_x`: above 1 the top is strong; below 1 it is weak
    /// and not stable upright (Klein and Sommerfeld; the paper, section 3).
    pub fn strength_ratio(&self, tilt: &Tilt) -> f64 {
        let a = self.nutation_frequency(tilt.axial_rate());
        // For a tippe top: inverted, so that its centre of mass is above the centre of the sphere.
        let moment = self.gravity_moment().abs();
        a.abs() / (4.0 * moment / self.transverse_moment).sqrt()
    }
}
