//! The arrows that viewers draw at a top: vectors of a sample, and the places where they begin.

pub(crate) mod palette;
mod preview;
pub(crate) mod scale;
pub(crate) mod snapshot;

pub use self::scale::Scales;

use self::palette::{GREEN, GREY, ORANGE, SKY, VERMILION, WHITE, YELLOW};
use self::scale::MAX_LENGTH;
use self::snapshot::Snapshot;
use super::fields::{CONTACT, MOMENTUM, POSE, TORQUE};
use super::table::quantity::Quantity;
use super::topic::Topic;
use nalgebra::Vector3;

/// A vector that is drawn as an arrow.
///
/// The torques begin at the tip of the horizontal part of the angular momentum: friction's shortens it, that of gravity
/// turns it about the vertical.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrow {
    SlipVelocity,
    FrictionForce,
    /// From the point that torques are about to the point of contact.
    Lever,
    FrictionTorque,
    Momentum,
    HorizontalMomentum,
    VerticalMomentum,
    GravityTorque,
    Weight,
}

/// The looks of an arrow.
pub(crate) struct ArrowStyle {
    pub(crate) name: &'static str,
    /// The symbol; empty if it has none.
    pub(crate) symbol: &'static str,
    pub(crate) color: u32,
    /// Thickness relative to the friction force.
    pub(crate) thickness: f64,
}

impl Arrow {
    /// All of them.
    pub(crate) const ALL: [Self; 9] = [
        Self::SlipVelocity,
        Self::FrictionForce,
        Self::Lever,
        Self::FrictionTorque,
        Self::Momentum,
        Self::HorizontalMomentum,
        Self::VerticalMomentum,
        Self::GravityTorque,
        Self::Weight,
    ];

    /// The looks.
    pub(crate) fn style(self) -> ArrowStyle {
        let (name, symbol, color, thickness) = match self {
            Self::SlipVelocity => ("slip velocity", "v", SKY, 0.7),
            Self::FrictionForce => ("friction force", "F", ORANGE, 1.0),
            Self::Lever => ("lever", "r", WHITE, 0.5),
            Self::FrictionTorque => ("friction torque", "τ", VERMILION, 1.3),
            Self::Momentum => ("angular momentum", "L", YELLOW, 1.4),
            Self::HorizontalMomentum => ("horizontal part of L", "", YELLOW, 1.1),
            Self::VerticalMomentum => ("vertical part of L", "", YELLOW, 0.4),
            Self::GravityTorque => ("gravity torque", "", GREEN, 0.7),
            Self::Weight => ("weight", "Mg", GREY, 0.5),
        };
        ArrowStyle {
            name,
            symbol,
            color,
            thickness,
        }
    }

    pub(crate) fn quantity(self) -> Quantity {
        match self {
            Self::SlipVelocity => Quantity::Velocity,
            Self::FrictionForce | Self::Weight => Quantity::Force,
            Self::Lever => Quantity::Length,
            Self::FrictionTorque | Self::GravityTorque => Quantity::Torque,
            Self::Momentum | Self::HorizontalMomentum | Self::VerticalMomentum => {
                Quantity::Momentum
            }
        }
    }

    /// Quantity per metre; 0 if there is nothing to draw, such as friction without friction.
    pub(crate) fn scale(self, scales: &Scales) -> f64 {
        match self {
            Self::SlipVelocity => scales.slip,
            Self::FrictionForce => scales.force,
            Self::Lever => 1.0,
            Self::FrictionTorque => scales.friction_torque,
            Self::Momentum | Self::HorizontalMomentum | Self::VerticalMomentum => scales.momentum,
            Self::GravityTorque => scales.gravity_torque,
            Self::Weight => scales.weight,
        }
    }

    /// Whether the arrow is drawn, to these scales, for a recording that has some topics.
    pub(crate) fn is_drawn(self, scales: &Scales, has: impl Fn(Topic) -> bool) -> bool {
        let topics: &[Topic] = match self {
            Self::SlipVelocity | Self::FrictionForce => &[CONTACT],
            Self::Lever => &[POSE, CONTACT],
            Self::FrictionTorque | Self::GravityTorque => &[POSE, TORQUE, CONTACT],
            Self::Momentum | Self::HorizontalMomentum | Self::VerticalMomentum => &[POSE, MOMENTUM],
            Self::Weight => &[POSE],
        };
        self.scale(scales) > 0.0 && topics.iter().all(|topic| has(*topic))
    }

    /// The vector.
    fn value(self, sample: &Snapshot) -> Vector3<f64> {
        match self {
            Self::SlipVelocity => sample.slip,
            Self::FrictionForce => sample.friction,
            Self::Lever => sample.contact - sample.origin,
            Self::FrictionTorque => sample.friction_torque,
            Self::Momentum => sample.momentum,
            Self::HorizontalMomentum => sample.horizontal_momentum(),
            Self::VerticalMomentum => sample.momentum.z * Vector3::z(),
            Self::GravityTorque => sample.weight_torque,
            Self::Weight => -sample.weight * Vector3::z(),
        }
    }
}

