//! The arrows of the scene.

use nalgebra::{UnitQuaternion, Vector3};
use rerun::archetypes::Arrows3D;
use rerun::{Color, Radius};

use super::legend::LegendRow;
use crate::rerun::identity::Identity;
use crate::rerun::identity::scale::{self, Scales};
use crate::rerun::output::track::Track;
use crate::rerun::output::{ComponentColumns, Output};
use crate::rerun::palette;
use crate::rerun::role::Role;
use crate::telemetry::Message;
use crate::telemetry::fields::{CONTACT, VectorField, contact, momentum, torque};
use crate::telemetry::proportions::Proportions;

/// A kind of arrow.
struct ArrowKind {
    name: &'static str,
    /// The colour in a recording of one run.
    color: u32,
    /// The quantity that it shows.
    vector: VectorField,
    /// Quantity per metre.
    scale: fn(&Scales) -> f64,
}

/// All kinds of arrows.
static KINDS: [ArrowKind; 5] = [
    ArrowKind {
        name: "slip velocity",
        color: palette::SKY,
        vector: contact::SLIP_WORLD,
        scale: |scales| scales.slip,
    },
    ArrowKind {
        name: "friction force",
        color: palette::ORANGE,
        vector: contact::FRICTION_FORCE,
        scale: |scales| scales.force,
    },
    ArrowKind {
        name: "gravity torque",
        color: palette::GREEN,
        vector: torque::GRAVITY_BODY,
        scale: |scales| scales.gravity_torque,
    },
    ArrowKind {
        name: "friction torque",
        color: palette::VERMILION,
        vector: torque::FRICTION_BODY,
        scale: |scales| scales.friction_torque,
    },
    ArrowKind {
        name: "angular momentum",
        color: palette::YELLOW,
        vector: momentum::WORLD,
        scale: |scales| scales.momentum,
    },
];

/// The only arrow drawn in a comparison: all arrows of both runs would hide the tops.
const COMPARED: VectorField = contact::FRICTION_FORCE;

/// A kind of arrow that is drawn in a recording.
struct DrawnKind {
    kind: &'static ArrowKind,
    /// Quantity per metre.
    scale: f64,
    /// The scale as text.
    legend: String,
}

/// The arrows that are drawn. Without friction, its arrows have no length and are omitted.
fn drawn(identity: &Identity, role: &Role) -> Vec<DrawnKind> {
    let mut drawn = Vec::new();
    for kind in &KINDS {
        let scale = (kind.scale)(&identity.geometry.scales);
        let is_shown = role.is_alone() || kind.vector == COMPARED;
        if identity.has(kind.vector.topic()) && scale > 0.0 && is_shown {
            drawn.push(DrawnKind {
                kind,
                scale,
                legend: scale::legend(scale, kind.vector.x().unit()),
            });
        }
    }
    drawn
}

/// Quantity per centimetre of each arrow, in Markdown.
pub(super) fn explanation(identity: &Identity, role: &Role) -> String {
    let mut text = "\n\n## Arrows\n\n| arrow | scale |\n| --- | --- |\n".to_owned();
    for DrawnKind { kind, legend, .. } in drawn(identity, role) {
        text += &format!("| {} | {legend} |\n", kind.name);
    }
    if Proportions::new(&identity.geometry.top).is_ball {
        text += "\nThe ball would hide the starts of torques and of the angular momentum: they start at its surface.\n";
    }
    text
}

/// An arrow at the origin of a quantity, with a row in the legend.
pub(super) struct Arrow {
    vector: VectorField,
    /// Quantity per metre.
    scale: f64,
    /// Height of the top, m.
    height: f64,
    /// Distance of the arrow's start from its origin, m.
    gap: f64,
    arrows: Track<[[f32; 3]; 2]>,
    row: LegendRow,
    /// The texts of the row where the arrow is drawn in its length, and where it is cut off, because it would leave the view.
    texts: [Track<Option<[f32; 3]>>; 2],
    /// Whether the arrow was cut off at its last message.
    was_cut: Option<bool>,
}

