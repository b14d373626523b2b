//! Curves that share an entity: the numbers of a channel, or numbers that follow from several channels.

use rerun::AsComponents;
use rerun::components::MarkerShape;

use crate::rerun::identity::Identity;
use crate::rerun::palette::{GREEN, GREY, SKY, VERMILION, WHITE, YELLOW};
use crate::rerun::role::Role;
use crate::rerun::style::{self, LineStyle};
use crate::telemetry::fields::{
    ACCELERATION, EVENTS, FREE_PEG, MOMENTUM, NUTATION, NumberField, POSE, Plot, STATE, TORQUE,
};
use crate::telemetry::{Quantity, Topic};

/// Curves of a chart that share an entity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::rerun) enum Curves {
    /// Numbers of a channel.
    Field(Plot),
    /// Numbers that no message has.
    Derived(Derived),
}

/// Numbers that follow from the messages of a sample or of a nutation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::rerun) enum Derived {
    /// Horizontal and vertical part of the angular momentum.
    MomentumParts,
    /// Torque of friction along the horizontal part of the angular momentum.
    TorqueAlong,
    /// The spin ω·n about the axis, which is finite where the axis is vertical.
    AxialRate,
    /// θ at each event.
    EventMarks,
    /// Relative change of Jellett's integral since the start.
    JellettChange,
    /// Means of the terms of d²θ/dt² over each nutation.
    ThetaTerms,
    /// Means of the terms of d²φ/dt².
    PhiTerms,
    /// Means of the terms of d²ψ/dt².
    PsiTerms,
}

/// What is known of derived curves.
struct DerivedInfo {
    /// The name of the entity.
    name: &'static str,
    quantity: Quantity,
    styles: &'static [LineStyle],
    /// The topics that the curves are made from.
    topics: &'static [Topic],
}

const TERMS: &[LineStyle] = &[
    ("friction", VERMILION, 1.8),
    ("all other terms", YELLOW, 1.2),
    ("sum", GREY, 1.2),
];

impl Derived {
    /// All of them.
    pub(in crate::rerun) const ALL: [Self; 8] = [
        Self::MomentumParts,
        Self::TorqueAlong,
        Self::AxialRate,
        Self::EventMarks,
        Self::JellettChange,
        Self::ThetaTerms,
        Self::PhiTerms,
        Self::PsiTerms,
    ];

    fn info(self) -> DerivedInfo {
        let (name, quantity, styles, topics): (_, _, &[LineStyle], &[Topic]) = match self {
            Self::MomentumParts => (
                "momentum_parts",
                Quantity::Momentum,
                &[("horizontal", YELLOW, 2.0), ("vertical", SKY, 1.5)],
                &[POSE, MOMENTUM],
            ),
            Self::TorqueAlong => (
                "torque_along_horizontal_momentum",
                Quantity::Torque,
                &[("τ along the horizontal part of L", VERMILION, 1.5)],
                &[POSE, MOMENTUM, TORQUE],
            ),
            Self::AxialRate => (
                "axial_rate",
                Quantity::Rate,
                &[("ω·n", GREEN, 1.2)],
                &[POSE],
            ),
            Self::EventMarks => (
                "event_marks",
                Quantity::Angle,
                &[("event", WHITE, 3.5)],
                &[EVENTS],
            ),
            Self::JellettChange => (
                "jellett_change",
                // Relative, as a component of a direction: its typical magnitude is 1.
                Quantity::Direction,
                &[("relative change", SKY, 1.2)],
                &[FREE_PEG],
            ),
            Self::ThetaTerms => (
                "mean_terms/theta_ddot",
                Quantity::Acceleration,
                TERMS,
                MEANS,
            ),
            Self::PhiTerms => ("mean_terms/phi_ddot", Quantity::Acceleration, TERMS, MEANS),
            Self::PsiTerms => ("mean_terms/psi_ddot", Quantity::Acceleration, TERMS, MEANS),
        };
        DerivedInfo {
            name,
            quantity,
            styles,
            topics,
        }
    }
}

/// The topics that means over a nutation are made from.
const MEANS: &[Topic] = &[STATE, ACCELERATION, NUTATION];

impl Curves {
    /// The path of the entity, without the run.
    pub(in crate::rerun) fn path(self) -> String {
        match self {
            Self::Field(plot) => plot.to_string(),
            Self::Derived(derived) => format!("/derived/{}", derived.info().name),
        }
    }

    /// The unit of the numbers.
    pub(in crate::rerun) fn unit(self) -> &'static str {
        match self {
            Self::Field(plot) => plot.unit(),
            Self::Derived(derived) => derived.info().quantity.unit(),
        }
    }

    /// The quantity of each number.
    pub(in crate::rerun) fn quantities(self) -> Vec<Quantity> {
        match self {
            Self::Field(plot) => plot
                .numbers()
                .map(|number| number.leaf().quantity)
                .collect(),
            Self::Derived(derived) => {
                let DerivedInfo {
                    quantity, styles, ..
                } = derived.info();
                vec![quantity; styles.len()]
            }
        }
    }

    /// Whether a recording has the topics that the numbers are made from.
    pub(in crate::rerun) fn is_in(self, identity: &Identity) -> bool {
        match self {
            Self::Field(plot) => identity.has(plot.topic()),
            Self::Derived(derived) => derived
                .info()
                .topics
                .iter()
                .all(|topic| identity.has(*topic)),
        }
    }

    /// Whether the distance from zero matters: the sense and the size of a torque, more than its changes.
    pub(in crate::rerun) fn includes_zero(self) -> bool {
        self == Self::Derived(Derived::TorqueAlong)
    }

    /// Whether the numbers belong to a nutation, and are drawn as dots over the curve of their quantity.
    pub(in crate::rerun) fn are_means(self) -> bool {
        matches!(self, Self::Field(plot) if plot.topic() == NUTATION)
    }

    /// Names, colours and widths.
    pub(super) fn series(self, role: &Role) -> Box<dyn AsComponents> {
        match self {
            Self::Field(plot) => {
                let numbers: Vec<NumberField> = plot.numbers().collect();
                style::series(&numbers, role)
            }
            Self::Derived(derived) => {
                let styles = derived.info().styles;
                match derived {
                    Derived::EventMarks => Box::new(style::marks(styles, MarkerShape::Diamond)),
                    _ => Box::new(style::lines(styles)),
                }
            }
        }
    }
}