/// An arrow of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DrawnArrow {
    /// The place where it begins, m.
    pub(crate) start: Vector3<f64>,
    /// From there to the tip, m.
    pub(crate) vector: Vector3<f64>,
    /// Whether it would be too long for the view, and was cut off.
    pub(crate) is_cut: bool,
}

/// The arrows of a sample, to scale.
pub(crate) struct SampleArrows<'s> {
    sample: &'s Snapshot,
    scales: &'s Scales,
    /// Height of the top, m.
    height: f64,
    /// The angular momentum as it is drawn, m.
    momentum: Vector3<f64>,
    /// Its length relative to its scale: 1, or less if it is cut off.
    shrink: f64,
}

impl<'s> SampleArrows<'s> {
    /// The arrows of a top with this height, m.
    pub(crate) fn new(sample: &'s Snapshot, scales: &'s Scales, height: f64) -> Self {
        let whole = sample.momentum / scales.momentum;
        let (momentum, is_cut) = clip_to_view(whole, height);
        Self {
            sample,
            scales,
            height,
            momentum,
            shrink: if is_cut {
                momentum.norm() / whole.norm()
            } else {
                1.0
            },
        }
    }

    /// One of the arrows; `None` if the sample lacks a part of it.
    pub(crate) fn get(&self, arrow: Arrow) -> Option<DrawnArrow> {
        let vector = arrow.value(self.sample) / arrow.scale(self.scales);
        let (vector, is_cut) = match arrow.quantity() {
            // The parts remain parts of the whole.
            Quantity::Momentum => (self.shrink * vector, self.shrink < 1.0),
            _ => clip_to_view(vector, self.height),
        };
        let drawn = DrawnArrow {
            start: self.start(arrow),
            vector,
            is_cut,
        };
        let tip = drawn.start + vector;
        tip.iter().all(|part| part.is_finite()).then_some(drawn)
    }

    /// The place where an arrow begins, m.
    fn start(&self, arrow: Arrow) -> Vector3<f64> {
        let sample = self.sample;
        match arrow {
            Arrow::SlipVelocity | Arrow::FrictionForce => sample.contact,
            Arrow::Lever | Arrow::Momentum | Arrow::HorizontalMomentum => sample.origin,
            Arrow::FrictionTorque | Arrow::VerticalMomentum | Arrow::GravityTorque => {
                sample.origin + Vector3::new(self.momentum.x, self.momentum.y, 0.0)
            }
            Arrow::Weight => sample.center,
        }
    }
}

