//! The slip of two runs in words.

use super::history::{Slip, stand_apart};
use crate::words::{Piece, Sentence, sentence, span};
use schemars::JsonSchema;
use serde::Serialize;

/// The slip of two runs, for those that slip.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct SlipComparison {
    /// The slip of A.
    pub a: Option<Slip>,
    /// The slip of B.
    pub b: Option<Slip>,
}

impl SlipComparison {
    /// What the coefficient of friction does in both runs; `None` if neither slips, or both do the same.
    pub fn sentence(&self) -> Option<Sentence> {
        let [a, b] = [&self.a, &self.b].map(|slip| slip.as_ref().map(Slip::words));
        if a == b {
            return None;
        }
        let [a, b] = [a, b].map(|words| words.unwrap_or_else(|| "no slip".into()));
        Some(sentence!("A: {}; B: {}.", a, b))
    }
}

impl Slip {
    /// What the coefficient of friction does with the slip speed, where the run slips.
    fn words(&self) -> Sentence {
        let mut path: Vec<f64> = self.path.iter().map(|point| point.coefficient).collect();
        let slows = self.end.speed <= self.start.speed;
        if !slows {
            path.reverse();
        }
        let cause = if slows { "slows" } else { "gets faster" };
        match path[..] {
            [from, to] if !stand_apart(from, to) => {
                sentence!(
                    "μ stays at {}",
                    Piece::rounded(self.start.coefficient, 3, "")
                )
            }
            [from, to] => change([from, to], cause),
            [from, between, to] => {
                let verb = verb(to - between);
                let to = Piece::number(to, 3, "");
                sentence!(
                    "{}, then {} to {}",
                    change([from, between], cause),
                    verb,
                    to
                )
            }
            _ => {
                let least = path.iter().copied().fold(f64::INFINITY, f64::min);
                let greatest = path.iter().copied().fold(0.0, f64::max);
                let [least, greatest] = Piece::range([least, greatest], 3, "");
                sentence!(
                    "μ changes between {} and {} as the slip {}",
                    least,
                    greatest,
                    cause
                )
            }
        }
    }
}

/// A coefficient of friction that rises or falls with the slip speed.
fn change([from, to]: [f64; 2], cause: &'static str) -> Sentence {
    let verb = verb(to - from);
    let coefficients = span([from, to], 3, "");
    sentence!("μ {} from {} as the slip {}", verb, coefficients, cause)
}

fn verb(change: f64) -> &'static str {
    if change < 0.0 { "falls" } else { "rises" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::slip::{PathPoint, SlipPoint, VisitedSpeeds};

    /// A slip that slows from 0.4 to 0.1 m/s, with these coefficients.
    fn slip(coefficients: &[f64]) -> Slip {
        let mut path = Vec::new();
        for (index, coefficient) in coefficients.iter().enumerate() {
            path.push(PathPoint {
                speed: 0.4 / (index + 1) as f64,
                coefficient: *coefficient,
            });
        }
        let point = |speed: f64, coefficient: f64| SlipPoint {
            time: 1.0 - speed,
            speed,
            coefficient,
        };
        Slip {
            time: 0.3,
            start: point(0.4, coefficients[0]),
            end: point(0.1, coefficients[coefficients.len() - 1]),
            path,
            quantiles: [0.1, 0.2, 0.4],
            turning_rate: None,
            visited: VisitedSpeeds::default(),
        }
    }

    fn faster(coefficients: &[f64]) -> Slip {
        let slip = slip(coefficients);
        Slip {
            start: slip.end,
            end: slip.start,
            ..slip
        }
    }

    #[test]
    fn coefficients_are_told_with_the_slip() {
        let constant = slip(&[0.03, 0.03]);
        for (a, b, expected) in [
            (None, None, None),
            (Some(constant.clone()), Some(constant.clone()), None),
            (
                None,
                Some(constant.clone()),
                Some("A: no slip; B: μ stays at 0.03."),
            ),
            (
                Some(constant.clone()),
                Some(slip(&[0.042, 0.031])),
                Some("A: μ stays at 0.03; B: μ falls from 0.0420 to 0.0310 as the slip slows."),
            ),
            (
                Some(slip(&[0.042, 0.03, 0.05])),
                Some(faster(&[0.042, 0.031])),
                Some(
                    "A: μ falls from 0.0420 to 0.0300 as the slip slows, then rises to 0.0500; \
                     B: μ rises from 0.0310 to 0.0420 as the slip gets faster.",
                ),
            ),
            (
                Some(constant),
                Some(slip(&[0.03, 0.02, 0.04, 0.01])),
                Some(
                    "A: μ stays at 0.03; B: μ changes between 0.0100 and 0.0400 as the slip slows.",
                ),
            ),
        ] {
            let sentence = SlipComparison { a, b }.sentence();
            assert_eq!(sentence.map(|found| found.to_string()).as_deref(), expected);
        }
    }
}
