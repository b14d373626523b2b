//! The layout for one run: the scene at the left with the events below, the main charts at the right.

use rerun::StoreId;
use rerun::blueprint::components::{ContainerKind, Corner2D, PanelState};
use rerun::components::Name;
use rerun::external::re_sdk_types::blueprint::archetypes as parts;

use super::axis::{MIN_SPAN, axis_range};
use super::builder::{BlueprintLayout, Child, Messages, column, row, tabs};
use super::charts::{Chart, MORE, RATES, RISE, TABLE, TERMS, TRAVEL};
use super::corner::{EndedChart, corner_for};
use super::views::{
    SceneView, events, hodograph, playback_speed, regimes, scene, set_time_range, time_panel,
    time_series, why, window,
};
use crate::rerun::entity::{self, ABOUT, EACH_EVENT, FIT_REPORT, LEGEND, STAGE};
use crate::rerun::identity::magnitude::Magnitudes;
use crate::rerun::identity::{Identity, Playback};
use crate::rerun::measurement::page;
use crate::rerun::plots::Plots;
use crate::rerun::role::Role;
use crate::rerun::scene::has_hodograph;
use crate::rerun::streams::why::has_why;
use crate::telemetry::fields::{CONTACT, EVENTS, POSE};
use crate::telemetry::proportions::Proportions;

/// The messages of the layout.
pub(crate) fn messages(identity: &Identity, playback: Playback) -> Messages {
    first(identity, playback).finish()
}

/// The layout until the run has ended.
fn first(identity: &Identity, playback: Playback) -> BlueprintLayout {
    let mut layout = BlueprintLayout::new(&identity.store());
    complete(&mut layout, identity, None, &time_panel(playback, 1.0));
    layout
}

/// The messages of a layout that shows only what is said about a run.
pub(crate) fn only_about(store: &StoreId) -> Messages {
    let mut layout = BlueprintLayout::new(store);
    let about = layout.view("TextDocument", "About this run", ABOUT, &["$origin"]);
    let page = layout.contain(tabs(), &[about]);
    // Without a run there is no time.
    let panel = parts::TimePanelBlueprint::new().with_state(PanelState::Hidden);
    window(&mut layout, page, None, [1.0, 1.0], &panel);
    layout.finish()
}

/// A run that has ended.
pub(crate) struct EndedRun<'a> {
    /// The duration, s.
    pub(crate) duration: f64,
    /// The ranges of its values.
    pub(crate) plots: &'a Plots,
    /// Whether its description begins with the reason for the motion.
    pub(crate) has_story: bool,
}

/// The messages that change the layout when the run has ended: it plays the run from the start, and its charts fit the
/// values.
pub(crate) fn messages_at_end(identity: &Identity, ended: &EndedRun<'_>) -> Messages {
    let mut layout = BlueprintLayout::changes(&identity.store());
    let panel = time_panel(Playback::FromStart, playback_speed(ended.duration));
    complete(&mut layout, identity, Some(ended), &panel);
    layout.remove_missing(&first(identity, identity.playback));
    layout.finish()
}

/// Fills the window with the layout of a run, which fits its values if it has ended.
fn complete(
    layout: &mut BlueprintLayout,
    identity: &Identity,
    ended: Option<&EndedRun<'_>>,
    panel: &parts::TimePanelBlueprint,
) {
    let left = left_side(layout, identity, ended.is_some_and(|ended| ended.has_story));
    if ended.is_some() {
        // Only charts move. The viewer would place the camera of a new scene differently.
        layout.start_new_parts();
    }
    let right = right_side(layout, identity, ended);
    // Without a scene the left side has only text.
    let shares = if identity.has(POSE) {
        [44.0, 56.0]
    } else {
        [25.0, 75.0]
    };
    window(layout, left, right, shares, panel);
    if let Some(ended) = ended {
        set_time_range(layout, ended.duration);
    }
}

