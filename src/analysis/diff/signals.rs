//! The differences of single numbers over time.

use super::growth::Envelope;
use super::pairing::Pair;
use super::report::{ChannelDifference, FieldDifference, Growth, Parting, TextDifference};
use super::tolerance::{Tolerance, Tolerances, full_name};
use crate::physics::math::{atan2, ulp_distance, unwrap_near};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// A field parts where its difference first reaches this part of its largest magnitude.
const PARTED: f64 = 1e-6;
/// Where the integrators' errors are larger, it must be so many times as large as they are.
const ABOVE_FLOOR: f64 = 10.0;
/// More doubles between two numbers than these are no rounding.
const ROUNDING_ULPS: u64 = 1 << 16;

/// What is known of a field from its pairs so far.
#[derive(Clone, Debug)]
struct Tally {
    tolerance: Tolerance,
    count: u64,
    not_numbers: u64,
    largest: f64,
    at_ns: u64,
    sum: f64,
    sum_of_squares: f64,
    scale: f64,
    ulp: u64,
    first_different: Option<u64>,
    first_beyond: Option<u64>,
    beyond: u64,
    /// When the difference first reached 2^exponent, for rising exponents.
    rungs: Vec<(i32, u64)>,
    interpolation_error: f64,
}

impl Tally {
    fn new(tolerance: Tolerance) -> Self {
        Self {
            tolerance,
            count: 0,
            not_numbers: 0,
            largest: 0.0,
            at_ns: 0,
            sum: 0.0,
            sum_of_squares: 0.0,
            scale: 0.0,
            ulp: 0,
            first_different: None,
            first_beyond: None,
            beyond: 0,
            rungs: Vec::new(),
            interpolation_error: 0.0,
        }
    }

    #[inline]
    fn add(&mut self, time_ns: u64, a: f64, b: f64) {
        self.add_difference(time_ns, a, b, b - a);
    }

    #[inline]
    fn add_difference(&mut self, time_ns: u64, a: f64, b: f64, difference: f64) {
        if a.to_bits() == b.to_bits() && !a.is_nan() {
            self.count += 1;
            if a.is_finite() {
                self.scale = self.scale.max(a.abs());
            }
            return;
        }
        self.add_different(time_ns, a, b, difference);
    }

    fn add_different(&mut self, time_ns: u64, a: f64, b: f64, difference: f64) {
        if a.is_nan() && b.is_nan() {
            return;
        }
        self.first_different.get_or_insert(time_ns);
        if !self.tolerance.allows(a, b) {
            self.first_beyond.get_or_insert(time_ns);
            self.beyond += 1;
        }
        if !difference.is_finite() {
            self.not_numbers += 1;
            return;
        }
        self.count += 1;
        self.scale = self.scale.max(a.abs()).max(b.abs());
        self.ulp = self.ulp.max(ulp_distance(a, b));
        self.sum += difference;
        self.sum_of_squares += difference * difference;
        if difference.abs() > self.largest.abs() {
            self.largest = difference;
            self.at_ns = time_ns;
            let exponent = exponent(difference);
            if self.rungs.last().is_none_or(|(last, _)| *last < exponent) {
                self.rungs.push((exponent, time_ns));
            }
        }
    }

    /// When the difference first reached the threshold, rounded up to the next power of two; ns.
    fn reached(&self, threshold: f64) -> Option<u64> {
        let needed = if threshold > 0.0 {
            exponent(threshold) + 1
        } else {
            i32::MIN
        };
        let rung = self.rungs.iter().find(|(exponent, _)| *exponent >= needed);
        rung.map(|(_, time_ns)| *time_ns)
    }

    fn difference(&self, field: &str, unit: &str, is_interpolated: bool) -> FieldDifference {
        let count = self.count.max(1) as f64;
        FieldDifference {
            field: field.to_owned(),
            unit: unit.to_owned(),
            count: self.count,
            not_numbers: self.not_numbers,
            largest: self.largest,
            at: seconds(self.at_ns),
            rms: (self.sum_of_squares / count).sqrt(),
            mean: self.sum / count,
            scale: self.scale,
            relative: if self.scale > 0.0 {
                self.largest.abs() / self.scale
            } else {
                0.0
            },
            ulp: (self.ulp < ROUNDING_ULPS).then_some(self.ulp),
            first_different: self.first_different.map(seconds),
            first_beyond: self.first_beyond.map(seconds),
            beyond: self.beyond,
            tolerance: self.tolerance,
            interpolation_error: is_interpolated.then_some(self.interpolation_error),
            ..FieldDifference::default()
        }
    }
}