impl Arrow {
    /// The arrows with data to draw; sends colours, thickness and names.
    pub(super) fn all(identity: &Identity, role: &Role, output: &mut Output) -> Vec<Self> {
        let proportions = Proportions::new(&identity.geometry.top);
        let size = proportions.size();
        let mut arrows = Vec::new();
        for (
            index,
            DrawnKind {
                kind,
                scale,
                legend,
            },
        ) in drawn(identity, role).into_iter().enumerate()
        {
            let name = kind.name.replace(' ', "_");
            let entity = role.entity(&format!("scene/{name}"));
            let color = role.color(kind.color, 0);
            let radius = 0.017 * size * role.thickness();
            let arrow = Arrows3D::update_fields()
                .with_colors([Color::from_u32(color)])
                .with_radii([Radius::new_scene_units(radius as f32)]);
            output.send_static(entity.as_str(), &arrow);
            let row = LegendRow::new(identity, role, index, &name, color);
            let name = role.short_name(kind.name);
            let texts = [
                ("whole", format!("{name} ({legend})")),
                ("cut", format!("{name} (longer than drawn; {legend})")),
            ];
            arrows.push(Self {
                vector: kind.vector,
                scale,
                height: size,
                gap: gap(kind.vector, &proportions),
                arrows: Track::new(entity, arrow_columns, output),
                texts: texts.map(|(part, text)| row.open(part, &text, output)),
                row,
                was_cut: None,
            });
        }
        arrows
    }

    /// Removes the arrow and its name from this time on, ns.
    pub(super) fn remove(&mut self, time_ns: u64, output: &mut Output) {
        self.arrows.push(output, time_ns, [[[0.0; 3]; 2]]);
        for text in &self.texts {
            text.push(output, time_ns, [None]);
        }
    }

    /// Adds a row for a message of the arrow's channel. Orientation (world from body) is that of the last pose; the places
    /// are the centre of the peg and the point of contact, as they are drawn.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        orientation: Option<UnitQuaternion<f64>>,
        [peg, contact]: [Vector3<f64>; 2],
        output: &mut Output,
    ) {
        let (time_ns, vector) = (message.time_ns, self.vector);
        if message.topic() != vector.topic() {
            return;
        }
        let origin = if is_at_contact(vector) { contact } else { peg };
        let own = vector.of(message);
        let vector = match orientation {
            _ if !vector.is_in_body_axes() => own,
            Some(orientation) => orientation * own,
            // Without a pose the directions of the body axes are unknown.
            None => return,
        };
        let (arrow, is_cut) = clip_to_view(vector / self.scale, self.height);
        let start = match arrow.try_normalize(0.0) {
            Some(direction) => origin + self.gap * direction,
            None => origin,
        };
        let row = [start, arrow].map(|part| part.cast::<f32>().into());
        self.arrows.push(output, time_ns, [row]);
        if self.was_cut != Some(is_cut) {
            self.was_cut = Some(is_cut);
            let place = Some(self.row.place());
            let places = if is_cut { [None, place] } else { [place, None] };
            for (text, place) in self.texts.iter().zip(places) {
                text.push(output, time_ns, [place]);
            }
        }
    }
}

/// Distance of an arrow's start from its origin, m: a ball would hide a short arrow that starts at its centre.
fn gap(vector: VectorField, proportions: &Proportions) -> f64 {
    if proportions.is_ball && !is_at_contact(vector) {
        proportions.peg
    } else {
        0.0
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

/// Whether an arrow begins at the point of contact, or the lowest point of a peg in the air; others begin at the centre of
/// the peg.
fn is_at_contact(vector: VectorField) -> bool {
    vector.topic() == CONTACT
}

fn arrow_columns(rows: &[[[f32; 3]; 2]]) -> ComponentColumns {
    let arrows = Arrows3D::update_fields()
        .with_origins(rows.iter().map(|[origin, _]| *origin))
        .with_vectors(rows.iter().map(|[_, vector]| *vector));
    Ok(arrows.columns_of_unit_batches()?.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rerun::identity::Playback;
    use crate::run::scenario::{PRESETS, Preset, Scenario};
    use crate::run::simulation::Simulation;
    use crate::telemetry::{Telemetry, Topic, Topics};

    /// An arrow of a run.
    struct Drawn {
        name: &'static str,
        vector: VectorField,
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
                .map(|DrawnKind { kind, scale, .. }| Drawn {
                    name: kind.name,
                    vector: kind.vector,
                    scale,
                    magnitudes: Vec::new(),
                })
                .collect();
            let mut telemetry = Telemetry::with_topics(&Topics::All);
            for record in Simulation::new(scenario).unwrap() {
                let all = telemetry.messages(&record.unwrap(), |message| {
                    for arrow in &mut arrows {
                        if arrow.vector.topic() == message.topic() {
                            arrow.magnitudes.push(arrow.vector.of(message).norm());
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
                    for arrow in run.arrows.iter().filter(|arrow| arrow.vector == COMPARED) {
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
            let force = run.arrows.iter().find(|arrow| arrow.vector == COMPARED);
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
