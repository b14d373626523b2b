//! Rise and fall of the axis over a run, on which all sentences of a story agree.

use super::claim::Claim;

/// How the inclination of the axis changes over a run.
///
/// The words of each claim follow from it, so that no two sentences of a story contradict each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Course {
    /// No claim is about it.
    #[default]
    Open,
    /// All nutations are alike, and the top falls in none.
    Repeats,
    /// All nutations are alike, and the top falls in each.
    FallsRepeatedly,
    Rises,
    Falls,
    RisesThenFalls,
    FallsThenRises,
}

impl Course {
    /// The course of a run with these claims. `has_fallen`: whether the axis passes the level of a fall, or that of an
    /// inversion, whatever the cause. `has_drift`: whether what follows the claims is about a rise or fall.
    pub(super) fn new(claims: &[Claim], has_fallen: bool, has_drift: bool) -> Self {
        if claims.iter().any(is_repeated) {
            return if has_fallen {
                Self::FallsRepeatedly
            } else {
                Self::Repeats
            };
        }
        let rises = claims.iter().any(Claim::is_rise);
        let falls = claims.iter().any(Claim::is_fall);
        match (rises, falls) {
            (false, false) => Self::Open,
            (true, false) | (false, true) if has_drift => Self::RisesThenFalls,
            (false, true) => Self::Falls,
            (true, false) => Self::Rises,
            (true, true) if is_fall_first(claims) => Self::FallsThenRises,
            (true, true) => Self::RisesThenFalls,
        }
    }

    /// Whether a claim comes before the others about rise and fall.
    pub(super) fn comes_first(self, claim: &Claim) -> bool {
        match self {
            Self::FallsThenRises => claim.is_fall(),
            Self::Open
            | Self::Repeats
            | Self::FallsRepeatedly
            | Self::Rises
            | Self::Falls
            | Self::RisesThenFalls => false,
        }
    }

    /// The beginning of the first sentence about a rise: `The`, or words of time before it.
    pub(super) fn start_of_rise(self) -> &'static str {
        match self {
            Self::RisesThenFalls => "At first, the",
            Self::FallsThenRises => "Later, the",
            Self::Open | Self::Repeats | Self::FallsRepeatedly | Self::Rises | Self::Falls => "The",
        }
    }

    /// Words of time before a sentence about a fall; empty if it is the only motion.
    pub(super) fn start_of_fall(self) -> &'static str {
        match self {
            Self::RisesThenFalls => "Later, ",
            Self::FallsThenRises => "At first, ",
            Self::Open | Self::Repeats | Self::FallsRepeatedly | Self::Rises | Self::Falls => "",
        }
    }
}

/// Whether the first and the last nutation have the same mean inclination, without friction.
fn is_repeated(claim: &Claim) -> bool {
    matches!(
        claim,
        Claim::Conserves {
            mean_theta: Some(_),
            ..
        }
    )
}

