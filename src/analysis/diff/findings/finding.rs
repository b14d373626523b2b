//! A finding: a pair of corresponding numbers, and how it is displayed.

use crate::analysis::diff::integration_error::IntegrationError;
use crate::run::simulation::{EventKind, StopReason};
use crate::words::number::{Digits, significant};
use crate::words::{Number, Piece, Sentence, sentence};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
use std::borrow::Cow;

/// The quantity of a finding. Label, unit and digits follow from it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Quantity {
    /// Time of the end, s.
    End {
        /// The conditions that end A and B; absent if it is not recorded.
        ends: [Option<EndCondition>; 2],
    },
    /// Time at which the mean of θ crosses a level, s.
    MeanCrossing {
        /// The level, rad.
        level: f64,
    },
    /// Time at which θ first reaches a level, s.
    FirstReach {
        /// The level, rad.
        level: f64,
    },
    /// Time at which a tippe top inverts, s.
    Inversion,
    /// Time of the first loop, s.
    FirstLoop,
    /// Number of loops.
    Loops {
        /// The time up to which they are counted, s.
        until: f64,
    },
    /// Time of the first event of a kind, s.
    FirstEvent {
        /// The kind.
        event: EventKind,
    },
    /// Time at which the peg first rolls, s.
    FirstRoll,
    /// Number of times in the air.
    Hops {
        /// The time up to which they are counted, s.
        until: f64,
    },
    /// θ at the start of the rolling that lasts to the end, rad.
    FinalRollTheta,
    /// Mean of θ over a nutation, rad.
    MeanTheta {
        /// Time, s.
        at: f64,
    },
    /// Mean of φ̇ over a nutation, rad/s.
    MeanPrecession {
        /// Time, s.
        at: f64,
    },
    /// Mean of ψ̇ over a nutation, rad/s.
    MeanSpin {
        /// Time, s.
        at: f64,
    },
    /// Lead of B's nutation over A's, cycles.
    PhaseLead {
        /// Time, s.
        at: f64,
    },
    /// Amplitude of θ̇ in a nutation, rad/s.
    Amplitude {
        /// Time, s.
        at: f64,
    },
    /// Energy lost up to a time, J.
    EnergyLost {
        /// The time, s.
        until: f64,
    },
    /// The largest difference of the torques of friction, losses and air drag of both models, evaluated at the states of
    /// A, N m.
    TorqueDifference {
        /// Whether there is air drag.
        has_air_drag: bool,
    },
}

/// Condition that ends a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EndCondition {
    /// The reason.
    pub reason: StopReason,
    /// The limit of the scenario that was reached: θ in rad, or the duration in s; absent for other reasons.
    pub limit: Option<f64>,
}

impl EndCondition {
    fn label(self) -> Sentence {
        let name = self.reason.words();
        match (self.reason, self.limit) {
            (StopReason::Risen | StopReason::Fallen, Some(level)) => {
                sentence!("{} to {}", name, angle(level))
            }
            _ => name.into(),
        }
    }
}

/// A level of θ, rad.
fn angle(level: f64) -> Piece {
    Piece::number(level, 3, "rad")
}

impl Quantity {
    /// The compared quantity, without the unit.
    pub fn label(self) -> Sentence {
        match self {
            Self::End { ends: [a, b] } => match (a, b) {
                (None, _) | (_, None) => sentence!("ends"),
                (Some(a), Some(b)) if a.label() == b.label() => sentence!("ends ({})", a.label()),
                (Some(a), Some(b)) => sentence!("ends ({}, {})", a.label(), b.label()),
            },
            Self::MeanCrossing { level } => sentence!("mean θ crosses {}", angle(level)),
            Self::FirstReach { level } => sentence!("θ first reaches {}", angle(level)),
            Self::Inversion => sentence!("inverts"),
            Self::FirstLoop => sentence!("first loop"),
            Self::Loops { until } => sentence!("loops by {}", Piece::time(until)),
            Self::FirstEvent { event } => event_label(event).into(),
            Self::FirstRoll => sentence!("first rolls"),
            Self::Hops { until } => sentence!("hops by {}", Piece::time(until)),
            Self::FinalRollTheta => sentence!("θ at start of final rolling"),
            Self::MeanTheta { at } => sentence!("mean θ at {}", Piece::time(at)),
            Self::MeanPrecession { at } => sentence!("mean φ̇ at {}", Piece::time(at)),
            Self::MeanSpin { at } => sentence!("mean ψ̇ at {}", Piece::time(at)),
            Self::PhaseLead { at } => {
                sentence!("nutation phase lead in cycles at {}", Piece::time(at))
            }
            Self::Amplitude { at } => sentence!("nutation amplitude of θ̇ at {}", Piece::time(at)),
            Self::EnergyLost { until } => sentence!("energy lost by {}", Piece::time(until)),
            Self::TorqueDifference { has_air_drag: true } => {
                sentence!("largest difference of friction and air drag torques")
            }
            Self::TorqueDifference {
                has_air_drag: false,
            } => sentence!("largest difference of friction torques"),
        }
    }

