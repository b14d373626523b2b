//! The figures over time.

use super::looks::{self, Looks, PALE, SHADE};
use super::run::Run;
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::frame::{Band, Quantity};
use crate::figures::plot::legend::Entry;
use crate::figures::plot::page::{Curve, Page, Panel};
use crate::figures::plot::range::{extremes, overlap};
use crate::figures::plot::shape::{Point, Stroke};
use crate::figures::plot::text::Text;
use crate::telemetry::fields::{
    NumberField, acceleration as terms_of, contact, energy as energies, free_peg, nutation,
    precession as rates, state, torque as torques,
};

/// Time, as an axis label.
const TIME: Quantity = Quantity::new("*t*", "s");

/// The paper's figure 2: the inclination and the rates with their averages over nutations.
pub(super) fn motion(runs: &[&Run], width: f64) -> Drawing {
    let panels = [
        ("*θ*", state::THETA, nutation::THETA_MEAN),
        ("*θ\u{307}*", state::THETA_DOT, nutation::THETA_DOT_MEAN),
        ("*φ\u{307}*", state::PHI_DOT, nutation::PHI_DOT_MEAN),
        ("*ψ\u{307}*", state::PSI_DOT, nutation::PSI_DOT_MEAN),
    ];
    let mut legend = motion_legend(runs);
    legend.extend(note(runs, &panels.map(|(_, field, _)| field)));
    let panels = panels.map(|(symbol, field, mean)| {
        let mut panel = Panel::new(symbol, field.unit());
        // Near the vertical, φ̇ and ψ̇ diverge.
        panel.is_singular = [state::PHI_DOT, state::PSI_DOT].contains(&field);
        motions(&mut panel, runs, field);
        averages(&mut panel, runs, field, mean);
        panel
    });
    page(legend, panels.into()).draw(width)
}

/// The note of runs whose samples are too few, and which don't record the region in which some fields nutate either.
fn note(runs: &[&Run], fields: &[NumberField]) -> Option<Entry> {
    let is_without = |run: &&Run| fields.iter().any(|field| run.envelope(*field).is_none());
    let without: Vec<_> = runs.iter().copied().filter(is_without).collect();
    looks::note(&without)
}

/// Adds a curve of each run to a panel.
fn curves(
    panel: &mut Panel,
    runs: &[&Run],
    meaning: &str,
    points: impl Fn(&Run) -> Vec<Point>,
    stroke: impl Fn(usize) -> Stroke,
) {
    for (index, run) in runs.iter().enumerate() {
        let meaning = format!("{}: {meaning}", run.name);
        panel.curve(meaning, points(run), stroke(index));
    }
}

/// The curve of each run, or its nutation envelope if the sampling is too coarse.
fn motions(panel: &mut Panel, runs: &[&Run], field: NumberField) {
    let looks = Looks { runs: runs.len() };
    let (series, stroke) = (|run: &Run| run.series(field), |run| looks.motion(run));
    curves(panel, runs, field.path(), series, stroke);
    for (index, run) in runs.iter().enumerate() {
        let envelope = run.coarseness().and_then(|_| run.envelope(field));
        panel.envelopes.extend(envelope.map(|[lower, upper]| Band {
            meaning: format!("{}: {}, range in each nutation", run.name, field.path()),
            lower,
            upper,
            fill: looks.envelope(index),
        }));
    }
}

fn averages(panel: &mut Panel, runs: &[&Run], field: NumberField, mean: NumberField) {
    let looks = Looks { runs: runs.len() };
    let meaning = format!("average of {}", field.path());
    let (points, stroke) = (|run: &Run| run.averages(mean), |run| looks.average(run));
    curves(panel, runs, &meaning, points, stroke);
}

/// The averages of a quantity whose fast oscillation fills a band.
fn averages_of_band(run: &Run, field: NumberField) -> Option<Vec<Point>> {
    let (points, averages) = (run.series(field), run.means(field));
    let (low, high) = extremes(points.iter().map(|point| point.1));
    let is_band = climb(&points) - climb(&averages) > high - low;
    (is_band && is_line(&averages)).then_some(averages)
}

/// The sum of all changes of a curve, upward and downward.
fn climb(points: &[Point]) -> f64 {
    let steps = points.windows(2).map(|pair| (pair[1].1 - pair[0].1).abs());
    steps.filter(|step| step.is_finite()).sum()
}

/// Whether these points form a line.
fn is_line(points: &[Point]) -> bool {
    let finite = points.iter().filter(|point| point.1.is_finite());
    finite.take(2).count() == 2
}