/// Cuts an arrow off if it is too long for the view. Also returns whether it was.
///
/// The scale comes from the start of the run, and some quantities grow by more than an order of magnitude: the angular
/// momentum does where a law of friction has only some of the torque's components.
fn clip_to_view(arrow: Vector3<f64>, height: f64) -> (Vector3<f64>, bool) {
    let longest = MAX_LENGTH * height;
    let length = arrow.norm();
    if length > longest {
        (longest / length * arrow, true)
    } else {
        (arrow, false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::scenario::{PRESETS, Preset, Scenario};
    use crate::run::simulation::Simulation;
    use crate::telemetry::arrows::snapshot::SnapshotReader;
    use crate::telemetry::proportions::Proportions;
    use crate::telemetry::{Telemetry, TelemetryError, Topics};

    /// The magnitudes of an arrow in the samples of a run.
    struct Magnitudes {
        arrow: Arrow,
        values: Vec<f64>,
    }

    /// A run of a preset, and its arrows.
    struct Run {
        name: &'static str,
        scales: Scales,
        height: f64,
        arrows: Vec<Magnitudes>,
    }

    impl Run {
        fn new(name: &'static str, scenario: &Scenario) -> Self {
            let topics: Vec<_> = Topic::all_with(scenario.model.support).collect();
            let scales = Scales::new(scenario);
            let mut arrows = Vec::new();
            for arrow in Arrow::ALL {
                if arrow.is_drawn(&scales, |topic| topics.contains(&topic)) {
                    let values = Vec::new();
                    arrows.push(Magnitudes { arrow, values });
                }
            }
            let mut reader = SnapshotReader::new(
                scenario.model.top,
                scenario.model.support.is_free(),
                |topic| topics.contains(&topic),
            );
            let mut telemetry = Telemetry::with_topics(&Topics::All);
            for record in Simulation::new(scenario).unwrap() {
                let all = telemetry.messages(&record.unwrap(), |message| {
                    if let Some(snapshot) = reader.take(message) {
                        for Magnitudes { arrow, values } in &mut arrows {
                            values.push(arrow.value(snapshot).norm());
                        }
                    }
                    Ok::<_, TelemetryError>(())
                });
                all.unwrap();
            }
            Self {
                name,
                scales,
                height: Proportions::new(&scenario.model.top).size(),
                arrows,
            }
        }

        /// The greatest length of an arrow with this scale, in heights of the top, and the share of the samples in which
        /// it is cut off.
        fn lengths(&self, magnitudes: &Magnitudes, scale: f64) -> (f64, f64) {
            let values = &magnitudes.values;
            let lengths = values.iter().map(|m| m / scale / self.height);
            let cut = lengths.clone().filter(|length| *length > MAX_LENGTH);
            let share = cut.count() as f64 / values.len() as f64;
            (lengths.fold(0.0, f64::max), share)
        }
    }

    fn preset(name: &'static str) -> Run {
        let mut values = Preset::find(name).unwrap().values().unwrap();
        // Other times than those from which the scales follow.
        values.set("sampling.period", "0.0037").unwrap();
        Run::new(name, &Scenario::new(values).unwrap())
    }

    fn presets() -> Vec<Run> {
        PRESETS.iter().map(|found| preset(&found.name)).collect()
    }

    /// Arrows that outgrow the view in a preset: friction without the precession's term drives the precession.
    const CUT: [(&str, Arrow); 2] = [
        ("paper-precession-term-only", Arrow::FrictionTorque),
        ("paper-precession-term-only", Arrow::Momentum),
    ];

    /// The lever has its true length, and parts are cut off with the whole.
    const WITHOUT_SCALE: [Arrow; 3] = [
        Arrow::Lever,
        Arrow::HorizontalMomentum,
        Arrow::VerticalMomentum,
    ];

    /// Length of an arrow that is easy to see, in heights of the top. One height is about 4 cm of a screen.
    const READABLE: f64 = 0.25;

    #[test]
    fn arrows_of_presets_are_readable_and_fit_the_view() {
        for run in presets() {
            for magnitudes in &run.arrows {
                let arrow = magnitudes.arrow;
                if WITHOUT_SCALE.contains(&arrow) {
                    continue;
                }
                let (longest, cut) = run.lengths(magnitudes, arrow.scale(&run.scales));
                let text = format!("{}: {arrow:?}, {longest} at most, {cut} cut", run.name);
                assert!(longest >= READABLE, "{text}");
                let fits = cut <= 0.02;
                assert_eq!(fits, !CUT.contains(&(run.name, arrow)), "{text}");
            }
        }
    }

    #[test]
    fn arrows_of_pairs_are_readable_and_fit_the_view() {
        let runs = presets();
        for a in &runs {
            for b in &runs {
                let common = a.scales.common_force(&b.scales);
                let mut longest: f64 = 0.0;
                for run in [a, b] {
                    for arrow in run
                        .arrows
                        .iter()
                        .filter(|m| m.arrow == Arrow::FrictionForce)
                    {
                        let (length, cut) = run.lengths(arrow, common);
                        assert!(cut <= 0.02, "{} and {}: {cut} cut", a.name, b.name);
                        longest = longest.max(length);
                    }
                }
                let is_any_drawn = common > 0.0;
                let is_readable = longest >= READABLE;
                assert_eq!(
                    is_readable, is_any_drawn,
                    "{} and {}: {longest}",
                    a.name, b.name
                );
            }
        }
    }

    #[test]
    fn pair_of_tippe_tops_is_readable_on_both_sides() {
        let runs = ["tippe-top", "tippe-top-hangs"].map(preset);
        let common = runs[0].scales.common_force(&runs[1].scales);
        for run in runs {
            let force = run.arrows.iter().find(|m| m.arrow == Arrow::FrictionForce);
            let (longest, _) = run.lengths(force.unwrap(), common);
            assert!(longest >= READABLE, "{}: {longest}", run.name);
        }
    }

    #[test]
    fn scales_of_presets_are_round() {
        for preset in PRESETS.iter() {
            let scenario = preset.scenario().unwrap();
            let scales = Scales::new(&scenario);
            for arrow in Arrow::ALL {
                let scale = arrow.scale(&scales);
                let digits = format!("{scale:e}");
                let is_round = ["1e", "2e", "5e"]
                    .iter()
                    .any(|start| digits.starts_with(start));
                let is_slip = arrow == Arrow::SlipVelocity;
                let is_absent = scale == 0.0 && (scenario.is_frictionless() || is_slip);
                assert!(
                    is_round || is_absent,
                    "{}: {arrow:?}, {digits}",
                    preset.name
                );
            }
        }
    }

    #[test]
    fn long_arrows_are_cut() {
        let long = Vector3::new(3.0, 0.0, 4.0);
        let (cut, is_cut) = clip_to_view(long, 1.0);
        assert!(is_cut && (cut.norm() - MAX_LENGTH).abs() < 1e-15);
        assert!(cut.cross(&long).norm() < 1e-15, "the direction stays");
        assert_eq!(clip_to_view(0.1 * long, 1.0), (0.1 * long, false));
    }
}