/// Whether the axis falls before the end of its rise.
fn is_fall_first(claims: &[Claim]) -> bool {
    let mut rise_end = f64::NEG_INFINITY;
    let mut fall = f64::INFINITY;
    for claim in claims {
        match claim {
            Claim::FrictionRaises { until, .. } => rise_end = rise_end.max(*until),
            Claim::WeakTopFalls { time, .. } => fall = fall.min(*time),
            _ => {}
        }
    }
    // Without an end of its own, a rise is that of the mean motion, which a fall ends.
    fall < rise_end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::explain::explain;
    use crate::run::scenario::{Preset, Scenario};
    use crate::run::simulation::EventKind;

    fn conserves(mean_theta: Option<[f64; 2]>) -> Claim {
        Claim::Conserves {
            energy_deviation: 0.0,
            momentum_deviations: [0.0; 2],
            mean_theta,
        }
    }

    fn raises(until: f64, theta_at_end: f64) -> Claim {
        Claim::FrictionRaises {
            horizontal: [2.0, 1.0],
            vertical: [1.0, 1.0],
            is_vertical_constant: true,
            by_friction: -1.0,
            angle_to_momentum: 0.01,
            theta: [0.5, 0.2],
            until,
            theta_at_end,
            has_friction: true,
            has_air_drag: false,
        }
    }

    fn falls(time: f64) -> Claim {
        Claim::WeakTopFalls {
            axial: [0.5, 0.4],
            critical: 1.0,
            theta: [0.5, 1.6],
            time,
            has_friction: true,
            has_air_drag: false,
            needs_loss: false,
        }
    }

    #[test]
    fn words_of_rise_and_fall_agree() {
        let repeats = || conserves(Some([1.0; 2]));
        for (name, claims, [has_fallen, has_drift], course) in [
            ("none", vec![], [true, false], Course::Open),
            ("level", vec![repeats()], [false, false], Course::Repeats),
            (
                "swings",
                vec![repeats()],
                [true, false],
                Course::FallsRepeatedly,
            ),
            (
                "weak without friction",
                vec![repeats(), falls(0.1)],
                [true, false],
                Course::FallsRepeatedly,
            ),
            (
                "one nutation",
                vec![conserves(None), falls(0.1)],
                [true, false],
                Course::Falls,
            ),
            (
                "rise",
                vec![raises(3.0, 0.2)],
                [false, false],
                Course::Rises,
            ),
            (
                "rise undone",
                vec![raises(3.0, 0.6)],
                [false, true],
                Course::RisesThenFalls,
            ),
            (
                "rise, fall",
                vec![raises(3.0, 1.6), falls(4.0)],
                [true, false],
                Course::RisesThenFalls,
            ),
            (
                "fall, rise",
                vec![raises(3.0, 0.2), falls(1.0)],
                [true, false],
                Course::FallsThenRises,
            ),
        ] {
            assert_eq!(
                Course::new(&claims, has_fallen, has_drift),
                course,
                "{name}"
            );
            let text: String = claims
                .iter()
                .map(|claim| claim.words_in(course, &claims))
                .collect();
            assert!(
                !text.contains("neither rises nor falls") || course == Course::Repeats,
                "{name}: {text}"
            );
            let has_both = text.contains("top rises because") && text.contains("falls");
            assert!(
                !has_both || (text.contains("At first, ") && text.contains("Later, ")),
                "{name}: {text}"
            );
        }
    }

    /// The story of a preset with other values, and whether the top falls or inverts.
    fn story_of(preset: &str, keys: &[(&str, &str)]) -> (String, bool) {
        let mut values = Preset::find(preset).unwrap().values().unwrap();
        for (key, value) in keys {
            values.set(key, value).unwrap();
        }
        let explanation = explain(&Scenario::new(values).unwrap()).unwrap();
        let falls = explanation
            .events
            .iter()
            .any(|event| event.name == EventKind::Fallen.name());
        (explanation.story.text().unwrap_or_default(), falls)
    }

    #[test]
    fn names_the_weakness_of_a_top_that_falls() {
        let slowed: &[_] = &[("friction.k", "0.06"), ("initial.psi_dot", "30")];
        for (preset, keys, expected) in [
            (
                "frictionless",
                &[("initial.psi_dot", "0"), ("stop.duration", "1")][..],
                "falls each time because it is weak from the start",
            ),
            (
                "full-coulomb",
                &[("initial.psi_dot", "0")],
                "falls because it is weak from the start",
            ),
            ("full-coulomb", slowed, "slows the spin further"),
        ] {
            let (text, falls) = story_of(preset, keys);
            assert!(falls && text.contains(expected), "{preset}: {text}");
        }
    }

    #[test]
    fn names_why_a_strong_top_falls_without_friction() {
        for (keys, expected) in [
            (
                [
                    ("initial.psi_dot", "60"),
                    ("initial.theta", "1.5"),
                    ("initial.phi_dot", "0"),
                ],
                "although its spin",
            ),
            (
                [
                    ("initial.theta", "0.5"),
                    ("initial.theta_dot", "200"),
                    ("initial.phi_dot", "0"),
                ],
                "even without gravity",
            ),
        ] {
            let (text, falls) = story_of("frictionless", &keys);
            assert!(falls && text.contains(expected), "{keys:?}: {text}");
        }
    }

    /// Slow, weak and strong tops, with and without friction, upright and beyond the horizontal.
    #[test]
    fn stories_do_not_contradict_themselves() {
        for preset in ["frictionless", "full-coulomb", "paper"] {
            for spin in ["-60", "0", "5", "30", "45", "170"] {
                for theta in ["0.2", "0.5", "1.4", "1.7"] {
                    let keys = [
                        ("initial.psi_dot", spin),
                        ("initial.theta", theta),
                        ("stop.theta_risen", ""),
                        ("stop.theta_fallen", ""),
                        ("stop.duration", "1.5"),
                    ];
                    let (text, falls) = story_of(preset, &keys);
                    let name = format!("{preset}, spin {spin}, tilt {theta}: {text}");
                    assert!(
                        !(falls && text.contains("neither rises nor falls")),
                        "{name}"
                    );
                    let has_both = text.contains("top rises") && text.contains("top falls");
                    assert!(!has_both || text.contains("At first, "), "{name}");
                }
            }
        }
    }
}