/// The scene, if there is one, and below it the events and the description, which comes first if it has the reason for
/// the motion.
fn left_side(layout: &mut BlueprintLayout, identity: &Identity, has_story: bool) -> Child {
    let about = layout.view("TextDocument", "About this run", ABOUT, &["$origin"]);
    let mut pages = vec![about];
    if identity.has(POSE) {
        pages.push(layout.view("TextDocument", "Legend", LEGEND, &["$origin"]));
    }
    if identity.has(EVENTS) {
        let place = usize::from(has_story);
        for (name, entity) in [("Each event", EACH_EVENT), ("Events", entity::EVENTS)] {
            let contents = [Role::Alone.entity(entity)];
            let log = events(layout, name, &contents);
            // The second one takes the place of the first: `Events` comes before `Each event`.
            pages.insert(place, log);
        }
    }
    if identity.measurement.is_some() {
        let report = layout.view("TextDocument", "Report", FIT_REPORT, &["$origin"]);
        pages.insert(0, report);
    }
    let words = layout.contain(tabs(), &pages);
    if !identity.has(POSE) {
        return words;
    }
    let whole = [format!("{STAGE}/**")];
    let stage = SceneView {
        name: &identity.title,
        contents: &whole,
        runs: &[(Role::Alone, &identity.geometry)],
        geometry: &identity.geometry,
        origin: Role::Alone.scene_origin(identity.geometry.is_free),
        distance: 1.0,
    };
    let scene = scene(layout, &stage);
    let pictures = if has_hodograph(identity) {
        let above = hodograph(layout, &identity.geometry);
        layout.contain(row(&[64.0, 36.0]), &[scene, above])
    } else {
        scene
    };
    // A report is longer than a list of events.
    let heights = match identity.measurement {
        Some(_) => [52.0, 48.0],
        None => [66.0, 34.0],
    };
    layout.contain(column(&heights), &[pictures, words])
}

/// The first page: of a tippe top, and of others.
const INVERSION_PAGE: &str = "How it inverts";
const RISE_PAGE: &str = "Rise";
/// The page of a peg on the table.
const TABLE_PAGE: &str = "On the table";

/// Whether a run has regimes worth a view.
pub(crate) fn has_regimes(identity: &Identity) -> bool {
    identity.geometry.is_free && identity.has(CONTACT)
}

/// A page of charts.
struct RunPage {
    name: &'static str,
    /// Number of charts in a row.
    columns: u32,
    charts: Vec<&'static Chart>,
}

/// The pages of charts of a run. The charts of the first page that are constant give their places to charts of other
/// pages that are not, and move to the last of these. The terms of the accelerations stay together.
fn pages(identity: &Identity, plots: Option<&Plots>) -> Vec<RunPage> {
    let is_ball = Proportions::new(&identity.geometry.top).is_ball;
    let is_free = identity.geometry.is_free;
    let mut pages = vec![match (is_free, is_ball) {
        (false, _) => page(RISE_PAGE, &RISE, identity),
        (true, false) => page(RISE_PAGE, &TRAVEL, identity),
        (true, true) => page(INVERSION_PAGE, &TRAVEL, identity),
    }];
    if is_free {
        pages.push(page(TABLE_PAGE, &TABLE, identity));
        pages.push(page("Rates", &RATES, identity));
    }
    pages.push(page("More", &MORE, identity));
    if let Some(plots) = plots {
        replace_constant_charts(&mut pages, |chart| {
            is_constant(chart, plots, &identity.magnitudes)
        });
    }
    pages.push(RunPage {
        columns: 1,
        ..page("Terms", &TERMS, identity)
    });
    pages
}

/// The page of these charts, without those that have no data.
fn page(name: &'static str, charts: &'static [Chart], identity: &Identity) -> RunPage {
    RunPage {
        name,
        columns: 2,
        charts: charts
            .iter()
            .filter(|chart| chart.curves.iter().any(|curves| curves.is_in(identity)))
            .collect(),
    }
}