/// The legend of runs and their averages.
fn motion_legend(runs: &[&Run]) -> Vec<Entry> {
    let looks = Looks { runs: runs.len() };
    let has_averages = |run: &&Run| is_line(&run.averages(nutation::THETA_MEAN));
    let averages = runs.iter().any(has_averages);
    if runs.len() == 1 {
        let average = Entry::line(looks.average(0), "average over each nutation");
        let mut legend = vec![Entry::line(looks.motion(0), "simulation")];
        legend.extend(averages.then_some(average));
        return legend;
    }
    let mut legend = looks::legend(runs, |run| looks.average(run));
    let about = if averages {
        "simulation; lines: averages over nutations"
    } else {
        "simulation"
    };
    legend.push(Entry::area(PALE, about));
    legend
}

/// The paper's figure 4: θ of each further run with the averages of the first.
pub(super) fn compared(runs: &[&Run], width: f64) -> Drawing {
    let looks = Looks { runs: 1 };
    let Some((reference, others)) = runs.split_first() else {
        return Drawing::new(width);
    };
    let panel = |run: &&Run| {
        let mut panel = Panel::new("*θ*", "rad");
        motions(&mut panel, &[run], state::THETA);
        averages(&mut panel, &[reference], state::THETA, nutation::THETA_MEAN);
        let name = Text::name(&run.name);
        panel.legend.push(Entry::of(looks.motion(0), name));
        panel
    };
    let name = Text::name(&reference.name).followed_by(", average over each nutation");
    let mut legend = vec![Entry::of(looks.average(0), name)];
    legend.extend(note(others, &[state::THETA]));
    let page = page(legend, others.iter().map(panel).collect());
    let shares_x = false;
    Page { shares_x, ..page }.draw(width)
}

/// A panel that shows several quantities of all runs, with a legend of the quantities.
struct Terms<'a> {
    panel: Panel,
    runs: &'a [&'a Run],
    count: usize,
    /// Number of bands of rapidly oscillating quantities, drawn below all lines.
    bands: usize,
}

impl<'a> Terms<'a> {
    fn new(runs: &'a [&'a Run], symbol: &'static str, unit: &'static str) -> Self {
        Self {
            panel: Panel::new(symbol, unit),
            runs,
            count: 0,
            bands: 0,
        }
    }

    /// Adds a number; `name` is markup. If it oscillates too fast to be resolved, it is drawn as a pale band with its
    /// average as a line.
    fn number(mut self, name: &str, field: NumberField) -> Self {
        let runs = self.runs;
        let looks = Looks { runs: runs.len() };
        for (index, run) in runs.iter().enumerate() {
            if averages_of_band(run, field).is_some() {
                let band = Curve {
                    meaning: format!("{}: {}", run.name, field.path()),
                    points: run.series(field),
                    stroke: looks.ripple(index, self.count),
                };
                self.panel.curves.insert(self.bands, band);
                self.bands += 1;
            }
        }
        self.term(name, |run| {
            averages_of_band(run, field).unwrap_or_else(|| run.series(field))
        })
    }

    /// Adds a quantity; `name` is markup.
    fn term(mut self, name: &str, points: impl Fn(&Run) -> Vec<Point>) -> Self {
        let (panel, runs, count) = (&mut self.panel, self.runs, self.count);
        let looks = Looks { runs: runs.len() };
        let entry = Entry::line(looks.term_in_legend(count), name);
        let first = panel.curves.len();
        let stroke = |run| looks.term(run, count);
        curves(panel, runs, &entry.text.spoken, points, stroke);
        let mut drawn = panel.curves[first..].iter();
        if drawn.any(|curve| is_line(&curve.points)) {
            panel.legend.push(entry);
        }
        self.count += 1;
        self
    }
}

/// Draws panels with several quantities each.
fn draw(runs: &[&Run], width: f64, panels: Vec<Terms<'_>>) -> Drawing {
    let mut legend = looks::legend(runs, Looks::run_in_legend);
    if panels.iter().any(|terms| terms.bands > 0) {
        legend.push(Entry::area(PALE, "nutation; the line in it: its average"));
    }
    legend.extend(looks::note(runs));
    let panels = panels.into_iter().map(|terms| terms.panel);
    page(legend, panels.collect()).draw(width)
}

/// A page of panels over the same time.
fn page(legend: Vec<Entry>, panels: Vec<Panel>) -> Page {
    Page {
        x: TIME,
        legend,
        panels,
        shares_x: true,
    }
}

/// Mean accelerations below this fraction of the gravity term are integration errors.
const NEGLIGIBLE: f64 = 1e-6;

