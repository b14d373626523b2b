//! The regime of the contact between peg and table.

/// Regime of the contact between peg and table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Regime {
    /// The contact point is at rest on the table: it sticks, or the peg rolls.
    Sticking,
    /// The contact point slips.
    Slipping,
    /// The peg is in the air.
    Flying,
}

impl Regime {
    /// All regimes, in the order of their codes.
    pub const ALL: [Self; 3] = [Self::Sticking, Self::Slipping, Self::Flying];

    /// The number that is recorded for this regime.
    pub const fn code(self) -> f64 {
        match self {
            Self::Sticking => 0.0,
            Self::Slipping => 1.0,
            Self::Flying => 2.0,
        }
    }

    /// The regime of a recorded number; `None` for any other number.
    pub fn from_code(code: f64) -> Option<Self> {
        // Exactly: every encoding keeps small whole numbers.
        Self::ALL.into_iter().find(|regime| regime.code() == code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_round_trip() {
        for regime in Regime::ALL {
            assert_eq!(Regime::from_code(regime.code()), Some(regime));
        }
    }

    #[test]
    fn other_numbers_have_no_regime() {
        for code in [f64::NAN, f64::INFINITY, -1.0, 0.5, 3.0] {
            assert_eq!(Regime::from_code(code), None, "{code}");
        }
    }
}
