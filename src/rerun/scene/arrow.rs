//! The arrows of the scene.

use rerun::archetypes::Arrows3D;
use rerun::{Color, Radius};

use crate::rerun::identity::Identity;
use crate::rerun::output::track::Track;
use crate::rerun::output::{ComponentColumns, Output};
use crate::rerun::palette;
use crate::rerun::role::Role;
use crate::telemetry::Quantity;
use crate::telemetry::arrows::scale::per_centimetre;
use crate::telemetry::arrows::{Arrow, DrawnArrow};
use crate::telemetry::proportions::Proportions;
use crate::telemetry::side::Side;

/// The only arrow drawn in a comparison: all arrows of both runs would hide the tops.
const COMPARED: Arrow = Arrow::FrictionForce;

/// The arrows that are drawn.
fn drawn(identity: &Identity, role: &Role) -> Vec<Arrow> {
    let scales = &identity.geometry.scales;
    Arrow::ALL
        .into_iter()
        .filter(|arrow| role.is_alone() || *arrow == COMPARED)
        .filter(|arrow| arrow.is_drawn(scales, |topic| identity.has(topic)))
        .collect()
}

/// The label of an arrow in the scene. Of two that may be at one place, each leaves its line to the other.
fn label(arrow: Arrow, role: &Role) -> String {
    let label = match arrow {
        Arrow::FrictionTorque => "\nfriction torque τ",
        Arrow::HorizontalMomentum => "horizontal part\n",
        Arrow::Momentum => "L\n",
        Arrow::VerticalMomentum => "\nvertical part",
        other => other.style().symbol,
    };
    match role {
        Role::Compared(Side::A) => format!("A: {label}\n"),
        Role::Compared(Side::B) => format!("\nB: {label}"),
        Role::Alone | Role::Difference | Role::Magnitude => label.to_owned(),
    }
}

/// Length of the shortest arrow with a label, in heights of the top: a label is about as large.
const LABELLED: f64 = 0.15;

/// The arrows with their scales, in Markdown.
pub(super) fn legend(identity: &Identity) -> String {
    let mut text = "| arrow | 1 cm is |\n| --- | --- |\n".to_owned();
    for arrow in drawn(identity, &Role::Alone) {
        let style = arrow.style();
        let scale = match arrow.quantity() {
            Quantity::Length => "1 cm".to_owned(),
            quantity => per_centimetre(arrow.scale(&identity.geometry.scales), quantity.unit()),
        };
        let symbol = match style.symbol {
            "" => String::new(),
            symbol => format!("**{symbol}** "),
        };
        let color = palette::name(style.color);
        text += &format!("| {symbol}{}, {color} | {scale} |\n", style.name);
    }
    let point = if identity.geometry.is_free {
        "centre of mass"
    } else {
        "centre of the peg"
    };
    text + &format!("\nL, r and the torques are about the {point}.\n")
}

/// The rows of an arrow with its label.
pub(super) struct ArrowTrack {
    pub(super) arrow: Arrow,
    arrows: Track<[[f32; 3]; 2]>,
    label: String,
    labels: Track<String>,
    /// The label of the last row.
    shown: Option<String>,
    /// Length of the shortest arrow with a label, m.
    labelled: f64,
}

impl ArrowTrack {
    /// The arrows with data to draw; sends colours and thickness.
    pub(super) fn all(identity: &Identity, role: &Role, output: &mut Output) -> Vec<Self> {
        let height = Proportions::new(&identity.geometry.top).size();
        let mut arrows = Vec::new();
        for arrow in drawn(identity, role) {
            let looks = arrow.style();
            let entity = role.entity(&format!("scene/{}", looks.name.replace(' ', "_")));
            let radius = 0.017 * height * looks.thickness * role.thickness();
            let style = Arrows3D::update_fields()
                .with_colors([Color::from_u32(role.color(looks.color, 0))])
                .with_radii([Radius::new_scene_units(radius as f32)])
                .with_show_labels(true);
            output.send_static(entity.as_str(), &style);
            arrows.push(Self {
                arrow,
                arrows: Track::new(entity.as_str(), arrow_columns, output),
                label: label(arrow, role),
                labels: Track::new(entity, label_columns, output),
                shown: None,
                labelled: LABELLED * height,
            });
        }
        arrows
    }

    /// Removes the arrow from this time on, ns.
    pub(super) fn remove(&mut self, time_ns: u64, output: &mut Output) {
        self.arrows.push(output, time_ns, [[[0.0; 3]; 2]]);
        self.labels.push(output, time_ns, [String::new()]);
    }

    /// Adds a row.
    pub(super) fn write(&mut self, time_ns: u64, drawn: &DrawnArrow, output: &mut Output) {
        let row = [drawn.start, drawn.vector].map(|part| part.cast::<f32>().into());
        self.arrows.push(output, time_ns, [row]);
        let label = if drawn.is_cut {
            format!("{} (longer than drawn)", self.label)
        } else if drawn.vector.norm() < self.labelled {
            String::new()
        } else {
            self.label.clone()
        };
        if self.shown.as_ref() != Some(&label) {
            self.labels.push(output, time_ns, [label.clone()]);
            self.shown = Some(label);
        }
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
