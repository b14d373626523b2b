//! The arrows of the scene.

use nalgebra::Vector3;
use rerun::archetypes::Arrows3D;
use rerun::{Color, Radius};

use crate::rerun::identity::Identity;
use crate::rerun::identity::scale::{self, Scales};
use crate::rerun::output::track::Track;
use crate::rerun::output::{ComponentColumns, Output};
use crate::rerun::palette;
use crate::rerun::role::Role;
use crate::rerun::snapshot::Snapshot;
use crate::telemetry::fields::{CONTACT, MOMENTUM, POSE, TORQUE};
use crate::telemetry::proportions::Proportions;
use crate::telemetry::{Quantity, Topic};

/// A kind of arrow.
struct ArrowKind {
    name: &'static str,
    /// The label of the arrow in the scene.
    label: &'static str,
    /// The symbol that stands for the name in the label; empty if the label is a name.
    symbol: &'static str,
    /// The colour in a recording of one run.
    color: u32,
    /// Thickness relative to the most important arrows.
    thickness: f64,
    quantity: Quantity,
    /// The value that is drawn.
    value: fn(&Snapshot) -> Vector3<f64>,
    /// The place where the arrow begins, m, given the drawn angular momentum.
    start: fn(&Snapshot, Vector3<f64>) -> Vector3<f64>,
    /// Quantity per metre.
    scale: fn(&Scales) -> f64,
    /// The topics without which there is no arrow.
    topics: &'static [Topic],
}

/// All kinds of arrows.
///
/// The torques begin at the tip of the horizontal part of the angular momentum: friction's shortens it, that of gravity
/// turns it about the vertical.
static KINDS: [ArrowKind; 9] = [
    ArrowKind {
        name: "slip velocity",
        label: "v",
        symbol: "v",
        color: palette::SKY,
        thickness: 0.7,
        quantity: Quantity::Velocity,
        value: |s| s.slip,
        start: |s, _| s.contact,
        scale: |scales| scales.slip,
        topics: &[CONTACT],
    },
    ArrowKind {
        name: "friction force",
        label: "F",
        symbol: "F",
        color: palette::ORANGE,
        thickness: 1.0,
        quantity: Quantity::Force,
        value: |s| s.friction,
        start: |s, _| s.contact,
        scale: |scales| scales.force,
        topics: &[CONTACT],
    },
    ArrowKind {
        name: "lever",
        label: "r",
        symbol: "r",
        color: palette::WHITE,
        thickness: 0.5,
        quantity: Quantity::Length,
        value: |s| s.contact - s.origin,
        start: |s, _| s.origin,
        scale: |_| 1.0,
        topics: &[POSE, CONTACT],
    },
    ArrowKind {
        name: "friction torque",
        // At the place of the next label: each leaves its line to the other.
        label: "\nfriction torque τ",
        symbol: "τ",
        color: palette::VERMILION,
        thickness: 1.3,
        quantity: Quantity::Torque,
        value: |s| s.friction_torque,
        start: tip_of_horizontal,
        scale: |scales| scales.friction_torque,
        topics: &[POSE, TORQUE, CONTACT],
    },
    ArrowKind {
        name: "angular momentum",
        label: "L",
        symbol: "L",
        color: palette::YELLOW,
        thickness: 1.4,
        quantity: Quantity::Momentum,
        value: |s| s.momentum,
        start: |s, _| s.origin,
        scale: |scales| scales.momentum,
        topics: &[POSE, MOMENTUM],
    },
    ArrowKind {
        name: "horizontal part of L",
        label: "horizontal part\n",
        symbol: "",
        color: palette::YELLOW,
        thickness: 1.1,
        quantity: Quantity::Momentum,
        value: Snapshot::horizontal_momentum,
        start: |s, _| s.origin,
        scale: |scales| scales.momentum,
        topics: &[POSE, MOMENTUM],
    },
    ArrowKind {
        name: "vertical part of L",
        label: "vertical part",
        symbol: "",
        color: palette::YELLOW,
        thickness: 0.4,
        quantity: Quantity::Momentum,
        value: |s| s.momentum.z * Vector3::z(),
        start: tip_of_horizontal,
        scale: |scales| scales.momentum,
        topics: &[POSE, MOMENTUM],
    },
    ArrowKind {
        name: "gravity torque",
        label: "",
        symbol: "",
        color: palette::GREEN,
        thickness: 0.7,
        quantity: Quantity::Torque,
        value: |s| s.weight_torque,
        start: tip_of_horizontal,
        scale: |scales| scales.gravity_torque,
        topics: &[POSE, TORQUE, CONTACT],
    },
    ArrowKind {
        name: "weight",
        label: "Mg",
        symbol: "Mg",
        color: palette::GREY,
        thickness: 0.5,
        quantity: Quantity::Force,
        value: |s| -s.weight * Vector3::z(),
        start: |s, _| s.center,
        scale: |scales| scales.weight,
        topics: &[POSE],
    },
];

