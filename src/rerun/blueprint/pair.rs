//! The layout for two runs that are compared: both tops on one table, and for each quantity both
//! curves, their difference, and how the difference grows.

use rerun::blueprint::components::Corner2D;
use rerun::components::Name;

use super::axis::{MIN_SPAN, axis_range};
use super::builder::{BlueprintLayout, Child, Messages, column, row, tabs};
use super::charts::{
    Chart, FRICTION_CONTRASTS, MORE_CONTRASTS, MOTION_CONTRASTS, RATE_CONTRASTS, TABLE_CONTRASTS,
    TRAVEL_CONTRASTS,
};
use super::corner::{EndedChart, corner_for};
use super::views::{
    SceneView, events, playback_speed, scene, set_time_range, time_panel, time_series, titled,
    window,
};
use crate::rerun::entity::{self, ABOUT, STAGE, SUMMARY};
use crate::rerun::identity::{Geometry, Playback};
use crate::rerun::pair::PairIdentity;
use crate::rerun::plots::Plots;
use crate::rerun::plots::curves::Curves;
use crate::rerun::role::Role;
use crate::telemetry::Topic;
use crate::telemetry::fields::{EVENTS, POSE};
use crate::telemetry::side::Side;

/// Shortest value axis of a difference, relative to the typical magnitude of the quantity: shorter ones would show the
/// errors of integration.
const MIN_DIFFERENCE: f64 = 1e-9;

/// Distance of the camera in each of two views next to each other, relative to that in a single view: the arrows must
/// fit into the narrower views.
const NARROW: f64 = 1.5;

/// The extent of a comparison that has ended.
pub(crate) struct Extent<'a> {
    /// Duration of the longer run, s.
    pub(crate) duration: f64,
    /// The values of both runs.
    pub(crate) runs: [&'a Plots; 2],
    /// The differences.
    pub(crate) differences: &'a Plots,
    /// The logarithms of the differences.
    pub(crate) logarithms: &'a Plots,
}

/// The messages of the layout; at the end of the comparison, those that change it to show the whole extent.
pub(crate) fn messages(identity: &PairIdentity, extent: Option<&Extent<'_>>) -> Messages {
    let mut layout = complete(identity, extent);
    if extent.is_some() {
        layout.remove_missing(&complete(identity, None));
    }
    layout.finish()
}

/// The layout of a comparison that runs, or that has ended with this extent.
fn complete(identity: &PairIdentity, extent: Option<&Extent<'_>>) -> BlueprintLayout {
    let store = identity.store();
    let mut layout = match extent {
        Some(_) => BlueprintLayout::changes(&store),
        None => BlueprintLayout::new(&store),
    };
    let left = left_side(&mut layout, identity);
    if extent.is_some() {
        // Without some charts the others have other numbers. They must not inherit properties.
        layout.start_new_parts();
    }
    let mut charts = Charts {
        layout: &mut layout,
        identity,
        extent,
    };
    let right = charts.pages();
    let speed = extent.map_or(1.0, |extent| playback_speed(extent.duration));
    let panel = time_panel(Playback::FromStart, speed);
    window(&mut layout, left, right, [38.0, 62.0], &panel);
    if let Some(extent) = extent {
        set_time_range(&mut layout, extent.duration);
    }
    layout
}

/// The scene, if there is one, and below it the summary and the events.
fn left_side(layout: &mut BlueprintLayout, identity: &PairIdentity) -> Child {
    let mut rows = Vec::new();
    let mut shares = Vec::new();
    if let Some(scene) = scenes(layout, identity) {
        rows.push(scene);
        shares.push(53.0);
    }
    rows.push(texts(layout, identity));
    shares.push(25.0);
    let runs = roles(identity, EVENTS);
    if !runs.is_empty() {
        let contents: Vec<_> = runs
            .iter()
            .map(|(role, _)| role.entity(entity::EVENTS))
            .collect();
        rows.push(events(layout, "Events", &contents));
        shares.push(22.0);
    }
    layout.contain(column(&shares), &rows)
}

