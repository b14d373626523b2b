//! Scales of axes: ranges of values with ticks at round numbers.

use std::ops::RangeInclusive;

/// Maximum magnitude of an axis.
pub(crate) const MAX_MAGNITUDE: f64 = 1e100;

/// Magnitudes below this are zero in SI units.
const ZERO: f64 = 1e-12;

/// The digits of the minor ticks of a logarithmic scale.
const ALL_DIGITS: &[u8] = &[1, 2, 3, 4, 5, 6, 7, 8, 9];

/// The digits of the labelled ticks in each decade of a logarithmic scale, from many to few.
const LABELLED_DIGITS: [&[u8]; 4] = [ALL_DIGITS, &[1, 2, 3, 5], &[1, 2, 5], &[1, 3]];

/// Powers of ten alone.
const ONE: &[u8] = &[1];

/// The range of values along an axis, with its ticks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// Tick labels are in units of ten to this power (a multiple of three).
    pub(crate) exponent: i32,
    /// The ticks with labels.
    pub(crate) ticks: Vec<Tick>,
    /// The values of the ticks without labels, between the others.
    pub(crate) minor: Vec<f64>,
    step: TickDistance,
}

/// A tick with its label.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub(crate) value: f64,
    pub(crate) label: String,
}

/// The distance between two ticks: 1, 2 or 5 times a power of ten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct TickDistance {
    mantissa: i64,
    exponent: i32,
}

impl TickDistance {
    fn value(self) -> f64 {
        times_power_of_ten(self.mantissa as f64, self.exponent)
    }

    /// The next longer step.
    fn next(self) -> Self {
        let (mantissa, exponent) = match self.mantissa {
            1 => (2, self.exponent),
            2 => (5, self.exponent),
            _ => (1, self.exponent + 1),
        };
        Self { mantissa, exponent }
    }

    /// The tick at a multiple of the step, with a label in units of ten to the power `unit`.
    fn tick(self, multiple: i64, unit: i32) -> Tick {
        let number = (multiple * self.mantissa) as f64;
        let decimals = (unit - self.exponent).max(0) as usize;
        let shown = times_power_of_ten(number, self.exponent - unit);
        Tick {
            value: times_power_of_ten(number, self.exponent),
            // A hyphen is shorter than a minus sign in print.
            label: format!("{shown:.decimals$}").replace('-', "−"),
        }
    }
}

/// A number times a power of ten, rounded once.
fn times_power_of_ten(number: f64, exponent: i32) -> f64 {
    // A product with a power of ten would round twice; 1e-3 has no exact value.
    format!("{number}e{exponent}").parse().unwrap_or(f64::NAN)
}

/// The multiples of a step in a range.
fn multiples(step: f64, low: f64, high: f64) -> RangeInclusive<i64> {
    // The end of a range that should coincide with a tick does so up to rounding.
    let slack = 1e-9;
    (low / step - slack).ceil() as i64..=(high / step + slack).floor() as i64
}

/// The shortest step with at most `max` multiples in a range.
fn shortest_step(low: f64, high: f64, max: usize) -> TickDistance {
    // A thousandth of the range has more multiples than any axis has labels.
    let mut step = TickDistance {
        mantissa: 1,
        exponent: decade(high - low) - 3,
    };
    while (high / step.value()).floor() - (low / step.value()).ceil() + 1.0 > max as f64 {
        step = step.next();
    }
    step
}

impl Scale {
    /// A scale from `low` to `high` with at most `max_labels` labels, but with three if they fit the range.
    ///
    /// An empty range is widened; if the ends are not finite, it becomes 0 to 1.
    pub(crate) fn new(low: f64, high: f64, max_labels: usize) -> Self {
        let (low, high) = widened(low, high);
        let exponent = exponent_of_labels(decade(low.abs().max(high.abs())));
        Self::in_units(exponent, (low, high), max_labels)
    }

