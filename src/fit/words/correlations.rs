//! Pairs of parameters that the data determine together better than each alone.

use super::super::report::Correlation;
use crate::words::number::fixed;
use serde::Serialize;

/// Number of pairs in the sentence.
const MAX_PAIRS: usize = 3;

/// What a report says of correlated parameters.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Correlations {
    /// A sentence on the strongest ones; empty if there are none.
    pub sentence: String,
    /// The weaker ones, which the sentence leaves out.
    pub others: Vec<String>,
}

impl Correlations {
    pub(super) fn new(correlations: &[Correlation]) -> Self {
        let mut pairs: Vec<&Correlation> = correlations.iter().collect();
        pairs.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
        if pairs.is_empty() {
            return Self::default();
        }
        let mut named: Vec<String> = pairs.into_iter().map(pair).collect();
        let others = named.split_off(named.len().min(MAX_PAIRS));
        Self {
            sentence: format!(
                "The data fix the combination of some parameters better than each alone, because a change of one nearly makes up for a change of the other: {}.",
                named.join(", ")
            ),
            others,
        }
    }
}

/// Two parameters with their correlation.
fn pair(
    Correlation {
        parameters: [a, b],
        correlation,
    }: &Correlation,
) -> String {
    format!("{a} and {b} (correlation {})", fixed(*correlation, 3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strongest_pairs_come_first() {
        let pair = |a: &str, b: &str, correlation| Correlation {
            parameters: [a.to_owned(), b.to_owned()],
            correlation,
        };
        let Correlations { sentence, others } = Correlations::new(&[
            pair("a", "b", 0.91),
            pair("a", "c", -0.9994),
            pair("b", "c", -0.93),
            pair("b", "d", 0.98),
        ]);
        assert!(
            sentence.ends_with(
                ": a and c (correlation −0.999), b and d (correlation 0.980), b and c (correlation −0.930)."
            ),
            "{sentence}"
        );
        assert_eq!(others, ["a and b (correlation 0.910)"]);
        assert_eq!(Correlations::new(&[]), Correlations::default());
    }
}