/// The exponent of the largest power of two that is not larger.
fn exponent(value: f64) -> i32 {
    libm::frexp(value.abs()).1 - 1
}

fn seconds(time_ns: u64) -> f64 {
    time_ns as f64 / 1e9
}

/// A number that is computed from others: how two directions or orientations differ.
#[derive(Clone, Debug)]
struct Derived {
    name: &'static str,
    kind: DerivedKind,
    tally: Tally,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DerivedKind {
    /// An angle as a direction: whole turns don't count.
    Direction(usize),
    /// The angle between two orientations (x, y, z, w).
    Orientation([usize; 4]),
    /// The angle between two vectors.
    Between([usize; 3]),
}

impl DerivedKind {
    fn difference(self, a: &[f64], b: &[f64]) -> f64 {
        match self {
            Self::Direction(at) => unwrap_near(b[at] - a[at], 0.0),
            Self::Orientation(at) => {
                let of = |row: &[f64]| {
                    let [x, y, z, w] = at.map(|at| row[at]);
                    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
                };
                let turn = of(a).conjugate() * of(b);
                2.0 * atan2(turn.imag().norm(), turn.scalar().abs())
            }
            Self::Between(at) => {
                let of = |row: &[f64]| Vector3::from(at.map(|at| row[at]));
                let (a, b) = (of(a), of(b));
                atan2(a.cross(&b).norm(), a.dot(&b))
            }
        }
    }
}

/// The derived numbers of a topic of ours.
fn derived(topic: &str, fields: &[Field]) -> Vec<Derived> {
    let find = |name: &str| fields.iter().position(|field| field.name == name);
    let of = |name: &str| {
        let component = |ending: &str| find(&format!("{name}.{ending}"));
        [
            component("x"),
            component("y"),
            component("z"),
            component("w"),
        ]
    };
    let mut all = Vec::new();
    let mut add = |name, kind: Option<DerivedKind>| {
        all.extend(kind.map(|kind| Derived {
            name,
            kind,
            tally: Tally::new(Tolerance::default()),
        }));
    };
    match topic {
        "/top/state" => {
            add("φ as a direction", find("phi").map(DerivedKind::Direction));
            add("ψ as a direction", find("psi").map(DerivedKind::Direction));
        }
        "/top/pose" => {
            if let [Some(x), Some(y), Some(z), Some(w)] = of("orientation") {
                add(
                    "angle of the orientations",
                    Some(DerivedKind::Orientation([x, y, z, w])),
                );
            }
            if let [Some(x), Some(y), Some(z), _] = of("axis") {
                add("angle of the axes", Some(DerivedKind::Between([x, y, z])));
            }
        }
        _ => {}
    }
    all
}

/// A field that one of the runs has, or both.
#[derive(Clone, Debug)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) unit: &'static str,
    /// Where it stands in the rows of A and of B.
    pub(super) places: [Option<usize>; 2],
}

impl Field {
    fn is_common(&self) -> bool {
        self.places.iter().all(Option::is_some)
    }

    /// Its value in a row of one of the runs; NaN if it has none.
    fn of(&self, row: &[f64], side: usize) -> f64 {
        let value = self.places[side].and_then(|place| row.get(place));
        value.copied().unwrap_or(f64::NAN)
    }
}

/// The differences of a topic.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) topic: String,
    fields: Vec<Field>,
    tallies: Vec<Tally>,
    derived: Vec<Derived>,
    /// How the differences of these fields grow.
    growing: Vec<(usize, Envelope)>,
    is_interpolated: bool,
    pub(super) pairs: u64,
    pub(super) identical: u64,
    texts: Option<TextDifference>,
    /// Whether the first texts of any pair differ: for events, what they are.
    pub(super) kinds_differ: bool,
    /// Pairs of which only the texts differ.
    pub(super) other_words: u64,
    /// Times of the first and the last pair, ns.
    pub(super) span: Option<(u64, u64)>,
    /// B's numbers in A's order.
    sorted: [Vec<f64>; 2],
}

impl Channel {
    pub(super) fn new(topic: &str, is_interpolated: bool) -> Self {
        Self {
            topic: topic.to_owned(),
            fields: Vec::new(),
            tallies: Vec::new(),
            derived: Vec::new(),
            growing: Vec::new(),
            is_interpolated,
            pairs: 0,
            identical: 0,
            texts: None,
            kinds_differ: false,
            other_words: 0,
            span: None,
            sorted: [Vec::new(), Vec::new()],
        }
    }