    /// A scale of a quantity whose usual values are hundredths: only smaller ones have a power of ten.
    pub(crate) fn of_hundredths((low, high): (f64, f64), max_labels: usize) -> Self {
        let (low, high) = widened(low, high);
        let exponent = match decade(low.abs().max(high.abs())) {
            -2 => 0,
            decade => exponent_of_labels(decade),
        };
        Self::in_units(exponent, (low, high), max_labels)
    }

    /// A scale whose labels are in units of ten to the power `exponent`.
    fn in_units(exponent: i32, (low, high): (f64, f64), max_labels: usize) -> Self {
        let step = shortest_step(low, high, max_labels.max(3));
        // Minor ticks are at round numbers too: 0.5 apart where the step is 2, 0.2 where it is 1, 1 where it is 5.
        let parts = if step.mantissa == 2 { 4 } else { 5 };
        let part = step.value() / parts as f64;
        Self {
            low,
            high,
            exponent,
            ticks: multiples(step.value(), low, high)
                .map(|multiple| step.tick(multiple, exponent))
                .collect(),
            minor: multiples(part, low, high)
                .filter(|multiple| multiple % parts != 0)
                .map(|multiple| multiple as f64 * part)
                .collect(),
            step,
        }
    }

    /// A scale of decimal logarithms from `low` to `high`, with at most `max_labels` labels, but with three if they fit
    /// the range: some digits of each decade, powers of ten alone, or round numbers if the range is less than a decade.
    pub(crate) fn logarithmic(low: f64, high: f64, max_labels: usize) -> Self {
        let linear = Self::new(low, high, max_labels);
        let Some((ticks, every)) = linear.labelled_decades(max_labels) else {
            return linear.within_a_decade(max_labels);
        };
        // Minor ticks at digits would be misleading if not every decade has a label.
        let digits = if every == 1 { ALL_DIGITS } else { ONE };
        Self {
            exponent: 0,
            minor: linear
                .decade_ticks(digits, 1)
                .into_iter()
                .map(|tick| tick.value)
                .filter(|value| ticks.iter().all(|tick| tick.value != *value))
                .collect(),
            ticks,
            ..linear
        }
    }

    /// As many labelled ticks of a logarithmic scale as allowed, and the distance between decades with labels.
    fn labelled_decades(&self, max_labels: usize) -> Option<(Vec<Tick>, i32)> {
        let decades = (self.high - self.low) as i32 + 1;
        let powers_of_ten = (1..=decades).map(|every| (ONE, every));
        LABELLED_DIGITS
            .map(|digits| (digits, 1))
            .into_iter()
            .chain(powers_of_ten)
            .map(|(digits, every)| (self.decade_ticks(digits, every), every))
            .find(|(ticks, _)| (2..=max_labels.max(3)).contains(&ticks.len()))
    }

    /// Ticks at some digits of every n-th decade of a logarithmic scale.
    fn decade_ticks(&self, digits: &[u8], every: i32) -> Vec<Tick> {
        let slack = 1e-9 * (self.high - self.low);
        let range = self.low - slack..=self.high + slack;
        let mut ticks = Vec::new();
        for decade in self.low.floor() as i32..=self.high.floor() as i32 {
            if decade.rem_euclid(every) != 0 {
                continue;
            }
            for digit in digits {
                let value = f64::from(decade) + libm::log10(f64::from(*digit));
                if range.contains(&value) {
                    let label = decimal(*digit, decade);
                    ticks.push(Tick { value, label });
                }
            }
        }
        ticks
    }

    /// The logarithmic scale of the same range with the ticks of a linear one.
    fn within_a_decade(self, max_labels: usize) -> Self {
        let unit = exponent_of_labels(self.low.floor() as i32);
        let [from, to] = [self.low, self.high].map(|log| libm::exp10(log - f64::from(unit)));
        let mut numbers = Self::new(from, to, max_labels);
        let values = numbers.ticks.iter_mut().map(|tick| &mut tick.value);
        for value in values.chain(&mut numbers.minor) {
            *value = libm::log10(*value) + f64::from(unit);
        }
        Self {
            exponent: numbers.exponent + unit,
            ticks: numbers.ticks,
            minor: numbers.minor,
            ..self
        }
    }

