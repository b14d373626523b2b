//! The layout for two runs that are compared: both tops on one table, and for each quantity both
//! curves, their difference, and how the difference grows.

use rerun::blueprint::components::{Corner2D, LinkAxis};
use rerun::blueprint::datatypes::TextLogColumnKind;
use rerun::components::Name;

use super::builder::{Child, Layout, Messages, column, row, tabs};
use super::charts::{
    Chart, FRICTION_CONTRASTS, MORE_CONTRASTS, MOTION_CONTRASTS, RATE_CONTRASTS, TABLE_CONTRASTS,
    TRAVEL_CONTRASTS,
};
use super::views::{
    Stage, bound, events, scene, speed, target, time_panel, time_series, titled, window,
};
use crate::physics::math;
use crate::rerun::entity::{self, ABOUT, STAGE, SUMMARY};
use crate::rerun::identity::{Geometry, Playback};
use crate::rerun::look::Look;
use crate::rerun::pair::PairIdentity;
use crate::rerun::plots::Plots;
use crate::rerun::scale::power_of_ten;
use crate::telemetry::Topic;
use crate::telemetry::fields::{EVENTS, POSE, Plot};
use crate::telemetry::side::Side;

/// Distance of the camera in each of two views next to each other, relative to that in a single view: the arrows must
/// fit into the narrower views.
const NARROW: f64 = 1.5;

/// The extent of a comparison that has ended.
pub(crate) struct Extent<'a> {
    /// Duration of the longer run, s.
    pub(crate) duration: f64,
    /// The least and the greatest difference of a plot.
    pub(crate) differences: &'a Plots,
}

/// The messages of the layout; at the end of the comparison, those that change it to show the whole extent.
pub(crate) fn messages(identity: &PairIdentity, extent: Option<&Extent<'_>>) -> Messages {
    let store = identity.store();
    let mut layout = match extent {
        Some(_) => Layout::changes(&store),
        None => Layout::new(&store),
    };
    let left = left_side(&mut layout, identity);
    let mut charts = Charts {
        layout: &mut layout,
        identity,
        extent,
    };
    let right = charts.pages();
    let speed = extent.map_or(1.0, |extent| speed(extent.duration));
    let panel = time_panel(Playback::FromStart, speed);
    window(layout, left, right, [38.0, 62.0], true, &panel)
}

/// The scene, if there is one, and below it the summary and the events.
fn left_side(layout: &mut Layout, identity: &PairIdentity) -> Child {
    let mut rows = Vec::new();
    let mut shares = Vec::new();
    if let Some(scene) = scenes(layout, identity) {
        rows.push(scene);
        shares.push(53.0);
    }
    rows.push(words(layout, identity));
    shares.push(25.0);
    let runs = looks(identity, EVENTS);
    if !runs.is_empty() {
        let contents: Vec<_> = runs
            .iter()
            .map(|(look, _)| look.entity(entity::EVENTS))
            .collect();
        let kinds = [TextLogColumnKind::LogLevel, TextLogColumnKind::Body];
        rows.push(events(layout, "Events", &contents, &kinds));
        shares.push(22.0);
    }
    layout.contain(column(&shares), &rows)
}

/// Both tops in one view, if their pegs are fixed; otherwise in two, each with a camera that follows its top.
fn scenes(layout: &mut Layout, identity: &PairIdentity) -> Option<Child> {
    let geometry = identity.stage()?;
    let runs = looks(identity, POSE);
    if !geometry.is_free {
        let names = [Side::A, Side::B].map(|side| titled_run(identity, side));
        return Some(stage(
            layout,
            &names.join(" · "),
            &runs,
            &geometry,
            None,
            1.0,
        ));
    }
    let mut views = Vec::new();
    for run in runs {
        let (look, own) = &run;
        let Look::Compared(side, _) = look else {
            continue;
        };
        let name = titled_run(identity, *side);
        let target = target(look, own);
        views.push(stage(layout, &name, &[run], &geometry, target, NARROW));
    }
    layout.contain_any(row(&[]), &views)
}

