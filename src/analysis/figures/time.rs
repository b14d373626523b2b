//! The figures over time.

use super::looks::{self, Looks, PALE, SHADE};
use super::run::Run;
use crate::analysis::plot::drawing::Drawing;
use crate::analysis::plot::frame::{Band, Quantity, extremes};
use crate::analysis::plot::legend::Entry;
use crate::analysis::plot::page::{Page, Panel};
use crate::analysis::plot::shape::Point;
use crate::analysis::plot::text::Text;
use crate::telemetry::fields::{
    NumberField, acceleration as terms_of, contact, energy as energies, nutation,
    precession as rates, state, torque as torques,
};

/// Time, as on axes.
const TIME: Quantity = Quantity {
    symbol: "*t*",
    unit: "s",
};

/// The paper's figure 2: the inclination and the rates with their averages over nutations.
pub(super) fn motion(runs: &[&Run], width: f64) -> Drawing {
    let panels = [
        ("*θ*", state::THETA, nutation::THETA_MEAN),
        ("*θ\u{307}*", state::THETA_DOT, nutation::THETA_DOT_MEAN),
        ("*φ\u{307}*", state::PHI_DOT, nutation::PHI_DOT_MEAN),
        ("*ψ\u{307}*", state::PSI_DOT, nutation::PSI_DOT_MEAN),
    ];
    let panels = panels.map(|(symbol, field, mean)| {
        let mut panel = Panel::new(symbol, field.unit());
        motions(&mut panel, runs, field);
        averages(&mut panel, runs, field, mean);
        panel
    });
    page(motion_legend(runs), panels.into()).draw(width)
}

fn motions(panel: &mut Panel, runs: &[&Run], field: NumberField) {
    let looks = Looks { runs: runs.len() };
    for (index, run) in runs.iter().enumerate() {
        let meaning = format!("{}: {}", run.name, field.path());
        panel.curve(meaning, run.series(field), looks.motion(index));
    }
}

fn averages(panel: &mut Panel, runs: &[&Run], field: NumberField, mean: NumberField) {
    let looks = Looks { runs: runs.len() };
    for (index, run) in runs.iter().enumerate() {
        let meaning = format!("{}: average of {}", run.name, field.path());
        panel.curve(meaning, run.averages(mean), looks.average(index));
    }
}

/// The legend of runs and their averages.
fn motion_legend(runs: &[&Run]) -> Vec<Entry> {
    let looks = Looks { runs: runs.len() };
    if runs.len() == 1 {
        return vec![
            Entry::line(looks.motion(0), "simulation"),
            Entry::line(looks.average(0), "average over each nutation"),
        ];
    }
    let mut legend = looks::legend(runs, Looks::average);
    legend.push(Entry::area(
        PALE,
        "simulation; lines: average over each nutation",
    ));
    legend
}

/// The paper's figure 4: θ of each further run with the averages of the first.
pub(super) fn compared(runs: &[&Run], width: f64) -> Drawing {
    let looks = Looks { runs: 1 };
    let Some((reference, others)) = runs.split_first() else {
        return page(Vec::new(), Vec::new()).draw(width);
    };
    let panel = |run: &&Run| {
        let mut panel = Panel::new("*θ*", "rad");
        let points = run.series(state::THETA);
        panel.curve(format!("{}: theta", run.name), points, looks.motion(0));
        let meaning = format!("{}: average of theta", reference.name);
        panel.curve(
            meaning,
            reference.averages(nutation::THETA_MEAN),
            looks.average(0),
        );
        let name = Text::name(&run.name);
        panel.legend.push(Entry::of(looks.motion(0), name));
        panel
    };
    let name = Text::name(&reference.name).followed_by(", average over each nutation");
    Page {
        shares_x: false,
        ..page(
            vec![Entry::of(looks.average(0), name)],
            others.iter().map(panel).collect(),
        )
    }
    .draw(width)
}

/// A panel that shows several quantities of all runs, with a legend of the quantities.
struct Terms<'a> {
    panel: Panel,
    runs: &'a [&'a Run],
    count: usize,
}

impl<'a> Terms<'a> {
    fn new(runs: &'a [&'a Run], symbol: &'static str, unit: &'static str) -> Self {
        Self {
            panel: Panel::new(symbol, unit),
            runs,
            count: 0,
        }
    }

    /// Adds a quantity; `name` is markup.
    fn term(mut self, name: &str, points: impl Fn(&Run) -> Vec<Point>) -> Self {
        let looks = Looks {
            runs: self.runs.len(),
        };
        let entry = Entry::line(looks.term_in_legend(self.count), name);
        for (index, run) in self.runs.iter().enumerate() {
            let meaning = format!("{}: {}", run.name, entry.text.spoken);
            let stroke = looks.term(index, self.count);
            self.panel.curve(meaning, points(run), stroke);
        }
        self.panel.legend.push(entry);
        self.count += 1;
        self
    }
}

