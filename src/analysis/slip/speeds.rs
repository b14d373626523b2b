//! Slip speeds by the time that a run spends at them.

use std::collections::BTreeMap;

/// Bits of a number below its bin: each octave has 2⁶ bins.
const BITS_BELOW: u32 = f64::MANTISSA_DIGITS - 1 - 6;

/// Slip speeds that a run visited, by the time that it spent at them, with the coefficients of friction there.
///
/// A histogram, because runs have any number of samples. Its bins are the 64 parts of each octave of speeds, whatever the
/// run is: so the counts are exact, and those of two runs have the same bins.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VisitedSpeeds {
    /// Time that a sample stands for, s.
    period: f64,
    /// The samples in each bin, by the first bits of their speeds.
    bins: BTreeMap<u64, Samples>,
}

/// The samples in a bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Samples {
    count: u64,
    /// The sum of their coefficients of friction.
    coefficients: f64,
}

/// A range of slip speeds, and the time that a run spent in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedBin {
    /// The lower end, m/s.
    pub from: f64,
    /// The upper end, which belongs to the next bin, m/s.
    pub to: f64,
    /// The time spent in it, s.
    pub time: f64,
    /// The mean coefficient of friction in that time.
    pub coefficient: f64,
}

impl VisitedSpeeds {
    /// No speeds yet; each sample will stand for a time of `period`, s.
    pub fn new(period: f64) -> Self {
        Self {
            period,
            bins: BTreeMap::new(),
        }
    }

    /// Adds a sample with a slip speed above 0, m/s, and the coefficient of friction there.
    pub fn add(&mut self, speed: f64, coefficient: f64) {
        // The bits of positive numbers are in the order of the numbers.
        let samples = self.bins.entry(speed.to_bits() >> BITS_BELOW).or_default();
        samples.count += 1;
        samples.coefficients += coefficient;
    }

    /// The number of samples.
    fn count(&self) -> u64 {
        self.bins.values().map(|samples| samples.count).sum()
    }

    /// The time of all samples, s.
    pub fn time(&self) -> f64 {
        self.count() as f64 * self.period
    }

    /// The bins with samples, from slow to fast.
    pub fn bins(&self) -> impl DoubleEndedIterator<Item = SpeedBin> + '_ {
        self.bins.iter().map(|(bin, samples)| {
            let count = samples.count as f64;
            SpeedBin {
                from: lower_end(*bin),
                to: lower_end(bin + 1),
                time: count * self.period,
                coefficient: samples.coefficients / count,
            }
        })
    }

    /// The speed below which a run spends this part of its time of slip, m/s: to the width of a bin, 1/64 of the speed or
    /// less. `None` without samples.
    pub fn quantile(&self, part: f64) -> Option<f64> {
        let below = part * self.time();
        let (mut sum, mut last) = (0.0, None);
        for SpeedBin { from, to, time, .. } in self.bins() {
            let share = (below - sum) / time;
            if share <= 1.0 {
                return Some(from + share.max(0.0) * (to - from));
            }
            sum += time;
            last = Some(to);
        }
        last
    }
}

/// The lower end of a bin, m/s.
fn lower_end(bin: u64) -> f64 {
    f64::from_bits(bin << BITS_BELOW)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_bins_hold_the_time_of_their_speeds() {
        let speeds: Vec<f64> = (1..=5000).map(|i| 1e-3 * f64::from(i * i % 4999)).collect();
        let speeds: Vec<f64> = speeds.into_iter().filter(|speed| *speed > 0.0).collect();
        let mut visited = VisitedSpeeds::new(0.25);
        for speed in &speeds {
            visited.add(*speed, 2.0 * speed);
        }
        let mut time = 0.0;
        for bin in visited.bins() {
            let (from, to) = (bin.from, bin.to);
            let mut within = speeds.clone();
            within.retain(|speed| (from..to).contains(speed));
            let count = within.len() as f64;
            assert_eq!(bin.time, 0.25 * count, "{from} to {to}");
            assert!(to - from <= from / 64.0, "{from} to {to}");
            let mean = 2.0 * within.iter().sum::<f64>() / count;
            assert!((bin.coefficient - mean).abs() <= count * f64::EPSILON * mean);
            time += bin.time;
        }
        assert_eq!((time, visited.time()), (0.25 * speeds.len() as f64, time));
    }

    #[test]
    fn val_quantiles_are_those_of_the_sorted_speeds() {
        let mut visited = VisitedSpeeds::new(1e-3);
        assert_eq!(visited.quantile(0.5), None);
        for i in 1..=10_000 {
            visited.add(f64::from(i) * 1e-4, 0.03);
        }
        for part in [0.05, 0.25, 0.5, 0.75, 0.95, 1.0] {
            let found = visited.quantile(part).unwrap();
            assert!((found - part).abs() <= part / 64.0, "{part}: {found}");
        }
    }
}
