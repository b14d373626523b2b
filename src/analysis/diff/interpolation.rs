//! What a run has at a time between its messages.

use super::item::Item;
use super::time_map::Instant;
use crate::analysis::course::curve::{hermite3, hermite5, lagrange};
use crate::telemetry::{Leaf, Quantity, Topic};

/// How a field is interpolated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Method {
    /// On a straight line.
    #[default]
    Linear,
    /// Not at all: it is what it was last.
    Hold,
    /// On the cubic through the four nearest values.
    Cubic,
    /// By Hermite's cubic, with the field that is its derivative.
    Slope(usize),
    /// By Hermite's polynomial of fifth degree, with its first and second derivatives.
    Curvature(usize, usize),
}

impl Method {
    /// The methods for the numbers of a channel of the table: with derivatives where they are recorded.
    pub(super) fn of_channel(topic: Topic) -> Vec<Self> {
        let numbers = &topic.info().numbers;
        let method = |leaf: &Leaf| match leaf.derivative.map(|at| (at, numbers[at].derivative)) {
            Some((first, Some(second))) => Self::Curvature(first, second),
            Some((first, None)) => Self::Slope(first),
            None if leaf.quantity == Quantity::Flag => Self::Hold,
            None => Self::Cubic,
        };
        numbers.iter().map(method).collect()
    }

    /// How many times larger the error gets if a message in the middle is left out and put back by its
    /// neighbours, which are twice as far apart: two to the power of the method's order, or for a cubic the
    /// ratio of the products of distances (4 to 9/16).
    pub(super) fn exaggeration(self) -> f64 {
        match self {
            Self::Hold => 1.0,
            Self::Linear => 4.0,
            Self::Cubic => 64.0 / 9.0,
            Self::Slope(_) => 16.0,
            Self::Curvature(..) => 64.0,
        }
    }
}

/// The messages around an instant, and how much each of them counts there.
#[derive(Debug)]
pub(super) struct Stencil<'a> {
    /// The two neighbours of the instant, and what lies beyond them.
    rows: Vec<&'a Item>,
    /// Lagrange's weights of the rows.
    weights: Vec<f64>,
    neighbours: [&'a Item; 2],
    /// The time between the neighbours, s.
    h: f64,
    /// The part of it that has passed at the instant.
    s: f64,
}

impl<'a> Stencil<'a> {
    /// A stencil for an instant between two neighbours, with other messages beside them.
    pub(super) fn new(
        neighbours: [&'a Item; 2],
        others: impl IntoIterator<Item = &'a Item>,
        at: Instant,
    ) -> Self {
        let [left, right] = neighbours;
        let rows: Vec<_> = neighbours.into_iter().chain(others).collect();
        // Exact in integers first: times since 1970 in ns have more digits than doubles.
        let seconds =
            |row: &&Item| (i128::from(row.time_ns) - i128::from(left.time_ns)) as f64 / 1e9;
        let h = seconds(&right);
        let t = ((at.ns - left.time_ns) as f64 + at.rest) / 1e9;
        let nodes: Vec<f64> = rows.iter().map(seconds).collect();
        Self {
            weights: lagrange(&nodes, t).collect(),
            rows,
            neighbours,
            h,
            s: t / h,
        }
    }

    /// How many fields the neighbours both have.
    pub(super) fn width(&self) -> usize {
        let [left, right] = self.neighbours.map(|row| row.numbers.len());
        left.min(right)
    }

    /// A field at the instant.
    pub(super) fn value(&self, field: usize, method: Method) -> f64 {
        let of = |row: &Item, field: usize| row.numbers.get(field).copied().unwrap_or(f64::NAN);
        let [x, y] = self.neighbours;
        match method {
            Method::Hold => of(x, field),
            Method::Linear => of(x, field) + self.s * (of(y, field) - of(x, field)),
            Method::Cubic => {
                let column = self.rows.iter().map(|row| of(row, field));
                self.weights
                    .iter()
                    .zip(column)
                    .map(|(w, value)| w * value)
                    .sum()
            }
            Method::Slope(d) => {
                let [x, y] = [x, y].map(|row| [of(row, field), of(row, d)]);
                hermite3(x, y, self.h, self.s)
            }
            Method::Curvature(d, c) => {
                let [x, y] = [x, y].map(|row| [of(row, field), of(row, d), of(row, c)]);
                hermite5(x, y, self.h, self.s)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_yes_or_no_is_held_and_all_else_interpolated() {
        let mut held = Vec::new();
        for topic in Topic::all().filter(|topic| topic.info().is_sampled) {
            let methods = Method::of_channel(topic).into_iter();
            for (leaf, method) in topic.info().numbers.iter().zip(methods) {
                if method == Method::Hold {
                    held.push(leaf.path.as_str());
                }
            }
        }
        assert_eq!(held, ["regime"]);
        let row = |time_ns, number| Item {
            time_ns,
            numbers: vec![number],
            ..Item::default()
        };
        let (left, right) = (row(0, 1.0), row(10, 0.0));
        let stencil = Stencil::new([&left, &right], [], Instant::from(9));
        assert_eq!(stencil.value(0, Method::Hold), 1.0);
    }
}