/// Exchanges the constant charts of the first page for others, as long as there are any.
fn replace_constant_charts(pages: &mut [RunPage], is_constant: impl Fn(&Chart) -> bool) {
    let Some((first, others)) = pages.split_first_mut() else {
        return;
    };
    let mut moved = Vec::new();
    for place in &mut first.charts {
        if !is_constant(place) {
            continue;
        }
        for page in &mut *others {
            if let Some(at) = page.charts.iter().position(|chart| !is_constant(chart)) {
                moved.push(std::mem::replace(place, page.charts.remove(at)));
                break;
            }
        }
    }
    if let Some(last) = others.last_mut() {
        last.charts.extend(moved);
    }
}

/// Variations of a quantity below this fraction of its magnitude are rounding errors.
const ROUNDING: f64 = 1e-9;

/// Whether all numbers of a chart are constant.
fn is_constant(chart: &Chart, plots: &Plots, magnitudes: &Magnitudes) -> bool {
    chart.curves.iter().all(|curves| {
        plots.ranges(*curves).all(|(quantity, [low, high])| {
            let greatest = low.abs().max(high.abs());
            let variation = if curves.includes_zero() {
                greatest
            } else {
                high - low
            };
            variation <= ROUNDING * magnitudes.typical(quantity).max(greatest)
        })
    })
}

/// Pages of charts, with axes and legends that fit the values of a run that has ended.
fn right_side(
    layout: &mut BlueprintLayout,
    identity: &Identity,
    ended: Option<&EndedRun<'_>>,
) -> Option<Child> {
    let plots = ended.map(|ended| ended.plots);
    let mut grids = Vec::new();
    if let Some(measurement) = &identity.measurement {
        grids.push(page::page(layout, measurement, plots));
    }
    for page in pages(identity, plots) {
        let mut views = Vec::new();
        for chart in page.charts {
            let contents: Vec<_> = chart.curves.iter().map(|curves| curves.path()).collect();
            let range = value_range(chart, identity, plots);
            let corner = legend(chart, identity, ended, range);
            views.push(time_series(
                layout,
                &chart.title(),
                &contents,
                corner,
                range,
            ));
        }
        if page.name == TABLE_PAGE && has_regimes(identity) {
            views.push(regimes(layout));
        }
        let grid = parts::ContainerBlueprint::new(ContainerKind::Grid)
            .with_grid_columns(page.columns)
            .with_display_name(Name(page.name.into()));
        grids.extend(layout.contain_any(grid, &views));
        if [RISE_PAGE, INVERSION_PAGE].contains(&page.name) && has_why(identity) {
            grids.push(why(layout, &identity.geometry));
        }
    }
    layout.contain_any(tabs(), &grids)
}

/// The range of a chart's axis; `None` if the viewer's choice is as good.
fn value_range(chart: &Chart, identity: &Identity, plots: Option<&Plots>) -> Option<[f64; 2]> {
    axis_range(chart.curves, &[plots?], &identity.magnitudes, MIN_SPAN)
}

/// The corner of a chart's legend, where the curves of a run that has ended are not. The title names a single curve.
fn legend(
    chart: &Chart,
    identity: &Identity,
    ended: Option<&EndedRun<'_>>,
    range: Option<[f64; 2]>,
) -> Option<Corner2D> {
    let shown = chart.curves.iter().filter(|curves| curves.is_in(identity));
    let lines = shown.flat_map(|curves| curves.quantities()).count();
    let chart = ended.map(|ended| EndedChart {
        curves: chart.curves,
        runs: std::slice::from_ref(&ended.plots),
        range,
        duration: ended.duration,
    });
    (lines > 1).then(|| corner_for(chart.as_ref()))
}

#[cfg(test)]
mod tests {
    use super::super::charts::GAP_NAME;
    use super::*;
    use crate::rerun::identity::Geometry;
    use crate::rerun::output::{Destinations, Output};
    use crate::rerun::plots::curves::Curves;
    use crate::run::scenario::{Preset, Scenario};
    use crate::run::simulation::Simulation;
    use crate::telemetry::arrows::snapshot::SnapshotReader;
    use crate::telemetry::fields::energy;
    use crate::telemetry::{Telemetry, TelemetryError, Topic, Topics};