/// The title of a run's scene.
fn titled_run(identity: &PairIdentity, side: Side) -> String {
    let name = identity.name_of(side);
    match side {
        Side::A => format!("A: {name} (blue, solid)"),
        Side::B => format!("B: {name} (orange, translucent)"),
    }
}

/// A view of the scene of some runs on the common table.
fn stage(
    layout: &mut Layout,
    name: &str,
    runs: &[(Look, &Geometry)],
    geometry: &Geometry,
    target: Option<String>,
    distance: f64,
) -> Child {
    let mut contents = vec![format!("{STAGE}/**")];
    contents.extend(runs.iter().map(|(look, _)| look.entity("scene/**")));
    let stage = Stage {
        name,
        contents: &contents,
        runs,
        geometry,
        target,
        distance,
    };
    scene(layout, &stage)
}

/// The looks and geometries of the runs that have a topic.
fn looks(identity: &PairIdentity, topic: Topic) -> Vec<(Look, &Geometry)> {
    let sides = [Side::A, Side::B].into_iter();
    let sides = sides.filter(|side| identity.run(*side).has(topic));
    let of = |side| (identity.look(side), &identity.run(side).geometry);
    sides.map(of).collect()
}

/// Tabs with the summary and the run descriptions.
fn words(layout: &mut Layout, identity: &PairIdentity) -> Child {
    let mut pages = vec![layout.view("TextDocument", "Summary", SUMMARY, &["$origin"])];
    for side in [Side::A, Side::B] {
        let about = identity.look(side).entity(ABOUT);
        pages.push(layout.view("TextDocument", identity.name_of(side), &about, &["$origin"]));
    }
    layout.contain(tabs(), &pages)
}

/// The charts of a comparison.
struct Charts<'a> {
    layout: &'a mut Layout,
    identity: &'a PairIdentity,
    extent: Option<&'a Extent<'a>>,
}

impl Charts<'_> {
    /// Pages of charts. Those without data are left out.
    fn pages(&mut self) -> Option<Child> {
        let is_free = self.identity.is_any_free();
        let mut motion = if is_free {
            self.rows(&TRAVEL_CONTRASTS)
        } else {
            self.rows(&MOTION_CONTRASTS)
        };
        let friction = FRICTION_CONTRASTS.iter();
        let friction: Vec<_> = friction.filter_map(|chart| self.overlay(chart)).collect();
        motion.extend(self.layout.contain_any(row(&[]), &friction));
        let mut all = vec![("Differences", motion)];
        if is_free {
            all.push(("On the table", self.rows(&TABLE_CONTRASTS)));
            all.push(("Rates", self.rows(&RATE_CONTRASTS)));
        }
        all.push(("More", self.rows(&MORE_CONTRASTS)));
        let mut pages = Vec::new();
        for (name, rows) in all {
            let page = column(&[]).with_display_name(Name(name.into()));
            pages.extend(self.layout.contain_any(page, &rows));
        }
        self.layout.contain_any(tabs(), &pages)
    }

    /// A row of charts per quantity: both curves, their difference, and the magnitude of that.
    fn rows(&mut self, contrasts: &[Chart]) -> Vec<Child> {
        let mut rows = Vec::new();
        for contrast in contrasts {
            let mut charts: Vec<_> = self.overlay(contrast).into_iter().collect();
            charts.extend(self.difference(contrast));
            charts.extend(self.magnitude(contrast));
            rows.extend(self.layout.contain_any(row(&[]), &charts));
        }
        rows
    }

    /// The curves of both runs.
    fn overlay(&mut self, contrast: &Chart) -> Option<Child> {
        let identity = self.identity;
        let contents = [Side::A, Side::B].map(|side| {
            let is_there = |plot: Plot| identity.run(side).has(plot.topic());
            entities(contrast.plots, is_there, &identity.look(side))
        });
        let name = titled(contrast.name, contrast.plots[0].unit());
        self.curves(&name, &contents.concat(), contrast.legend)
    }

    /// The difference of the curves, if both runs have them.
    fn difference(&mut self, contrast: &Chart) -> Option<Child> {
        let plots = contrast.differences;
        let is_there = |plot| self.identity.has_difference_of(plot);
        let contents = entities(plots, is_there, &Look::Difference);
        let name = format!("{}: B − A", contrast.name);
        let name = titled(&name, contrast.plots[0].unit());
        let view = self.curves(&name, &contents, None)?;
        if let Some(extent) = self.extent {
            let whole = plots
                .iter()
                .flat_map(|plot| extent.differences.ranges(*plot))
                .map(|(_, range)| range)
                .reduce(|[low, high], [least, most]| [low.min(least), high.max(most)]);
            if let Some(range) = whole.and_then(with_ticks) {
                bound(self.layout, &view, range);
            }
        }
        Some(view)
    }

    /// The logarithm of the difference, if both runs have the curves.
    fn magnitude(&mut self, contrast: &Chart) -> Option<Child> {
        let is_there = |plot| self.identity.has_magnitude_of(plot);
        let contents = entities(contrast.differences, is_there, &Look::Magnitude);
        let name = format!("{}: log₁₀ |B − A|", contrast.name);
        self.curves(&name, &contents, None)
    }

    /// A chart whose time axis moves with those of all others, if it has contents.
    fn curves(
        &mut self,
        name: &str,
        contents: &[String],
        legend: Option<Corner2D>,
    ) -> Option<Child> {
        let link = LinkAxis::LinkToGlobal;
        (!contents.is_empty()).then(|| time_series(self.layout, name, contents, legend, link))
    }
}

