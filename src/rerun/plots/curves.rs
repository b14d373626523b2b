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

const AXIAL_RATE: [LineStyle; 1] = [("ω·n", GREEN, 1.2)];
const TORQUE_ALONG: [LineStyle; 1] = [("τ along the horizontal part of L", VERMILION, 1.5)];
const MOMENTUM_PARTS: [LineStyle; 2] = [("horizontal", YELLOW, 2.0), ("vertical", SKY, 1.5)];
const JELLETT_CHANGE: [LineStyle; 1] = [("relative change", SKY, 1.2)];
const EVENT_MARKS: [LineStyle; 1] = [("event", WHITE, 3.5)];
const TERMS: [LineStyle; 3] = [
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

    fn name(self) -> &'static str {
        match self {
            Self::MomentumParts => "momentum_parts",
            Self::TorqueAlong => "torque_along_horizontal_momentum",
            Self::AxialRate => "axial_rate",
            Self::EventMarks => "event_marks",
            Self::JellettChange => "jellett_change",
            Self::ThetaTerms => "mean_terms/theta_ddot",
            Self::PhiTerms => "mean_terms/phi_ddot",
            Self::PsiTerms => "mean_terms/psi_ddot",
        }
    }

    fn quantity(self) -> Quantity {
        match self {
            Self::MomentumParts => Quantity::Momentum,
            Self::TorqueAlong => Quantity::Torque,
            Self::AxialRate => Quantity::Rate,
            Self::EventMarks => Quantity::Angle,
            // Relative, as a component of a direction: its typical magnitude is 1.
            Self::JellettChange => Quantity::Direction,
            Self::ThetaTerms | Self::PhiTerms | Self::PsiTerms => Quantity::Acceleration,
        }
    }

    fn styles(self) -> &'static [LineStyle] {
        match self {
            Self::MomentumParts => &MOMENTUM_PARTS,
            Self::TorqueAlong => &TORQUE_ALONG,
            Self::AxialRate => &AXIAL_RATE,
            Self::EventMarks => &EVENT_MARKS,
            Self::JellettChange => &JELLETT_CHANGE,
            Self::ThetaTerms | Self::PhiTerms | Self::PsiTerms => &TERMS,
        }
    }

    fn topics(self) -> &'static [Topic] {
        match self {
            Self::MomentumParts => &[POSE, MOMENTUM],
            Self::TorqueAlong => &[POSE, MOMENTUM, TORQUE],
            Self::AxialRate => &[POSE],
            Self::EventMarks => &[EVENTS],
            Self::JellettChange => &[FREE_PEG],
            Self::ThetaTerms | Self::PhiTerms | Self::PsiTerms => &[STATE, ACCELERATION, NUTATION],
        }
    }
}

impl Curves {
    /// The path of the entity, without the run.
    pub(in crate::rerun) fn path(self) -> String {
        match self {
            Self::Field(plot) => plot.to_string(),
            Self::Derived(derived) => format!("/derived/{}", derived.name()),
        }
    }

    /// The unit of the numbers.
    pub(in crate::rerun) fn unit(self) -> &'static str {
        match self {
            Self::Field(plot) => plot.unit(),
            Self::Derived(derived) => derived.quantity().unit(),
        }
    }

    /// The quantity of each number.
    pub(in crate::rerun) fn quantities(self) -> Vec<Quantity> {
        match self {
            Self::Field(plot) => plot
                .numbers()
                .map(|number| number.leaf().quantity)
                .collect(),
            Self::Derived(derived) => vec![derived.quantity(); derived.styles().len()],
        }
    }

    /// Whether a recording has the topics that the numbers are made from.
    pub(in crate::rerun) fn is_in(self, identity: &Identity) -> bool {
        match self {
            Self::Field(plot) => identity.has(plot.topic()),
            Self::Derived(derived) => derived.topics().iter().all(|topic| identity.has(*topic)),
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
            Self::Derived(Derived::EventMarks) => {
                Box::new(style::marks(&EVENT_MARKS, MarkerShape::Diamond))
            }
            Self::Derived(derived) => Box::new(style::lines(derived.styles())),
        }
    }
}