/// The tip of the horizontal part of the angular momentum, m.
fn tip_of_horizontal(snapshot: &Snapshot, drawn: Vector3<f64>) -> Vector3<f64> {
    snapshot.origin + Vector3::new(drawn.x, drawn.y, 0.0)
}

/// The only arrow drawn in a comparison: all arrows of both runs would hide the tops.
const COMPARED: &str = "friction force";

/// A kind of arrow that is drawn in a recording.
struct DrawnKind {
    kind: &'static ArrowKind,
    /// Quantity per metre.
    scale: f64,
}

/// The arrows that are drawn. Without friction, its arrows have no length and are omitted.
fn drawn(identity: &Identity, role: &Role) -> Vec<DrawnKind> {
    let mut drawn = Vec::new();
    for kind in &KINDS {
        let scale = (kind.scale)(&identity.geometry.scales);
        let is_shown = role.is_alone() || kind.name == COMPARED;
        let has_data = kind.topics.iter().all(|topic| identity.has(*topic));
        if has_data && scale > 0.0 && is_shown {
            drawn.push(DrawnKind { kind, scale });
        }
    }
    drawn
}

/// The arrows with their scales, in Markdown.
pub(super) fn legend(identity: &Identity) -> String {
    let mut text = "| arrow | 1 cm is |\n| --- | --- |\n".to_owned();
    for DrawnKind { kind, scale } in drawn(identity, &Role::Alone) {
        let scale = match kind.quantity {
            Quantity::Length => "1 cm".to_owned(),
            quantity => scale::per_centimetre(scale, quantity.unit()),
        };
        let symbol = match kind.symbol {
            "" => String::new(),
            symbol => format!("**{symbol}** "),
        };
        let color = palette::name(kind.color);
        text += &format!("| {symbol}{}, {color} | {scale} |\n", kind.name);
    }
    let point = if identity.geometry.is_free {
        "centre of mass"
    } else {
        "centre of the peg"
    };
    text + &format!("\nL, r and the torques are about the {point}.\n")
}

/// An arrow with its label.
pub(super) struct Arrow {
    drawn: DrawnKind,
    /// Height of the top, m.
    height: f64,
    arrows: Track<[[f32; 3]; 2]>,
    label: String,
    labels: Track<String>,
    /// Whether the arrow was cut off at its last row.
    was_cut: Option<bool>,
}

impl Arrow {
    /// The arrows with data to draw; sends colours and thickness.
    pub(super) fn all(identity: &Identity, role: &Role, output: &mut Output) -> Vec<Self> {
        let height = Proportions::new(&identity.geometry.top).size();
        let mut arrows = Vec::new();
        for drawn in drawn(identity, role) {
            let kind = drawn.kind;
            let entity = role.entity(&format!("scene/{}", kind.name.replace(' ', "_")));
            let radius = 0.017 * height * kind.thickness * role.thickness();
            let style = Arrows3D::update_fields()
                .with_colors([Color::from_u32(role.color(kind.color, 0))])
                .with_radii([Radius::new_scene_units(radius as f32)])
                .with_show_labels(true);
            output.send_static(entity.as_str(), &style);
            arrows.push(Self {
                drawn,
                height,
                arrows: Track::new(entity.as_str(), arrow_columns, output),
                label: role.short_name(kind.label),
                labels: Track::new(entity, label_columns, output),
                was_cut: None,
            });
        }
        arrows
    }