/// Both tops in one view, if their pegs are fixed; otherwise in two, each of which travels with its top.
fn scenes(layout: &mut BlueprintLayout, identity: &PairIdentity) -> Option<Child> {
    let geometry = identity.common_geometry()?;
    let runs = roles(identity, POSE);
    if !geometry.is_free {
        let names = Side::BOTH.map(|side| titled_run(identity, side));
        return Some(scene_view(
            layout,
            &names.join(" · "),
            &runs,
            &geometry,
            STAGE.to_owned(),
            1.0,
        ));
    }
    // No view can travel with two tops that travel apart.
    let mut views = Vec::new();
    for run in runs {
        let (role, own) = &run;
        let Role::Compared(side) = role else {
            continue;
        };
        let name = format!("{}: {}", side.name(), identity.name_of(*side));
        let origin = role.scene_origin(own.is_free);
        views.push(scene_view(layout, &name, &[run], &geometry, origin, NARROW));
    }
    layout.contain_any(row(&[]), &views)
}

/// The title of a run in a scene of both, short enough for names with changed keys. The summary says more of the colours.
fn titled_run(identity: &PairIdentity, side: Side) -> String {
    let name = identity.name_of(side);
    match side {
        Side::A => format!("A (blue): {name}"),
        Side::B => format!("B (orange): {name}"),
    }
}

/// A view of the scene of some runs on the common table.
fn scene_view(
    layout: &mut BlueprintLayout,
    name: &str,
    runs: &[(Role, &Geometry)],
    geometry: &Geometry,
    origin: String,
    distance: f64,
) -> Child {
    let mut contents = vec![format!("{STAGE}/**")];
    contents.extend(runs.iter().map(|(role, _)| role.entity("scene/**")));
    let stage = SceneView {
        name,
        contents: &contents,
        runs,
        geometry,
        origin,
        distance,
    };
    scene(layout, &stage)
}

/// The looks and geometries of the runs that have a topic.
fn roles(identity: &PairIdentity, topic: Topic) -> Vec<(Role, &Geometry)> {
    Side::BOTH
        .into_iter()
        .filter(|side| identity.run(*side).has(topic))
        .map(|side| (Role::Compared(side), &identity.run(side).geometry))
        .collect()
}

/// Tabs with the summary and the run descriptions.
fn texts(layout: &mut BlueprintLayout, identity: &PairIdentity) -> Child {
    let mut pages = vec![layout.view("TextDocument", "Summary", SUMMARY, &["$origin"])];
    for side in Side::BOTH {
        let about = Role::Compared(side).entity(ABOUT);
        pages.push(layout.view("TextDocument", identity.name_of(side), &about, &["$origin"]));
    }
    layout.contain(tabs(), &pages)
}

/// The charts of a comparison.
struct Charts<'a> {
    layout: &'a mut BlueprintLayout,
    identity: &'a PairIdentity,
    extent: Option<&'a Extent<'a>>,
}

