//! How to compare.

use super::tolerance::Tolerances;

/// What of B is compared with what of A.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// What is at the same time.
    #[default]
    Time,
    /// What is at the same phase of the nutation: after as many cycles.
    Nutation,
    /// What is at the same mean of θ over a nutation.
    Theta,
    /// What comes in the same place of its topic.
    Index,
}

impl Align {
    /// The alignment's name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Nutation => "nutation",
            Self::Theta => "theta",
            Self::Index => "index",
        }
    }
}

/// By how much B's clock is put forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offset {
    /// By so much, ns.
    By(i64),
    /// So that the first messages are at the same time.
    Start,
}

impl Default for Offset {
    /// Not at all.
    fn default() -> Self {
        Self::By(0)
    }
}

/// How to compare two runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// What is compared with what.
    pub align: Align,
    /// Pairs messages that are nearest to each other and no farther apart than this, ns, instead of those with equal
    /// times.
    pub max_dt: Option<u64>,
    /// By how much B's clock is put forward.
    pub offset: Offset,
    /// What counts as equal.
    pub tolerances: Tolerances,
    /// Whether to find the integrators' errors, by simulating each scenario again with tighter tolerances.
    pub floor: bool,
    /// The topics to compare; all that both have if the list is empty.
    pub topics: Vec<String>,
}

impl Default for Options {
    /// All topics at equal times, bit for bit, with the integrators' errors.
    fn default() -> Self {
        Self {
            align: Align::Time,
            max_dt: None,
            offset: Offset::default(),
            tolerances: Tolerances::default(),
            floor: true,
            topics: Vec::new(),
        }
    }
}