    /// Removes the arrow from this time on, ns.
    pub(super) fn remove(&mut self, time_ns: u64, output: &mut Output) {
        self.arrows.push(output, time_ns, [[[0.0; 3]; 2]]);
        self.labels.push(output, time_ns, [String::new()]);
    }

    /// Adds a row for a sample, in which the angular momentum is drawn like this.
    pub(super) fn write(
        &mut self,
        snapshot: &Snapshot,
        momentum: &DrawnMomentum,
        output: &mut Output,
    ) {
        let kind = self.drawn.kind;
        let vector = (kind.value)(snapshot) / self.drawn.scale;
        let (vector, is_cut) = match kind.quantity {
            // The parts remain parts of the whole.
            Quantity::Momentum => (momentum.shrink * vector, momentum.shrink < 1.0),
            _ => clip_to_view(vector, self.height),
        };
        let start = (kind.start)(snapshot, momentum.vector);
        if !(start + vector).iter().all(|part| part.is_finite()) {
            return;
        }
        let row = [start, vector].map(|part| part.cast::<f32>().into());
        self.arrows.push(output, snapshot.time_ns, [row]);
        if self.was_cut != Some(is_cut) {
            self.was_cut = Some(is_cut);
            let label = if is_cut {
                format!("{} (longer than drawn)", self.label)
            } else {
                self.label.clone()
            };
            self.labels.push(output, snapshot.time_ns, [label]);
        }
    }
}

/// The angular momentum as it is drawn.
pub(super) struct DrawnMomentum {
    /// The arrow, m.
    vector: Vector3<f64>,
    /// Length of the arrow relative to its scale: 1, or less if it is cut off.
    shrink: f64,
}

impl DrawnMomentum {
    /// The angular momentum of a sample of a top with this height, m.
    pub(super) fn new(snapshot: &Snapshot, scales: &Scales, height: f64) -> Self {
        let whole = snapshot.momentum / scales.momentum;
        let (vector, is_cut) = clip_to_view(whole, height);
        Self {
            vector,
            shrink: if is_cut {
                vector.norm() / whole.norm()
            } else {
                1.0
            },
        }
    }
}

/// Cuts an arrow off if it is too long for the view. Also returns whether it was.
///
/// The scale comes from the start of the run, and some quantities grow by more than an order of magnitude: the angular
/// momentum does where a law of friction has only some of the torque's components.
fn clip_to_view(arrow: Vector3<f64>, height: f64) -> (Vector3<f64>, bool) {
    let longest = scale::max_length(height);
    let length = arrow.norm();
    if length > longest {
        (longest / length * arrow, true)
    } else {
        (arrow, false)
    }
}

/// The components of arrows: starts and vectors.
pub(in crate::rerun) fn arrow_columns(rows: &[[[f32; 3]; 2]]) -> ComponentColumns {
    let arrows = Arrows3D::update_fields()
        .with_origins(rows.iter().map(|[origin, _]| *origin))
        .with_vectors(rows.iter().map(|[_, vector]| *vector));
    Ok(arrows.columns_of_unit_batches()?.collect())
}

