//! Scales of axes: ranges of values with ticks at round numbers.

use std::ops::RangeInclusive;

/// The range of values along an axis, with its ticks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// The numbers at the ticks are to be multiplied by ten to this power, a multiple of three.
    pub(crate) exponent: i32,
    step: Step,
    /// Along an axis of decimal logarithms: which numbers stand there.
    logarithms: Option<Logarithms>,
}

/// The numbers along an axis of decimal logarithms.
#[cfg_attr(
    not(feature = "sweep"),
    expect(dead_code, reason = "only figures of sweeps have such axes")
)]
#[derive(Clone, Debug, PartialEq)]
enum Logarithms {
    Decades(Decades),
    /// Those that stand along an axis of the numbers themselves, in units of this power of ten.
    Numbers(Box<Scale>, i32),
}

/// Numbers of one digit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Decades {
    /// Their digits, from 1 to 9.
    digits: &'static [usize],
    /// Decades have numbers if they are multiples of this.
    every: i32,
}

/// The digits that may have numbers along an axis of logarithms, from many to few.
#[cfg(feature = "sweep")]
const DIGITS: [&[usize]; 4] = [&ALL, &[1, 2, 3, 5], &[1, 2, 5], &[1, 3]];

/// The digits of numbers.
const ALL: [usize; 9] = [1, 2, 3, 4, 5, 6, 7, 8, 9];

/// The decimal logarithms of the digits.
const LOGARITHMS: [f64; 10] = [
    f64::NEG_INFINITY,
    0.0,
    std::f64::consts::LOG10_2,
    0.477_121_254_719_662_4,
    2.0 * std::f64::consts::LOG10_2,
    1.0 - std::f64::consts::LOG10_2,
    std::f64::consts::LOG10_2 + 0.477_121_254_719_662_4,
    0.845_098_040_014_256_8,
    3.0 * std::f64::consts::LOG10_2,
    2.0 * 0.477_121_254_719_662_4,
];

/// The distance between two ticks: 1, 2 or 5 times a power of ten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Step {
    mantissa: i64,
    exponent: i32,
}

impl Step {
    fn value(self) -> f64 {
        scaled(self.mantissa as f64, self.exponent)
    }

    fn next(self) -> Self {
        let (mantissa, exponent) = match self.mantissa {
            1 => (2, self.exponent),
            2 => (5, self.exponent),
            _ => (1, self.exponent + 1),
        };
        Self { mantissa, exponent }
    }
}

/// A number times a power of ten, rounded once while the power is exact.
fn scaled(number: f64, exponent: i32) -> f64 {
    let mut power = 1.0;
    for _ in 0..exponent.unsigned_abs() {
        power *= 10.0;
    }
    if exponent < 0 {
        number / power
    } else {
        number * power
    }
}

/// A tick with its label.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub(crate) value: f64,
    pub(crate) label: String,
}

impl Scale {
    /// A scale from `low` to `high` with at most `most` numbers, but with three if they fit the range.
    ///
    /// A range without length is widened; if the ends are not finite it becomes 0 to 1.
    pub(crate) fn new(low: f64, high: f64, most: usize) -> Self {
        let (low, high) = widened(low, high);
        let magnitude = low.abs().max(high.abs());
        let mut step = Step {
            mantissa: 1,
            exponent: decade(high - low) - 3,
        };
        while count(low, high, step) > most.max(3) as f64 {
            step = step.next();
        }
        let exponent = easy_exponent(decade(magnitude));
        Self {
            low,
            high,
            exponent,
            step,
            logarithms: None,
        }
    }

    /// A scale of decimal logarithms, from `low` to `high`, with at most `most` numbers, but with three if they fit the
    /// range: some digits of each decade, powers of ten alone, or what a range of less than a decade needs.
    #[cfg(feature = "sweep")]
    pub(crate) fn of_logarithms(low: f64, high: f64, most: usize) -> Self {
        let linear = Self::new(low, high, most);
        let all = (linear.high - linear.low) as i32 + 1;
        let of_digits = DIGITS.map(|digits| Decades { digits, every: 1 });
        let of_powers = (1..=all).map(|every| Decades {
            digits: &[1],
            every,
        });
        let mut decades = of_digits.into_iter().chain(of_powers);
        let fitting =
            decades.find(|decades| (2..=most.max(3)).contains(&linear.decades(*decades).len()));
        let logarithms = if let Some(decades) = fitting {
            Logarithms::Decades(decades)
        } else {
            let unit = easy_exponent(linear.low.floor() as i32);
            let [low, high] =
                [linear.low, linear.high].map(|logarithm| libm::exp10(logarithm - f64::from(unit)));
            Logarithms::Numbers(Box::new(Self::new(low, high, most)), unit)
        };
        let exponent = match &logarithms {
            Logarithms::Decades(_) => 0,
            Logarithms::Numbers(numbers, unit) => numbers.exponent + unit,
        };
        Self {
            exponent,
            logarithms: Some(logarithms),
            ..linear
        }
    }

