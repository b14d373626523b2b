//! Pairs of parameters that the data determine together better than each alone.

use super::super::report::Correlation;
use crate::words::{Piece, Sentence, sentence};

/// Number of pairs in the sentence.
const MAX_PAIRS: usize = 3;

/// A sentence on the strongest correlations, if there are any, and with `all` a line for each of the others.
pub(super) fn lines(correlations: &[Correlation], all: bool) -> Vec<Sentence> {
    let mut strongest: Vec<&Correlation> = correlations.iter().collect();
    strongest.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
    if strongest.is_empty() {
        return Vec::new();
    }
    let others = strongest.split_off(strongest.len().min(MAX_PAIRS));
    let mut lines = vec![sentence!(
        "The data fix the combination of some parameters better than each alone, because a change of one nearly makes up for a change of the other: {}.",
        Sentence::join(strongest.into_iter().map(pair), ", ")
    )];
    if all {
        lines.extend(others.into_iter().map(pair));
    } else if !others.is_empty() {
        lines.push(sentence!(
            "{} with {}.",
            Piece::count(others.len() as u64, "more pair"),
            Piece::argument("all")
        ));
    }
    lines
}

/// Two parameters with their correlation.
fn pair(
    Correlation {
        parameters: [a, b],
        correlation,
    }: &Correlation,
) -> Sentence {
    sentence!(
        "{} and {} (correlation {})",
        Piece::key(a.clone()),
        Piece::key(b.clone()),
        Piece::fixed(*correlation, 3, "")
    )
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
        let correlations = [
            pair("a", "b", 0.91),
            pair("a", "c", -0.9994),
            pair("b", "c", -0.93),
            pair("b", "d", 0.98),
        ];
        for (all, expected) in [
            (true, "a and b (correlation 0.910)"),
            (false, "1 more pair with all."),
        ] {
            let lines: Vec<String> = lines(&correlations, all)
                .iter()
                .map(Sentence::to_string)
                .collect();
            let [strongest, other] = &lines[..] else {
                panic!("{lines:?}");
            };
            assert!(
                strongest.ends_with(
                    ": a and c (correlation −0.999), b and d (correlation 0.980), b and c (correlation −0.930)."
                ),
                "{strongest}"
            );
            assert_eq!(other, expected);
        }
        assert!(lines(&[], true).is_empty());
    }
}