    /// The unit, empty for pure numbers.
    pub fn unit(self) -> &'static str {
        match self {
            Self::End { .. }
            | Self::MeanCrossing { .. }
            | Self::FirstReach { .. }
            | Self::Inversion
            | Self::FirstLoop
            | Self::FirstEvent { .. }
            | Self::FirstRoll => "s",
            Self::Loops { .. } | Self::Hops { .. } | Self::PhaseLead { .. } => "",
            Self::FinalRollTheta | Self::MeanTheta { .. } => "rad",
            Self::MeanPrecession { .. } | Self::MeanSpin { .. } | Self::Amplitude { .. } => "rad/s",
            Self::EnergyLost { .. } => "J",
            Self::TorqueDifference { .. } => "N m",
        }
    }

    /// Whether it is a time, s.
    fn is_time(self) -> bool {
        self.unit() == "s"
    }

    /// Whether it is the time of an event.
    pub(super) fn is_time_of_event(self) -> bool {
        self.is_time() && !matches!(self, Self::MeanCrossing { .. })
    }

    fn is_count(self) -> bool {
        matches!(self, Self::Loops { .. } | Self::Hops { .. })
    }

    /// A number of a run, with the digits of the quantity and without its unit, which the label has.
    fn number(self, value: f64) -> Number {
        let digits = if self.is_time() {
            Digits::Decimals(4)
        } else if self.is_count() {
            Digits::Decimals(0)
        } else {
            Digits::Significant(6)
        };
        Number {
            has_unit: false,
            ..Number::new(value, digits, self.unit())
        }
    }

    /// A difference that is not zero, with its sign and the digits of the quantity.
    fn format_difference(self, difference: f64) -> String {
        if self.is_time() {
            signed_duration(difference)
        } else if self.is_count() {
            format!("{difference:+}").replace('-', "−")
        } else {
            significant(difference, 3)
        }
    }

    fn format_uncertainty(self, uncertainty: f64) -> String {
        if self.is_time() {
            Piece::duration(uncertainty).to_string()
        } else {
            significant(uncertainty, 2)
        }
    }
}

/// A duration with its sign.
fn signed_duration(seconds: f64) -> String {
    let sign = if seconds < 0.0 { "−" } else { "+" };
    format!("{sign}{}", Piece::duration(seconds))
}

fn event_label(event: EventKind) -> String {
    match event {
        EventKind::Fallen => "falls".to_owned(),
        EventKind::UprightPassage => "first passes upright".to_owned(),
        EventKind::WeakTop => "becomes weak".to_owned(),
        EventKind::SlipStops => "first stops slipping".to_owned(),
        EventKind::Stick => "first sticks".to_owned(),
        EventKind::LiftOff => "first lifts off".to_owned(),
        EventKind::Rest => "comes to rest".to_owned(),
        EventKind::Jam => "jams".to_owned(),
        other => format!("first {}", other.name().replace('_', " ")),
    }
}

/// A pair of corresponding numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(into = "FindingReport")]
pub struct Finding {
    /// The compared quantity.
    pub quantity: Quantity,
    /// A's number; absent if it has none.
    pub a: Option<f64>,
    /// B's number; absent if it has none.
    pub b: Option<f64>,
    /// The difference B − A; absent if the numbers are unlike, e.g. times of ends of two kinds.
    pub difference: Option<f64>,
    /// Uncertainty of the difference; absent if it is not known.
    pub uncertainty: Option<f64>,
    /// Error of the difference due to the two integrations alone; absent if it is not known.
    pub integration_error: Option<f64>,
}