/// A page of panels with several quantities each.
fn terms(runs: &[&Run], panels: Vec<Terms<'_>>) -> Page {
    page(
        looks::legend(runs, Looks::run_in_legend),
        panels.into_iter().map(|terms| terms.panel).collect(),
    )
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

/// The terms of θ̈ and φ̈, averaged over nutations: why the top rises.
pub(super) fn acceleration(runs: &[&Run], width: f64) -> Drawing {
    let mean = |field: NumberField| move |run: &Run| run.means(field);
    let theta = Terms::new(runs, "mean *θ\u{308}*", "rad/s²")
        .term("gravitational", mean(terms_of::THETA_DDOT_GRAVITATIONAL))
        .term("gyroscopic", mean(terms_of::THETA_DDOT_GYROSCOPIC))
        .term("centrifugal", mean(terms_of::THETA_DDOT_CENTRIFUGAL))
        .term("frictional", mean(terms_of::THETA_DDOT_FRICTIONAL));
    let phi = Terms::new(runs, "mean *φ\u{308}*", "rad/s²")
        .term("frictional", mean(terms_of::PHI_DDOT_FRICTIONAL))
        .term("gyroscopic", mean(terms_of::PHI_DDOT_GYROSCOPIC))
        .term("Coriolis", mean(terms_of::PHI_DDOT_CORIOLIS));
    terms(runs, vec![theta, phi]).draw(width)
}

/// φ̇ and the rates of regular precession, with the region between them in which θ̈ is negative.
pub(super) fn precession(runs: &[&Run], width: f64) -> Drawing {
    let looks = Looks { runs: runs.len() };
    let mut slow = Panel::new("*φ\u{307}*", "rad/s");
    let mut fast = Panel::new("*φ\u{307}*", "rad/s");
    fast.height = 0.45;
    fast.is_broken = true;
    let roots = |panel: &mut Panel, field: NumberField| {
        for (index, run) in runs.iter().enumerate() {
            let meaning = format!("{}: {}", run.name, field.path());
            panel.curve(meaning, run.series(field), looks.root(index));
        }
    };
    motions(&mut slow, runs, state::PHI_DOT);
    roots(&mut slow, rates::SLOW_ROOT);
    averages(&mut slow, runs, state::PHI_DOT, nutation::PHI_DOT_MEAN);
    roots(&mut fast, rates::FAST_ROOT);
    // The fast root goes to infinity where the axis becomes horizontal.
    let starts = fast.curves.iter().filter_map(|curve| curve.points.first());
    fast.limit = 2.0 * extremes(starts.map(|point| point.1.abs())).1;
    if let [run] = runs {
        for panel in [&mut slow, &mut fast] {
            panel.bands = rising(run);
        }
    }
    let mut legend = motion_legend(runs);
    legend.push(Entry::line(
        looks.root_in_legend(),
        "regular precession, slow and fast",
    ));
    if !slow.bands.is_empty() {
        legend.push(Entry::area(SHADE, "*θ\u{308}* < 0: the top rises"));
    }
    page(legend, vec![fast, slow]).draw(width)
}

/// The regions where θ̈ is negative: θ̈ is positive at φ̇ = 0 and changes its sign at the roots.
fn rising(run: &Run) -> Vec<Band> {
    let slow = run.series(rates::SLOW_ROOT);
    let fast = run.series(rates::FAST_ROOT);
    let pairs = || slow.iter().zip(&fast);
    let pick = |which: fn(f64, f64) -> f64| -> Vec<Point> {
        pairs().map(|(a, b)| (a.0, which(a.1, b.1))).collect()
    };
    let far = |sign: f64| slow.iter().map(|(time, _)| (*time, sign * 1e9)).collect();
    let (low, high) = (pick(f64::min), pick(f64::max));
    let band = |lower, upper| Band {
        meaning: "the top rises".to_owned(),
        lower,
        upper,
        fill: SHADE,
    };
    let (least, greatest) = extremes(pairs().map(|(a, b)| a.1 * b.1));
    if least > 0.0 {
        vec![band(low, high)]
    } else if greatest < 0.0 {
        vec![band(far(-1.0), low), band(high, far(1.0))]
    } else {
        // A root went through infinity: the region changes its form.
        Vec::new()
    }
}

/// A number of a run over time.
fn series(field: NumberField) -> impl Fn(&Run) -> Vec<Point> {
    move |run| run.series(field)
}

/// The torques in the node frame.
pub(super) fn torque(runs: &[&Run], width: f64) -> Drawing {
    let gravity = Terms::new(runs, "*τ*", "N m")
        .term("gravity, *τ*_{*x*}", series(torques::GRAVITY_NODE.x()));
    let friction = Terms::new(runs, "*τ*", "N m")
        .term("friction, *τ*_{*y*}", series(torques::FRICTION_NODE.y()))
        .term("*τ*_{*z*}", series(torques::FRICTION_NODE.z()))
        .term("*τ*_{*x*}", series(torques::FRICTION_NODE.x()));
    terms(runs, vec![gravity, friction]).draw(width)
}

/// The slip speed and the path slipped.
pub(super) fn slip(runs: &[&Run], width: f64) -> Drawing {
    let speed = Terms::new(runs, "|*v*|", "m/s").term("slip speed", series(contact::SLIP_SPEED));
    let path = Terms::new(runs, "*s*", "m").term("path slipped", series(contact::SLIP_PATH));
    terms(runs, vec![speed, path]).draw(width)
}

/// The energies, and the work and power of friction.
pub(super) fn energy(runs: &[&Run], width: f64) -> Drawing {
    let change = |run: &Run| {
        let total = run.series(energies::TOTAL);
        let start = total.first().map_or(0.0, |point| point.1);
        total.into_iter().map(|(t, e)| (t, e - start)).collect()
    };
    let kinetic = Terms::new(runs, "*E*", "J")
        .term("total", series(energies::TOTAL))
        .term("kinetic", series(energies::KINETIC));
    let potential = Terms::new(runs, "*E*", "J").term("potential", series(energies::POTENTIAL));
    let work = Terms::new(runs, "Δ*E*", "J")
        .term("change of the total", change)
        .term("work of friction", series(energies::FRICTION_WORK));
    let power =
        Terms::new(runs, "*P*", "W").term("power of friction", series(energies::FRICTION_POWER));
    terms(runs, vec![kinetic, potential, work, power]).draw(width)
}
