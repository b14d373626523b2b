//! Parameters that data can't tell apart.

use std::fmt::{self, Display, Formatter};

/// Parameters that the data can't tell apart.
#[derive(Clone, Debug, PartialEq)]
pub enum Degeneracy {
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
pub enum Combination {
    /// The product of both.
    Product,
    /// The quotient of both.
    Quotient,
    /// Another one.
    Other,
}

/// A clause that says what is not determined.
impl Display for Degeneracy {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unseen { names } => {
                write!(f, "no signal depends on {}", names.join(" or "))
            }
            Self::Combined {
                symbols: [first, second],
                combination,
                is_exact,
                delta_chi2,
                ..
            } => {
                match combination {
                    Combination::Product | Combination::Quotient if !is_exact => {
                        let sign = if *combination == Combination::Product {
                            '·'
                        } else {
                            '/'
                        };
                        write!(
                            f,
                            "these data determine {first}{sign}{second} so much better than {first} and {second} that the derivatives of a fit can't tell them apart"
                        )?;
                        // The data may well tell them apart: by how much, the user should know.
                        match delta_chi2 {
                            Some(delta) => write!(
                                f,
                                " (χ² differs by {delta:.1e} if {first} changes by 1 % and {first}{sign}{second} does not)"
                            ),
                            None => Ok(()),
                        }
                    }
                    Combination::Product => write!(
                        f,
                        "only {first}·{second} is determined ({first} × 2 and {second} ÷ 2 is the same motion)"
                    ),
                    Combination::Quotient => write!(
                        f,
                        "only {first}/{second} is determined ({first} × 2 and {second} × 2 is the same motion)"
                    ),
                    Combination::Other => write!(
                        f,
                        "only a combination of {first} and {second} is determined ({first} and {second} can change together)"
                    ),
                }
            }
            Self::Together { names } => write!(
                f,
                "{} can change together without an effect on these data",
                join_names(names)
            ),
            Self::Several { names, directions } => {
                let known = names.len() - directions;
                write!(
                    f,
                    "of {} only {known} {} determined",
                    join_names(names),
                    if known == 1 {
                        "combination is"
                    } else {
                        "combinations are"
                    },
                )
            }
        }
    }
}

/// Joins the clauses of an error.
pub(super) fn join_clauses(degeneracies: &[Degeneracy]) -> String {
    let clauses: Vec<String> = degeneracies.iter().map(Degeneracy::to_string).collect();
    clauses.join("; ")
}

/// Names as a list with "and".
pub(super) fn join_names(names: &[String]) -> String {
    match names {
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// The pronoun that stands for a number of parameters.
pub(super) fn pronoun(count: usize) -> &'static str {
    if count == 1 { "it" } else { "them" }
}
