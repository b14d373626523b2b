//! "Did you mean" hints.

/// Minimum Jaro–Winkler similarity for a suggestion.
const MIN_SIMILARITY: f64 = 0.8;

/// Maximum number of suggested names: a longer list says no more than that the name is unknown.
const MAX_NAMES: usize = 3;

/// The hint for the most similar names, e.g. ` (did you mean friction.k?)`, or an empty string.
pub(crate) fn suggestion<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    did_you_mean(&similar_names(wrong, names))
}

/// The hint for these names, or an empty string if there are none.
pub(crate) fn did_you_mean(names: &[impl AsRef<str>]) -> String {
    if names.is_empty() {
        return String::new();
    }
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    format!(" (did you mean {}?)", names.join(" or "))
}

/// The names most similar to an unknown one.
pub(crate) fn similar_names<'a>(
    wrong: &str,
    names: impl IntoIterator<Item = &'a str>,
) -> Vec<&'a str> {
    most_similar(
        names
            .into_iter()
            .map(|name| (similarity(wrong, name), name)),
    )
}

/// Similarity of a name to an unknown one, from 0 to 1.
pub(crate) fn similarity(wrong: &str, name: &str) -> f64 {
    let mut letters = name.chars();
    // For example `fig2` for `figure-2`.
    let is_half = 2 * wrong.len() >= name.len() && name.starts_with(|l| wrong.starts_with(l));
    let is_short = is_half && wrong.chars().all(|letter| letters.any(|l| l == letter));
    // Above what Jaro–Winkler gives to names that are only alike.
    let least: f64 = if is_short { 0.9 } else { 0.0 };
    least.max(strsim::jaro_winkler(wrong, name))
}

/// The names of the highest similarity, at most [`MAX_NAMES`]; none if it is below [`MIN_SIMILARITY`].
pub(crate) fn most_similar<'a>(names: impl Iterator<Item = (f64, &'a str)>) -> Vec<&'a str> {
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
    best.truncate(MAX_NAMES);
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggests_nearest_names() {
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
