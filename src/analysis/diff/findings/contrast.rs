//! What sets two motions apart: the largest findings, which the headline tells.

use super::finding::Finding;
use super::quantity::{EndCondition, Quantity};
use crate::analysis::diff::evidence::Evidence;
use crate::analysis::history::{Cycle, RunHistory};
use crate::run::simulation::{EventKind, StopReason};
use crate::telemetry::side::Side;
use crate::words::number::Digits;
use crate::words::{Number, Piece, Sentence, and, sentence};
use schemars::JsonSchema;
use serde::Serialize;

/// Maximum number of contrasts.
const MAX_CONTRASTS: usize = 3;
/// Least relative difference of two times.
pub(in crate::analysis::diff) const MIN_PACE: f64 = 0.005;
/// Least ratio of two amplitudes of the nutation.
const MIN_NUTATION: f64 = 1.5;
/// Least amplitude of θ, relative to its mean, of a nutation that is worth a word.
const MIN_AMPLITUDE: f64 = 0.01;
/// A nutation is damped if its amplitude falls below this part of its first.
const DAMPED: f64 = 0.5;

/// A difference of two motions that is large enough for the headline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Contrast {
    /// B comes to the same state sooner or later than A.
    Pace {
        /// The time at which they come to it.
        of: Quantity,
        /// Ratio of B's time to A's.
        ratio: f64,
    },
    /// Only one run has an event, although the other goes on for longer.
    OnlyOne {
        /// The time of the event.
        of: Quantity,
        /// The run that has it.
        side: Side,
    },
    /// The amplitudes of the nutation differ at the end of the nutations that both have.
    Nutation {
        /// Ratio of B's amplitude of θ̇ to A's.
        ratio: f64,
        /// The run whose nutation is damped, if that of the other is not.
        damped: Option<Side>,
    },
}

/// The contrasts, at most three: the pace first, then what only one run does, then the nutation.
pub(in crate::analysis::diff) fn contrasts(
    evidence: &Evidence<'_>,
    findings: &[Finding],
) -> Vec<Contrast> {
    let differing = || findings.iter().filter(|finding| finding.differs());
    let mut found = Vec::new();
    found.extend(differing().find_map(pace));
    found.extend(differing().filter_map(only_one));
    found.truncate(MAX_CONTRASTS);
    if found.len() < MAX_CONTRASTS {
        found.extend(differing().find_map(|finding| nutation(evidence, finding)));
    }
    found
}

/// Whether a quantity tells how fast a motion is as a whole.
fn is_pace(quantity: Quantity) -> bool {
    match quantity {
        Quantity::End { ends: [a, b] } => a == b && a.is_some_and(EndCondition::is_of_theta),
        Quantity::MeanCrossing { .. } | Quantity::FirstReach { .. } | Quantity::Inversion => true,
        Quantity::FirstEvent { event } => event == EventKind::Fallen,
        _ => false,
    }
}

fn pace(finding: &Finding) -> Option<Contrast> {
    let (a, b) = finding.a.zip(finding.b)?;
    let ratio = b / a;
    let is_large = ratio.is_finite() && ratio > 0.0 && (ratio - 1.0).abs() >= MIN_PACE;
    (is_large && is_pace(finding.quantity)).then_some(Contrast::Pace {
        of: finding.quantity,
        ratio,
    })
}

fn only_one(finding: &Finding) -> Option<Contrast> {
    let side = match [finding.a, finding.b] {
        [Some(_), None] => Side::A,
        [None, Some(_)] => Side::B,
        [Some(_), Some(_)] | [None, None] => return None,
    };
    let of = finding.quantity;
    verb(of).map(|_| Contrast::OnlyOne { of, side })
}

fn nutation(evidence: &Evidence<'_>, finding: &Finding) -> Option<Contrast> {
    let Quantity::Amplitude { at } = finding.quantity else {
        return None;
    };
    let (a, b) = finding.a.zip(finding.b)?;
    let ratio = b / a;
    let histories = evidence.histories();
    let is_visible = histories
        .into_iter()
        .any(|run| relative_amplitude(run, at).is_some_and(|amplitude| amplitude > MIN_AMPLITUDE));
    let is_large = ratio.max(1.0 / ratio) >= MIN_NUTATION && ratio.is_finite() && ratio > 0.0;
    let from = evidence.averaged?.from;
    let damped = Side::BOTH.map(|side| {
        let amplitude = histories[side.index()].curve(Cycle::amplitude);
        let ends = amplitude.at(from).zip(amplitude.at(at));
        ends.is_some_and(|(first, last)| last < DAMPED * first)
    });
    let damped = match damped {
        [true, false] => Some(Side::A),
        [false, true] => Some(Side::B),
        [true, true] | [false, false] => None,
    };
    (is_large && is_visible).then_some(Contrast::Nutation { ratio, damped })
}

/// Amplitude of θ in the nutation at a time (s), relative to the mean of θ.
fn relative_amplitude(run: &RunHistory, time: f64) -> Option<f64> {
    let amplitude = run.curve(Cycle::amplitude_of_theta).at(time)?;
    Some(amplitude / run.curve(|cycle| cycle.means[0]).at(time)?)
}

/// Whether the motions are the same but for their nutation: they come to a state at the same time, and their means of θ
/// hardly differ.
fn is_same_but_for_nutation(contrasts: &[Contrast], findings: &[Finding]) -> bool {
    let is_of_nutation = |contrast: &Contrast| match contrast {
        Contrast::Nutation { .. } => true,
        Contrast::OnlyOne { of, .. } => *of == Quantity::FirstLoop,
        Contrast::Pace { .. } => false,
    };
    let has_pace = findings
        .iter()
        .any(|finding| is_pace(finding.quantity) && finding.a.is_some() && finding.b.is_some());
    let has_equal_means = findings.iter().all(|finding| match finding.quantity {
        Quantity::MeanTheta { .. } => finding.relative_difference() < Some(MIN_PACE),
        _ => true,
    });
    contrasts.iter().all(is_of_nutation) && has_pace && has_equal_means
}

