//! Events as they are kept.

/// An event of a run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Event {
    pub(crate) name: String,
    pub(crate) description: String,
    /// Time, s.
    pub(crate) time: f64,
    /// Inclination θ, rad.
    pub(crate) theta: f64,
    /// φ̇ and ψ̇, rad/s.
    pub(crate) rates: [f64; 2],
}