impl Charts<'_> {
    /// Pages of charts. Those without data are left out.
    fn pages(&mut self) -> Option<Child> {
        let is_free = self.identity.is_any_free();
        let motion = if is_free {
            self.rows(&TRAVEL_CONTRASTS)
        } else {
            self.rows(&MOTION_CONTRASTS)
        };
        let mut named_pages = vec![("Differences", motion)];
        if is_free {
            named_pages.push(("On the table", self.rows(&TABLE_CONTRASTS)));
            named_pages.push(("Rates", self.rows(&RATE_CONTRASTS)));
        }
        named_pages.push(("Friction", self.rows(&FRICTION_CONTRASTS)));
        named_pages.push(("More", self.rows(&MORE_CONTRASTS)));
        let mut pages = Vec::new();
        for (name, rows) in named_pages {
            let (rows, shares): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
            let page = column(&shares).with_display_name(Name(name.into()));
            pages.extend(self.layout.contain_any(page, &rows));
        }
        self.layout.contain_any(tabs(), &pages)
    }

    /// A row of charts per quantity: both curves, their difference, and the magnitude of that. Each row has a share of the
    /// height.
    fn rows(&mut self, contrasts: &[Chart]) -> Vec<(Child, f32)> {
        let mut rows = Vec::new();
        for contrast in contrasts {
            let overlay = self.overlay(contrast, rows.is_empty());
            let mut charts: Vec<_> = overlay.into_iter().collect();
            charts.extend(self.difference(contrast));
            charts.extend(self.magnitude(contrast));
            let row = self.layout.contain_any(row(&[]), &charts);
            rows.extend(row.map(|row| (row, height(contrast))));
        }
        rows
    }

    /// The curves of both runs. The first chart of a page explains the colours, which mean the same in all.
    fn overlay(&mut self, contrast: &Chart, is_first: bool) -> Option<Child> {
        let identity = self.identity;
        let contents = Side::BOTH.map(|side| {
            entities(
                contrast.curves,
                |curves| curves.is_in(identity.run(side)),
                &Role::Compared(side),
            )
        });
        let range = self
            .extent
            .and_then(|extent| self.range(contrast.curves, &extent.runs, MIN_SPAN));
        let chart = self.extent.map(|extent| EndedChart {
            curves: contrast.curves,
            runs: &extent.runs,
            range,
            duration: extent.duration,
        });
        let has_legend = is_first || has_parts(contrast.curves);
        let legend = has_legend.then(|| corner_for(chart.as_ref()));
        self.curves(&contrast.title(), &contents.concat(), legend, range)
    }

    /// The difference of the curves, if both runs have them.
    fn difference(&mut self, contrast: &Chart) -> Option<Child> {
        let plots = contrast.differences;
        let contents = entities(
            plots,
            |curves| self.identity.has_difference_of(curves),
            &Role::Difference,
        );
        let name = if self.is_without_difference(plots) {
            format!("{}: no difference", contrast.name)
        } else {
            titled(
                &format!("{}: B − A", contrast.name),
                contrast.curves[0].unit(),
            )
        };
        let range = self
            .extent
            .and_then(|extent| self.range(plots, &[extent.differences], MIN_DIFFERENCE));
        let legend = has_parts(plots).then_some(Corner2D::RightTop);
        self.curves(&name, &contents, legend, range)
    }

    /// Whether the runs are equal in these plots as long as both run.
    fn is_without_difference(&self, plots: &[Curves]) -> bool {
        let Some(extent) = self.extent else {
            return false;
        };
        let mut ranges = plots
            .iter()
            .flat_map(|plot| extent.differences.ranges(*plot))
            .peekable();
        ranges.peek().is_some() && ranges.all(|(_, range)| range == [0.0; 2])
    }

    /// The logarithm of the difference, if both runs have the curves and they are not equal: zero has no logarithm.
    fn magnitude(&mut self, contrast: &Chart) -> Option<Child> {
        if self.is_without_difference(contrast.differences) {
            return None;
        }
        let contents = entities(
            contrast.differences,
            |curves| self.identity.has_magnitude_of(curves),
            &Role::Magnitude,
        );
        let name = format!("{}: log₁₀ |B − A|", contrast.name);
        let range = self
            .extent
            .and_then(|extent| self.range(contrast.differences, &[extent.logarithms], 0.0));
        self.curves(&name, &contents, None, range)
    }

    /// The range of a chart of these values, at least `least` times as long as the quantity's typical magnitude.
    fn range(&self, plots: &[Curves], values: &[&Plots], least: f64) -> Option<[f64; 2]> {
        axis_range(plots, values, &self.identity.a.magnitudes, least)
    }

    /// A chart whose time axis moves with those of all others, if it has contents.
    fn curves(
        &mut self,
        name: &str,
        contents: &[String],
        legend: Option<Corner2D>,
        range: Option<[f64; 2]>,
    ) -> Option<Child> {
        (!contents.is_empty()).then(|| time_series(self.layout, name, contents, legend, range))
    }
}

/// The height of a row of charts relative to others: a legend that names three numbers of both runs needs more room.
fn height(contrast: &Chart) -> f32 {
    let numbers: usize = contrast
        .curves
        .iter()
        .map(|curves| curves.quantities().len())
        .sum();
    if numbers > 2 { 1.35 } else { 1.0 }
}

/// Whether a chart shows more than one number of a run, which a legend names. Nutation means lie on the curves that they
/// belong to.
fn has_parts(curves: &[Curves]) -> bool {
    let numbers = curves
        .iter()
        .filter(|curves| !curves.are_means())
        .flat_map(|curves| curves.quantities());
    numbers.count() > 1
}

/// The entities of the existing curves.
fn entities(curves: &[Curves], exists: impl Fn(Curves) -> bool, role: &Role) -> Vec<String> {
    curves
        .iter()
        .filter(|curves| exists(**curves))
        .map(|curves| role.entity(&curves.path()))
        .collect()
}
