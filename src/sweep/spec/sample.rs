//! Sampling: each coordinate depends only on seed, row and dimension.

use super::deserialize;
use super::sobol::{DIMENSIONS, Sobol};
use crate::run::scenario::KEYS;
use serde::{Deserialize, Serialize};

/// Sampling method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Sobol sequence (low discrepancy).
    #[default]
    Sobol,
    /// Independent random coordinates.
    Random,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 2] = [Self::Sobol, Self::Random];

    /// The name in specs and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sobol => "sobol",
            Self::Random => "random",
        }
    }

    /// Description for the help.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Sobol => "Sobol sequence (low discrepancy)",
            Self::Random => "Independent random coordinates",
        }
    }
}

/// Sampled points of some axes.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a section with count, method and seed"
)]
pub struct Sample {
    /// Number.
    #[serde(deserialize_with = "deserialize::count")]
    pub count: u64,
    /// Method by which they are chosen.
    #[serde(default, deserialize_with = "deserialize::method")]
    pub method: Method,
    /// The seed; 0 is the unscrambled Sobol sequence.
    #[serde(default, deserialize_with = "deserialize::seed")]
    pub seed: u64,
}

/// Each key may be an axis.
const _: () = assert!(KEYS.len() <= DIMENSIONS);

/// The coordinates of the points of a sample, each from 0 to below 1.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    seed: u64,
    /// One for each dimension; empty for random points.
    sobol: Vec<Sobol>,
}

impl Points {
    /// Points with this number of coordinates.
    pub(super) fn new(sample: &Sample, dimensions: usize) -> Self {
        let sobol = match sample.method {
            Method::Sobol => (0..dimensions).map(Sobol::new).collect(),
            Method::Random => Vec::new(),
        };
        let seed = sample.seed;
        Self { seed, sobol }
    }

    /// A coordinate of a point.
    pub(super) fn at(&self, row: u64, dimension: usize) -> f64 {
        match self.sobol.get(dimension) {
            // The sequence itself, as it is published, for the seed 0.
            Some(sobol) if self.seed == 0 => sobol.at(row, 0),
            Some(sobol) => sobol.at(row, mixed(&[self.seed, dimension as u64])),
            None => {
                // 53 bits, as many as a double holds.
                let digits = mixed(&[self.seed, row, dimension as u64]) >> 11;
                digits as f64 / (1_u64 << 53) as f64
            }
        }
    }
}

/// A pseudorandom hash of these numbers: SplitMix64 (G. L. Steele, D. Lea and C. H. Flood, Fast
/// splittable pseudorandom number generators, OOPSLA 2014), once for each.
fn mixed(numbers: &[u64]) -> u64 {
    numbers.iter().fold(0, |state: u64, number| {
        let z = (state ^ number).wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points_of(method: Method, seed: u64, dimensions: usize) -> Points {
        let count = 1;
        let sample = Sample {
            count,
            method,
            seed,
        };
        Points::new(&sample, dimensions)
    }

    /// The first numbers of SplitMix64 from the state 0: its state is a multiple of the golden ratio constant.
    #[test]
    fn val_mixing_is_splitmix64() {
        assert_eq!(mixed(&[0]), 0xe220_a839_7b1d_cdaf);
        assert_eq!(mixed(&[0x9e37_79b9_7f4a_7c15]), 0x6e78_9e6a_a1b9_65f4);
    }

    #[test]
    fn random_points_fill_the_cube_and_depend_on_the_seed() {
        let points = points_of(Method::Random, 7, 3);
        let other = points_of(Method::Random, 8, 3);
        for dimension in 0..3 {
            let all: Vec<f64> = (0..10_000).map(|row| points.at(row, dimension)).collect();
            assert!(all.iter().all(|at| (0.0..1.0).contains(at)));
            let mean = all.iter().sum::<f64>() / 1e4;
            // The mean of 10,000 has a standard deviation of 0.0029.
            assert!((mean - 0.5).abs() < 0.012, "{mean}");
            assert_ne!(points.at(0, dimension), other.at(0, dimension));
        }
        assert_ne!(points.at(5, 0), points.at(5, 1));
    }

    #[test]
    fn seed_shifts_the_sequence() {
        let plain = points_of(Method::Sobol, 0, 2);
        let shifted = points_of(Method::Sobol, 7, 2);
        assert_eq!(plain.at(0, 1), 0.0);
        assert_ne!(shifted.at(0, 1), 0.0);
        assert_ne!(shifted.at(0, 0), shifted.at(0, 1));
    }
}
