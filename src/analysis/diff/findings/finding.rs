//! A finding: a pair of corresponding numbers, and how it is displayed.

use super::quantity::Quantity;
use crate::analysis::diff::integration_error::IntegrationError;
use crate::words::{Piece, Sentence, sentence};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};
use std::borrow::Cow;

/// A dependence of a difference, other than on numerical errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "on", rename_all = "snake_case")]
pub enum Dependence {
    /// On the level of θ, which the comparison chose.
    Level {
        /// Change of the level, relative to it.
        relative: f64,
        /// Change of the difference with this level, in its unit.
        change: f64,
    },
    /// On the phase of the nutation.
    Nutation {
        /// The largest change of the difference, in its unit.
        change: f64,
    },
}

impl Dependence {
    /// The change of the difference, without its sign.
    fn magnitude(self) -> f64 {
        match self {
            Self::Level { change, .. } | Self::Nutation { change } => change.abs(),
        }
    }
}

/// A pair of corresponding numbers.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Finding {
    /// The compared quantity.
    #[serde(flatten)]
    pub quantity: Quantity,
    /// A's number; absent if it has none.
    pub a: Option<f64>,
    /// B's number; absent if it has none.
    pub b: Option<f64>,
    /// The difference B − A; absent if the numbers are unlike, e.g. times of ends of two kinds.
    pub difference: Option<f64>,
    /// Error of the difference due to the two integrations alone; absent if it is not known.
    pub integration_error: Option<f64>,
    /// What else the difference depends on: the chosen level, the phase of the nutation.
    pub dependences: Vec<Dependence>,
    /// Whether the numbers are equal within the tolerances that were set.
    pub is_tolerated: bool,
}

/// A finding in reports.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Finding")]
pub(in crate::analysis::diff) struct FindingReport<'f> {
    #[serde(flatten)]
    finding: Cow<'f, Finding>,
    /// The compared quantity in words.
    what: String,
    /// The unit, empty for pure numbers.
    unit: &'static str,
    /// The integration error and the largest dependence together; absent if neither is known.
    uncertainty: Option<f64>,
    /// Whether the numbers differ by more than the tolerances, the integration error and the ripple of the nutation.
    differs: bool,
}

/// Serializes findings with what follows from their numbers.
pub(in crate::analysis::diff) fn with_conclusions<S: Serializer>(
    findings: &[Finding],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(findings.iter().map(|finding| FindingReport {
        finding: Cow::Borrowed(finding),
        what: finding.quantity.label().to_string(),
        unit: finding.quantity.unit(),
        uncertainty: finding.uncertainty(),
        differs: finding.differs(),
    }))
}

impl Finding {
    /// A's and B's number, with an unknown error.
    pub(in crate::analysis::diff) fn new(quantity: Quantity, [a, b]: [Option<f64>; 2]) -> Self {
        Self {
            quantity,
            a,
            b,
            difference: a.zip(b).map(|(a, b)| b - a),
            integration_error: None,
            dependences: Vec::new(),
            is_tolerated: false,
        }
    }

    /// A difference without numbers of A and B, with an unknown error.
    pub(super) fn from_difference(quantity: Quantity, difference: f64) -> Self {
        Self {
            difference: Some(difference),
            ..Self::new(quantity, [None; 2])
        }
    }

    /// Sets the integration error of the difference; `None` if the numbers depend on the integration.
    pub(in crate::analysis::diff) fn with_error(self, error: IntegrationError) -> Option<Self> {
        let estimate = match error {
            IntegrationError::Unknown => None,
            IntegrationError::Within(error) => Some(error),
            IntegrationError::Undetermined => return None,
        };
        Some(Self {
            // Without a difference, the error would be that of nothing.
            integration_error: estimate.filter(|_| self.difference.is_some()),
            ..self
        })
    }

    /// Whether either run has the number.
    pub(super) fn is_known(&self) -> bool {
        self.a.is_some() || self.b.is_some() || self.difference.is_some()
    }

    /// Whether the numbers differ by more than the tolerances, the integration error and the ripple of the nutation, or
    /// exist in one run only.
    pub fn differs(&self) -> bool {
        match self.difference {
            _ if self.is_tolerated => false,
            // Without a known error, any difference counts.
            Some(difference) => {
                difference.abs() > self.integration_error.unwrap_or(0.0) + self.ripple()
            }
            None => self.a != self.b,
        }
    }

