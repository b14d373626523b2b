//! The topics and fields of the table as constants: handles that read their values from messages.
//!
//! A handle is called like its field, in capitals and with `_` for the dot: [`state::THETA`] is `theta` of
//! `/top/state`, [`acceleration::THETA_DDOT_FRICTIONAL`] is `theta_ddot.frictional` of `/top/acceleration`.
//! The handles are found in the table while the program is compiled, so a misspelt topic or field does not
//! compile:
//!
//! ```
//! use toprise::telemetry::fields::{STATE, pose, state};
//!
//! assert_eq!(STATE.name(), "/top/state");
//! assert_eq!(state::THETA.path(), "theta");
//! assert_eq!(pose::AXIS.z().path(), "axis.z");
//! ```
//!
//! ```compile_fail
//! use toprise::telemetry::fields::state;
//!
//! let theta = state::TEHTA;
//! ```

use super::channel::Leaf;
use super::message::{Message, Numbers};
use super::table::{
    Channel, EVENTS as EVENT_TABLE, IMPACTS as IMPACT_TABLE, NUTATION as NUTATION_TABLE, SAMPLES,
    Source,
};
use super::topic::Topic;
use nalgebra::{Quaternion, Vector3};
use std::fmt;

/// The handle of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NumberField {
    topic: Topic,
    index: usize,
    plot: &'static str,
}

impl NumberField {
    /// The number at `path` of the channel `topic`, for names that are known only when the program runs.
    #[must_use]
    pub fn find(topic: &str, path: &str) -> Option<Self> {
        let mut numbers = Topic::find(topic)?.numbers();
        numbers.find(|number| number.path() == path)
    }

    /// Its channel.
    #[must_use]
    pub const fn topic(self) -> Topic {
        self.topic
    }

    /// Its index in [`Message::numbers`].
    #[must_use]
    pub const fn index(self) -> usize {
        self.index
    }

    /// The plot that shows it.
    #[must_use]
    pub const fn plot(self) -> Plot {
        Plot {
            topic: self.topic,
            name: self.plot,
        }
    }

    /// Its row of the table.
    #[must_use]
    pub fn leaf(self) -> &'static Leaf {
        &self.topic.info().numbers[self.index]
    }

    /// Its path in a message, as in `theta` or `omega_body.x`.
    #[must_use]
    pub fn path(self) -> &'static str {
        &self.leaf().path
    }

    /// Its unit, empty for pure numbers.
    #[must_use]
    pub fn unit(self) -> &'static str {
        self.leaf().unit
    }

    /// Its value in some rows; NaN if they don't have it.
    #[inline]
    #[must_use]
    pub fn of(self, rows: &impl Numbers) -> f64 {
        let row = rows.numbers(self.topic);
        row.and_then(|row| row.get(self.index).copied())
            .unwrap_or(f64::NAN)
    }
}

/// Topic and path, as in `/top/state.theta`.
impl fmt::Display for NumberField {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.topic, self.path())
    }
}

impl Topic {
    /// The handles of the numbers of a message.
    pub fn numbers(self) -> impl Iterator<Item = NumberField> {
        let leaves = self.info().numbers.iter().enumerate();
        leaves.map(move |(index, leaf)| NumberField {
            topic: self,
            index,
            plot: leaf.plot,
        })
    }
}

/// The handle of a vector: three numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct VectorField(NumberField);

impl VectorField {
    /// Its x component.
    #[must_use]
    pub const fn x(self) -> NumberField {
        part(self.0, 0)
    }

    /// Its y component.
    #[must_use]
    pub const fn y(self) -> NumberField {
        part(self.0, 1)
    }

    /// Its z component.
    #[must_use]
    pub const fn z(self) -> NumberField {
        part(self.0, 2)
    }

    /// Its components x, y, z.
    #[must_use]
    pub const fn components(self) -> [NumberField; 3] {
        [self.x(), self.y(), self.z()]
    }

