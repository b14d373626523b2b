//! Why a tippe top turns over, or does not.

use super::claim::{Claim, SufficientSpin};
use super::evidence::{Evidence, ROUNDED};
use crate::physics::math::sin_cos;
use crate::physics::top::Top;
use crate::run::simulation::StopReason;
use std::f64::consts::FRAC_PI_2;

/// Number of inclinations at which the least energy is computed.
const INCLINATIONS: u32 = 64;

pub(super) fn inverts(evidence: &Evidence) -> Option<Claim> {
    let history = &evidence.history;
    let observations = &evidence.observations;
    if !history.is_tippe_top() || !history.has_exact_inversion() {
        return None;
    }
    let jellett_deviation = evidence.summary.peg.as_ref()?.jellett_deviation?;
    let span = observations.momentum.whole()?;
    let vertical = [span.from.vertical, span.to.vertical];
    let axial = [span.from.axial, span.to.axial];
    let theta = [span.from.theta, span.to.theta];
    let (center, kinetic) = (observations.center_height?, observations.kinetic?);
    let turns_over = theta[0] < FRAC_PI_2 && theta[1] > FRAC_PI_2;
    let reverses = vertical[0] * vertical[1] > 0.0 && axial[0] * axial[1] < 0.0;
    let rises = center.last > center.first && kinetic.last < kinetic.first;
    let lost_sliding = evidence.summary.peg.as_ref()?.lost?[0];
    // Other torques change Jellett's integral, and could turn the top over by themselves.
    let by_contact_force =
        jellett_deviation <= ROUNDED && !evidence.scenario.model.friction.has_losses();
    (turns_over && reverses && rises && by_contact_force && lost_sliding > 0.0).then_some(
        Claim::Inverts {
            time: history.inverted?,
            theta,
            jellett_deviation,
            vertical,
            axial,
            center_height: [center.first, center.last],
            kinetic: [kinetic.first, kinetic.last],
            lost_sliding,
        },
    )
}

/// A tippe top that has not enough energy to turn over.
///
/// No force at the contact point changes Jellett's integral. So at each inclination there is a least energy, and friction
/// only takes energy from the motion.
pub(super) fn stays_upright(evidence: &Evidence) -> Option<Claim> {
    let history = &evidence.history;
    let friction = &evidence.scenario.model.friction;
    let start = evidence.scenario.angles.theta;
    // Other torques change Jellett's integral.
    if friction.has_losses() || !friction.acts_at_contact() {
        return None;
    }
    if !history.is_tippe_top() || start >= FRAC_PI_2 || history.inverted.is_some() {
        return None;
    }
    // Otherwise the top may turn over after the end of the recording.
    history.stop_reason()?;
    let integral = JellettIntegral::new(evidence)?;
    let barrier = Barrier::new(evidence, &integral, start);
    let energy = history.energies?.first;
    barrier.stops(energy).then(|| Claim::StaysUpright {
        energy,
        needed: barrier.needed,
        needed_at: barrier.at,
        jellett: integral.value,
        jellett_deviation: integral.deviation,
        sufficient_spin: sufficient_spin(evidence, energy),
    })
}

/// Jellett's integral of a run, which is constant.
struct JellettIntegral {
    /// At the start, kg m³/s.
    value: f64,
    /// The largest deviation, relative to its terms.
    deviation: f64,
    /// Magnitude that it certainly has, kg m³/s.
    certain: f64,
}

impl JellettIntegral {
    /// `None` if it is not constant.
    fn new(evidence: &Evidence) -> Option<Self> {
        let integral = evidence.history.peg.as_ref()?.jellett()?;
        let top = &evidence.scenario.model.top;
        let terms =
            (top.center_distance.abs() + top.peg_radius) * evidence.observations.momentum.largest();
        // Without spin, its terms are rounding errors of a motion that has angular momentum all the same.
        let recorded = evidence.summary.peg.as_ref()?.jellett_deviation?;
        let deviation = if recorded <= ROUNDED {
            recorded
        } else {
            integral.deviation / terms
        };
        (deviation <= ROUNDED).then_some(Self {
            value: integral.first,
            deviation,
            certain: (integral.first.abs() - ROUNDED * terms).max(0.0),
        })
    }
}

/// The least energy of the top where it is largest between an inclination and the horizontal.
struct Barrier {
    /// The energy, J.
    needed: f64,
    /// The inclination, rad.
    at: f64,
}