    /// The difference relative to the larger number.
    pub(in crate::analysis::diff) fn relative_difference(&self) -> Option<f64> {
        let (a, b) = self.a.zip(self.b)?;
        let relative = (b - a).abs() / a.abs().max(b.abs());
        relative.is_finite().then_some(relative)
    }

    /// The largest change of the difference by the nutation; 0 if there is none.
    pub(in crate::analysis::diff) fn ripple(&self) -> f64 {
        let mut ripple = 0.0_f64;
        for dependence in &self.dependences {
            if let Dependence::Nutation { change } = dependence {
                ripple = ripple.max(*change);
            }
        }
        ripple
    }

    fn uncertainty(&self) -> Option<f64> {
        let magnitudes = self.dependences.iter().copied().map(Dependence::magnitude);
        match (self.integration_error, magnitudes.reduce(f64::max)) {
            (None, None) => None,
            (error, dependence) => Some(error.unwrap_or(0.0) + dependence.unwrap_or(0.0)),
        }
    }

    /// The cells of a table: what is compared with its unit, A's and B's number, B − A with its numerical error.
    pub fn cells(&self) -> [Sentence; 4] {
        let [what, a, b] = self.own_cells();
        [what, a, b, self.difference_cell().into()]
    }

    /// The cells of a table of equal numbers: what is compared with its unit, A's and B's number, and within what they are
    /// equal.
    pub fn cells_of_equal(&self) -> [Sentence; 4] {
        let [what, a, b] = self.own_cells();
        [what, a, b, self.limit_cell()]
    }

    fn own_cells(&self) -> [Sentence; 3] {
        let what = self.quantity.label_with_unit();
        [what, self.number_cell(self.a), self.number_cell(self.b)]
    }

    fn number_cell(&self, number: Option<f64>) -> Sentence {
        match number {
            Some(number) => Piece::Number(self.quantity.number(number)).into(),
            None => "–".into(),
        }
    }

    fn difference_cell(&self) -> String {
        /// Errors below this fraction of the difference are not shown: they are below the displayed digits.
        const NEGLIGIBLE: f64 = 1e-3;
        let Some(difference) = self.difference else {
            return String::new();
        };
        let text = self.quantity.format_difference(difference);
        match self.integration_error {
            Some(error) if error > NEGLIGIBLE * difference.abs() => {
                format!("{text} ± {}", self.magnitude_cell(error))
            }
            _ => text,
        }
    }

    /// An error or a change of the difference, in the unit that the head of the row has.
    fn magnitude_cell(&self, magnitude: f64) -> Piece {
        Piece::number(magnitude, 2, self.quantity.unit()).without_unit()
    }

    fn limit_cell(&self) -> Sentence {
        let error = self.integration_error.unwrap_or(0.0);
        match self.difference {
            None | Some(0.0) => "identical".into(),
            Some(difference) if difference.abs() <= error => {
                sentence!("{} (integration)", self.magnitude_cell(error))
            }
            Some(_) if self.is_tolerated => "the tolerance".into(),
            Some(_) => sentence!("{} (nutation)", self.magnitude_cell(self.ripple() + error)),
        }
    }

    /// The choices and the phase that a difference depends on, and its scale, if they must be known to judge it.
    pub fn remark(&self) -> Option<Sentence> {
        let mut remarks = Vec::new();
        remarks.extend(self.quantity.remark());
        for dependence in self.dependences.iter().filter(|_| self.differs()) {
            remarks.extend(self.dependence_remark(*dependence));
        }
        let is_empty = remarks.is_empty();
        let label = self.quantity.label();
        (!is_empty).then(|| sentence!("{}: {}.", label, Sentence::join(remarks, "; ")))
    }

    fn dependence_remark(&self, dependence: Dependence) -> Option<Sentence> {
        /// Changes below this fraction of the difference are not told.
        const NEGLIGIBLE: f64 = 1e-3;
        let difference = self.difference?.abs();
        let magnitude = self.quantity.magnitude(dependence.magnitude());
        (dependence.magnitude() > NEGLIGIBLE * difference).then(|| match dependence {
            Dependence::Level { relative, change } => sentence!(
                "at a level {} % lower, B − A is {} {}",
                Piece::rounded(-100.0 * relative, 2, ""),
                magnitude,
                if change < 0.0 { "less" } else { "more" }
            ),
            Dependence::Nutation { .. } => {
                sentence!("the phase of the nutation moves it by up to {}", magnitude)
            }
        })
    }
}
