//! The figures over time.

use super::looks::{self, Looks, PALE, SHADE};
use super::run::Run;
use crate::analysis::plot::drawing::Drawing;
use crate::analysis::plot::frame::{Band, Quantity, extremes};
use crate::analysis::plot::legend::Entry;
use crate::analysis::plot::page::{Page, Panel};
use crate::analysis::plot::shape::Point;
use crate::analysis::plot::text::Text;

/// Time, as on axes.
const TIME: Quantity = Quantity {
    symbol: "*t*",
    unit: "s",
};

const STATE: &str = "/top/state";

/// The paper's figure 2: the angles' course with their nutation averages.
pub(super) fn motion(runs: &[&Run], width: f64) -> Drawing {
    let panels = [
        ("*θ*", "rad", "theta", "theta_mean"),
        ("*θ\u{307}*", "rad/s", "theta_dot", "theta_dot_mean"),
        ("*φ\u{307}*", "rad/s", "phi_dot", "phi_dot_mean"),
        ("*ψ\u{307}*", "rad/s", "psi_dot", "psi_dot_mean"),
    ];
    let panels = panels.map(|(symbol, unit, field, mean)| {
        let mut panel = Panel::new(symbol, unit);
        motion_and_average(&mut panel, runs, (STATE, field), |run| run.averages(mean));
        panel
    });
    page(motion_legend(runs), panels.into()).draw(width)
}

/// A number of all runs, and over it their averages.
fn motion_and_average(
    panel: &mut Panel,
    runs: &[&Run],
    (topic, field): (&str, &str),
    average: impl Fn(&Run) -> Vec<Point>,
) {
    motions(panel, runs, (topic, field));
    averages(panel, runs, field, average);
}

fn motions(panel: &mut Panel, runs: &[&Run], (topic, field): (&str, &str)) {
    let looks = Looks { runs: runs.len() };
    for (index, run) in runs.iter().enumerate() {
        let meaning = format!("{}: {field}", run.name);
        panel.curve(meaning, run.series(topic, field), looks.motion(index));
    }
}

fn averages(panel: &mut Panel, runs: &[&Run], field: &str, average: impl Fn(&Run) -> Vec<Point>) {
    let looks = Looks { runs: runs.len() };
    for (index, run) in runs.iter().enumerate() {
        let meaning = format!("{}: average of {field}", run.name);
        panel.curve(meaning, average(run), looks.average(index));
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
        let points = run.series(STATE, "theta");
        panel.curve(format!("{}: theta", run.name), points, looks.motion(0));
        let meaning = format!("{}: average of theta", reference.name);
        panel.curve(meaning, reference.averages("theta_mean"), looks.average(0));
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

/// Several quantities of all runs in one panel, and the legend of the quantities.
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

/// Why the top rises: what turns θ̇ and φ̇, averaged over nutations.
pub(super) fn acceleration(runs: &[&Run], width: f64) -> Drawing {
    let mean = |field: &'static str| move |run: &Run| run.means("/top/acceleration", field);
    let theta = Terms::new(runs, "mean *θ\u{308}*", "rad/s²")
        .term("gravitational", mean("theta_ddot.gravitational"))
        .term("gyroscopic", mean("theta_ddot.gyroscopic"))
        .term("centrifugal", mean("theta_ddot.centrifugal"))
        .term("frictional", mean("theta_ddot.frictional"));
    let phi = Terms::new(runs, "mean *φ\u{308}*", "rad/s²")
        .term("frictional", mean("phi_ddot.frictional"))
        .term("gyroscopic", mean("phi_ddot.gyroscopic"))
        .term("Coriolis", mean("phi_ddot.coriolis"));
    terms(runs, vec![theta, phi]).draw(width)
}

/// φ̇ and the rates of regular precession, with the region between them in which θ̈ is negative.
pub(super) fn precession(runs: &[&Run], width: f64) -> Drawing {
    let looks = Looks { runs: runs.len() };
    let mut slow = Panel::new("*φ\u{307}*", "rad/s");
    let mut fast = Panel::new("*φ\u{307}*", "rad/s");
    fast.height = 0.45;
    fast.is_broken = true;
    let roots = |panel: &mut Panel, field: &str| {
        for (index, run) in runs.iter().enumerate() {
            let points = run.series("/top/precession", field);
            panel.curve(format!("{}: {field}", run.name), points, looks.root(index));
        }
    };
    motions(&mut slow, runs, (STATE, "phi_dot"));
    roots(&mut slow, "slow_root");
    averages(&mut slow, runs, "phi_dot", |run| {
        run.averages("phi_dot_mean")
    });
    roots(&mut fast, "fast_root");
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

/// Where θ̈ is negative: it is positive at φ̇ = 0, and changes its sign at the roots.
fn rising(run: &Run) -> Vec<Band> {
    let slow = run.series("/top/precession", "slow_root");
    let fast = run.series("/top/precession", "fast_root");
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

/// The torques in the node frame.
pub(super) fn torque(runs: &[&Run], width: f64) -> Drawing {
    let component = |field: &'static str| move |run: &Run| run.series("/top/torque", field);
    let gravity =
        Terms::new(runs, "*τ*", "N m").term("gravity, *τ*_{*x*}", component("gravity_node.x"));
    let friction = Terms::new(runs, "*τ*", "N m")
        .term("friction, *τ*_{*y*}", component("friction_node.y"))
        .term("*τ*_{*z*}", component("friction_node.z"))
        .term("*τ*_{*x*}", component("friction_node.x"));
    terms(runs, vec![gravity, friction]).draw(width)
}

/// How fast and how far the contact point slips.
pub(super) fn slip(runs: &[&Run], width: f64) -> Drawing {
    let topic = "/top/contact";
    let series = |field: &'static str| move |run: &Run| run.series(topic, field);
    let speed = Terms::new(runs, "|*v*|", "m/s").term("slip speed", series("slip_speed"));
    let path = Terms::new(runs, "*s*", "m").term("path slipped", series("slip_path"));
    terms(runs, vec![speed, path]).draw(width)
}

/// Where the energy is, and where it goes.
pub(super) fn energy(runs: &[&Run], width: f64) -> Drawing {
    let energy = |field: &'static str| move |run: &Run| run.series("/top/energy", field);
    let change = |run: &Run| {
        let total = run.series("/top/energy", "total");
        let start = total.first().map_or(0.0, |point| point.1);
        total.into_iter().map(|(t, e)| (t, e - start)).collect()
    };
    let kinetic = Terms::new(runs, "*E*", "J")
        .term("total", energy("total"))
        .term("kinetic", energy("kinetic"));
    let potential = Terms::new(runs, "*E*", "J").term("potential", energy("potential"));
    let work = Terms::new(runs, "Δ*E*", "J")
        .term("change of the total", change)
        .term("work of friction", energy("friction_work"));
    let power = Terms::new(runs, "*P*", "W").term("power of friction", energy("friction_power"));
    terms(runs, vec![kinetic, potential, work, power]).draw(width)
}