    /// The identity and the plots of the first second of a preset.
    fn plots(preset: &str) -> (Identity, Plots) {
        let mut values = Preset::find(preset).unwrap().values().unwrap();
        values.set("stop.duration", "1").unwrap();
        let scenario = Scenario::new(values).unwrap();
        let topics: Vec<_> = Topic::all_with(scenario.model.support).collect();
        let identity = Identity::new("test", &scenario, topics, Playback::FromStart);
        let mut output = Output::open(identity.store(), Destinations::default());
        let mut plots = Plots::new(|plot| identity.has(plot.topic()), &Role::Alone, &mut output)
            .with_derived(&identity, &Role::Alone, &mut output);
        let Geometry { top, is_free, .. } = identity.geometry;
        let mut snapshots = SnapshotReader::new(top, is_free, |topic| identity.has(topic));
        let mut telemetry = Telemetry::with_topics(&Topics::All);
        for record in Simulation::new(&scenario).unwrap() {
            let written = telemetry.messages(&record.unwrap(), |message| {
                plots.write(message, Some, &mut output);
                if let Some(snapshot) = snapshots.take(message) {
                    plots.write_snapshot(snapshot, &mut output);
                }
                Ok::<_, TelemetryError>(())
            });
            written.unwrap();
        }
        (identity, plots)
    }

    fn names(page: &RunPage) -> Vec<&str> {
        page.charts.iter().map(|chart| chart.name).collect()
    }

    #[test]
    fn moves_constant_charts_to_the_last_page() {
        let (identity, plots) = plots("free-viscous");
        let before = pages(&identity, None);
        let after = pages(&identity, Some(&plots));
        assert!(names(&before[0]).contains(&GAP_NAME));
        assert!(!names(&after[0]).contains(&GAP_NAME), "the peg never hops");
        let more = after.iter().find(|page| page.name == "More").unwrap();
        assert!(names(more).contains(&GAP_NAME));
        assert_eq!(before[0].charts.len(), after[0].charts.len());
        let count = |pages: &[RunPage]| pages.iter().map(|page| page.charts.len()).sum::<usize>();
        assert_eq!(count(&before), count(&after), "no chart is lost");
    }

    #[test]
    fn narrow_charts_have_short_legends() {
        for preset in ["paper", "tippe-top"] {
            let (identity, plots) = plots(preset);
            for page in pages(&identity, Some(&plots)) {
                for chart in &page.charts {
                    let lines: usize = chart
                        .curves
                        .iter()
                        .map(|curves| curves.quantities().len())
                        .sum();
                    assert!(lines <= 4 || page.columns == 1, "{}", chart.name);
                }
            }
        }
    }

    #[test]
    fn keeps_charts_that_vary() {
        let (identity, plots) = plots("paper");
        let before = pages(&identity, None);
        let after = pages(&identity, Some(&plots));
        assert_eq!(names(&before[0]), names(&after[0]));
    }

    #[test]
    fn axes_do_not_magnify_rounding_errors() {
        let (identity, plots) = plots("frictionless");
        let (_, [low, high]) = plots
            .ranges(Curves::Field(energy::TOTAL.plot()))
            .last()
            .unwrap();
        assert!(high - low < 1e-12, "energy is conserved");
        let torque = &MORE[0];
        assert!(is_constant(torque, &plots, &identity.magnitudes));
        let [low, high] =
            axis_range(torque.curves, &[&plots], &identity.magnitudes, MIN_SPAN).unwrap();
        assert!(high - low > 0.0);
        let (_, values) = plots.ranges(RISE[1].curves[0]).next().unwrap();
        let [low, high] =
            axis_range(RISE[1].curves, &[&plots], &identity.magnitudes, MIN_SPAN).unwrap_or(values);
        assert!(
            high - low < 2.0 * (values[1] - values[0]),
            "the top nutates"
        );
    }
}
