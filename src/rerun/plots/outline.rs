//! Coarse outlines of curves.

/// Maximum number of spans of time.
const SPANS: usize = 64;
/// The first length of a span, ns.
const FIRST_SPAN_NS: u64 = 1_000_000;

/// The least and the greatest value of a chart's curves in spans of time of equal length, from time 0 on.
///
/// There are at most [`SPANS`]: when the run outgrows them, each two become one.
pub(in crate::rerun) struct Outline {
    span_ns: u64,
    /// Reversed infinite bounds where there are no values.
    ranges: Vec<[f64; 2]>,
}

/// The range of no values.
const NO_VALUES: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

impl Outline {
    /// An outline without values.
    pub(in crate::rerun) fn new() -> Self {
        Self {
            span_ns: FIRST_SPAN_NS,
            ranges: Vec::new(),
        }
    }

    /// Adds a value at a time in ns.
    pub(in crate::rerun) fn add(&mut self, time_ns: u64, value: f64) {
        while time_ns / self.span_ns >= SPANS as u64 {
            self.ranges = self
                .ranges
                .chunks(2)
                .map(|pair| pair.iter().copied().fold(NO_VALUES, union))
                .collect();
            // A run of 292 years has less than 2^64 ns.
            self.span_ns = self.span_ns.saturating_mul(2);
        }
        let index = (time_ns / self.span_ns) as usize;
        if self.ranges.len() <= index {
            self.ranges.resize(index + 1, NO_VALUES);
        }
        self.ranges[index] = union(self.ranges[index], [value, value]);
    }

    /// The middles of the spans (ns) with the least and the greatest value in each.
    pub(in crate::rerun) fn ranges(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        self.ranges
            .iter()
            .enumerate()
            .map(|(index, range)| ((index as f64 + 0.5) * self.span_ns as f64, *range))
    }
}

fn union(one: [f64; 2], other: [f64; 2]) -> [f64; 2] {
    [one[0].min(other[0]), one[1].max(other[1])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn values_are_within_the_range_of_their_span(
            rows in prop::collection::vec((0_u64..1 << 50, -1.0..1.0), 1..200),
        ) {
            let mut outline = Outline::new();
            for (time_ns, value) in &rows {
                outline.add(*time_ns, *value);
            }
            prop_assert!(outline.ranges.len() <= SPANS);
            for (time_ns, value) in rows {
                let [low, high] = outline.ranges[(time_ns / outline.span_ns) as usize];
                prop_assert!(low <= value && value <= high);
            }
        }
    }
}
