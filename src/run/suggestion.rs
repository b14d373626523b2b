//! "Did you mean" hints.

/// Minimum Jaro–Winkler similarity for a suggestion.
const MIN_SIMILARITY: f64 = 0.8;

/// The hint for the most similar names, e.g. ` (did you mean friction.k?)`, or an empty string.
pub(crate) fn suggestion<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let names = names.into_iter();
    suggestion_from(names.map(|name| (similarity(wrong, name), name)))
}

/// Similarity of a name to an unknown one, from 0 to 1.
pub(crate) fn similarity(wrong: &str, name: &str) -> f64 {
    let mut letters = name.chars();
    // For example `fig2` for `figure-2`.
    let is_half = 2 * wrong.len() >= name.len() && name.starts_with(|l| wrong.starts_with(l));
    let is_short = is_half && wrong.chars().all(|letter| letters.any(|l| l == letter));
    let least: f64 = if is_short { 0.9 } else { 0.0 };
    least.max(strsim::jaro_winkler(wrong, name))
}

/// Like [`suggestion`], with precomputed similarities.
pub(crate) fn suggestion_from<'a>(names: impl Iterator<Item = (f64, &'a str)>) -> String {
    let mut best = Vec::new();
    let mut highest = MIN_SIMILARITY;
    for (similarity, name) in names {
        if similarity > highest {
            highest = similarity;
            best.clear();
        }
        if similarity >= highest {
            best.push(name);
        }
    }
    match &best[..] {
        [] => String::new(),
        _ => format!(" (did you mean {}?)", best.join(" or ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_names_most_like_a_wrong_one_are_asked_after() {
        let names = ["paper", "coulomb", "coulomb-sqrt", "figure-2", "figure-3"];
        assert_eq!(suggestion("coulob", names), " (did you mean coulomb?)");
        assert_eq!(suggestion("papr", names), " (did you mean paper?)");
        assert_eq!(
            suggestion("figure", names),
            " (did you mean figure-2 or figure-3?)"
        );
        assert_eq!(suggestion("fig2", names), " (did you mean figure-2?)");
        assert_eq!(suggestion("xyz", names), "");
    }
}
