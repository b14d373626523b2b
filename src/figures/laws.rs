//! Laws of friction: the coefficient of friction against the slip speed.

mod strips;

use self::strips::Strip;
use super::symbol;
use crate::analysis::slip::{Slip, VisitedSpeeds};
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::frame::{self, Frame, Quantity};
use crate::figures::plot::legend::{self, LegendEntry};
use crate::figures::plot::range::extremes;
use crate::figures::plot::shape::{Bounds, Colour, Point, Stroke};
use crate::figures::plot::style::{self, COLOURS, DASHES, MARGIN, MEDIUM};
use crate::figures::plot::text::Text;
use crate::figures::plot::ticks::Scale;
use crate::figures::style::Style;
use crate::physics::friction::FrictionLaw;
use crate::physics::kinematics::Tilt;
use crate::run::scenario::{Key, Scenario, Value};
use crate::telemetry::side::Side;
use crate::words::number::rounded;

/// The height of the frame relative to the width of the drawing.
const PROPORTION: f64 = 0.56;

/// The space at the ends of the axes, relative to the ranges of the curves.
const PADDING: f64 = 0.04;

/// The most characters of a formula in a legend.
const MAX_FORMULA: usize = 60;

/// Intervals of the grid on which a curve is computed: several for each pixel of a column.
const GRID: u32 = 4096;

/// The width of the mark of visited slip speeds, mm.
const HIGHLIGHTER: f64 = 2.6;

/// A static bound that differs from the curve by less than this part is its end.
const SAME: f64 = 1e-3;

const SPEED: Quantity = Quantity::new("slip speed *v*", "m/s");
const COEFFICIENT: Quantity = Quantity::new("coefficient of friction *μ*", "");

/// A law of friction to draw.
#[derive(Clone, Debug, PartialEq)]
pub struct LawCurve {
    /// The side of a comparison.
    side: Option<Side>,
    name: String,
    /// The name of the law, or its formula, unless it is the name of the curve.
    law_name: Option<String>,
    /// The parameters of the law, as markup.
    parameters: Vec<String>,
    law: FrictionLaw,
    /// The rate about the vertical at which the law is drawn, rad/s.
    turning_rate: f64,
    /// The fastest slip to draw, m/s.
    fastest: f64,
    /// The slip speeds that a run visited.
    visited: Option<VisitedSpeeds>,
}

impl LawCurve {
    /// The law of a scenario, up to its slip speed at the start, or if it starts without slip, to the greatest one that its
    /// energy allows. A law that depends on the rate about the vertical is that at the start.
    pub fn new(name: &str, scenario: &Scenario) -> Self {
        let tilt = Tilt::from_rates(scenario.angles.theta, scenario.rates);
        let at_start = scenario.slip_speed_at_start();
        let fastest = if at_start > 0.0 {
            at_start
        } else {
            scenario.model.largest_slip_speed(&scenario.start())
        };
        Self {
            side: None,
            name: name.to_owned(),
            law_name: Some(law_name(scenario)).filter(|law| law != name),
            parameters: parameters(scenario),
            law: scenario.model.friction.law.clone(),
            turning_rate: tilt.omega_lean.z,
            fastest,
            visited: None,
        }
    }

    /// The law of one of two compared runs, with its slip: up to the fastest, and a law that depends on the rate about the
    /// vertical at the mean rate. `None` for a run that does not slip.
    #[must_use]
    pub fn for_side(self, side: Side, slip: Option<&Slip>) -> Self {
        let mut law = Self {
            side: Some(side),
            ..self
        };
        if let Some(slip) = slip {
            law.fastest = slip.path.first().map_or(0.0, |point| point.speed);
            law.turning_rate = slip.turning_rate.unwrap_or(law.turning_rate);
            law.visited = Some(slip.visited.clone());
        }
        law
    }

    /// The coefficient of friction at slip speeds up to `fastest`, m/s. The slow ones are dense, because there laws of
    /// friction change most.
    fn points(&self, fastest: f64) -> Vec<Point> {
        let mut points = Vec::new();
        // Without slip there is a static bound instead.
        for point in 1..=GRID {
            let share = f64::from(point) / f64::from(GRID);
            let speed = fastest * share * share;
            points.push((speed, self.law.coefficient(speed, self.turning_rate)));
        }
        points
    }

