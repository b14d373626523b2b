//! What a comparison of laws has shown.

use crate::words::{Piece, Sentence, and, sentence};
use schemars::JsonSchema;
use serde::Serialize;

/// What a comparison of laws has shown.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Conclusion {
    /// None of the laws could be fitted.
    NothingFitted,
    /// None of the laws describes the data.
    NothingDescribes {
        /// The law with the lowest BIC.
        law: String,
        /// Why it does not.
        flaw: Flaw,
    },
    /// A law describes the data, but another one has the lowest BIC.
    NotLowest {
        /// The law that describes the data.
        law: String,
        /// The law with the lowest BIC.
        lowest: String,
        /// Why that does not describe the data.
        flaw: Flaw,
    },
    /// A law describes the data, but others are hardly worse, or may be better.
    Undecided {
        /// The law with the lowest BIC.
        law: String,
        /// Laws that the data do not tell from it.
        alike: Vec<String>,
        /// Laws for which no minimum was found.
        unfinished: Vec<String>,
    },
    /// A law is clearly best, and describes the data.
    Decided {
        /// The law.
        law: String,
        /// The law with the next BIC; absent if there is none.
        next: Option<Rival>,
        /// Laws for which no minimum was found.
        unfinished: Vec<String>,
    },
}

/// A law that is clearly worse than another.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Rival {
    /// The law.
    pub law: String,
    /// AIC above that of the other.
    pub delta_aic: f64,
    /// BIC above that of the other.
    pub delta_bic: f64,
}

/// Why a law does not describe the data.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Flaw {
    /// No minimum was found.
    NoMinimum,
    /// The residuals are too large.
    Size {
        /// χ²/ν.
        reduced_chi2: f64,
    },
    /// The residuals are correlated or have a mean other than zero.
    Residuals,
    /// The estimated standard deviations have no meaning.
    Sigma,
}

impl Conclusion {
    /// The conclusion in a sentence.
    pub fn sentence(&self) -> Sentence {
        match self {
            Self::NothingFitted => sentence!("None of the laws could be fitted."),
            Self::NothingDescribes { law, flaw } => {
                sentence!("None of the laws describes the data: {}.", flaw.clause(law))
            }
            Self::NotLowest { law, lowest, flaw } => sentence!(
                "Undecided: {} describes the data, but its BIC is not the lowest: {}.",
                law,
                flaw.clause(lowest)
            ),
            Self::Undecided {
                law,
                alike,
                unfinished,
            } if alike.is_empty() => sentence!(
                "Undecided: {} describes the data.{}",
                law,
                caveat(unfinished)
            ),
            Self::Undecided {
                law,
                alike,
                unfinished,
            } => sentence!(
                "Undecided: the data do not tell {} from {}.{}",
                law,
                list(alike),
                caveat(unfinished)
            ),
            Self::Decided {
                law,
                next,
                unfinished,
            } => sentence!(
                "{} describes the data{}.{}",
                law,
                next.as_ref().map_or_else(Sentence::default, Rival::clause),
                caveat(unfinished)
            ),
        }
    }
}

impl Rival {
    fn clause(&self) -> Sentence {
        sentence!(
            "; the next law, {}, is worse by ΔAIC = {} and ΔBIC = {}",
            &self.law,
            Piece::fixed(self.delta_aic, 1, ""),
            Piece::fixed(self.delta_bic, 1, "")
        )
    }
}

impl Flaw {
    /// Why the law with the lowest BIC does not describe the data.
    fn clause(self, law: &str) -> Sentence {
        match self {
            Self::NoMinimum => sentence!("no minimum was found for {}", law),
            Self::Size { reduced_chi2 } => sentence!(
                "{}, which has the lowest BIC, has χ²/ν = {}",
                law,
                Piece::fixed(reduced_chi2, 2, "")
            ),
            Self::Residuals => sentence!(
                "the residuals of {}, which has the lowest BIC, are correlated or have a mean other than zero",
                law
            ),
            Self::Sigma => sentence!(
                "the standard deviations estimated for {} have no meaning",
                law
            ),
        }
    }
}

/// A sentence on laws for which no minimum was found.
fn caveat(unfinished: &[String]) -> Sentence {
    let whose = match unfinished.len() {
        0 => return Sentence::default(),
        1 => "its",
        _ => "their",
    };
    sentence!(
        " No minimum was found for {}: {} criteria may be lower than shown.",
        list(unfinished),
        whose
    )
}

fn list(laws: &[String]) -> Sentence {
    and(laws.iter().map(Sentence::from).collect())
}
