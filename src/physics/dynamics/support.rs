//! Support of the peg, and contact phases.

/// Support of the peg.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Support {
    /// The centre of the peg stays in place, as if in a socket: the normal force always equals the weight.
    #[default]
    FixedPeg,
    /// The peg stands on the table and moves over it: it slides, rolls, lifts off and lands.
    FreePeg {
        /// Stronge's coefficient of restitution `e`: the work of restitution is `e²` times the work of compression (W.
        /// J. Stronge, Proc. R. Soc. Lond. A 431 (1990) 169).
        restitution: f64,
    },
}

impl Support {
    /// Whether the peg can move.
    pub fn is_free(self) -> bool {
        matches!(self, Self::FreePeg { .. })
    }

    /// The largest allowed integrator tolerances, relative and absolute (SI). With larger ones, the end of slip of a
    /// free peg is missed, because the slip reverses in each step.
    pub fn max_tolerance(self) -> f64 {
        if self.is_free() { 1e-9 } else { f64::INFINITY }
    }
}

/// Phase of the contact point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Phase {
    /// Sliding (no static friction).
    #[default]
    Sliding,
    /// Sticking: the contact point is at rest on the table. A top with a fixed peg then turns about the vertical as a
    /// whole; one with a free peg rolls.
    Sticking,
    /// In the air.
    Flying,
}