/// The entities of the existing plots.
fn entities(plots: &[Plot], is_there: impl Fn(Plot) -> bool, look: &Look) -> Vec<String> {
    let plots = plots.iter().filter(|plot| is_there(**plot));
    plots.map(|plot| look.entity(&plot.to_string())).collect()
}

/// Maximum number of labelled ticks of a small chart.
const MOST_TICKS: f64 = 7.0;

/// Ranges below this fraction of the values are rounding errors.
const SMALLEST_SPAN: f64 = 1e-12;

/// A range that contains these values and at least three labelled ticks; `None` if the values are equal.
fn with_ticks([low, high]: [f64; 2]) -> Option<[f64; 2]> {
    let size = high - low;
    let is_rounding = size <= SMALLEST_SPAN * low.abs().max(high.abs());
    if is_rounding || !size.is_finite() {
        return None;
    }
    let step = power_of_ten(math::log10(size / MOST_TICKS).ceil());
    let air = 0.05 * size;
    let [mut first, mut last] = [(low / step).ceil(), (high / step).floor()];
    while last - first < 2.0 {
        if high / step - last > first - low / step {
            last += 1.0;
        } else {
            first -= 1.0;
        }
    }
    Some([(first * step).min(low) - air, (last * step).max(high) + air])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_range_has_three_ticks(low in -1e3..1e3, size in 1e-9..1e3) {
            let [least, most] = with_ticks([low, low + size]).unwrap();
            prop_assert!(least <= low && low + size <= most);
            let step = power_of_ten(math::log10(size / MOST_TICKS).ceil());
            let ticks = (most / step).floor() - (least / step).ceil() + 1.0;
            prop_assert!((3.0..=MOST_TICKS + 3.0).contains(&ticks), "{ticks} from {least} to {most}");
        }
    }

    #[test]
    fn equal_values_have_no_range() {
        assert_eq!(with_ticks([1.0, 1.0]), None);
        assert_eq!(with_ticks([1.0, 1.0_f64.next_up()]), None);
        assert_eq!(with_ticks([0.0, 0.0]), None);
        assert_eq!(with_ticks([f64::INFINITY, f64::NEG_INFINITY]), None);
    }
}