    /// The places of some digits in some decades of the range, with their numbers.
    fn decades(&self, Decades { digits, every }: Decades) -> Vec<Tick> {
        let decades = self.low.floor() as i32..=self.high.floor() as i32;
        let ticks = decades
            .filter(move |decade| decade.rem_euclid(every) == 0)
            .flat_map(|decade| {
                digits.iter().map(move |digit| Tick {
                    value: f64::from(decade) + LOGARITHMS[*digit],
                    label: decimal(*digit, decade),
                })
            });
        let slack = 1e-9 * (self.high - self.low);
        let range = self.low - slack..=self.high + slack;
        ticks.filter(|tick| range.contains(&tick.value)).collect()
    }

    /// The place of a value in the range, from 0 to 1.
    pub(crate) fn place(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// The ticks with numbers.
    pub(crate) fn ticks(&self) -> Vec<Tick> {
        match &self.logarithms {
            Some(Logarithms::Decades(decades)) => self.decades(*decades),
            Some(Logarithms::Numbers(numbers, unit)) => {
                let ticks = numbers.ticks().into_iter();
                let place = |tick: Tick| Tick {
                    value: libm::log10(tick.value) + f64::from(*unit),
                    ..tick
                };
                ticks.map(place).collect()
            }
            None => self.labelled(self.numbers(self.step.value())),
        }
    }

    /// The ticks with numbers, and one more if the last is not close to the upper end.
    pub(crate) fn ticks_beyond(&self) -> Vec<Tick> {
        let numbers = self.numbers(self.step.value());
        let last = *numbers.end();
        let is_short = self.step.value() * (last as f64) < 0.99 * self.high;
        self.labelled(*numbers.start()..=last + i64::from(is_short))
    }

    fn labelled(&self, numbers: RangeInclusive<i64>) -> Vec<Tick> {
        let decimals = (self.exponent - self.step.exponent).max(0) as usize;
        let tick = |number: i64| {
            let value = scaled((number * self.step.mantissa) as f64, self.step.exponent);
            let shown = scaled(
                (number * self.step.mantissa) as f64,
                self.step.exponent - self.exponent,
            );
            let label = format!("{shown:.decimals$}").replace('-', "−");
            Tick { value, label }
        };
        numbers.map(tick).collect()
    }

    /// The values of the ticks without numbers, between the others.
    pub(crate) fn minor(&self) -> Vec<f64> {
        if let Some(Logarithms::Numbers(numbers, unit)) = &self.logarithms {
            let numbers = numbers.minor().into_iter();
            return numbers
                .map(|number| libm::log10(number) + f64::from(*unit))
                .collect();
        }
        if let Some(Logarithms::Decades(decades)) = self.logarithms {
            let numbers = self.decades(decades);
            // Where not every decade has a number, ticks for digits would be a smear.
            let digits = if decades.every == 1 {
                &ALL[..]
            } else {
                &ALL[..1]
            };
            let all = self.decades(Decades { digits, every: 1 }).into_iter();
            let all = all.map(|tick| tick.value);
            let is_minor = |value: &f64| numbers.iter().all(|tick| tick.value != *value);
            return all.filter(is_minor).collect();
        }
        let parts = if self.step.mantissa == 2 { 4 } else { 5 };
        let step = self.step.value() / parts as f64;
        self.numbers(step)
            .filter(|number| number % parts != 0)
            .map(|number| number as f64 * step)
            .collect()
    }

    fn numbers(&self, step: f64) -> RangeInclusive<i64> {
        // The end of a range that is meant to lie on a tick does so but for rounding.
        let slack = 1e-9;
        let first = (self.low / step - slack).ceil() as i64;
        let last = (self.high / step + slack).floor() as i64;
        first..=last
    }
}

/// A digit times a power of ten, as people write it.
fn decimal(digit: usize, decade: i32) -> String {
    match decade {
        0..=4 => format!("{digit}{}", "0".repeat(decade as usize)),
        -4..0 => format!("0.{}{digit}", "0".repeat(-decade as usize - 1)),
        _ => format!("{digit}e{decade}").replace('-', "−"),
    }
}

/// Magnitudes from this on have no scale.
pub(crate) const BEYOND_USE: f64 = 1e100;

/// Magnitudes below this are zero in SI units.
const ZERO: f64 = 1e-12;

/// The exponent of a positive number in scientific notation: its decimal logarithm, rounded down.
fn decade(number: f64) -> i32 {
    let text = format!("{number:e}");
    let exponent = text
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok());
    exponent.unwrap_or(0)
}

