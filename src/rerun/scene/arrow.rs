//! The arrows of the scene, each with its name beyond its tip.

use nalgebra::{UnitQuaternion, Vector3};
use rerun::archetypes::{Arrows3D, Points3D};
use rerun::{Color, Radius};

use crate::rerun::identity::Identity;
use crate::rerun::output::{Columns, Output};
use crate::rerun::palette;
use crate::rerun::role::Role;
use crate::rerun::scale::{self, Scales};
use crate::rerun::track::Track;
use crate::telemetry::Message;
use crate::telemetry::fields::{CONTACT, VectorField, contact, momentum, torque};
use crate::telemetry::proportions::Proportions;

/// Time between two positions of a label, in ns.
const LABEL_NS: u64 = 10_000_000;

/// A kind of arrow.
struct Kind {
    name: &'static str,
    /// The colour in a recording of one run.
    color: u32,
    /// The quantity that it shows.
    vector: VectorField,
    /// Quantity per metre.
    scale: fn(&Scales) -> f64,
    /// Distance by which its label is moved up, in heights of the top. The distances differ, so that labels don't overlap
    /// when arrows are short.
    lift: f64,
}

/// All kinds of arrows.
static KINDS: [Kind; 5] = [
    Kind {
        name: "slip velocity",
        color: palette::SKY,
        vector: contact::SLIP_WORLD,
        scale: |scales| scales.slip,
        lift: 0.0,
    },
    Kind {
        name: "friction force",
        color: palette::ORANGE,
        vector: contact::FRICTION_FORCE,
        scale: |scales| scales.force,
        lift: -0.13,
    },
    Kind {
        name: "gravity torque",
        color: palette::GREEN,
        vector: torque::GRAVITY_BODY,
        scale: |scales| scales.gravity_torque,
        lift: 0.13,
    },
    Kind {
        name: "friction torque",
        color: palette::VERMILION,
        vector: torque::FRICTION_BODY,
        scale: |scales| scales.friction_torque,
        lift: 0.26,
    },
    Kind {
        name: "angular momentum",
        color: palette::YELLOW,
        vector: momentum::WORLD,
        scale: |scales| scales.momentum,
        lift: 0.13,
    },
];

/// The only arrow drawn in a comparison: all arrows of both runs would hide the tops.
const COMPARED: VectorField = contact::FRICTION_FORCE;

/// A kind of arrow that is drawn in a recording.
struct DrawnKind {
    kind: &'static Kind,
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
    text
}

/// Distance of a label from the tip of its arrow, in heights of the top.
const LABEL_GAP: f64 = 0.12;
/// Length of the shortest arrow with a label, in heights of the top. Labels of shorter ones would overlap.
const MIN_LABELED: f64 = 0.1;

/// An arrow at the origin of a quantity, with a label beyond its tip.
pub(super) struct Arrow {
    vector: VectorField,
    /// Quantity per metre.
    scale: f64,
    /// Height of the top, m.
    height: f64,
    /// Distance by which the label is moved up from the tip, m.
    lift: f64,
    arrows: Track<[[f32; 3]; 2]>,
    labels: Track<Option<[f32; 3]>>,
    /// The labels of the arrow where it is cut off, because it would leave the view.
    cut_labels: Track<Option<[f32; 3]>>,
    next_label_ns: u64,
}

impl Arrow {
    /// The arrows with data to draw; sends colours, thickness and names.
    pub(super) fn all(identity: &Identity, role: &Role, output: &mut Output) -> Vec<Self> {
        let size = Proportions::new(&identity.geometry.top).size();
        let mut arrows = Vec::new();
        for DrawnKind {
            kind,
            scale,
            legend,
        } in drawn(identity, role)
        {
            let entity = role.entity(&format!("scene/{}", kind.name.replace(' ', "_")));
            let color = Color::from_u32(role.color(kind.color, 0));
            let radius = 0.017 * size * role.thickness();
            let arrow = Arrows3D::update_fields()
                .with_colors([color])
                .with_radii([Radius::new_scene_units(radius as f32)]);
            output.send_static(entity.as_str(), &arrow);
            let name = role.short_name(kind.name);
            let label = format!("{entity}/label");
            let cut_label = format!("{entity}/cut_label");
            let text = format!("{name} ({legend})");
            let cut_text = format!("{name} (longer than drawn; {legend})");
            send_label(&label, text, color, output);
            send_label(&cut_label, cut_text, color, output);
            arrows.push(Self {
                vector: kind.vector,
                scale,
                height: size,
                lift: (kind.lift + role.lift()) * size,
                arrows: Track::new(entity, arrow_columns, output),
                labels: Track::new(label, label_columns, output),
                cut_labels: Track::new(cut_label, label_columns, output),
                next_label_ns: 0,
            });
        }
        arrows
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
        let row = [origin, arrow].map(|part| part.cast::<f32>().into());
        self.arrows.push(output, time_ns, [row]);
        if time_ns >= self.next_label_ns {
            self.next_label_ns = time_ns.saturating_add(LABEL_NS);
            let place = self
                .label_offset(arrow)
                .map(|offset| (origin + offset).cast::<f32>().into());
            let (label, cut_label) = if is_cut { (None, place) } else { (place, None) };
            self.labels.push(output, time_ns, [label]);
            self.cut_labels.push(output, time_ns, [cut_label]);
        }
    }