    /// Notes where a field stands in the rows of one run; of the other too, if it is known.
    pub(super) fn learn(&mut self, side: usize, name: &str, place: usize, tolerances: &Tolerances) {
        if let Some(field) = self.fields.iter_mut().find(|field| field.name == name) {
            field.places[side] = Some(place);
            return;
        }
        let mut places = [None, None];
        places[side] = Some(place);
        let field = Field {
            name: name.to_owned(),
            unit: "",
            places,
        };
        self.add_field(field, tolerances);
    }

    /// Whether both have all its numbers.
    pub(super) fn is_complete(&self, numbers: usize) -> bool {
        self.fields.len() == numbers && self.fields.iter().all(Field::is_common)
    }

    /// Adds a field.
    pub(super) fn add_field(&mut self, field: Field, tolerances: &Tolerances) {
        let tolerance = tolerances.of(&self.topic, &field.name);
        self.tallies.push(Tally::new(tolerance));
        if self.topic == "/top/state" && matches!(field.name.as_str(), "theta" | "phi" | "psi") {
            self.growing.push((self.fields.len(), Envelope::default()));
        }
        self.fields.push(field);
    }

    /// Adds what is computed from fields of ours, once all of them are known.
    pub(super) fn add_derived(&mut self) {
        self.derived = derived(&self.topic, &self.fields);
    }

    pub(super) fn names(&self) -> impl Iterator<Item = String> + '_ {
        self.fields
            .iter()
            .map(|field| full_name(&self.topic, &field.name))
    }

    /// Takes in a pair; `difference` is filled with B − A of each field.
    pub(super) fn add(&mut self, pair: &Pair<'_>, difference: &mut Vec<f64>) {
        self.pairs += 1;
        let first = self.span.map_or(pair.time_ns, |(first, _)| first);
        self.span = Some((first, pair.time_ns));
        let mut is_same = true;
        difference.clear();
        for (field, tally) in self.fields.iter().zip(&mut self.tallies) {
            let (a, b) = (field.of(pair.a, 0), field.of(pair.b, 1));
            tally.add(pair.time_ns, a, b);
            difference.push(b - a);
            is_same &= a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        }
        if !self.add_texts(pair) {
            self.other_words += u64::from(is_same);
            is_same = false;
        }
        self.identical += u64::from(is_same);
        if is_same {
            return;
        }
        for (field, envelope) in &mut self.growing {
            envelope.add(pair.time_ns, difference[*field]);
        }
        if self.derived.is_empty() {
            return;
        }
        for (side, row) in [pair.a, pair.b].into_iter().enumerate() {
            self.sorted[side].clear();
            let values = self.fields.iter().map(|field| field.of(row, side));
            self.sorted[side].extend(values);
        }
        let [a, b] = &self.sorted;
        for derived in &mut self.derived {
            let angle = derived.kind.difference(a, b);
            derived.tally.add(pair.time_ns, 0.0, angle);
        }
    }

    fn add_texts(&mut self, pair: &Pair<'_>) -> bool {
        let Some((a, b)) = pair.texts else {
            return true;
        };
        self.kinds_differ |= a.first() != b.first();
        let Some((a, b)) = a.iter().zip(b).find(|(a, b)| a != b) else {
            return true;
        };
        let first = self.texts.get_or_insert_with(|| TextDifference {
            time: seconds(pair.time_ns),
            a: a.clone(),
            b: b.clone(),
            count: 0,
        });
        first.count += 1;
        false
    }

    /// Takes in how large the error of interpolating A's or B's field with this place can be.
    pub(super) fn add_estimate(&mut self, side: usize, place: usize, error: f64) {
        let fields = self.fields.iter().zip(&mut self.tallies);
        for (_, tally) in fields.filter(|(field, _)| field.places[side] == Some(place)) {
            tally.interpolation_error = tally.interpolation_error.max(error);
        }
    }

    /// The largest difference of each field.
    pub(super) fn largest(&self) -> impl Iterator<Item = (String, f64)> + '_ {
        self.names()
            .zip(self.tallies.iter().map(|tally| tally.largest.abs()))
    }

    /// What was found, but for the messages without a counterpart. `floor` gives the integrators' errors.
    pub(super) fn report(&self, floor: &impl Fn(&str) -> Option<f64>) -> ChannelDifference {
        let mut fields = Vec::new();
        let common = |(field, _): &(&Field, &Tally)| field.is_common();
        // Numbers of different events have nothing to do with each other.
        let comparable = if self.kinds_differ {
            0
        } else {
            self.fields.len()
        };
        let all = self.fields.iter().zip(&self.tallies).take(comparable);
        for (field, tally) in all.filter(common) {
            let mut found = tally.difference(&field.name, field.unit, self.is_interpolated);
            found.floor = floor(&full_name(&self.topic, &field.name));
            found.is_below_floor = found
                .floor
                .is_some_and(|floor| found.largest != 0.0 && found.largest.abs() <= floor);
            fields.push(found);
        }
        for derived in &self.derived {
            let mut found = derived.tally.difference(derived.name, "rad", false);
            found.is_derived = true;
            (found.scale, found.relative, found.ulp) = (0.0, 0.0, None);
            fields.push(found);
        }
        ChannelDifference {
            topic: self.topic.clone(),
            pairs: self.pairs,
            identical: self.identical,
            texts: self.texts.clone(),
            fields,
            ..ChannelDifference::default()
        }
    }

    /// When its fields parted.
    pub(super) fn partings(&self, floor: &impl Fn(&str) -> Option<f64>) -> Vec<Parting> {
        let mut partings = Vec::new();
        for (field, tally) in self.fields.iter().zip(&self.tallies) {
            let name = full_name(&self.topic, &field.name);
            let threshold = (PARTED * tally.scale).max(ABOVE_FLOOR * floor(&name).unwrap_or(0.0));
            let Some(time_ns) = tally.reached(threshold) else {
                continue;
            };
            partings.push(Parting {
                time: seconds(time_ns),
                kind: kind(&self.topic, &field.name).to_owned(),
                field: name,
                threshold,
            });
        }
        partings
    }

    /// How the differences of the angles grew.
    pub(super) fn growths(&self) -> Vec<Growth> {
        let growth = |(field, envelope): &(usize, Envelope)| {
            let name = full_name(&self.topic, &self.fields[*field].name);
            envelope.law(name)
        };
        self.growing.iter().filter_map(growth).collect()
    }
}