    /// Its channel.
    #[must_use]
    pub const fn topic(self) -> Topic {
        self.0.topic
    }

    /// The plot that shows it.
    #[must_use]
    pub const fn plot(self) -> Plot {
        self.0.plot()
    }

    /// Its value in some rows; NaN if they don't have it.
    #[inline]
    #[must_use]
    pub fn of(self, rows: &impl Numbers) -> Vector3<f64> {
        Vector3::from(self.components().map(|component| component.of(rows)))
    }
}

/// The handle of an orientation: the four numbers of a quaternion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RotationField(NumberField);

impl RotationField {
    /// Its components x, y, z, w.
    #[must_use]
    pub const fn components(self) -> [NumberField; 4] {
        [
            part(self.0, 0),
            part(self.0, 1),
            part(self.0, 2),
            part(self.0, 3),
        ]
    }

    /// Its channel.
    #[must_use]
    pub const fn topic(self) -> Topic {
        self.0.topic
    }

    /// Its value in some rows, as it was recorded; NaN if they don't have it.
    #[inline]
    #[must_use]
    pub fn of(self, rows: &impl Numbers) -> Quaternion<f64> {
        let [x, y, z, w] = self.components().map(|component| component.of(rows));
        Quaternion::new(w, x, y, z)
    }
}

/// The handle of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TextField {
    topic: Topic,
    index: usize,
}

impl TextField {
    /// Its channel.
    #[must_use]
    pub const fn topic(self) -> Topic {
        self.topic
    }

    /// Its index in [`Message::texts`].
    #[must_use]
    pub const fn index(self) -> usize {
        self.index
    }

    /// Its path in a message.
    #[must_use]
    pub fn path(self) -> &'static str {
        &self.topic.info().texts[self.index].path
    }

    /// Its value in a message; empty if the message doesn't have it.
    #[inline]
    #[must_use]
    pub fn of<'a>(self, message: &Message<'a>) -> &'a str {
        match message.texts.get(self.index) {
            Some(text) if message.channel == self.topic.index() => text,
            _ => "",
        }
    }
}

/// A plot of a channel: the numbers that are shown together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Plot {
    topic: Topic,
    name: &'static str,
}

impl Plot {
    /// The plots of a channel, in table order.
    #[must_use]
    pub fn all(topic: Topic) -> Vec<Self> {
        let mut plots: Vec<Self> = Vec::new();
        for leaf in &topic.info().numbers {
            if plots.iter().all(|plot| plot.name != leaf.plot) {
                let name = leaf.plot;
                plots.push(Self { topic, name });
            }
        }
        plots
    }

    /// The unit of its numbers.
    #[must_use]
    pub fn unit(self) -> &'static str {
        self.numbers().next().map_or("", NumberField::unit)
    }

    /// Its numbers, in table order.
    pub fn numbers(self) -> impl Iterator<Item = NumberField> {
        let leaves = self.topic.info().numbers.iter().enumerate();
        leaves
            .filter(move |(_, leaf)| leaf.plot == self.name)
            .map(move |(index, leaf)| NumberField {
                topic: self.topic,
                index,
                plot: leaf.plot,
            })
    }

    /// Its channel.
    #[must_use]
    pub const fn topic(self) -> Topic {
        self.topic
    }

    /// Its name within the channel.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.name
    }
}

/// Topic and name, as in `/top/energy/mechanical`.
impl fmt::Display for Plot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.topic, self.name)
    }
}

/// The number that stands `offset` places behind another.
const fn part(field: NumberField, offset: usize) -> NumberField {
    NumberField {
        index: field.index + offset,
        ..field
    }
}

/// Facts that a handle needs of a field of the table.
#[derive(Clone, Copy)]
struct Found {
    /// Index of its first number, or of its text.
    index: usize,
    /// Number of its numbers; 0 for a text.
    numbers: usize,
    plot: &'static str,
}