/// The verb of an event that a headline tells: "B loops", "B does not loop".
fn verb(quantity: Quantity) -> Option<[&'static str; 2]> {
    Some(match quantity {
        Quantity::FirstReach { .. } => ["rises", "does not rise"],
        Quantity::Inversion => ["inverts", "does not invert"],
        Quantity::FirstLoop => ["loops", "does not loop"],
        Quantity::FirstRoll => ["rolls", "does not roll"],
        Quantity::FirstEvent { event } => match event {
            EventKind::Fallen => ["falls", "does not fall"],
            EventKind::UprightPassage => ["passes upright", "does not pass upright"],
            EventKind::WeakTop => ["becomes weak", "does not become weak"],
            EventKind::SlipStops | EventKind::Stick => ["sticks", "does not stick"],
            EventKind::LiftOff => ["hops", "does not hop"],
            EventKind::Rest => ["comes to rest", "does not come to rest"],
            EventKind::Jam => ["jams", "does not jam"],
            _ => return None,
        },
        _ => return None,
    })
}

impl Contrast {
    /// The contrast as a predicate of B: "rises 3.0 times slower than A", "does not loop"; `None` if it is of B's nutation,
    /// or if only B does it.
    fn predicate(self) -> Option<Sentence> {
        match self {
            Self::Pace { of, ratio } => Some(pace_predicate(of, ratio)),
            Self::OnlyOne {
                of: Quantity::FirstReach { level },
                side: Side::A,
            } => Some(sentence!(
                "does not rise to {}",
                Piece::number(level, 3, "rad")
            )),
            Self::OnlyOne { of, side: Side::A } => verb(of).map(|[_, lacks]| lacks.into()),
            Self::OnlyOne { side: Side::B, .. } | Self::Nutation { .. } => None,
        }
    }

    /// What only B does.
    fn of_b_alone(self) -> Option<Sentence> {
        match self {
            Self::OnlyOne { of, side: Side::B } => verb(of).map(|[has, _]| has.into()),
            Self::OnlyOne { side: Side::A, .. } | Self::Pace { .. } | Self::Nutation { .. } => None,
        }
    }

    /// The nutation of B, after "B's nutation" or "B's": "is damped".
    fn of_nutation(self) -> Option<Sentence> {
        let Self::Nutation { ratio, damped } = self else {
            return None;
        };
        Some(match damped {
            Some(Side::B) => sentence!("is damped"),
            Some(Side::A) => sentence!("is not damped, unlike A's"),
            None if ratio > 1.0 => sentence!("is {} times stronger", factor(ratio)),
            None => sentence!("is {} times weaker", factor(1.0 / ratio)),
        })
    }
}

fn pace_predicate(of: Quantity, ratio: f64) -> Sentence {
    let verb: Sentence = match of {
        Quantity::End {
            ends: [Some(end), _],
        } if end.reason == StopReason::Fallen => "falls".into(),
        Quantity::FirstEvent { .. } => "falls".into(),
        Quantity::Inversion => "inverts".into(),
        Quantity::MeanCrossing { level, farthest } if level < farthest => {
            sentence!("sinks to a mean θ of {}", Piece::number(level, 3, "rad"))
        }
        Quantity::MeanCrossing { level, .. } => {
            sentence!("rises to a mean θ of {}", Piece::number(level, 3, "rad"))
        }
        _ => "rises".into(),
    };
    let (pace, factor_of_time) = if ratio > 1.0 {
        ("slower", ratio)
    } else {
        ("faster", 1.0 / ratio)
    };
    if factor_of_time < MIN_NUTATION {
        let percent = Piece::rounded(100.0 * (factor_of_time - 1.0), 2, "");
        sentence!("{} {} % {} than A", verb, percent, pace)
    } else {
        sentence!("{} {} times {} than A", verb, factor(factor_of_time), pace)
    }
}

/// A factor with two digits.
fn factor(value: f64) -> Piece {
    Piece::Number(Number::new(value, Digits::Significant(2), ""))
}

/// The headline of runs that differ: the contrasts as a sentence on B. `None` if nothing is large enough.
pub(in crate::analysis::diff) fn headline(
    contrasts: &[Contrast],
    findings: &[Finding],
) -> Option<Sentence> {
    let mut predicates = Vec::new();
    let mut of_b = Vec::new();
    for contrast in contrasts {
        predicates.extend(contrast.predicate());
        of_b.extend(contrast.of_b_alone());
    }
    let nutation = contrasts.iter().find_map(|contrast| contrast.of_nutation());
    let is_same = is_same_but_for_nutation(contrasts, findings);
    let mut clauses = Vec::new();
    if let Some(nutation) = &nutation
        && is_same
    {
        clauses.push(sentence!(
            "the same but for the nutation: B's {}",
            nutation.clone()
        ));
    }
    if !predicates.is_empty() {
        clauses.push(sentence!("B {}", and(predicates)));
    }
    if !of_b.is_empty() {
        clauses.push(sentence!("unlike A, B {}", and(of_b)));
    }
    if let Some(nutation) = nutation
        && !is_same
    {
        clauses.push(sentence!("B's nutation {}", nutation));
    }
    (!clauses.is_empty()).then(|| Sentence::join(clauses, "; ").capitalized())
}
