//! The quantities of findings, with their labels, units and digits.

use crate::run::simulation::{EventKind, StopReason};
use crate::words::number::{Digits, significant};
use crate::words::{Number, Piece, Sentence, sentence};
use schemars::JsonSchema;
use serde::Serialize;

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
        /// The farthest mean of θ that both runs come to, from which the level was chosen, rad.
        farthest: f64,
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
    /// Component of the angular velocity along the symmetry axis, ω·n, rad/s.
    AxialSpin {
        /// Time, s.
        at: f64,
    },
    /// RMS angle between the axes at equal times, rad.
    AxisDistance {
        /// The time up to which they are compared, s.
        until: f64,
        /// The largest angle, rad.
        largest: f64,
        /// Time of the largest, s.
        at: f64,
    },
    /// RMS angle between the axes at equal times and an equal phase of the precession, which is that of θ, rad.
    InclinationDistance {
        /// The time up to which they are compared, s.
        until: f64,
        /// The largest angle, rad.
        largest: f64,
        /// Time of the largest, s.
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
        /// Time of the state, s.
        at: f64,
        /// Root mean square of the torque of A, N m.
        rms_a: f64,
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
    /// Whether θ came to its limit.
    pub(super) fn is_of_theta(self) -> bool {
        matches!(self.reason, StopReason::Risen | StopReason::Fallen)
    }

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
    /// The `kind` of the quantity in reports.
    pub fn kind(self) -> String {
        let value = serde_json::to_value(self).unwrap_or_default();
        value["kind"].as_str().unwrap_or_default().to_owned()
    }

    /// The compared quantity, without the unit.
    pub fn label(self) -> Sentence {
        match self {
            Self::End { ends: [a, b] } => match (a, b) {
                (None, _) | (_, None) => sentence!("ends"),
                (Some(a), Some(b)) if a.label() == b.label() => sentence!("ends ({})", a.label()),
                (Some(a), Some(b)) => sentence!("ends ({}, {})", a.label(), b.label()),
            },
            Self::MeanCrossing { level, .. } => sentence!("mean θ crosses {}", angle(level)),
            Self::FirstReach { level } => sentence!("θ first reaches {}", angle(level)),
            Self::Inversion => sentence!("inverts"),
            Self::FirstLoop => sentence!("first loop"),
            Self::Loops { until } => sentence!("loops by {}", Piece::time(until)),
            Self::FirstEvent { event } => event_label(event).into(),
            Self::FirstRoll => sentence!("first rolls"),
            Self::Hops { until } => sentence!("hops by {}", Piece::time(until)),
            Self::FinalRollTheta => sentence!("θ at start of final rolling"),
            Self::MeanTheta { at } => sentence!("mean θ at {}, most different", Piece::time(at)),
            Self::MeanPrecession { at } => {
                sentence!("mean φ̇ at {}, most different", Piece::time(at))
            }
            Self::MeanSpin { at } => {
                sentence!("mean ψ̇ at {}, most different", Piece::time(at))
            }
            Self::AxialSpin { at } => sentence!("ω·n at {}, most different", Piece::time(at)),
            Self::AxisDistance { until, .. } => {
                sentence!("RMS angle between the axes by {}", Piece::time(until))
            }
            Self::InclinationDistance { .. } => {
                sentence!("RMS angle at equal phase of precession")
            }
            Self::PhaseLead { at } => {
                sentence!("nutation phase lead in cycles at {}", Piece::time(at))
            }
            Self::Amplitude { at } => sentence!("nutation amplitude of θ̇ at {}", Piece::time(at)),
            Self::EnergyLost { until } => sentence!("energy lost by {}", Piece::time(until)),
            Self::TorqueDifference {
                has_air_drag, at, ..
            } => {
                let torques = if has_air_drag {
                    "friction and air drag torques"
                } else {
                    "friction torques"
                };
                sentence!("{} at {}, most different", torques, Piece::time(at))
            }
        }
    }

    /// The compared quantity, with the unit.
    pub fn label_with_unit(self) -> Sentence {
        match self.unit() {
            "" => self.label(),
            unit => sentence!("{} [{}]", self.label(), unit),
        }
    }

    /// A change of a number, in the unit of the quantity, for a table; "–" if it is not known.
    pub fn cell_of_change(self, change: Option<f64>) -> String {
        change.map_or_else(|| "–".to_owned(), |change| self.format_difference(change))
    }

    /// The unit, empty for pure numbers.
    pub fn unit(self) -> &'static str {
        match self {
            // Numbers of events and of cycles, which the fields give the times of.
            Self::Loops { .. } | Self::Hops { .. } | Self::PhaseLead { .. } => "",
            _ => self.fields().first().map_or("", |field| field.unit()),
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
    pub(super) fn number(self, value: f64) -> Number {
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

    /// The scale of a difference without numbers of A and B.
    pub(super) fn scale(self) -> Option<f64> {
        match self {
            Self::TorqueDifference { rms_a, .. } => Some(rms_a),
            _ => None,
        }
    }

    /// A difference, with its sign and the digits of the quantity.
    pub(super) fn format_difference(self, difference: f64) -> String {
        if difference == 0.0 {
            "0".to_owned()
        } else if self.is_count() {
            format!("{difference:+}").replace('-', "−")
        } else {
            significant(difference, 3)
        }
    }

    /// An error or another magnitude of the quantity.
    pub(super) fn magnitude(self, magnitude: f64) -> Piece {
        if self.is_time() {
            Piece::duration(magnitude)
        } else {
            Piece::number(magnitude, 2, self.unit())
        }
    }

    /// The reason for which a level was chosen, or the scale of a difference without numbers of A and B.
    pub(super) fn remark(self) -> Option<Sentence> {
        match self {
            Self::MeanCrossing { farthest, .. } => Some(sentence!(
                "the level was chosen near the farthest mean θ that both reach, {}",
                angle(farthest)
            )),
            Self::TorqueDifference { rms_a, .. } => Some(sentence!(
                "both laws at the states of A, whose torque has an RMS of {}",
                Piece::number(rms_a, 3, "N m")
            )),
            Self::AxisDistance { largest, at, .. }
            | Self::InclinationDistance { largest, at, .. } => Some(sentence!(
                "at most {}, at {}",
                Piece::number(largest, 3, "rad"),
                Piece::time(at)
            )),
            _ => None,
        }
    }
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
