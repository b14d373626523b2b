//! Options of a comparison.

use super::tolerance::Tolerances;

/// Options of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The differences that count as equal.
    pub tolerances: Tolerances,
    /// Whether to estimate integration errors by repeating the simulations with tighter tolerances.
    pub floor: bool,
    /// The topics to compare; all common topics if empty.
    pub topics: Vec<String>,
}

impl Default for Options {
    /// All topics, bit for bit, with the integrators' errors.
    fn default() -> Self {
        Self {
            tolerances: Tolerances::default(),
            floor: true,
            topics: Vec::new(),
        }
    }
}
