//! Support of the peg, and what the contact point does.

/// Support of the peg.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Support {
    /// The centre of the peg stays in place, as if in a socket: the table carries the weight whatever the top does.
    #[default]
    FixedPeg,
    /// The peg stands on the table and moves over it: it slides, rolls, lifts off and lands.
    FreePeg {
        /// Stronge's coefficient of restitution `e`: an impact gives back `e²` of the work that compression took
        /// (W. J. Stronge, Proc. R. Soc. Lond. A 431 (1990) 169).
        restitution: f64,
    },
}

impl Support {
    /// Whether the peg can move.
    #[must_use]
    pub fn is_free(self) -> bool {
        matches!(self, Self::FreePeg { .. })
    }

    /// The largest tolerances with which the motion can be integrated, relative and absolute (SI). With larger ones the
    /// slip of a free peg that comes to rest is turned round in each step, and never seen to end.
    #[must_use]
    pub fn largest_tolerance(self) -> f64 {
        if self.is_free() { 1e-9 } else { f64::INFINITY }
    }
}

/// Phase of the contact point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Phase {
    /// Slips, or would: no friction holds it.
    #[default]
    Sliding,
    /// Stays at rest on the table. A top with a fixed peg then turns about the vertical as a whole; one with a free peg
    /// rolls.
    Holding,
    /// Is above the table: nothing touches the top but the air.
    Flying,
}