    /// The bound of the coefficient at rest, where the curve does not end in it.
    fn static_bound(&self, points: &[Point]) -> Option<f64> {
        let bound = self.law.static_bound_at(1.0, self.turning_rate);
        let (_, end) = points.first()?;
        (bound > 0.0 && (bound - end).abs() > SAME * bound).then_some(bound)
    }

    /// The entry in the legend.
    fn legend(&self, stroke: Stroke) -> LegendEntry {
        let side = self
            .side
            .map_or_else(String::new, |side| format!("{}: ", side.name()));
        let mut text = Text::plain(&side).followed_by_name(&self.name);
        let mut separator = ": ";
        if let Some(law) = &self.law_name {
            text = text.followed_by(separator).followed_by(law);
            separator = ", ";
        }
        let mut parameters = self.parameters.clone();
        if let FrictionLaw::Contensou { .. } = self.law {
            let rate = rounded(self.turning_rate, 3);
            parameters.push(format!("at *ω*_{{*z*′}} = {rate} rad/s"));
        }
        for parameter in &parameters {
            text = text.followed_by(separator).followed_by_markup(parameter);
            separator = ", ";
        }
        LegendEntry::from_text(stroke, text)
    }
}

/// The name of a scenario's law, or its formula, shortened.
fn law_name(scenario: &Scenario) -> String {
    let formula = scenario.word("friction.formula");
    if formula.is_empty() {
        return scenario.word("friction.law").to_owned();
    }
    let mut shown: String = formula.chars().take(MAX_FORMULA).collect();
    if shown != formula {
        shown.push('…');
    }
    format!("μ = {shown}")
}

/// The parameters of a scenario's law, as markup.
fn parameters(scenario: &Scenario) -> Vec<String> {
    let mut parameters = Vec::new();
    for (key, value) in scenario.entries() {
        parameters.extend(parameter(key, value));
    }
    parameters
}

/// A parameter of the law of sliding, as markup; `None` for other keys.
fn parameter(key: &Key, value: &Value) -> Option<String> {
    match (value, key.symbol) {
        (Value::Number(number), Some(symbol)) if key.path.starts_with("friction.") => {
            let symbol = symbol::markup((key, symbol));
            Some(format!("{symbol} = {}", written(*number, key.unit)))
        }
        _ => None,
    }
}

/// A number with its unit, rounded to six digits: those of an estimate would be more than a legend can have.
fn written(number: f64, unit: &str) -> String {
    let rounded = format!("{number:.5e}").parse().unwrap_or(number);
    let number = Value::Number(rounded).to_set_notation().replace('-', "−");
    format!("{number} {unit}").trim_end().to_owned()
}

/// A law with its line.
struct DrawnLaw<'a> {
    law: &'a LawCurve,
    points: Vec<Point>,
    static_bound: Option<f64>,
    stroke: Stroke,
}

impl DrawnLaw<'_> {
    /// Marks the curve from the slowest to the fastest slip of a run.
    fn highlight(&self, drawing: &mut Drawing, frame: &Frame) {
        let Some(visited) = &self.law.visited else {
            return;
        };
        let (slowest, _) = extremes(visited.bins().map(|bin| bin.from));
        let mut points = self.points.clone();
        points.retain(|(speed, _)| (slowest..=self.law.fastest).contains(speed));
        let meaning = format!("{}: visited slip speeds", self.law.name);
        let stroke = highlighter(self.stroke.colour);
        drawing.group(&meaning, frame.line(&points, stroke));
    }
}

/// The wide pale stroke over which a curve is drawn.
fn highlighter(colour: Colour) -> Stroke {
    Stroke {
        opacity: 0.3,
        ..style::line(colour, HIGHLIGHTER)
    }
}