/// The power of ten in whose units numbers of a decade are easily read.
fn easy_exponent(decade: i32) -> i32 {
    match decade {
        -1..=3 => 0,
        decade => decade.div_euclid(3) * 3,
    }
}

fn count(low: f64, high: f64, step: Step) -> f64 {
    let step = step.value();
    (high / step).floor() - (low / step).ceil() + 1.0
}

/// A range that is long enough for numbers at ticks to differ. A constant gets room on both sides so that these numbers
/// are short: a tenth of its value, or one around zero.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let magnitude = low.abs().max(high.abs());
    let is_sound = magnitude < BEYOND_USE && low <= high;
    if !is_sound {
        return (0.0, 1.0);
    }
    if high - low >= (magnitude * 1e-6).max(ZERO) {
        return (low, high);
    }
    let room = if magnitude < ZERO {
        1.0
    } else {
        0.1 * magnitude
    };
    (low - room, high + room)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(low: f64, high: f64, most: usize) -> Vec<String> {
        let ticks = Scale::new(low, high, most).ticks();
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
    fn small_and_large_numbers_share_a_power() {
        let scale = Scale::new(0.0, 0.000_23, 5);
        assert_eq!(scale.exponent, -6);
        assert_eq!(scale.ticks().last().unwrap().label, "200");
        let scale = Scale::new(0.0, 25_000.0, 6);
        assert_eq!((scale.exponent, scale.ticks()[1].label.as_str()), (3, "5"));
    }

    #[test]
    fn constants_have_short_numbers() {
        assert_eq!(labels(0.0, 0.0, 5), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(0.0, 1e-13, 5), labels(0.0, 0.0, 5));
        assert_eq!(
            labels(0.5, 0.5, 5),
            ["0.46", "0.48", "0.50", "0.52", "0.54"]
        );
    }

    #[cfg(feature = "sweep")]
    #[test]
    fn logarithms_have_the_numbers_that_they_are_of() {
        let log = libm::log10;
        let labels = |low: f64, high: f64, most| {
            let scale = Scale::of_logarithms(log(low), log(high), most);
            let ticks = scale.ticks();
            for tick in &ticks {
                let shown: f64 = tick.label.replace('−', "-").parse().unwrap();
                let shown = scaled(shown, scale.exponent);
                assert!((log(shown) - tick.value).abs() < 1e-14, "{tick:?}");
            }
            ticks.into_iter().map(|tick| tick.label).collect::<Vec<_>>()
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
    fn ranges_without_length_have_one() {
        for (low, high) in [
            (1.0, 1.0),
            (0.0, 0.0),
            (f64::NAN, 1.0),
            (-1e300, 1e300),
            (f64::INFINITY, 2.0),
        ] {
            let scale = Scale::new(low, high, 5);
            assert!(
                scale.high > scale.low && scale.ticks().len() >= 2,
                "{scale:?}"
            );
        }
    }

    proptest! {
        #[cfg(feature = "sweep")]
        #[test]
        fn ticks_of_logarithms_are_few_and_read_as_their_values(
            low in -30.0..6.0, span in 1e-3..18.0, most in 3_usize..10,
        ) {
            let scale = Scale::of_logarithms(low, low + span, most);
            let ticks = scale.ticks();
            let least = if span > 1.0 { 2 } else { 1 };
            prop_assert!((least..=most).contains(&ticks.len()), "{ticks:?}");
            for tick in ticks.iter().map(|tick| tick.value).chain(scale.minor()) {
                prop_assert!((-1e-6..=1.000_001).contains(&scale.place(tick)));
            }
            for tick in &ticks {
                let shown: f64 = tick.label.replace('−', "-").parse().unwrap();
                let place = libm::log10(scaled(shown, scale.exponent));
                prop_assert!((place - tick.value).abs() < 1e-9, "{tick:?}");
                // More than two numbers a decade would be too many.
                if 2.0 * span > most as f64 + 2.0 {
                    prop_assert_eq!(tick.value, tick.value.round());
                }
            }
        }

        #[test]
        fn ticks_lie_in_the_range_are_few_and_read_as_their_values(
            middle in -1e6..1e6, span in 1e-3..1e6, most in 3_usize..10,
        ) {
            let scale = Scale::new(middle - span, middle + span, most);
            let ticks = scale.ticks();
            prop_assert!(ticks.len() <= most && !ticks.is_empty(), "{ticks:?}");
            for tick in &ticks {
                let place = scale.place(tick.value);
                prop_assert!((-1e-6..=1.000_001).contains(&place));
                let shown: f64 = tick.label.replace('−', "-").parse().unwrap();
                let value = scaled(shown, scale.exponent);
                prop_assert!((value - tick.value).abs() <= 1e-9 * tick.value.abs().max(1.0));
            }
        }
    }
}
