//! Why a tippe top turns over, or does not.

use crate::analysis::explain::claim::{Claim, SufficientSpin};
use crate::analysis::explain::evidence::{Evidence, ROUNDED};
use crate::physics::math::sin_cos;
use crate::physics::top::Top;
use crate::run::simulation::StopReason;
use std::f64::consts::FRAC_PI_2;

/// Number of inclinations at which the least energy is computed.
const INCLINATIONS: u32 = 64;

/// A tippe top that turns over.
pub(super) fn inverts(evidence: &Evidence) -> Option<Claim> {
    let history = &evidence.history;
    let observations = &evidence.observations;
    if !history.is_tippe_top() || history.inverted().is_none() {
        return None;
    }
    let jellett_deviation = evidence.summary.peg.as_ref()?.jellett_deviation?;
    let span = observations.momentum.whole?;
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
            time: history.last_inversion()?,
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
    let start = evidence.scenario.angles.theta;
    if !can_only_be_barred(evidence) {
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
            (top.center_distance.abs() + top.peg_radius) * evidence.observations.momentum.largest;
        // Without spin, its terms are rounding errors of a motion that has angular momentum all the same.
        let recorded = evidence.summary.peg.as_ref()?.jellett_deviation?;
        let deviation = if recorded <= ROUNDED {
            recorded
        } else {
            integral.deviation() / terms
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

/// Why a tippe top that had enough energy has not turned over; `None` if the numbers don't show it.
pub(super) fn not_inverted(evidence: &Evidence) -> Option<Claim> {
    let history = &evidence.history;
    if !can_only_be_barred(evidence) {
        return None;
    }
    let stop = history.stop_reason()?;
    let integral = JellettIntegral::new(evidence)?;
    let [_, last] = history.states?;
    let barrier = Barrier::new(evidence, &integral, last.theta.clamp(0.0, FRAC_PI_2));
    let energies = history.energies?;
    if barrier.stops(energies.last) {
        return Some(Claim::EnergySpent {
            energy: [energies.first, energies.last],
            needed: barrier.needed,
        });
    }
    // A contact point that does not slip turns nothing over.
    let slip_speed = evidence.observations.slip_speed?;
    (stop == StopReason::Duration).then_some(Claim::NotYetInverted {
        energy: energies.last,
        needed: barrier.needed,
        slip_speed,
    })
}

/// Whether only too little energy can keep a tippe top, which starts upright, from turning over: friction acts, and no
/// torque changes Jellett's integral; and it has not turned over.
fn can_only_be_barred(evidence: &Evidence) -> bool {
    let history = &evidence.history;
    let friction = &evidence.scenario.model.friction;
    let starts_upright = evidence.scenario.angles.theta < FRAC_PI_2;
    let acts_by_force = friction.acts_at_contact() && !friction.has_losses();
    acts_by_force && history.is_tippe_top() && starts_upright && history.inverted().is_none()
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
    use crate::analysis::explain::{Explanation, explain};
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
            (("initial.psi_dot", "0"), "It spun too slowly"),
            (("initial.psi_dot", "30"), "It spun too slowly"),
            (("initial.theta", "1.45"), "friction took so much of it"),
            (
                ("friction.k", "0.003"),
                "had not turned over when the run ended",
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
            .map(|fact| fact.sentence().to_string())
            .collect();
        let expected = "The top started with an energy of −0.001173 J; to reach the horizontal, it would have needed at least 0 J (zero at the height of the peg's centre).";
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
                    if text.contains("did not turn over") {
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