/// Draws laws in one frame with a width in mm; below it, for the slip of each run, the time spent at each slip speed.
pub fn draw_laws(curves: &[LawCurve], width: f64) -> Drawing {
    let fastest = fastest(curves);
    let mut laws = Vec::new();
    for (index, law) in curves.iter().enumerate() {
        // To the end of the axis.
        let points = law.points((1.0 + PADDING) * fastest);
        laws.push(DrawnLaw {
            law,
            static_bound: law.static_bound(&points),
            points,
            stroke: stroke(index, curves.len()),
        });
    }
    let mut drawing = Drawing::new(width);
    drawing.title = title(curves);
    let top = legend::draw_at_top(&mut drawing, &legend_of(&laws)) + 0.6;
    let frame = frame(&laws, fastest, top, width);
    for drawn in &laws {
        drawn.highlight(&mut drawing, &frame);
    }
    for drawn in &laws {
        let mut shapes = frame.line(&drawn.points, drawn.stroke);
        if let Some(bound) = drawn.static_bound {
            let place = frame.place((0.0, bound));
            shapes.push(legend::end_dot(place, drawn.stroke.colour));
        }
        drawing.group(&drawn.law.name, shapes);
    }
    frame.draw(&mut drawing);
    frame.label_y(
        &mut drawing,
        &COEFFICIENT,
        frame::tick_labels_width(&frame.y),
    );
    let lowest = strips::draw(&mut drawing, &frame, &strips_of(&laws));
    lowest.label_x(&mut drawing, &SPEED);
    drawing.height = lowest.bounds.bottom + frame::ROOM_BELOW + MARGIN;
    drawing
}

/// The strips below the frame: one for each run.
fn strips_of<'a>(laws: &[DrawnLaw<'a>]) -> Vec<Strip<'a>> {
    let mut strips = Vec::new();
    for drawn in laws {
        if let (Some(side), Some(visited)) = (drawn.law.side, &drawn.law.visited) {
            strips.push(Strip {
                side,
                visited,
                colour: drawn.stroke.colour,
            });
        }
    }
    strips
}

/// The fastest slip that is drawn, m/s.
fn fastest(curves: &[LawCurve]) -> f64 {
    let fastest = curves.iter().map(|law| law.fastest).fold(0.0, f64::max);
    // Where nothing ever slips, any speed does.
    if fastest > 0.0 { fastest } else { 1.0 }
}

/// The stroke of a law. Laws often coincide, so they have different dashes, too.
fn stroke(index: usize, count: usize) -> Stroke {
    Stroke {
        dash: DASHES[index % DASHES.len()],
        ..style::line(
            COLOURS[index % COLOURS.len()],
            MEDIUM + Style::new(count).extra_width(index),
        )
    }
}

fn title(curves: &[LawCurve]) -> String {
    let names: Vec<_> = curves.iter().map(|law| law.name.as_str()).collect();
    format!(
        "Coefficient of friction over slip speed — {}",
        names.join(", ")
    )
}

