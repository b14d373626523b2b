//! The layout for two runs that are compared: both tops on one table, and for each quantity both
//! curves, their difference, and how the difference grows.

use super::*;
use crate::rerun::pair::PairIdentity;
use crate::telemetry::side::Side;

/// How the comparison ended, in words.
pub(in super::super) const SUMMARY: &str = "/summary";

/// A quantity that is compared.
struct Quantity {
    name: &'static str,
    unit: &'static str,
    /// What is shown of each run.
    curves: &'static [&'static str],
    /// What is subtracted.
    differences: &'static [&'static str],
    /// Where the legend is out of the curves' way. Most go without: colours mean the same everywhere.
    legend: Option<Corner2D>,
}

const fn quantity(
    name: &'static str,
    unit: &'static str,
    curves: &'static [&'static str],
    differences: &'static [&'static str],
    legend: Option<Corner2D>,
) -> Quantity {
    Quantity {
        name,
        unit,
        curves,
        differences,
        legend,
    }
}

/// What tells whether and how they differ; each is a row of plots.
#[rustfmt::skip]
const MOTION: [Quantity; 4] = [
    quantity("θ", "rad", &["/top/state/theta"], &["/top/state/theta", "/top/nutation/theta_mean"], Some(Corner2D::RightTop)),
    quantity("dθ/dt", "rad/s", &["/top/state/theta_dot", "/top/nutation/theta_dot_mean"], &["/top/state/theta_dot", "/top/nutation/theta_dot_mean"], None),
    quantity("dφ/dt", "rad/s", &["/top/state/phi_dot", "/top/nutation/phi_dot_mean"], &["/top/state/phi_dot", "/top/nutation/phi_dot_mean"], None),
    quantity("dψ/dt", "rad/s", &["/top/state/psi_dot"], &["/top/state/psi_dot", "/top/nutation/psi_dot_mean"], None),
];

/// What friction does; in one row.
#[rustfmt::skip]
const FRICTION: [Quantity; 3] = [
    quantity("Slip speed", "m/s", &["/top/contact/slip_speed"], &[], None),
    quantity("Power of friction", "W", &["/top/energy/friction_power"], &[], None),
    quantity("Work of friction", "J", &["/top/energy/friction_work"], &[], None),
];

/// What else there is to see; each is a row of plots.
#[rustfmt::skip]
const MORE: [Quantity; 5] = [
    quantity("Slip speed", "m/s", &["/top/contact/slip_speed"], &["/top/contact/slip_speed"], None),
    quantity("Friction torque, node frame", "N m", &["/top/torque/friction_node"], &["/top/torque/friction_node"], Some(Corner2D::LeftBottom)),
    quantity("Energy, total and kinetic", "J", &["/top/energy/mechanical"], &["/top/energy/mechanical"], Some(Corner2D::LeftBottom)),
    quantity("dφ/dt − slow root", "rad/s", &["/top/precession/excess"], &["/top/precession/excess"], None),
    quantity("Nutation period", "s", &["/top/nutation/period"], &["/top/nutation/period"], None),
];

/// Whether the layout shows the differences of this entity.
pub(in super::super) fn compares(entity: &str) -> bool {
    let mut rows = MOTION.iter().chain(&MORE);
    rows.any(|quantity| quantity.differences.contains(&entity))
}

/// All messages of the blueprint, the last of which activates it.
pub(in super::super) fn messages(identity: &PairIdentity) -> Result<Vec<LogMsg>, RerunError> {
    let mut layout = Layout::new(&identity.recording_id);
    let left = left_side(&mut layout, identity)?;
    let right = right_side(&mut layout, identity)?;
    let root = match right {
        Some(right) => {
            layout.container(ContainerKind::Horizontal, &[left, right], &[38.0, 62.0])?
        }
        None => left,
    };
    layout.fill(&root)?;
    panels(&mut layout, true, identity.playback)?;
    Ok(layout.finish())
}

/// The scene if there is one, and below it the words: how the comparison ended, and what happened.
fn left_side(layout: &mut Layout, identity: &PairIdentity) -> Result<Child, RerunError> {
    let mut rows = Vec::new();
    let mut shares = Vec::new();
    if let Some(proportions) = identity.stage_proportions() {
        let name = format!(
            "{} (blue, solid) and {} (orange, translucent)",
            identity.name_of(Side::A),
            identity.name_of(Side::B)
        );
        let runs = looks(identity, POSE);
        let contents = runs.iter().map(|run| run.entity("scene/**"));
        let contents: Vec<_> = contents.chain([format!("{STAGE}/**")]).collect();
        rows.push(scene(layout, &name, &contents, &runs, &proportions)?);
        shares.push(53.0);
    }
    rows.push(words(layout, identity)?);
    shares.push(25.0);
    let runs = looks(identity, EVENTS);
    if !runs.is_empty() {
        let contents: Vec<_> = runs.iter().map(|run| run.entity(EVENTS)).collect();
        let kinds = [
            blueprint_data::TextLogColumnKind::LogLevel,
            blueprint_data::TextLogColumnKind::Body,
        ];
        rows.push(events(layout, &contents, &kinds)?);
        shares.push(22.0);
    }
    layout.container(ContainerKind::Vertical, &rows, &shares)
}

