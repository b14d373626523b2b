//! Parameters that data can't tell apart.

use crate::words::{Piece, Sentence, and, sentence};

/// Parameters that the data can't tell apart.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::fit) enum Degeneracy {
    /// No signal depends on these parameters.
    Unseen {
        /// Names of the parameters.
        names: Vec<String>,
    },
    /// Only a combination of two positive parameters is determined.
    Combined {
        /// Names of the parameters.
        names: [String; 2],
        /// Symbols of the parameters in formulas.
        symbols: [String; 2],
        /// The combination that is determined.
        combination: Combination,
        /// Whether motions with the same combination are the same, and not only similar in these data.
        is_exact: bool,
        /// Δχ² at which 1 % more of the first parameter is compensated by the second; `None` if not computed.
        delta_chi2: Option<f64>,
    },
    /// These parameters can change together in one way.
    Together {
        /// Names of the parameters.
        names: Vec<String>,
    },
    /// These parameters can change together in several ways.
    Several {
        /// Names of the parameters.
        names: Vec<String>,
        /// Number of independent ways.
        directions: usize,
    },
}

/// A combination of two parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::fit) enum Combination {
    /// The product of both.
    Product,
    /// The quotient of both.
    Quotient,
    /// Another one.
    Other,
}

impl Degeneracy {
    /// A clause that says what is not determined.
    pub(in crate::fit) fn sentence(&self) -> Sentence {
        match self {
            Self::Unseen { names } => sentence!("no signal depends on {}", or(names)),
            Self::Combined {
                symbols,
                combination,
                is_exact,
                delta_chi2,
                ..
            } => combined(symbols, *combination, *is_exact, *delta_chi2),
            Self::Together { names } => sentence!(
                "{} can change together without an effect on these data",
                and(keys(names))
            ),
            Self::Several { names, directions } => {
                let known = names.len() - directions;
                sentence!(
                    "of {} only {} {} determined",
                    and(keys(names)),
                    Piece::count(known as u64, "combination"),
                    if known == 1 { "is" } else { "are" }
                )
            }
        }
    }

    /// The parameters to fix.
    pub(in crate::fit) fn fixed(&self) -> Sentence {
        match self {
            Self::Unseen { names } => and(keys(names)),
            Self::Combined { names, .. } => or(names),
            Self::Together { .. } => sentence!("one of them"),
            Self::Several { directions, .. } => sentence!("{} of them", directions.to_string()),
        }
    }
}

/// What the data determine of two parameters.
fn combined(
    [first, second]: &[String; 2],
    combination: Combination,
    is_exact: bool,
    delta_chi2: Option<f64>,
) -> Sentence {
    let (sign, factor) = match combination {
        Combination::Product => ('·', '÷'),
        Combination::Quotient => ('/', '×'),
        Combination::Other => {
            return sentence!(
                "only a combination of {} and {} is determined ({} and {} can change together)",
                first,
                second,
                first,
                second
            );
        }
    };
    let known = format!("{first}{sign}{second}");
    if is_exact {
        return sentence!(
            "only {} is determined ({} × 2 and {} {} 2 is the same motion)",
            known,
            first,
            second,
            factor.to_string()
        );
    }
    // The data may well tell them apart: by how much, the user should know.
    let effect = delta_chi2.map_or_else(Sentence::default, |delta| {
        sentence!(
            " (χ² differs by {} if {} changes by 1 % and {} does not)",
            Piece::number(delta, 2, ""),
            first,
            &known
        )
    });
    sentence!(
        "these data determine {} so much better than {} and {} that the derivatives of a fit can't tell them apart{}",
        &known,
        first,
        second,
        effect
    )
}

/// Parameters in a sentence.
pub(in crate::fit) fn keys(names: &[String]) -> Vec<Sentence> {
    names
        .iter()
        .map(|name| Piece::key(name.clone()).into())
        .collect()
}

/// Parameters as a list with "or".
pub(in crate::fit) fn or(names: &[String]) -> Sentence {
    Sentence::join(keys(names), " or ")
}

/// The pronoun that stands for a number of parameters.
pub(in crate::fit) fn pronoun(count: usize) -> &'static str {
    if count == 1 { "it" } else { "them" }
}