    /// The position of a value in the range, from 0 to 1.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// The ticks with labels, and one more if the last is not close to the upper end.
    pub(crate) fn into_ticks_beyond(mut self) -> Vec<Tick> {
        // A last tick within a hundredth of the end stands for it.
        let last = *multiples(self.step.value(), self.low, self.high).end();
        if self.step.value() * (last as f64) < 0.99 * self.high {
            self.ticks.push(self.step.tick(last + 1, self.exponent));
        }
        self.ticks
    }
}

/// A digit times a power of ten, in human-readable form.
fn decimal(digit: u8, decade: i32) -> String {
    match decade {
        0..=4 => format!("{digit}{}", "0".repeat(decade as usize)),
        -4..0 => format!("0.{}{digit}", "0".repeat(-decade as usize - 1)),
        _ => format!("{digit}e{decade}").replace('-', "−"),
    }
}

/// The exponent of a positive number in scientific notation: its decimal logarithm, rounded down.
fn decade(number: f64) -> i32 {
    // The logarithm itself may be rounded to the next integer just below a power of ten.
    format!("{number:e}")
        .split('e')
        .next_back()
        .and_then(|exponent| exponent.parse().ok())
        .unwrap_or(0)
}

/// The power of ten that is the unit of labels in a decade.
fn exponent_of_labels(decade: i32) -> i32 {
    match decade {
        -1..=3 => 0,
        decade => decade.div_euclid(3) * 3,
    }
}

