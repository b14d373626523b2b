//! What a comparison of laws has shown.

use super::estimate::REJECTED;
use super::report::{Comparison, Extension, LawFit, Verdict};
use crate::words::{Piece, Sentence, and, sentence};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
use std::borrow::Cow;

/// A law is clearly better if AIC and BIC are both lower by this: the other is 20 times less likely (Burnham & Anderson).
const DECISIVE: f64 = 6.0;

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

impl Comparison {
    /// The conclusion from the fits of all laws.
    pub fn conclusion(&self) -> Conclusion {
        let fits: Vec<&LawFit> = self
            .laws
            .iter()
            .filter(|law| law.failure.is_none())
            .collect();
        let [first, others @ ..] = &fits[..] else {
            return Conclusion::NothingFitted;
        };
        let Some(best) = fits.iter().find(|fit| fit.verdict == Verdict::Fitted) else {
            return Conclusion::NothingDescribes {
                law: first.law.clone(),
                flaw: first.flaw(),
            };
        };
        if best.law == first.law {
            return first.compared_with(others);
        }
        Conclusion::NotLowest {
            law: best.law.clone(),
            lowest: first.law.clone(),
            flaw: first.flaw(),
        }
    }

    /// Whether one law is clearly best and describes the data.
    pub fn is_decided(&self) -> bool {
        matches!(self.conclusion(), Conclusion::Decided { .. })
    }

    /// The verdict on all laws together.
    pub(super) fn verdict(&self) -> Verdict {
        let describes = self.laws.iter().any(|law| law.verdict == Verdict::Fitted);
        if self.is_decided() {
            Verdict::Fitted
        } else if describes {
            Verdict::Undecided
        } else {
            // A law that is ahead without a minimum might describe the data.
            let first = self.laws.first().map(|law| law.verdict);
            first.unwrap_or(Verdict::NotConverged)
        }
    }
}

impl LawFit {
    /// The conclusion if this law has the lowest BIC and describes the data.
    fn compared_with(&self, others: &[&Self]) -> Conclusion {
        let law = self.law.clone();
        let (mut alike, mut unfinished) = (Vec::new(), Vec::new());
        let mut is_open = false;
        for other in others {
            // Both criteria: AIC favours laws with more parameters, BIC those with fewer.
            let is_alike =
                other.delta_aic - self.delta_aic < DECISIVE || other.delta_bic < DECISIVE;
            is_open |= is_alike;
            if other.verdict == Verdict::NotConverged {
                unfinished.push(other.law.clone());
            } else if is_alike {
                alike.push(other.law.clone());
            }
        }
        if is_open {
            return Conclusion::Undecided {
                law,
                alike,
                unfinished,
            };
        }
        Conclusion::Decided {
            law,
            next: others.first().map(|next| Rival {
                law: next.law.clone(),
                delta_aic: next.delta_aic - self.delta_aic,
                delta_bic: next.delta_bic,
            }),
            unfinished,
        }
    }

    /// Why the law does not describe the data.
    fn flaw(&self) -> Flaw {
        if !self.quality.is_converged {
            Flaw::NoMinimum
        } else if self.quality.p_value.is_some_and(|p| p < REJECTED) {
            Flaw::Size {
                reduced_chi2: self.quality.chi2 / self.quality.freedom as f64,
            }
        } else if self.residual_p_value.is_some_and(|p| p < REJECTED) {
            Flaw::Residuals
        } else {
            Flaw::Sigma
        }
    }
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

/// Comparison of laws.
#[derive(Serialize, JsonSchema)]
pub(super) struct ComparisonReport {
    /// The laws by BIC, lowest first. If it is decided, the first one is preferred.
    laws: Vec<LawFit>,
    /// Whether one law is clearly best and describes the data.
    is_decided: bool,
    /// The verdict in a sentence.
    sentence: String,
    /// The verdict with its numbers.
    conclusion: Conclusion,
    /// Extensions of the data that are expected to decide between the two best laws, if undecided; none if no small one
    /// does.
    extensions: Vec<Extension>,
}

impl From<Comparison> for ComparisonReport {
    fn from(comparison: Comparison) -> Self {
        let conclusion = comparison.conclusion();
        Self {
            is_decided: comparison.is_decided(),
            sentence: conclusion.sentence().to_string(),
            conclusion,
            laws: comparison.laws,
            extensions: comparison.extensions,
        }
    }
}

/// As it is serialized: with the conclusion.
impl JsonSchema for Comparison {
    fn schema_name() -> Cow<'static, str> {
        "Comparison".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        ComparisonReport::json_schema(generator)
    }
}
