//! A finding: a pair of corresponding numbers, and how it is displayed.

use crate::analysis::phrase::{duration, signed_duration, significant};
use schemars::JsonSchema;
use serde::Serialize;

/// The quantity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FindingKind {
    /// Time of the end, s.
    End,
    /// Time at which the mean of θ crosses a level, s.
    MeanCrossing,
    /// Time at which θ first reaches a level, s.
    FirstReach,
    /// Time at which a tippe top inverts, s.
    Inversion,
    /// Time of the first loop, s; of a tippe top: of the first reversal of the precession.
    FirstLoop,
    /// Number of loops; of a tippe top: of reversals of the precession.
    Loops,
    /// Time of the first event of another kind, s.
    FirstEvent,
    /// Time at which the peg first rolls, s.
    FirstRoll,
    /// Number of flights.
    Flights,
    /// θ at the start of the rolling that lasts to the end, rad.
    FinalRollTheta,
    /// Mean of θ over a nutation, rad.
    MeanTheta,
    /// Mean of φ̇ over a nutation, rad/s.
    MeanPrecession,
    /// Mean of ψ̇ over a nutation, rad/s.
    MeanSpin,
    /// Lead of B's nutation over A's, cycles.
    PhaseLead,
    /// Amplitude of θ̇ in a nutation, rad/s.
    Amplitude,
    /// Energy lost up to a time, J.
    EnergyLost,
    /// The largest difference of the torques of friction, losses and air drag of both models at A's states, N m.
    TorqueDifference,
}

impl FindingKind {
    /// The unit, empty for pure numbers.
    pub fn unit(self) -> &'static str {
        match self {
            Self::End
            | Self::MeanCrossing
            | Self::FirstReach
            | Self::Inversion
            | Self::FirstLoop
            | Self::FirstEvent
            | Self::FirstRoll => "s",
            Self::Loops | Self::Flights | Self::PhaseLead => "",
            Self::FinalRollTheta | Self::MeanTheta => "rad",
            Self::MeanPrecession | Self::MeanSpin | Self::Amplitude => "rad/s",
            Self::EnergyLost => "J",
            Self::TorqueDifference => "N m",
        }
    }

    /// Whether it is the time of an event.
    pub(super) fn is_time_of_event(self) -> bool {
        self.unit() == "s" && self != Self::MeanCrossing
    }

    fn is_count(self) -> bool {
        matches!(self, Self::Loops | Self::Flights)
    }
}

/// A pair of corresponding numbers.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Finding {
    /// The kind of quantity.
    pub kind: FindingKind,
    /// The compared quantity.
    pub what: String,
    /// The unit, empty for pure numbers.
    pub unit: String,
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

impl Finding {
    /// A's and B's number with the integration error of their difference, which is also its uncertainty.
    pub(super) fn new(
        kind: FindingKind,
        what: impl Into<String>,
        [a, b]: [Option<f64>; 2],
        error: Option<f64>,
    ) -> Self {
        let difference = a.zip(b).map(|(a, b)| b - a);
        let error = error.filter(|_| difference.is_some());
        Self {
            kind,
            what: what.into(),
            unit: kind.unit().to_owned(),
            a,
            b,
            difference,
            uncertainty: error,
            integration_error: error,
        }
    }

    /// A difference without numbers of A and B.
    pub(super) fn of_difference(
        kind: FindingKind,
        what: impl Into<String>,
        difference: f64,
        error: Option<f64>,
    ) -> Self {
        Self {
            difference: Some(difference),
            uncertainty: error,
            integration_error: error,
            ..Self::new(kind, what, [None; 2], None)
        }
    }

    /// Whether either run has the number.
    pub(super) fn is_known(&self) -> bool {
        self.a.is_some() || self.b.is_some() || self.difference.is_some()
    }

    /// Whether the numbers differ by more than the integration error, or exist in one run only.
    pub fn differs(&self) -> bool {
        let error = self.integration_error.unwrap_or(0.0);
        match self.difference {
            Some(difference) => difference.abs() > error,
            None => self.a != self.b,
        }
    }

    /// The cells of a table: what is compared with its unit, A's and B's number, B − A with its uncertainty.
    pub fn cells(&self) -> [String; 4] {
        let is_time = self.kind.unit() == "s";
        let value = |value: Option<f64>| match value {
            Some(value) if is_time => format!("{value:.4}"),
            Some(value) if self.kind.is_count() => format!("{value}"),
            Some(value) => significant(value, 6),
            None => "–".to_owned(),
        };
        let difference = self.difference.map(|difference| match difference {
            0.0 => "0".to_owned(),
            shift if is_time => signed_duration(shift),
            count if self.kind.is_count() => format!("{count:+}").replace('-', "−"),
            difference => significant(difference, 3),
        });
        // Uncertainties below the displayed digits are omitted.
        let is_shown = |error: &f64| *error > NEGLIGIBLE * self.difference.unwrap_or(0.0).abs();
        let uncertainty = match self.uncertainty.filter(is_shown) {
            Some(error) if is_time => format!(" ± {}", duration(error)),
            Some(error) => format!(" ± {}", significant(error, 2)),
            None => String::new(),
        };
        let what = match self.unit.as_str() {
            "" => self.what.clone(),
            unit => format!("{} [{unit}]", self.what),
        };
        let difference = difference.map_or_else(String::new, |text| text + &uncertainty);
        [what, value(self.a), value(self.b), difference]
    }
}

/// Uncertainties below this fraction of the difference are not shown.
const NEGLIGIBLE: f64 = 1e-3;
