//! The values of a quantity in a run.

/// The values that a quantity takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extent {
    /// The first, which is that of the first sample unless the recording lacks it.
    pub(crate) first: f64,
    pub(crate) last: f64,
    pub(crate) least: f64,
    pub(crate) greatest: f64,
}

impl Extent {
    /// Takes the next value; one that is not finite is not recorded.
    pub(crate) fn take(extent: &mut Option<Self>, value: f64) {
        if !value.is_finite() {
            return;
        }
        let known = extent.get_or_insert(Self {
            first: value,
            last: value,
            least: value,
            greatest: value,
        });
        known.last = value;
        known.least = known.least.min(value);
        known.greatest = known.greatest.max(value);
    }

    /// The largest deviation from the first value.
    pub(crate) fn deviation(&self) -> f64 {
        (self.greatest - self.first).max(self.first - self.least)
    }
}