impl Barrier {
    fn new(evidence: &Evidence, integral: &JellettIntegral, from: f64) -> Self {
        let top = &evidence.scenario.model.top;
        let mut barrier = Self {
            needed: f64::NEG_INFINITY,
            at: from,
        };
        for Inclination { theta, sin, cos } in inclinations(from) {
            let least = top.least_energy(integral.certain, sin, cos);
            if least > barrier.needed {
                barrier = Self {
                    needed: least,
                    at: theta,
                };
            }
        }
        barrier
    }

    /// Whether a top with this energy, J, can't pass it.
    fn stops(&self, energy: f64) -> bool {
        self.needed - energy > ROUNDED * self.needed.abs().max(energy.abs())
    }
}

/// Why a tippe top with enough energy at the start has not turned over by the end of its run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NotInverted {
    /// Friction has taken so much energy that the rest is not enough: it will not turn over.
    Spent,
    /// It has enough energy, and its contact point slips: it may turn over later.
    NotYet,
}

/// Why a tippe top that had enough energy has not turned over; `None` if the numbers don't show it.
pub(super) fn not_inverted(evidence: &Evidence) -> Option<NotInverted> {
    let history = &evidence.history;
    let friction = &evidence.scenario.model.friction;
    let start = evidence.scenario.angles.theta;
    if friction.has_losses() || !friction.acts_at_contact() {
        return None;
    }
    if !history.is_tippe_top() || start >= FRAC_PI_2 || history.inverted.is_some() {
        return None;
    }
    let stop = history.stop_reason()?;
    let integral = JellettIntegral::new(evidence)?;
    let [_, last] = history.states?;
    let barrier = Barrier::new(evidence, &integral, last.theta.clamp(0.0, FRAC_PI_2));
    if barrier.stops(history.energies?.last) {
        return Some(NotInverted::Spent);
    }
    // Where the peg rolls, friction does no work and turns nothing over.
    let still_slips = evidence.observations.grip.is_none();
    (still_slips && stop == StopReason::Duration).then_some(NotInverted::NotYet)
}

impl NotInverted {
    /// The reason in words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Spent => {
                "The top does not turn over. At first it had enough energy for it, but friction has taken so much of it that the rest is not enough: friction at the contact point does not change Jellett's integral, and with this value of the integral the axis could reach the horizontal only with more energy than is left."
            }
            Self::NotYet => {
                "The top has not turned over when the run ends. It still has the energy that it needs to reach the horizontal, and its contact point still slips: a longer run shows whether friction turns it over."
            }
        }
    }
}

/// An inclination of the axis.
struct Inclination {
    /// The angle, rad.
    theta: f64,
    sin: f64,
    cos: f64,
}

/// Inclinations from that at the start, rad, to the horizontal.
fn inclinations(start: f64) -> impl Iterator<Item = Inclination> {
    (0..=INCLINATIONS).map(move |at| {
        if at == INCLINATIONS {
            // π/2 isn't a floating-point number, and its cosine isn't zero.
            return Inclination {
                theta: FRAC_PI_2,
                sin: 1.0,
                cos: 0.0,
            };
        }
        let part = f64::from(at) / f64::from(INCLINATIONS);
        let theta = start + part * (FRAC_PI_2 - start);
        let (sin, cos) = sin_cos(theta);
        Inclination { theta, sin, cos }
    })
}

/// The spin with which the top would have enough energy, given its energy at the start, J.
///
/// The spin ψ̇ adds to Jellett's integral in proportion, and to the energy by its square. So what the energy lacks at an
/// inclination is a quadratic function of ψ̇. If it opens downwards at all of them, a faster spin is enough; if it is
/// positive everywhere at one of them, none is.
fn sufficient_spin(evidence: &Evidence, energy: f64) -> SufficientSpin {
    let top = &evidence.scenario.model.top;
    let (rates, start) = (evidence.scenario.rates, evidence.scenario.angles.theta);
    let (start_sin, start_cos) = sin_cos(start);
    let axial = top.axial_moment;
    // Jellett's integral is `per_spin ψ̇ + unspun`.
    let per_spin = axial * (top.center_distance + top.peg_radius * start_cos);
    let carried = rates.phi * start_cos;
    let across = top.central_moment() * rates.phi * start_sin * start_sin;
    let unspun = per_spin * carried + top.peg_radius * across;
    if 0.5 * per_spin * per_spin / least_jellett_moment(top, start) < 0.5 * axial * (1.0 - ROUNDED)
    {
        return SufficientSpin::Faster;
    }
    let unspun_energy = energy - axial * rates.psi * (0.5 * rates.psi + carried);
    // Rounding of the energies, which may be much larger than the least that is lacking.
    let rounded = 64.0 * f64::EPSILON * energy.abs() + ROUNDED * unspun_energy.abs();
    for Inclination { sin, cos, .. } in inclinations(start) {
        let moment = top.jellett_moment(sin, cos);
        let square = 0.5 * (per_spin * per_spin / moment - axial);
        let linear = per_spin * unspun / moment - axial * carried;
        let constant = top.least_energy(unspun, sin, cos) - unspun_energy;
        let is_open_upwards = square > ROUNDED * axial;
        if is_open_upwards && constant - 0.25 * linear * linear / square > rounded {
            return SufficientSpin::Absent;
        }
    }
    SufficientSpin::Unknown
}