/// A pair of corresponding numbers, in reports.
#[derive(Serialize, JsonSchema)]
struct FindingReport {
    #[serde(flatten)]
    quantity: Quantity,
    /// The compared quantity in words.
    what: String,
    /// The unit, empty for pure numbers.
    unit: &'static str,
    /// A's number; absent if it has none.
    a: Option<f64>,
    /// B's number; absent if it has none.
    b: Option<f64>,
    /// The difference B − A; absent if the numbers are unlike, e.g. times of ends of two kinds.
    difference: Option<f64>,
    /// Uncertainty of the difference; absent if it is not known.
    uncertainty: Option<f64>,
    /// Error of the difference due to the two integrations alone; absent if it is not known.
    integration_error: Option<f64>,
}

impl From<Finding> for FindingReport {
    fn from(finding: Finding) -> Self {
        Self {
            quantity: finding.quantity,
            what: finding.quantity.label().to_string(),
            unit: finding.quantity.unit(),
            a: finding.a,
            b: finding.b,
            difference: finding.difference,
            uncertainty: finding.uncertainty,
            integration_error: finding.integration_error,
        }
    }
}

/// As it is serialized: with the label and the unit of the quantity.
impl JsonSchema for Finding {
    fn schema_name() -> Cow<'static, str> {
        "Finding".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        FindingReport::json_schema(generator)
    }
}

impl Finding {
    /// A's and B's number, with an unknown error.
    pub(in crate::analysis::diff) fn new(quantity: Quantity, [a, b]: [Option<f64>; 2]) -> Self {
        Self {
            quantity,
            a,
            b,
            difference: a.zip(b).map(|(a, b)| b - a),
            uncertainty: None,
            integration_error: None,
        }
    }

    /// A difference without numbers of A and B, with an unknown error.
    pub(super) fn from_difference(quantity: Quantity, difference: f64) -> Self {
        Self {
            difference: Some(difference),
            ..Self::new(quantity, [None; 2])
        }
    }

    /// Sets the integration error of the difference, which is also its uncertainty; `None` if the numbers depend on the
    /// integration.
    pub(in crate::analysis::diff) fn with_error(self, error: IntegrationError) -> Option<Self> {
        let estimate = match error {
            IntegrationError::Unknown => None,
            IntegrationError::Within(error) => Some(error),
            IntegrationError::Undetermined => return None,
        };
        // Without a difference, the error would be that of nothing.
        let known = estimate.filter(|_| self.difference.is_some());
        Some(Self {
            uncertainty: known,
            integration_error: known,
            ..self
        })
    }

    /// Whether either run has the number.
    pub(super) fn is_known(&self) -> bool {
        self.a.is_some() || self.b.is_some() || self.difference.is_some()
    }

    /// Whether the numbers differ by more than the integration error, or exist in one run only.
    pub fn differs(&self) -> bool {
        let error = self.integration_error.unwrap_or(0.0);
        match self.difference {
            // Without a known error, any difference counts.
            Some(difference) => difference.abs() > error,
            None => self.a != self.b,
        }
    }

    /// The cells of a table: what is compared with its unit, A's and B's number, B − A with its uncertainty.
    pub fn cells(&self) -> [Sentence; 4] {
        let what = match self.quantity.unit() {
            "" => self.quantity.label(),
            unit => sentence!("{} [{}]", self.quantity.label(), unit),
        };
        [
            what,
            self.number_cell(self.a),
            self.number_cell(self.b),
            self.difference_cell().into(),
        ]
    }

    fn number_cell(&self, number: Option<f64>) -> Sentence {
        match number {
            Some(number) => Piece::Number(self.quantity.number(number)).into(),
            None => "–".into(),
        }
    }

    fn difference_cell(&self) -> String {
        /// Uncertainties below this fraction of the difference are not shown: they are below the displayed digits.
        const NEGLIGIBLE: f64 = 1e-3;
        let Some(difference) = self.difference else {
            return String::new();
        };
        let text = if difference == 0.0 {
            "0".to_owned()
        } else {
            self.quantity.format_difference(difference)
        };
        match self.uncertainty {
            Some(error) if error > NEGLIGIBLE * difference.abs() => {
                format!("{text} ± {}", self.quantity.format_uncertainty(error))
            }
            _ => text,
        }
    }
}