/// The terms of θ̈ and φ̈, averaged over nutations.
pub(super) fn acceleration(runs: &[&Run], width: f64) -> Drawing {
    let mean = |field: NumberField| move |run: &Run| run.means(field);
    let gravity = runs
        .iter()
        .flat_map(|run| run.means(terms_of::THETA_DDOT_GRAVITATIONAL));
    let (_, gravity) = extremes(gravity.map(|point| point.1.abs()));
    let theta = Terms::new(runs, "mean *θ\u{308}*", "rad/s²")
        .term("gravitational", mean(terms_of::THETA_DDOT_GRAVITATIONAL))
        .term("gyroscopic", mean(terms_of::THETA_DDOT_GYROSCOPIC))
        .term("centrifugal", mean(terms_of::THETA_DDOT_CENTRIFUGAL))
        .term("frictional", mean(terms_of::THETA_DDOT_FRICTIONAL));
    let mut phi = Terms::new(runs, "mean *φ\u{308}*", "rad/s²")
        .term("frictional", mean(terms_of::PHI_DDOT_FRICTIONAL))
        .term("gyroscopic", mean(terms_of::PHI_DDOT_GYROSCOPIC))
        .term("Coriolis", mean(terms_of::PHI_DDOT_CORIOLIS));
    phi.panel.rounding = NEGLIGIBLE * gravity;
    phi.panel.is_singular = true;
    draw(runs, width, vec![theta, phi])
}

/// φ̇ and the rates of regular precession, with the region between them in which θ̈ is negative.
pub(super) fn precession(runs: &[&Run], width: f64) -> Drawing {
    let looks = Looks { runs: runs.len() };
    let mut near = Panel::new("*φ\u{307}*", "rad/s");
    near.is_singular = true;
    let mut far = near.clone();
    motions(&mut near, runs, state::PHI_DOT);
    near.most = around(near.range());
    for (index, run) in runs.iter().enumerate() {
        for (panel, field) in [&mut near, &mut far].into_iter().zip(by_nearness(run)) {
            let meaning = format!("{}: {}", run.name, field.path());
            panel.curve(meaning, run.series(field), looks.root(Some(index)));
        }
    }
    averages(&mut near, runs, state::PHI_DOT, nutation::PHI_DOT_MEAN);
    let mut panels = arranged(near, far);
    let mut legend = motion_legend(runs);
    let roots = "regular precession, slow and fast";
    legend.push(Entry::line(looks.root(None), roots));
    if let [run] = runs {
        let bands = rising(run);
        if !bands.is_empty() {
            legend.push(Entry::area(SHADE, "*θ\u{308}* < 0"));
        }
        for panel in &mut panels {
            panel.bands.clone_from(&bands);
        }
    }
    legend.extend(looks::note(runs));
    page(legend, panels).draw(width)
}

/// The y range around the motion; roots outside it are clipped.
fn around((low, high): (f64, f64)) -> (f64, f64) {
    let room = 2.0 * (high - low).max(low.abs()).max(high.abs());
    (low - room, high + room)
}