/// The topic with this name.
const fn topic(name: &str) -> Topic {
    let mut index = 0;
    while index <= SAMPLES.len() + 2 {
        let topic = Topic::at(index);
        if is_called(name, topic.name()) {
            return topic;
        }
        index += 1;
    }
    panic!("the table has no such topic");
}

/// The field of `topic` with this handle.
const fn find(topic: Topic, handle: &str) -> Found {
    let index = topic.index();
    let found = if index < SAMPLES.len() {
        find_in(&SAMPLES[index], handle)
    } else if index == SAMPLES.len() {
        find_in(&NUTATION_TABLE, handle)
    } else if index == SAMPLES.len() + 1 {
        find_in(&EVENT_TABLE, handle)
    } else {
        find_in(&IMPACT_TABLE, handle)
    };
    match found {
        Some(found) => found,
        None => panic!("the channel has no such field"),
    }
}

const fn find_in<S>(channel: &Channel<S>, handle: &str) -> Option<Found> {
    let (mut numbers_before, mut texts_before) = (0, 0);
    let mut at = 0;
    while at < channel.fields.len() {
        let field = &channel.fields[at];
        let numbers = match field.source {
            Source::Number(_) => 1,
            Source::Vector(_) => 3,
            Source::Rotation(_) => 4,
            Source::Text(_) => 0,
        };
        if is_called(handle, field.name) {
            return Some(Found {
                index: if numbers > 0 {
                    numbers_before
                } else {
                    texts_before
                },
                numbers,
                plot: field.plot,
            });
        }
        numbers_before += numbers;
        texts_before += (numbers == 0) as usize;
        at += 1;
    }
    None
}

/// Whether a handle belongs to a name: they are equal up to case, with `_` for the dot.
const fn is_called(handle: &str, name: &str) -> bool {
    let (handle, name) = (handle.as_bytes(), name.as_bytes());
    if handle.len() != name.len() {
        return false;
    }
    let mut at = 0;
    while at < name.len() {
        let expected = match name[at] {
            b'.' => b'_',
            letter => letter.to_ascii_uppercase(),
        };
        if handle[at].to_ascii_uppercase() != expected {
            return false;
        }
        at += 1;
    }
    true
}

const fn number_at(topic: Topic, handle: &str, numbers: usize) -> NumberField {
    let found = find(topic, handle);
    assert!(found.numbers == numbers, "the field is of another kind");
    NumberField {
        topic,
        index: found.index,
        plot: found.plot,
    }
}

const fn number(topic: Topic, handle: &str) -> NumberField {
    number_at(topic, handle, 1)
}

const fn vector(topic: Topic, handle: &str) -> VectorField {
    VectorField(number_at(topic, handle, 3))
}

const fn rotation(topic: Topic, handle: &str) -> RotationField {
    RotationField(number_at(topic, handle, 4))
}

const fn text(topic: Topic, handle: &str) -> TextField {
    let found = find(topic, handle);
    assert!(found.numbers == 0, "the field is of another kind");
    TextField {
        topic,
        index: found.index,
    }
}

/// Quantities of the state with their least and greatest values in a nutation.
pub(crate) const NUTATING: [[NumberField; 3]; 4] = [
    [state::THETA, nutation::THETA_MIN, nutation::THETA_MAX],
    [
        state::THETA_DOT,
        nutation::THETA_DOT_MIN,
        nutation::THETA_DOT_MAX,
    ],
    [state::PHI_DOT, nutation::PHI_DOT_MIN, nutation::PHI_DOT_MAX],
    [state::PSI_DOT, nutation::PSI_DOT_MIN, nutation::PSI_DOT_MAX],
];

/// Declares the handles of a channel, by kind.
macro_rules! handles {
    ($topic:ident, $fields:ident = $name:literal {
        $($kind:ident -> $type:ident: $($handle:ident)*;)*
    }) => {
        #[doc = concat!("`", $name, "`.")]
        pub const $topic: Topic = topic($name);

        #[doc = concat!("The fields of `", $name, "`.")]
        pub mod $fields {
            use $crate::telemetry::fields::*;

            $($(
                #[doc = concat!("Handle of a field of `", $name, "`.")]
                pub const $handle: $type = $kind($topic, stringify!($handle));
            )*)*

            /// For each handle its index and how many numbers it has.
            #[cfg(test)]
            pub(super) fn places() -> Vec<(usize, usize)> {
                vec![$($({
                    let found = find($topic, stringify!($handle));
                    (found.index, found.numbers)
                }),*),*]
            }
        }
    };
}