/// The least [`Top::jellett_moment`] between this inclination, rad, and the horizontal, without that at this inclination:
/// there the top has enough energy.
fn least_jellett_moment(top: &Top, start: f64) -> f64 {
    let (_, start_cos) = sin_cos(start);
    let at_horizontal = top.jellett_moment(1.0, 0.0);
    // A quadratic function of cos θ.
    let excess = top.axial_moment - top.central_moment();
    let cos = -top.axial_moment * top.center_distance / (top.peg_radius * excess);
    if cos > 0.0 && cos < start_cos {
        at_horizontal.min(top.jellett_moment((1.0 - cos * cos).sqrt(), cos))
    } else {
        at_horizontal
    }
}

#[cfg(test)]
mod tests {
    use crate::analysis::explain::{Explanation, Fact, explain};
    use crate::run::scenario::{Preset, Scenario};
    use crate::run::simulation::EventKind;

    fn explained(keys: &[(&str, &str)]) -> Explanation {
        let mut values = Preset::find("tippe-top").unwrap().values().unwrap();
        for (key, value) in keys {
            values.set(key, value).unwrap();
        }
        explain(&Scenario::new(values).unwrap()).unwrap()
    }

    /// The story of a run of this length, s, and whether the top turns over in it.
    fn story_within(duration: &str, keys: &[(&str, &str)]) -> (String, bool) {
        let explanation = explained(&[keys, &[("stop.duration", duration)]].concat());
        let inverts = explanation
            .events
            .iter()
            .any(|event| event.name == EventKind::Inverts.name());
        (explanation.story.text().unwrap_or_default(), inverts)
    }

    #[test]
    fn names_why_a_tippe_top_does_not_turn_over() {
        for (keys, expected) in [
            (("initial.psi_dot", "0"), "It spins too slowly"),
            (("initial.psi_dot", "30"), "It spins too slowly"),
            (
                ("initial.theta", "1.45"),
                "friction has taken so much of it",
            ),
            (
                ("friction.k", "0.003"),
                "has not turned over when the run ends",
            ),
        ] {
            let text = explained(&[keys]).story.text().unwrap_or_default();
            assert!(text.contains(expected), "{keys:?}: {text}");
        }
    }

    #[test]
    fn energies_to_turn_over_have_a_noun_and_units() {
        let explanation = explained(&[("initial.psi_dot", "0")]);
        let sentences: Vec<String> = explanation
            .chapters
            .iter()
            .flat_map(|chapter| &chapter.facts)
            .map(Fact::sentence)
            .collect();
        let expected = "The top starts with an energy of −0.001173 J; to reach the horizontal, it would need at least 0 J (zero at the height of the peg's centre).";
        assert!(
            sentences.iter().any(|sentence| sentence == expected),
            "{sentences:?}"
        );
    }

    /// Slow and fast, inclined and nearly upright, on slippery and rough tables: a top that is said not to turn over does
    /// not in a run of four times the length, either, and each one has a reason.
    #[test]
    fn reasons_hold_in_longer_runs() {
        for spin in ["-90", "0", "10", "45", "60", "80", "150"] {
            for theta in ["0.02", "0.3", "0.9", "1.5"] {
                for k in ["0.02", "0.1", "0.4"] {
                    let keys = [
                        ("initial.psi_dot", spin),
                        ("initial.theta", theta),
                        ("friction.k", k),
                    ];
                    let (text, has_inverted) = story_within("3", &keys);
                    assert!(has_inverted || !text.is_empty(), "{keys:?}");
                    if text.contains("does not turn over") {
                        assert!(
                            !has_inverted && !story_within("12", &keys).1,
                            "{keys:?}: {text}"
                        );
                    }
                }
            }
        }
    }
}