/// The looks of the runs that have a topic.
fn looks(identity: &PairIdentity, topic: &str) -> Vec<Look> {
    let sides = [Side::A, Side::B].into_iter();
    let sides = sides.filter(|side| identity.run(*side).has_topic(topic));
    sides.map(|side| identity.look(side)).collect()
}

/// The summary, and behind it what there is to say about each run.
fn words(layout: &mut Layout, identity: &PairIdentity) -> Result<Child, RerunError> {
    let mut tabs = vec![layout.view("TextDocument", "Summary", SUMMARY, &["$origin"])?];
    for side in [Side::A, Side::B] {
        let about = identity.look(side).entity(ABOUT);
        tabs.push(layout.view("TextDocument", identity.name_of(side), &about, &["$origin"])?);
    }
    layout.container(ContainerKind::Tabs, &tabs, &[])
}

/// Two pages of plots; plots and pages without data are left out.
fn right_side(layout: &mut Layout, identity: &PairIdentity) -> Result<Option<Child>, RerunError> {
    let mut motion = rows(layout, identity, &MOTION)?;
    motion.extend(overlays(layout, identity, &FRICTION)?);
    let more = rows(layout, identity, &MORE)?;
    let mut pages = Vec::new();
    for (name, rows) in [("How they differ", motion), ("More", more)] {
        if !rows.is_empty() {
            let page = parts::ContainerBlueprint::new(ContainerKind::Vertical)
                .with_display_name(Name(name.into()));
            pages.push(layout.contain(page, &rows)?);
        }
    }
    if pages.is_empty() {
        return Ok(None);
    }
    layout.container(ContainerKind::Tabs, &pages, &[]).map(Some)
}

/// A row per quantity: both curves, their difference, and its magnitude.
fn rows(
    layout: &mut Layout,
    identity: &PairIdentity,
    quantities: &[Quantity],
) -> Result<Vec<Child>, RerunError> {
    let mut rows = Vec::new();
    for quantity in quantities {
        let mut row: Vec<_> = overlay(layout, identity, quantity)?.into_iter().collect();
        row.extend(differences(layout, identity, quantity)?);
        if !row.is_empty() {
            rows.push(layout.container(ContainerKind::Horizontal, &row, &[])?);
        }
    }
    Ok(rows)
}

/// One row with the curves of several quantities, if there is any.
fn overlays(
    layout: &mut Layout,
    identity: &PairIdentity,
    quantities: &[Quantity],
) -> Result<Option<Child>, RerunError> {
    let mut row = Vec::new();
    for quantity in quantities {
        row.extend(overlay(layout, identity, quantity)?);
    }
    if row.is_empty() {
        return Ok(None);
    }
    layout
        .container(ContainerKind::Horizontal, &row, &[])
        .map(Some)
}

/// The curves of both runs.
fn overlay(
    layout: &mut Layout,
    identity: &PairIdentity,
    quantity: &Quantity,
) -> Result<Option<Child>, RerunError> {
    let mut contents = Vec::new();
    for side in [Side::A, Side::B] {
        let look = identity.look(side);
        let there = quantity.curves.iter();
        let there = there.filter(|entity| identity.run(side).has_some(&[entity]));
        contents.extend(there.map(|entity| look.entity(entity)));
    }
    let name = format!("{} ({})", quantity.name, quantity.unit);
    curves(layout, &name, &contents, quantity.legend)
}

/// The difference of the curves and its logarithm, if both runs have them.
fn differences(
    layout: &mut Layout,
    identity: &PairIdentity,
    quantity: &Quantity,
) -> Result<Vec<Child>, RerunError> {
    let Quantity { name, unit, .. } = quantity;
    let there = |has: &dyn Fn(&str) -> bool, look: Look| -> Vec<String> {
        let entities = quantity.differences.iter().filter(|entity| has(entity));
        entities.map(|entity| look.entity(entity)).collect()
    };
    let plain = there(
        &|entity| identity.has_difference_of(entity),
        Look::Difference,
    );
    let magnitude = there(&|entity| identity.has_magnitude_of(entity), Look::Magnitude);
    let plain = curves(layout, &format!("{name}: B − A ({unit})"), &plain, None)?;
    let magnitude = curves(layout, &format!("{name}: log₁₀ |B − A|"), &magnitude, None)?;
    Ok(plain.into_iter().chain(magnitude).collect())
}

/// A plot whose time axis moves with those of all others; none without contents.
fn curves(
    layout: &mut Layout,
    name: &str,
    contents: &[String],
    legend: Option<Corner2D>,
) -> Result<Option<Child>, RerunError> {
    if contents.is_empty() {
        return Ok(None);
    }
    let legend = match legend {
        Some(corner) => parts::PlotLegend::new().with_corner(corner),
        None => parts::PlotLegend::new().with_visible(false),
    };
    let view = time_series(layout, name, contents, &legend)?;
    let linked = parts::TimeAxis::new().with_link(components::LinkAxis::LinkToGlobal);
    layout.property(&view, "TimeAxis", &linked)?;
    Ok(Some(view))
}