handles!(STATE, state = "/top/state" {
    number -> NumberField: PHI THETA PSI PHI_DOT THETA_DOT PSI_DOT PHI_DDOT THETA_DDOT PSI_DDOT;
});

handles!(POSE, pose = "/top/pose" {
    rotation -> RotationField: ORIENTATION;
    vector -> VectorField: AXIS OMEGA_BODY OMEGA_WORLD PEG_POSITION;
});

handles!(TORQUE, torque = "/top/torque" {
    vector -> VectorField: GRAVITY_BODY FRICTION_BODY TOTAL_BODY GRAVITY_NODE FRICTION_NODE TOTAL_NODE;
});

handles!(ACCELERATION, acceleration = "/top/acceleration" {
    number -> NumberField:
        THETA_DDOT_GYROSCOPIC THETA_DDOT_CENTRIFUGAL THETA_DDOT_GRAVITATIONAL THETA_DDOT_FRICTIONAL
        PHI_DDOT_GYROSCOPIC PHI_DDOT_CORIOLIS PHI_DDOT_FRICTIONAL
        PSI_DDOT_GYROSCOPIC PSI_DDOT_CORIOLIS PSI_DDOT_FRICTIONAL
        PHI_DOT_GYROSCOPIC PHI_DOT_CORIOLIS PHI_DOT_FRICTIONAL PSI_DOT_FRICTIONAL;
});

handles!(CONTACT, contact = "/top/contact" {
    vector -> VectorField: SLIP_BODY SLIP_WORLD FRICTION_FORCE CONTACT_POINT;
    number -> NumberField: SLIP_SPEED NORMAL_FORCE SLIP_PATH REGIME SLIP_WORK;
});

handles!(ENERGY, energy = "/top/energy" {
    number -> NumberField: KINETIC POTENTIAL TOTAL FRICTION_POWER FRICTION_WORK;
    vector -> VectorField: FRICTION_WORK_NODE;
});

handles!(MOMENTUM, momentum = "/top/momentum" {
    number -> NumberField: VERTICAL AXIAL;
    vector -> VectorField: WORLD;
});

handles!(PRECESSION, precession = "/top/precession" {
    number -> NumberField: SLOW_ROOT FAST_ROOT EXCESS STRENGTH_RATIO;
});

handles!(CENTER_OF_MASS, center_of_mass = "/top/center_of_mass" {
    vector -> VectorField: POSITION VELOCITY ACCELERATION ANGULAR_MOMENTUM;
});

handles!(FREE_PEG, free_peg = "/top/free_peg" {
    number -> NumberField:
        GAP JELLETT ROUTH TRANSLATIONAL LOST_SLIDING LOST_LOSSES LOST_RESTITUTION LOST_IMPACT_FRICTION
        DRIVEN_THETA_DDOT DRIVEN_PHI_DDOT DRIVEN_PSI_DDOT;
    vector -> VectorField: VELOCITY;
});

handles!(NUTATION, nutation = "/top/nutation" {
    number -> NumberField:
        CYCLE START PERIOD THETA_MIN THETA_MAX THETA_MEAN THETA_DOT_MEAN PHI_DOT_MEAN PSI_DOT_MEAN
        THETA_DOT_MIN THETA_DOT_MAX PHI_DOT_MIN PHI_DOT_MAX PSI_DOT_MIN PSI_DOT_MAX PHI_DDOT_FRICTIONAL_MEAN;
});

handles!(EVENTS, events = "/events" {
    text -> TextField: NAME DESCRIPTION;
    number -> NumberField: TIME PHI THETA PSI PHI_DOT THETA_DOT PSI_DOT;
});