fn legend_of(laws: &[DrawnLaw<'_>]) -> Vec<LegendEntry> {
    let mut legend = Vec::new();
    for drawn in laws {
        legend.push(drawn.law.legend(drawn.stroke));
    }
    if laws.iter().any(|drawn| drawn.static_bound.is_some()) {
        legend.push(LegendEntry::dot("bound at rest"));
    }
    if laws.iter().any(|drawn| drawn.law.visited.is_some()) {
        legend.push(LegendEntry::line(
            highlighter(style::BLACK),
            "slip speeds of the run; below: time spent at each",
        ));
    }
    legend
}

/// The frame below `top`, from zero to the fastest slip and above the highest curve.
fn frame(laws: &[DrawnLaw<'_>], fastest: f64, top: f64, width: f64) -> Frame {
    let height = width * PROPORTION;
    let points = laws.iter().flat_map(|drawn| &drawn.points);
    let bounds = laws.iter().filter_map(|drawn| drawn.static_bound);
    let (_, highest) = extremes(points.map(|point| point.1).chain(bounds));
    // Without friction, any axis does.
    let highest = if highest > 0.0 { highest } else { 1.0 };
    let y = Scale::of_hundredths(padded(highest), frame::max_labels_up(height));
    let left = MARGIN + frame::room_left(&y, &COEFFICIENT);
    let right = width - MARGIN - frame::ROOM_RIGHT;
    let bounds = Bounds::between((left, top), (right, top + height));
    let (slowest, fastest) = padded(fastest);
    let x = Scale::new(slowest, fastest, frame::max_labels_across(bounds.width()));
    Frame { bounds, x, y }
}

/// The range from zero to a value, with some space at both ends.
fn padded(high: f64) -> (f64, f64) {
    (-PADDING * high, (1.0 + PADDING) * high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::math::{cos, exp, tanh};
    use crate::run::scenario::Preset;

    fn law(name: &str, keys: &[(&str, &str)]) -> LawCurve {
        let mut values = Preset::find("paper").unwrap().values().unwrap();
        values.change("friction.law", name).unwrap();
        for (key, value) in keys {
            values.set(key, value).unwrap();
        }
        LawCurve::new(name, &Scenario::new(values).unwrap())
    }

    /// Compares a curve with a formula, which is written down once more.
    #[track_caller]
    fn assert_curve(law: &LawCurve, mu: impl Fn(f64) -> f64) {
        for (speed, coefficient) in law.points(0.5) {
            let expected = mu(speed);
            let rounding = 8.0 * f64::EPSILON * expected;
            assert!(
                (coefficient - expected).abs() <= rounding,
                "{} at {speed}: {coefficient} instead of {expected}",
                law.name
            );
        }
    }

    #[test]
    fn val_curves_are_the_formulas_of_the_laws() {
        let k = ("friction.k", "0.03");
        let smooth = [k, ("friction.smoothing_speed", "0.02")];
        assert_curve(&law("none", &[]), |_| 0.0);
        assert_curve(&law("coulomb", &[k]), |_| 0.03);
        assert_curve(&law("coulomb-sqrt", &smooth), |v| {
            0.03 * v / (v * v + 0.0004).sqrt()
        });
        assert_curve(&law("coulomb-tanh", &smooth), |v| 0.03 * tanh(v / 0.02));
        assert_curve(&law("coulomb-rational", &smooth), |v| 0.03 * v / (v + 0.02));
        assert_curve(
            &law("viscous", &[k, ("friction.viscous_speed", "0.4")]),
            |v| 0.03 * v / 0.4,
        );
        let stribeck = [
            k,
            ("friction.static_k", "0.05"),
            ("friction.stribeck_speed", "0.04"),
            ("friction.viscous_slope", "0.01"),
        ];
        let stribeck_formula = |v: f64| 0.03 + 0.02 * exp(-v * v / 0.0016) + 0.01 * v;
        assert_curve(&law("stribeck", &stribeck), stribeck_formula);
        let formula = [
            k,
            ("friction.formula", "k + a*exp(-(v/b)^2) + c*v"),
            ("friction.a", "0.02"),
            ("friction.b", "0.04"),
            ("friction.c", "0.01"),
        ];
        assert_curve(&law("formula", &formula), stribeck_formula);
        let contensou = [
            k,
            ("friction.patch_radius", "2e-4"),
            ("initial.theta", "0.5"),
            ("initial.phi_dot", "2"),
            ("initial.psi_dot", "100"),
        ];
        let rim_speed = 2e-4 * (2.0 + 100.0 * cos(0.5));
        let mean_rim_speed = 8.0 / (3.0 * std::f64::consts::PI) * rim_speed;
        assert_curve(&law("contensou", &contensou), |v| {
            0.03 * v / (v + mean_rim_speed)
        });
    }

    #[test]
    fn dots_are_bounds_at_rest_beside_the_curve() {
        let formula = [
            ("friction.formula", "k"),
            ("friction.a", ""),
            ("friction.static_k", "0.05"),
        ];
        for (law, expected) in [
            (law("coulomb", &[]), None),
            (law("stribeck", &[]), None),
            (law("viscous", &[]), None),
            (law("contensou", &[]), None),
            (law("formula", &formula), Some(0.05)),
        ] {
            assert_eq!(law.static_bound(&law.points(0.5)), expected, "{}", law.name);
        }
    }

    #[test]
    fn formulas_stand_in_the_legend() {
        let curve = law("formula", &[]);
        let entry = curve.legend(stroke(0, 1));
        assert_eq!(
            entry.text.spoken,
            "formula: μ = k*tanh(v/a), k = 0.03, a = 0.03"
        );
    }
}
