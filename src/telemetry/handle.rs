//! Handles of fields and plots: they read values from messages and return names and units.

use super::table::channel::Leaf;
use crate::telemetry::message::{Message, Numbers};
use crate::telemetry::topic::Topic;
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
    /// The handle of the number with this index in the messages of a channel, shown in this plot.
    pub(super) const fn new(topic: Topic, index: usize, plot: &'static str) -> Self {
        Self { topic, index, plot }
    }

    /// The topic of the channel.
    pub const fn topic(self) -> Topic {
        self.topic
    }

    /// The index in [`Message::numbers`].
    pub const fn index(self) -> usize {
        self.index
    }

    /// The plot that shows it.
    pub const fn plot(self) -> Plot {
        Plot {
            topic: self.topic,
            name: self.plot,
        }
    }

    /// The row of the table.
    pub fn leaf(self) -> &'static Leaf {
        &self.topic.info().numbers[self.index]
    }

    /// The path in a message, e.g. `theta` or `omega_body.x`.
    pub fn path(self) -> &'static str {
        &self.leaf().path
    }

    /// The unit; empty for pure numbers.
    pub fn unit(self) -> &'static str {
        self.leaf().unit
    }

    /// The value in a message; NaN if it is missing.
    #[inline]
    pub fn of(self, rows: &impl Numbers) -> f64 {
        // Files may lack channels, and those of other versions fields.
        let row = rows.numbers(self.topic);
        row.and_then(|row| row.get(self.index).copied())
            .unwrap_or(f64::NAN)
    }
}

/// Topic and path, e.g. `/top/state.theta`.
impl fmt::Display for NumberField {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.topic, self.path())
    }
}

impl Topic {
    /// The handles of the numbers of a message.
    pub fn numbers(self) -> impl Iterator<Item = NumberField> {
        let leaves = self.info().numbers.iter().enumerate();
        leaves.map(move |(index, leaf)| NumberField::new(self, index, leaf.plot))
    }
}

/// The handle of a vector: three numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct VectorField(NumberField);

impl VectorField {
    /// The handle of the vector whose first number has this index.
    pub(super) const fn new(topic: Topic, index: usize, plot: &'static str) -> Self {
        Self(NumberField::new(topic, index, plot))
    }

    /// The x component.
    pub const fn x(self) -> NumberField {
        part(self.0, 0)
    }

    /// The y component.
    pub const fn y(self) -> NumberField {
        part(self.0, 1)
    }

    /// The z component.
    pub const fn z(self) -> NumberField {
        part(self.0, 2)
    }

    /// The components x, y, z.
    pub const fn components(self) -> [NumberField; 3] {
        [self.x(), self.y(), self.z()]
    }

    /// The topic of the channel.
    pub const fn topic(self) -> Topic {
        self.0.topic
    }

    /// The plot that shows it.
    pub const fn plot(self) -> Plot {
        self.0.plot()
    }

    /// The value in a message; NaN if it is missing.
    #[inline]
    pub fn of(self, rows: &impl Numbers) -> Vector3<f64> {
        Vector3::from(self.components().map(|component| component.of(rows)))
    }
}

/// The handle of an orientation: the four numbers of a quaternion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RotationField(NumberField);

impl RotationField {
    /// The handle of the orientation whose first number has this index.
    pub(super) const fn new(topic: Topic, index: usize, plot: &'static str) -> Self {
        Self(NumberField::new(topic, index, plot))
    }

    /// The components x, y, z, w.
    pub const fn components(self) -> [NumberField; 4] {
        let first = self.0;
        [first, part(first, 1), part(first, 2), part(first, 3)]
    }

    /// The value in a message, as recorded; NaN if it is missing.
    #[inline]
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
    /// The handle of the text with this index in the messages of a channel.
    // Texts have no plot. The argument is there because the macro `channels!` makes all kinds of handles alike.
    pub(super) const fn new(topic: Topic, index: usize, _: &'static str) -> Self {
        Self { topic, index }
    }

    /// The value in a message; empty if it is missing.
    #[inline]
    pub fn of<'a>(self, message: &Message<'a>) -> &'a str {
        match message.texts.get(self.index) {
            Some(text) if message.channel == self.topic.index() => text,
            _ => "",
        }
    }
}

/// A plot of a channel: numbers that are shown together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Plot {
    topic: Topic,
    name: &'static str,
}

impl Plot {
    /// The plots of a channel, in table order.
    pub fn all(topic: Topic) -> Vec<Self> {
        let mut plots: Vec<Self> = Vec::new();
        for plot in topic.numbers().map(NumberField::plot) {
            if !plots.contains(&plot) {
                plots.push(plot);
            }
        }
        plots
    }

    /// The unit of its numbers.
    pub fn unit(self) -> &'static str {
        self.numbers().next().map_or("", NumberField::unit)
    }

    /// The numbers that it shows, in table order.
    pub fn numbers(self) -> impl Iterator<Item = NumberField> {
        let numbers = self.topic.numbers();
        numbers.filter(move |number| number.plot == self.name)
    }

    /// The topic of the channel.
    pub const fn topic(self) -> Topic {
        self.topic
    }

    /// The name within the channel.
    pub const fn name(self) -> &'static str {
        self.name
    }
}

/// Topic and name, e.g. `/top/energy/mechanical`.
impl fmt::Display for Plot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.topic, self.name)
    }
}

/// The number `offset` positions after another.
const fn part(field: NumberField, offset: usize) -> NumberField {
    NumberField {
        index: field.index + offset,
        ..field
    }
}