/// The kinds of quantities, from cause to effect.
pub(super) const KINDS: [&str; 6] = ["force", "torque", "acceleration", "rate", "angle", "other"];

/// What kind of quantity a field is.
fn kind(topic: &str, field: &str) -> &'static str {
    match topic {
        "/top/torque" => "torque",
        "/top/acceleration" => "acceleration",
        "/top/contact" if field.ends_with("force") || field.contains("force.") => "force",
        "/top/contact" if field.starts_with("slip_") && field != "slip_path" => "rate",
        "/top/state" if field.ends_with("_ddot") => "acceleration",
        "/top/state" if field.ends_with("_dot") => "rate",
        "/top/state" => "angle",
        "/top/pose" if field.starts_with("omega") => "rate",
        "/top/pose" => "angle",
        _ => "other",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_reached_within_a_factor_of_two() {
        let mut tally = Tally::new(Tolerance::default());
        for i in 0..1000_u64 {
            tally.add(i, 0.0, 1e-9 * i as f64);
        }
        for threshold in [1e-9, 3.3e-8, 5e-7] {
            let time = tally.reached(threshold).unwrap() as f64 * 1e-9;
            assert!(
                time >= threshold * 0.999_999 && time <= 2.0 * threshold + 1e-9,
                "{threshold}: {time}"
            );
        }
        assert_eq!(tally.reached(1e-6), None);
        // Anything at all.
        assert_eq!(tally.reached(0.0), Some(1));
    }

    #[test]
    fn directions_and_orientations_don_t_count_turns() {
        let near = |kind: DerivedKind, a: &[f64], b: &[f64], expected: f64| {
            let found = kind.difference(a, b);
            assert!((found - expected).abs() < 1e-12, "{kind:?}: {found}");
        };
        near(
            DerivedKind::Direction(0),
            &[0.1],
            &[0.3 + 20.0 * std::f64::consts::PI],
            0.2,
        );
        let turned =
            crate::physics::kinematics::world_from_body(crate::physics::kinematics::Euler {
                phi: 0.4,
                theta: 0.0,
                psi: 0.0,
            });
        let c = turned.coords;
        near(
            DerivedKind::Orientation([0, 1, 2, 3]),
            &[0.0, 0.0, 0.0, 1.0],
            &[-c.x, -c.y, -c.z, -c.w],
            0.4,
        );
        near(
            DerivedKind::Between([0, 1, 2]),
            &[1.0, 0.0, 0.0],
            &[0.0, 0.0, 2.0],
            0.5 * std::f64::consts::PI,
        );
    }
}