/// The rates of regular precession: first the one that φ̇ follows.
fn by_nearness(run: &Run) -> [NumberField; 2] {
    let median = |field| {
        let values = run.series(field).into_iter().map(|point| point.1);
        let mut values: Vec<_> = values.filter(|value| value.is_finite()).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let rate = median(state::PHI_DOT);
    let distance = |root| (rate - median(root)).abs();
    if distance(rates::FAST_ROOT) < distance(rates::SLOW_ROOT) {
        [rates::FAST_ROOT, rates::SLOW_ROOT]
    } else {
        [rates::SLOW_ROOT, rates::FAST_ROOT]
    }
}

/// Panels of the motion with the root it follows and of the other root, with a broken common axis if they are
/// separated.
fn arranged(near: Panel, far: Panel) -> Vec<Panel> {
    let (of_near, of_far) = (near.range(), far.range());
    let height = 0.45;
    let far = Panel { height, ..far };
    if far.is_empty() {
        return vec![near];
    }
    if overlap(of_near, of_far) {
        return vec![near, far];
    }
    let is_above = of_far.0 > of_near.1;
    let (upper, lower) = if is_above { (far, near) } else { (near, far) };
    let is_broken = true;
    vec![Panel { is_broken, ..upper }, lower]
}

/// The regions where θ̈ is negative: θ̈ is positive at φ̇ = 0 and changes its sign at the roots.
///
/// While both roots have the same sign it is negative between them. If one root passes through infinity and changes
/// sign, θ̈ is negative outside them.
fn rising(run: &Run) -> Vec<Band> {
    let slow = run.series(rates::SLOW_ROOT).into_iter();
    let roots: Vec<_> = slow.zip(run.series(rates::FAST_ROOT)).collect();
    let sign = |(slow, fast): &(Point, Point)| {
        let product = slow.1 * fast.1;
        product.is_finite().then_some(product > 0.0)
    };
    let mut bands = Vec::new();
    for part in roots.chunk_by(|one, other| sign(one) == sign(other)) {
        let pick = |which: fn(f64, f64) -> f64| -> Vec<Point> {
            part.iter().map(|(a, b)| (a.0, which(a.1, b.1))).collect()
        };
        let far = |end: f64| part.iter().map(|(root, _)| (root.0, end)).collect();
        let band = |lower, upper| Band {
            meaning: "driven upright".to_owned(),
            lower,
            upper,
            fill: SHADE,
        };
        let (low, high) = (pick(f64::min), pick(f64::max));
        match part.first().and_then(sign) {
            Some(true) => bands.push(band(low, high)),
            Some(false) => bands.extend([band(far(-FAR), low), band(high, far(FAR))]),
            None => {}
        }
    }
    bands
}

/// A rate beyond all axes, rad/s.
const FAR: f64 = 1e9;

/// The torques in the node frame.
pub(super) fn torque(runs: &[&Run], width: f64) -> Drawing {
    let gravity =
        Terms::new(runs, "*τ*", "N m").number("gravity, *τ*_{*x*}", torques::GRAVITY_NODE.x());
    let friction = Terms::new(runs, "*τ*", "N m")
        .number("friction, *τ*_{*y*}", torques::FRICTION_NODE.y())
        .number("*τ*_{*z*}", torques::FRICTION_NODE.z())
        .number("*τ*_{*x*}", torques::FRICTION_NODE.x());
    draw(runs, width, vec![gravity, friction])
}

/// The slip speed and the path slipped.
pub(super) fn slip(runs: &[&Run], width: f64) -> Drawing {
    let speed = Terms::new(runs, "|*v*|", "m/s").number("slip speed", contact::SLIP_SPEED);
    let path = Terms::new(runs, "*s*", "m").number("slip path", contact::SLIP_PATH);
    draw(runs, width, vec![speed, path])
}

/// The normal force and the height of the peg above the table.
pub(super) fn hops(runs: &[&Run], width: f64) -> Drawing {
    let force = Terms::new(runs, "*N*", "N").number("normal force", contact::NORMAL_FORCE);
    let gap = Terms::new(runs, "*h*", "m").number("height of the peg", free_peg::GAP);
    draw(runs, width, vec![force, gap])
}

/// Relative energy changes below this are integration errors.
const CONSERVED: f64 = 1e-9;

/// The energies, and the work and power of friction.
pub(super) fn energy(runs: &[&Run], width: f64) -> Drawing {
    let change = |run: &Run| {
        let total = run.series(energies::TOTAL);
        let start = total.first().map_or(0.0, |point| point.1);
        total.into_iter().map(|(t, e)| (t, e - start)).collect()
    };
    let kinetic = Terms::new(runs, "*E*", "J")
        .number("total", energies::TOTAL)
        .number("kinetic", energies::KINETIC);
    let potential = Terms::new(runs, "*E*", "J").number("potential", energies::POTENTIAL);
    let largest = runs.iter().flat_map(|run| run.series(energies::KINETIC));
    let (_, largest) = extremes(largest.map(|point| point.1.abs()));
    let mut work = Terms::new(runs, "Δ*E*", "J")
        .term("change of the total", change)
        .number("work of friction", energies::FRICTION_WORK);
    work.panel.rounding = CONSERVED * largest;
    let power = Terms::new(runs, "*P*", "W").number("power of friction", energies::FRICTION_POWER);
    draw(runs, width, vec![kinetic, potential, work, power])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A panel whose only curve goes through this range.
    fn panel((low, high): (f64, f64)) -> Panel {
        let mut panel = Panel::new("*φ\u{307}*", "rad/s");
        let points = vec![(0.0, low), (1.0, high)];
        panel.curve("φ\u{307}", points, Looks { runs: 1 }.motion(0));
        panel
    }

    #[test]
    fn an_axis_is_broken_only_between_ranges_that_are_apart() {
        let arranged = |near, far| {
            let panels = arranged(panel(near), panel(far));
            let values = panels
                .iter()
                .map(|panel| (panel.range().0, panel.is_broken));
            values.collect::<Vec<_>>()
        };
        assert_eq!(
            arranged((1.0, 2.0), (900.0, 950.0)),
            [(900.0, true), (1.0, false)]
        );
        assert_eq!(
            arranged((1.0, 2.0), (-950.0, -900.0)),
            [(1.0, true), (-950.0, false)]
        );
        assert_eq!(
            arranged((1.0, 2.0), (-50.0, 50.0)),
            [(1.0, false), (-50.0, false)]
        );
    }

    #[test]
    fn a_root_that_is_far_off_leaves_the_motion_its_axis() {
        assert_eq!(around((1.0, 2.0)), (-3.0, 6.0));
        assert_eq!(around((499.0, 500.0)), (-501.0, 1500.0));
    }
}