fn label_columns(rows: &[String]) -> ComponentColumns {
    let labels = Arrows3D::update_fields().with_labels(rows.iter().map(String::as_str));
    Ok(labels.columns_of_unit_batches()?.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rerun::identity::Playback;
    use crate::rerun::snapshot::SnapshotReader;
    use crate::run::scenario::{PRESETS, Preset, Scenario};
    use crate::run::simulation::Simulation;
    use crate::telemetry::{Telemetry, Topic, Topics};

    /// An arrow of a run.
    struct Drawn {
        name: &'static str,
        value: fn(&Snapshot) -> Vector3<f64>,
        /// Quantity per metre.
        scale: f64,
        /// The magnitudes of the samples.
        magnitudes: Vec<f64>,
    }

    /// A run of a preset, and its arrows.
    struct Run {
        name: &'static str,
        identity: Identity,
        height: f64,
        arrows: Vec<Drawn>,
    }

    impl Run {
        fn new(name: &'static str, scenario: &Scenario) -> Self {
            let topics = Topic::all_with(scenario.model.support).collect();
            let identity = Identity::new("test", scenario, topics, Playback::FromStart);
            let mut arrows: Vec<_> = drawn(&identity, &Role::Alone)
                .into_iter()
                .map(|DrawnKind { kind, scale }| Drawn {
                    name: kind.name,
                    value: kind.value,
                    scale,
                    magnitudes: Vec::new(),
                })
                .collect();
            let mut reader = SnapshotReader::new(
                scenario.model.top,
                scenario.model.support.is_free(),
                &identity.topics,
            );
            let mut telemetry = Telemetry::with_topics(&Topics::All);
            for record in Simulation::new(scenario).unwrap() {
                let all = telemetry.messages(&record.unwrap(), |message| {
                    if let Some(snapshot) = reader.take(message) {
                        for arrow in &mut arrows {
                            arrow.magnitudes.push((arrow.value)(snapshot).norm());
                        }
                    }
                    Ok::<_, crate::telemetry::TelemetryError>(())
                });
                all.unwrap();
            }
            Self {
                name,
                height: Proportions::new(&identity.geometry.top).size(),
                identity,
                arrows,
            }
        }

        /// The greatest length of an arrow with this scale, in heights of the top, and the share of the samples in which
        /// it is cut off.
        fn lengths(&self, arrow: &Drawn, scale: f64) -> (f64, f64) {
            let lengths = arrow.magnitudes.iter().map(|m| m / scale / self.height);
            let cut = lengths.clone().filter(|l| *l > scale::max_length(1.0));
            let share = cut.count() as f64 / arrow.magnitudes.len() as f64;
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
    const CUT: [(&str, &str); 2] = [
        ("paper-precession-term-only", "friction torque"),
        ("paper-precession-term-only", "angular momentum"),
    ];

    /// Length of an arrow that is easy to see, in heights of the top. One height is about 4 cm of a screen.
    const READABLE: f64 = 0.25;

    #[test]
    fn arrows_of_presets_are_readable_and_fit_the_view() {
        for run in presets() {
            for arrow in &run.arrows {
                // The lever has its true length, and parts are cut off with the whole.
                if ["lever", "horizontal part of L", "vertical part of L"].contains(&arrow.name) {
                    continue;
                }
                let (longest, cut) = run.lengths(arrow, arrow.scale);
                let text = format!("{}: {}, {longest} at most, {cut} cut", run.name, arrow.name);
                assert!(longest >= READABLE, "{text}");
                let fits = cut <= 0.02;
                assert_eq!(fits, !CUT.contains(&(run.name, arrow.name)), "{text}");
            }
        }
    }

    #[test]
    fn arrows_of_pairs_are_readable_and_fit_the_view() {
        let runs = presets();
        for a in &runs {
            for b in &runs {
                let [own, other] = [a, b].map(|run| run.identity.geometry.scales);
                let common = own.common_force(&other);
                let mut longest: f64 = 0.0;
                for run in [a, b] {
                    for arrow in run.arrows.iter().filter(|arrow| arrow.name == COMPARED) {
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
        let [own, other] = [&runs[0], &runs[1]].map(|run| run.identity.geometry.scales);
        let common = own.common_force(&other);
        for run in runs {
            let force = run.arrows.iter().find(|arrow| arrow.name == COMPARED);
            let (longest, _) = run.lengths(force.unwrap(), common);
            assert!(longest >= READABLE, "{}: {longest}", run.name);
        }
    }

    #[test]
    fn long_arrows_are_cut() {
        let long = Vector3::new(3.0, 0.0, 4.0);
        let (cut, is_cut) = clip_to_view(long, 1.0);
        assert!(is_cut && (cut.norm() - scale::max_length(1.0)).abs() < 1e-15);
        assert!(cut.cross(&long).norm() < 1e-15, "the direction stays");
        assert_eq!(clip_to_view(0.1 * long, 1.0), (0.1 * long, false));
    }
}