handles!(IMPACTS, impacts = "/top/impact" {
    number -> NumberField: TIME BOUNCE STAYS RESTITUTION LOST_RESTITUTION LOST_FRICTION;
    vector -> VectorField: POINT IMPULSE BEFORE AFTER;
});

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::channel::channels;
    use crate::telemetry::quantity::Quantity;

    #[test]
    fn every_field_of_the_table_has_one_handle() {
        let all = [
            (STATE, state::places()),
            (POSE, pose::places()),
            (TORQUE, torque::places()),
            (ACCELERATION, acceleration::places()),
            (CONTACT, contact::places()),
            (ENERGY, energy::places()),
            (MOMENTUM, momentum::places()),
            (PRECESSION, precession::places()),
            (CENTER_OF_MASS, center_of_mass::places()),
            (FREE_PEG, free_peg::places()),
            (NUTATION, nutation::places()),
            (EVENTS, events::places()),
            (IMPACTS, impacts::places()),
        ];
        assert_eq!(all.len(), channels().len());
        for ((index, info), (topic, mut places)) in channels().iter().enumerate().zip(all) {
            assert_eq!((topic.index(), topic.name()), (index, info.topic));
            places.sort_unstable();
            let texts = places.iter().filter(|place| place.1 == 0);
            assert!(
                texts.map(|place| place.0).eq(0..info.texts.len()),
                "{topic}"
            );
            let numbers = places.iter().filter(|place| place.1 > 0);
            let covered = numbers.flat_map(|(index, count)| *index..index + count);
            assert!(covered.eq(0..info.numbers.len()), "{topic}");
        }
    }

    #[test]
    fn handles_agree_with_the_channels() {
        assert_eq!(state::THETA.to_string(), "/top/state.theta");
        let paths = pose::ORIENTATION.components().map(NumberField::path);
        assert_eq!(
            paths,
            [
                "orientation.x",
                "orientation.y",
                "orientation.z",
                "orientation.w"
            ]
        );
        assert_eq!(contact::CONTACT_POINT.y().path(), "contact_point.y");
        assert_eq!(events::DESCRIPTION.path(), "description");
        assert_eq!(nutation::PSI_DOT_MEAN.path(), "psi_dot_mean");
        assert_eq!(energy::TOTAL.plot().to_string(), "/top/energy/mechanical");
        for topic in Topic::all() {
            assert_eq!(topic.name(), topic.info().topic);
        }
    }

    #[test]
    fn what_a_message_does_not_have_is_not_a_number() {
        let numbers: Vec<f64> = (0..16).map(f64::from).collect();
        let message = Message {
            channel: POSE.index(),
            sequence: 0,
            time_ns: 0,
            numbers: &numbers,
            texts: &[],
        };
        assert_eq!(pose::AXIS.of(&message), Vector3::new(4.0, 5.0, 6.0));
        assert_eq!(pose::ORIENTATION.of(&message).w, 3.0);
        assert!(state::THETA.of(&message).is_nan());
        assert_eq!(events::NAME.of(&message), "");
    }

    #[test]
    fn derivatives_are_those_of_the_angles() {
        for channel in channels() {
            for leaf in &channel.numbers {
                let derivative = leaf.derivative.map(|at| &channel.numbers[at]);
                let expected = match leaf.quantity {
                    Quantity::Angle => Quantity::Rate,
                    _ => Quantity::Acceleration,
                };
                assert!(derivative.is_none_or(|derivative| derivative.quantity == expected));
            }
        }
        let info = STATE.info();
        let path = |field: NumberField| {
            let derivative = field.leaf().derivative?;
            Some(info.numbers[derivative].path.as_str())
        };
        assert_eq!(path(state::PHI), Some("phi_dot"));
        assert_eq!(path(state::PSI_DOT), Some("psi_ddot"));
        assert_eq!(path(state::THETA_DDOT), None);
    }
}