/// A range long enough for tick labels to differ. A constant is padded on both sides so that the labels
/// are short: by a tenth of its value, or by one around zero.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let magnitude = low.abs().max(high.abs());
    // Comparisons with NaN are false.
    let is_sound = magnitude < MAX_MAGNITUDE && low <= high;
    if !is_sound {
        return (0.0, 1.0);
    }
    if high - low >= (magnitude * 1e-6).max(ZERO) {
        return (low, high);
    }
    let padding = if magnitude < ZERO {
        1.0
    } else {
        0.1 * magnitude
    };
    (low - padding, high + padding)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(low: f64, high: f64, most: usize) -> Vec<String> {
        let ticks = Scale::new(low, high, most).ticks;
        ticks.into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(labels(0.0, 24.72, 6), ["0", "5", "10", "15", "20"]);
        assert_eq!(
            labels(0.0, 0.52, 6),
            ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]
        );
        assert_eq!(labels(-0.3, 0.1, 5), ["−0.3", "−0.2", "−0.1", "0.0", "0.1"]);
        assert_eq!(labels(-1.0, 1.0, 3), ["−1", "0", "1"]);
    }

    #[test]
    fn labels_share_a_power_of_ten() {
        let scale = Scale::new(0.0, 0.000_23, 5);
        assert_eq!(scale.exponent, -6);
        assert_eq!(scale.ticks.last().unwrap().label, "200");
        let scale = Scale::new(0.0, 25_000.0, 6);
        assert_eq!((scale.exponent, scale.ticks[1].label.as_str()), (3, "5"));
    }

    #[test]
    fn labels_of_constants_are_short() {
        assert_eq!(labels(0.0, 0.0, 5), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(0.0, 1e-13, 5), labels(0.0, 0.0, 5));
        assert_eq!(
            labels(0.5, 0.5, 5),
            ["0.46", "0.48", "0.50", "0.52", "0.54"]
        );
    }

    #[test]
    fn logarithmic_labels_are_round_numbers() {
        let log = libm::log10;
        let labels = |low: f64, high: f64, most| {
            let scale = Scale::logarithmic(log(low), log(high), most);
            let ticks = &scale.ticks;
            for tick in ticks {
                let shown: f64 = tick.label.replace('−', "-").parse().unwrap();
                let shown = times_power_of_ten(shown, scale.exponent);
                assert!((log(shown) - tick.value).abs() < 1e-14, "{tick:?}");
            }
            let labels = scale.ticks.into_iter().map(|tick| tick.label);
            labels.collect::<Vec<_>>()
        };
        assert_eq!(
            labels(0.005, 0.1, 7),
            ["0.005", "0.01", "0.02", "0.03", "0.05", "0.1"]
        );
        assert_eq!(labels(1.0, 1e4, 6), ["1", "10", "100", "1000", "10000"]);
        assert_eq!(labels(0.03, 0.06, 6), ["0.03", "0.04", "0.05", "0.06"]);
        assert_eq!(labels(2e-7, 2e-6, 4), ["2e−7", "5e−7", "1e−6", "2e−6"]);
        // Several decades have powers of ten alone, and some of them if they are many.
        assert_eq!(
            labels(6e-7, 0.8, 6),
            ["1e−6", "1e−5", "0.0001", "0.001", "0.01", "0.1"]
        );
        assert_eq!(labels(6e-7, 0.8, 5), ["1e−6", "0.0001", "0.01"]);
        assert_eq!(labels(1e-9, 1e2, 5), ["1e−9", "1e−6", "0.001", "1"]);
        // Between two digits too there are numbers.
        assert_eq!(labels(0.31, 0.39, 5), ["0.32", "0.34", "0.36", "0.38"]);
        assert_eq!(labels(0.058, 0.094, 3), ["60", "80"]);
    }

    #[test]
    fn widens_empty_and_infinite_ranges() {
        for (low, high) in [
            (1.0, 1.0),
            (0.0, 0.0),
            (f64::NAN, 1.0),
            (-1e300, 1e300),
            (f64::INFINITY, 2.0),
        ] {
            let scale = Scale::new(low, high, 5);
            assert!(
                scale.high > scale.low && scale.ticks.len() >= 2,
                "{scale:?}"
            );
        }
    }

    proptest! {
        #[test]
        fn logarithmic_labels_are_few_and_equal_their_values(
            low in -30.0..6.0, span in 1e-3..18.0, most in 3_usize..10,
        ) {
            let scale = Scale::logarithmic(low, low + span, most);
            let ticks = &scale.ticks;
            let least = if span > 1.0 { 2 } else { 1 };
            prop_assert!((least..=most).contains(&ticks.len()), "{ticks:?}");
            for tick in ticks.iter().map(|tick| tick.value).chain(scale.minor.clone()) {
                prop_assert!((-1e-6..=1.000_001).contains(&scale.fraction(tick)));
            }
            for tick in ticks {
                let shown: f64 = tick.label.replace('−', "-").parse().unwrap();
                let place = libm::log10(times_power_of_ten(shown, scale.exponent));
                prop_assert!((place - tick.value).abs() < 1e-9, "{tick:?}");
                // More than two numbers a decade would be too many.
                if 2.0 * span > most as f64 + 2.0 {
                    prop_assert_eq!(tick.value, tick.value.round());
                }
            }
        }

        #[test]
        fn labels_are_few_and_equal_their_values(
            middle in -1e6..1e6, span in 1e-3..1e6, most in 3_usize..10,
        ) {
            let scale = Scale::new(middle - span, middle + span, most);
            let ticks = &scale.ticks;
            prop_assert!(ticks.len() <= most && !ticks.is_empty(), "{ticks:?}");
            for tick in ticks {
                let place = scale.fraction(tick.value);
                prop_assert!((-1e-6..=1.000_001).contains(&place));
                let shown: f64 = tick.label.replace('−', "-").parse().unwrap();
                let value = times_power_of_ten(shown, scale.exponent);
                prop_assert!((value - tick.value).abs() <= 1e-9 * tick.value.abs().max(1.0));
            }
        }
    }
}