    /// Position of the label of an arrow relative to the arrow's origin, m; none for a short arrow.
    fn label_offset(&self, arrow: Vector3<f64>) -> Option<Vector3<f64>> {
        let direction = arrow.try_normalize(MIN_LABELED * self.height)?;
        Some(arrow + LABEL_GAP * self.height * direction + self.lift * Vector3::z())
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

/// Sends the text and the style of a label, which gets its places later.
fn send_label(entity: &str, text: String, color: Color, output: &mut Output) {
    let label = Points3D::update_fields()
        .with_colors([color])
        // Rerun draws text in a scene only as the label of a point: this one can't be seen.
        .with_radii([Radius::new_ui_points(0.0)])
        .with_labels([text])
        .with_show_labels(true);
    output.send_static(entity, &label);
}

/// Whether an arrow begins at the point of contact, or the lowest point of a peg in the air; others begin at the centre of
/// the peg.
fn is_at_contact(vector: VectorField) -> bool {
    vector.topic() == CONTACT
}

fn arrow_columns(rows: &[[[f32; 3]; 2]]) -> Columns {
    let arrows = Arrows3D::update_fields()
        .with_origins(rows.iter().map(|[origin, _]| *origin))
        .with_vectors(rows.iter().map(|[_, vector]| *vector));
    Ok(arrows.columns_of_unit_batches()?.collect())
}

fn label_columns(rows: &[Option<[f32; 3]>]) -> Columns {
    let points = Points3D::update_fields().with_positions(rows.iter().copied().flatten());
    let lengths = rows.iter().map(|row| usize::from(row.is_some()));
    Ok(points.columns(lengths)?.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rerun::identity::Playback;
    use crate::run::scenario::{PRESETS, Scenario};
    use crate::run::simulation::Simulation;
    use crate::telemetry::{Telemetry, Topic, Topics};

    /// The longest of each arrow in a run, in heights of the top and before it is cut, in the order of [`drawn`].
    fn longest(identity: &Identity, scenario: &Scenario) -> Vec<(&'static str, f64)> {
        let height = Proportions::new(&identity.geometry.top).size();
        let mut lengths: Vec<_> = drawn(identity, &Role::Alone)
            .into_iter()
            .map(|drawn| (drawn, 0.0_f64))
            .collect();
        let mut telemetry = Telemetry::with_topics(&Topics::All);
        for record in Simulation::new(scenario).unwrap() {
            let all = telemetry.messages(&record.unwrap(), |message| {
                for (DrawnKind { kind, scale, .. }, longest) in &mut lengths {
                    if kind.vector.topic() == message.topic() {
                        let length = kind.vector.of(message).norm() / *scale;
                        *longest = longest.max(length / height);
                    }
                }
                Ok::<_, crate::telemetry::TelemetryError>(())
            });
            all.unwrap();
        }
        lengths
            .iter()
            .map(|(drawn, longest)| (drawn.kind.name, *longest))
            .collect()
    }

    /// Arrows that outgrow the view in a preset: friction without the precession's term drives the precession.
    const CUT: [(&str, &str); 2] = [
        ("paper-precession-term-only", "friction torque"),
        ("paper-precession-term-only", "angular momentum"),
    ];

    /// Arrows that are too short for a label all the time: the scale of the gravity torque is that of a top that may
    /// invert, and this one stays almost upright.
    const SHORT: [(&str, &str); 1] = [("tippe-top-hangs", "gravity torque")];

    #[test]
    fn arrows_of_presets_fit_the_view() {
        for preset in PRESETS.iter() {
            let mut values = preset.values().unwrap();
            values.set("sampling.period", "0.005").unwrap();
            let scenario = Scenario::new(values).unwrap();
            let topics = Topic::all_with(scenario.model.support).collect();
            let identity = Identity::new("test", &scenario, topics, Playback::FromStart);
            for (arrow, longest) in longest(&identity, &scenario) {
                let name = preset.name.as_str();
                let has_label = longest >= MIN_LABELED;
                assert_eq!(
                    has_label,
                    !SHORT.contains(&(name, arrow)),
                    "{name}: {arrow} has {longest} at most"
                );
                let is_cut = longest > scale::max_length(1.0);
                assert_eq!(
                    is_cut,
                    CUT.contains(&(name, arrow)),
                    "{name}: {arrow} has {longest}"
                );
            }
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
