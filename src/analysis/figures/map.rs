//! The map of a sweep: what came of its runs, over one or two of the keys that varied.

use crate::analysis::plot::drawing::{Anchor, Drawing};
use crate::analysis::plot::frame::{self, Frame};
use crate::analysis::plot::legend::{self, Entry};
use crate::analysis::plot::range::{NONE, extremes, union};
use crate::analysis::plot::shape::{Bounds, Colour, Point, Shape, Stroke};
use crate::analysis::plot::style::{self, COLOURS, DASHES, FONT, LINE, MARGIN, MEDIUM};
use crate::analysis::plot::text::Text;
use crate::analysis::plot::ticks::{BEYOND_USE, Scale};
use crate::physics::math::log10;
use crate::run::simulation::StopReason;

/// Values that differ at least so many times are drawn over their logarithms, if their spacing says nothing else.
const LOGARITHMIC: f64 = 30.0;

/// Colours show logarithms from here on: evenly spread over the values, all below a tenth of the greatest would share a
/// tenth of the [`SHADES`].
const LOGARITHMIC_COLOURS: f64 = 10.0;

/// Spacings that differ by less than this part are equal.
const EVEN: f64 = 1e-6;

/// The proportion of the frame.
const HEIGHT: f64 = 0.72;
/// The greatest height of the frame, mm.
const TALLEST: f64 = 90.0;

/// The width of the bar of colours, and its distance from the frame, mm.
const BAR: f64 = 3.0;
const BAR_GAP: f64 = 2.5;
/// The number of colours in the bar.
const SHADES: usize = 64;

/// The radius of the dots of a sample, mm.
const DOT: f64 = 0.55;

/// Colours from small to large values: equal steps look equal, and in grey too (viridis, S. van der Walt and N. Smith).
const RAMP: [Colour; 9] = [
    Colour(68, 1, 84),
    Colour(71, 44, 122),
    Colour(59, 81, 139),
    Colour(44, 113, 142),
    Colour(33, 144, 141),
    Colour(39, 173, 129),
    Colour(92, 200, 99),
    Colour(170, 220, 50),
    Colour(253, 231, 37),
];

/// What is told of runs that have no outcome, and their colour.
const NO_OUTCOME_WORDS: &str = "no outcome";
const NO_OUTCOME: Colour = Colour(0x30, 0x30, 0x30);

/// The colour of reasons to stop that are not known here.
const UNKNOWN: Colour = Colour(0xf0, 0xc8, 0xa0);

/// The colour of runs that stopped for a reason and have no value to show: the same in every figure, and none of the ramp.
fn stop_colour(stop: StopReason) -> Colour {
    match stop {
        StopReason::Fallen => Colour(0xd5, 0x5e, 0x00),
        StopReason::Duration => Colour(0xdd, 0xdd, 0xdd),
        StopReason::Risen => Colour(0xcc, 0x79, 0xa7),
        StopReason::SlipStopped => Colour(0x99, 0x99, 0x99),
        StopReason::Rest => Colour(0xa6, 0xce, 0xe3),
        StopReason::Singular => Colour(0x8c, 0x56, 0x4b),
        StopReason::Jam => Colour(0x80, 0x00, 0x20),
        StopReason::Pivot => Colour(0xff, 0xb6, 0xc1),
        StopReason::Interrupted | StopReason::Failed => NO_OUTCOME,
    }
}

/// A quantity of a map: its name, its unit, and its value in each run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapAxis {
    /// The name of its column.
    pub name: String,
    /// The unit; empty where there is none.
    pub unit: String,
    /// The values; NaN where there is none.
    pub values: Vec<f64>,
}

/// What a map is drawn of. All lists are as long as there are runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// What varies across.
    pub x: MapAxis,
    /// What varies upward; none draws curves.
    pub y: Option<MapAxis>,
    /// What colours or curves show.
    pub color: MapAxis,
    /// Why each run stopped; none where it has no outcome.
    pub stops: Vec<Option<String>>,
    /// Whether the axis looped; none where that is not known.
    pub loops: Vec<Option<bool>>,
    /// The scenario of each run: each has a curve of its own.
    pub scenarios: Vec<String>,
}

/// Values along an axis, as they are drawn: logarithms if `is_log`.
struct Along {
    is_log: bool,
    /// Each different value once, in order.
    values: Vec<f64>,
    /// Where these are drawn: neighbours that differ too little may be drawn at one place.
    levels: Vec<f64>,
    /// Where each run is drawn.
    places: Vec<f64>,
}

/// A border between two cells of a grid of which only one loops.
struct Border {
    /// The cell on its left or below it.
    column: usize,
    row: usize,
    /// Whether the other cell is on the right rather than above.
    is_upright: bool,
    /// 1 where the other cell loops, −1 where this one does.
    toward: f64,
}

impl Along {
    fn new(values: &[f64]) -> Self {
        Self::of(values, is_logarithmic(values))
    }

    /// Values as colours show them.
    fn of_colours(values: &[f64]) -> Self {
        let (least, greatest) = extremes(values.iter().copied());
        let is_log = least > 0.0 && greatest >= LOGARITHMIC_COLOURS * least;
        Self::of(values, is_log)
    }

    fn of(values: &[f64], is_log: bool) -> Self {
        let place = |value: &f64| if is_log { log10(*value) } else { *value };
        let places: Vec<f64> = values.iter().map(place).collect();
        let drawn = values.iter().filter(|value| place(value).is_finite());
        let mut values: Vec<f64> = drawn.copied().collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        Self {
            is_log,
            levels: values.iter().map(place).collect(),
            values,
            places,
        }
    }

    /// The ends of the cell around each level: halfway to its neighbours; a level without any has a tenth of its value on
    /// both sides.
    fn edges(&self) -> Vec<f64> {
        let levels = &self.levels;
        let between = levels
            .windows(2)
            .map(|pair| f64::midpoint(pair[0], pair[1]));
        let between: Vec<_> = between.collect();
        let (Some(first), Some(last)) = (levels.first(), levels.last()) else {
            return Vec::new();
        };
        let alone = if *first == 0.0 {
            1.0
        } else {
            0.1 * first.abs()
        };
        let low = first - between.first().map_or(alone, |edge| edge - first);
        let high = last + between.last().map_or(alone, |edge| last - edge);
        let mut edges = vec![low];
        edges.extend(between);
        edges.push(high);
        edges
    }

    /// Which of the different values this is.
    fn level(&self, value: f64) -> Option<usize> {
        let level = self.values.partition_point(|other| *other < value);
        (self.values.get(level) == Some(&value)).then_some(level)
    }

    fn scale(&self, (low, high): Point, most: usize) -> Scale {
        scale(self.is_log, (low, high), most)
    }
}

fn scale(is_log: bool, (low, high): (f64, f64), most: usize) -> Scale {
    if is_log {
        Scale::of_logarithms(low, high, most)
    } else {
        Scale::new(low, high, most)
    }
}

/// Whether values are better drawn over their logarithms: those of a grid if that spaces them evenly, others if they
/// differ widely.
fn is_logarithmic(values: &[f64]) -> bool {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else {
        return false;
    };
    if *first <= 0.0 || sorted.len() < 3 {
        return *first > 0.0 && last / first >= LOGARITHMIC;
    }
    let logarithms: Vec<f64> = sorted.iter().map(|value| log10(*value)).collect();
    let is_even = |levels: &[f64]| {
        let gaps = levels.windows(2).map(|pair| pair[1] - pair[0]);
        let (least, greatest) = extremes(gaps);
        least > 0.0 && greatest - least <= EVEN * greatest
    };
    if is_even(&sorted) {
        false
    } else {
        is_even(&logarithms) || last / first >= LOGARITHMIC
    }
}

impl Map {
    /// Draws the map with a width in mm.
    ///
    /// # Errors
    /// What stands in the way: no runs, or several at one place.
    pub fn draw(&self, width: f64) -> Result<Drawing, String> {
        let placed = self.placed();
        if placed.stops.is_empty() {
            let also = self.y.iter().map(|y| format!(" and one of {}", y.name));
            let also: String = also.collect();
            return Err(format!("no run has a value of {}{also}", self.x.name));
        }
        placed.drawn(width)
    }

    /// The runs that have a place in the figure.
    fn placed(&self) -> Self {
        let is_placed = |run: usize| {
            let mut axes = [&self.x].into_iter().chain(&self.y);
            axes.all(|axis| axis.values[run].is_finite())
        };
        fn of<T: Clone>(all: &[T], runs: &[usize]) -> Vec<T> {
            runs.iter().map(|run| all[*run].clone()).collect()
        }
        let runs: Vec<usize> = (0..self.stops.len())
            .filter(|run| is_placed(*run))
            .collect();
        let axis = |axis: &MapAxis| MapAxis {
            values: of(&axis.values, &runs),
            ..axis.clone()
        };
        Self {
            x: axis(&self.x),
            y: self.y.as_ref().map(axis),
            color: axis(&self.color),
            stops: of(&self.stops, &runs),
            loops: of(&self.loops, &runs),
            scenarios: of(&self.scenarios, &runs),
        }
    }

    fn drawn(&self, width: f64) -> Result<Drawing, String> {
        for axis in [&self.x, &self.color].into_iter().chain(&self.y) {
            let is_beyond = |value: &&f64| value.is_finite() && value.abs() >= BEYOND_USE;
            if let Some(value) = axis.values.iter().find(is_beyond) {
                return Err(format!(
                    "{} is {value:e} in one of the runs: numbers from {BEYOND_USE:e} on can't be drawn",
                    axis.name
                ));
            }
        }
        let mut drawing = match &self.y {
            Some(y) => self.plane(y, width)?,
            None => self.curves(width)?,
        };
        let over = self.y.iter().map(|y| format!(" and {}", y.name));
        let over: String = over.collect();
        drawing.title = format!("{} over {}{over}", self.color.name, self.x.name);
        Ok(drawing)
    }

    /// What stands for a run that has no value to show.
    fn outcome(&self, run: usize) -> &str {
        self.stops[run].as_deref().unwrap_or(NO_OUTCOME_WORDS)
    }

    /// The outcomes of runs that have no value to show, in the order of their names.
    fn outcomes(&self) -> Vec<&str> {
        let valueless = (0..self.stops.len()).filter(|run| !self.color.values[*run].is_finite());
        let mut outcomes: Vec<_> = valueless.map(|run| self.outcome(run)).collect();
        outcomes.sort_unstable();
        outcomes.dedup();
        outcomes
    }

    /// The colours of outcomes.
    fn outcome_colours(&self) -> Vec<(&str, Colour)> {
        let colour = |outcome: &str| {
            let stop = StopReason::ALL.iter().find(|stop| stop.name() == outcome);
            match stop {
                Some(stop) => stop_colour(*stop),
                None if outcome == NO_OUTCOME_WORDS => NO_OUTCOME,
                None => UNKNOWN,
            }
        };
        let outcomes = self.outcomes().into_iter();
        outcomes.map(|outcome| (outcome, colour(outcome))).collect()
    }

    /// The entry of an outcome in a legend.
    fn entry(&self, outcome: &str, colour: Colour) -> Entry {
        Entry::area(colour, &outcome_words(outcome, &self.color.name))
    }

    /// A map over two keys.
    fn plane(&self, y: &MapAxis, width: f64) -> Result<Drawing, String> {
        let (across, upward) = (Along::new(&self.x.values), Along::new(&y.values));
        let cells = self.cells(y, &across, &upward)?;
        let shades = Along::of_colours(&self.color.values);
        let colours = self.outcome_colours();
        let range = extremes(shades.levels.iter().copied());
        let of = |run: usize| {
            let place = shades.places[run];
            if place.is_finite() {
                return shade(place, range);
            }
            let outcome = self.outcome(run);
            let found = colours.iter().find(|(name, _)| *name == outcome);
            found.map_or(NO_OUTCOME, |(_, colour)| *colour)
        };
        let borders = match &cells {
            Some(cells) => self.borders(cells, across.levels.len()),
            None => Vec::new(),
        };

        let mut drawing = Drawing::new(width);
        let mut key: Vec<_> = colours
            .iter()
            .map(|(outcome, colour)| self.entry(outcome, *colour))
            .collect();
        if !borders.is_empty() {
            key.push(Entry::line(
                contour(),
                "edge of the runs that loop; ticks point to them",
            ));
        }
        let legend_room = legend::draw_at_top(&mut drawing, &key);
        let has_bar = !shades.levels.is_empty();
        let top = legend_room + if has_bar { LINE } else { 0.0 } + 0.6;

        let [x_range, y_range] = match &cells {
            Some(_) => [&across, &upward].map(|axis| extremes(axis.edges().into_iter())),
            None => [&across, &upward].map(|axis| aired(extremes(axis.levels.iter().copied()))),
        };
        let height = TALLEST.min(width * HEIGHT);
        let y_scale = upward.scale(y_range, frame::ticks_up(height));
        let y_text = label(y, y_scale.exponent);
        let left = MARGIN + frame::room_beside(&y_scale, &y_text);
        let bar_scale = scale(shades.is_log, range, frame::ticks_up(height));
        let bar_room = if has_bar {
            BAR_GAP + BAR + 1.0 + frame::ticks_width(&bar_scale)
        } else {
            frame::ROOM_RIGHT
        };
        let right = width - MARGIN - bar_room;
        let bounds = Bounds {
            left,
            top,
            right,
            bottom: top + height,
        };
        let frame = Frame {
            x: across.scale(x_range, frame::ticks_across(right - left)),
            y: y_scale,
            bounds,
        };
        match &cells {
            Some(cells) => {
                draw_cells(&mut drawing, &frame, [&across, &upward], cells, &of);
                if !borders.is_empty() {
                    let lines = contour_lines(&frame, [&across, &upward], &borders);
                    drawing.group("where looping begins", lines);
                }
            }
            None => {
                let runs = 0..across.places.len();
                let dots = runs.filter_map(|run| {
                    let place = (across.places[run], upward.places[run]);
                    let is_there = place.0.is_finite() && place.1.is_finite();
                    is_there.then(|| dot(frame.place(place), of(run)))
                });
                let dots = dots.collect();
                drawing.group("runs", dots);
            }
        }
        frame.draw(&mut drawing);
        frame.label_x(&mut drawing, label(&self.x, frame.x.exponent));
        frame.label_y(&mut drawing, y_text, frame::ticks_width(&frame.y));
        if has_bar {
            self.draw_bar(&mut drawing, bounds, bar_scale, range);
        }
        drawing.height = bounds.bottom + frame::ROOM_BELOW + MARGIN;
        Ok(drawing)
    }

    /// The run in each cell of a grid, row by row upward; none if the runs make no grid.
    fn cells(
        &self,
        y: &MapAxis,
        across: &Along,
        upward: &Along,
    ) -> Result<Option<Vec<Option<usize>>>, String> {
        let (columns, rows) = (across.levels.len(), upward.levels.len());
        let runs = across.places.len();
        // A grid with holes is one still; a sample has about as many values as runs.
        if columns * rows > 2 * runs {
            return Ok(None);
        }
        let mut cells = vec![None; columns * rows];
        for run in 0..runs {
            let at = [
                across.level(self.x.values[run]),
                upward.level(y.values[run]),
            ];
            let [Some(column), Some(row)] = at else {
                continue;
            };
            if cells[row * columns + column].replace(run).is_some() {
                return Err(format!(
                    "several runs have {} = {:?} and {} = {:?}: choose among them with --where",
                    self.x.name, self.x.values[run], y.name, y.values[run]
                ));
            }
        }
        Ok(Some(cells))
    }

    /// The borders between cells of which only one loops, where both are known.
    fn borders(&self, cells: &[Option<usize>], columns: usize) -> Vec<Border> {
        let rows = cells.len() / columns.max(1);
        let loops = |column: usize, row: usize| {
            let is_there = column < columns && row < rows;
            let run = is_there.then(|| cells[row * columns + column]).flatten()?;
            self.loops[run]
        };
        let mut borders = Vec::new();
        for row in 0..rows {
            for column in 0..columns {
                let neighbours = [(true, column + 1, row), (false, column, row + 1)];
                for (is_upright, right, above) in neighbours {
                    let pair = loops(column, row).zip(loops(right, above));
                    if let Some((here, there)) = pair
                        && here != there
                    {
                        borders.push(Border {
                            column,
                            row,
                            is_upright,
                            toward: if there { 1.0 } else { -1.0 },
                        });
                    }
                }
            }
        }
        borders
    }

    fn draw_bar(&self, drawing: &mut Drawing, beside: Bounds, scale: Scale, range: (f64, f64)) {
        let left = beside.right + BAR_GAP;
        let bounds = Bounds {
            left,
            right: left + BAR,
            ..beside
        };
        let bar = Frame {
            x: Scale::new(0.0, 1.0, 3),
            y: scale,
            bounds,
        };
        let step = bounds.height() / SHADES as f64;
        let shades = (0..SHADES).map(|shade_of| {
            let bottom = bounds.bottom - shade_of as f64 * step;
            let middle = (shade_of as f64 + 0.5) / SHADES as f64;
            let value = bar.y.low + middle * (bar.y.high - bar.y.low);
            Shape::Area {
                points: Bounds {
                    top: (bottom - step - OVERLAP).max(bounds.top),
                    bottom,
                    ..bounds
                }
                .corners(),
                fill: shade(value, range),
            }
        });
        drawing.group("colours", shades.collect());
        let mut border = bounds.corners();
        border.extend_from_within(..1);
        let stroke = style::frame();
        drawing.group(
            "frame",
            vec![Shape::Line {
                points: border,
                stroke,
            }],
        );
        for tick in bar.y.ticks() {
            let y = bar.place((0.0, tick.value)).1 + 0.33 * FONT;
            let text = Text::plain(&tick.label);
            drawing.label(text, (bounds.right + 1.0, y), Anchor::Start);
        }
        let text = label(&self.color, bar.y.exponent);
        let right = drawing.width - MARGIN;
        drawing.label(text, (right, bounds.top - frame::ABOVE), Anchor::End);
    }

    /// Curves over one key: one for each scenario.
    fn curves(&self, width: f64) -> Result<Drawing, String> {
        let across = Along::new(&self.x.values);
        let upward = Along::new(&self.color.values);
        let mut names: Vec<&str> = self.scenarios.iter().map(String::as_str).collect();
        names.sort_unstable();
        names.dedup();
        let colours = self.outcome_colours();
        let mut drawing = Drawing::new(width);
        let most = COLOURS.len() * DASHES.len();
        if names.len() > most {
            return Err(format!(
                "{} scenarios are more than the {most} curves that can be told apart: choose with --where scenario=NAME",
                names.len()
            ));
        }
        let stroke = |curve: usize| Stroke {
            dash: DASHES[curve / COLOURS.len()],
            ..style::line(COLOURS[curve % COLOURS.len()], MEDIUM)
        };
        let strokes: Vec<_> = (0..names.len()).map(stroke).collect();
        let mut key = Vec::new();
        if names.len() > 1 {
            let lines = names.iter().zip(&strokes);
            key.extend(lines.map(|(name, stroke)| Entry::of(*stroke, Text::name(name))));
        }
        let entries = colours.iter();
        key.extend(entries.map(|(outcome, colour)| self.entry(outcome, *colour)));
        let top = legend::draw_at_top(&mut drawing, &key) + 0.6;
        let height = TALLEST.min(width * HEIGHT);
        // What has no value is marked below the curves: a strip for each.
        let strips = if colours.is_empty() { 0 } else { names.len() };
        let pitch = (STRIP + STRIP_GAP).min(STRIPS * height / strips.max(1) as f64);
        let strip = pitch * STRIP / (STRIP + STRIP_GAP);
        let (low, high) = aired(union(NONE, extremes(upward.levels.iter().copied())));
        let part = (strips as f64 * pitch) / height;
        let low = low - (high - low) * part / (1.0 - part);
        let y_scale = upward.scale((low, high), frame::ticks_up(height));
        let text = label(&self.color, y_scale.exponent);
        let left = MARGIN + frame::room_beside(&y_scale, &text);
        let bounds = Bounds {
            left,
            top,
            right: width - MARGIN - frame::ROOM_RIGHT,
            bottom: top + height,
        };
        let frame = Frame {
            x: across.scale(
                aired(extremes(across.levels.iter().copied())),
                frame::ticks_across(bounds.width()),
            ),
            y: y_scale,
            bounds,
        };
        for (index, (name, stroke)) in names.iter().zip(&strokes).enumerate() {
            let mut runs: Vec<usize> = (0..self.scenarios.len())
                .filter(|run| self.scenarios[*run] == *name && across.places[*run].is_finite())
                .collect();
            runs.sort_by(|a, b| self.x.values[*a].total_cmp(&self.x.values[*b]));
            if let Some(pair) = runs
                .windows(2)
                .find(|pair| self.x.values[pair[0]] == self.x.values[pair[1]])
            {
                return Err(format!(
                    "several runs of {name} have {} = {:?}: choose among them with --where",
                    self.x.name, self.x.values[pair[0]]
                ));
            }
            let points: Vec<Point> = runs
                .iter()
                .map(|run| (across.places[*run], upward.places[*run]))
                .collect();
            let mut shapes = frame.line(&points, *stroke);
            let there = points.iter().filter(|point| point.1.is_finite());
            shapes.extend(there.map(|point| dot(frame.place(*point), stroke.colour)));
            drawing.group(name, shapes);
            let y = bounds.bottom - (strips - index.min(strips)) as f64 * pitch;
            let marks = runs.iter().filter(|run| !upward.places[**run].is_finite());
            let marks = marks.map(|run| {
                let outcome = self.outcome(*run);
                let colour = colours.iter().find(|(name, _)| *name == outcome);
                let x = frame.place((across.places[*run], low)).0;
                Shape::Area {
                    points: Bounds {
                        left: x - 0.6,
                        top: y,
                        right: x + 0.6,
                        bottom: y + strip,
                    }
                    .corners(),
                    fill: colour.map_or(NO_OUTCOME, |(_, colour)| *colour),
                }
            });
            let marks: Vec<_> = marks.collect();
            if !marks.is_empty() {
                drawing.group(&format!("{name}: no value"), marks);
            }
        }
        frame.draw(&mut drawing);
        frame.label_x(&mut drawing, label(&self.x, frame.x.exponent));
        frame.label_y(&mut drawing, text, frame::ticks_width(&frame.y));
        drawing.height = bounds.bottom + frame::ROOM_BELOW + MARGIN;
        Ok(drawing)
    }
}

/// The height of the marks of runs without a value, and the distance between those of two scenarios, mm.
const STRIP: f64 = 1.2;
const STRIP_GAP: f64 = 0.5;

/// The most of the frame's height that these marks take.
const STRIPS: f64 = 0.25;

/// The length of the ticks at the edge of what loops, mm.
const EDGE_TICK: f64 = 0.9;

/// Areas reach so far below their upper and right neighbours, which are drawn later, mm: no seams show.
const OVERLAP: f64 = 0.15;

/// The line around what loops.
fn contour() -> Stroke {
    style::line(style::BLACK, MEDIUM)
}

/// Borders as lines, with a tick in the middle of each toward the cell that loops.
fn contour_lines(frame: &Frame, axes: [&Along; 2], borders: &[Border]) -> Vec<Shape> {
    let [xs, ys] = axes.map(Along::edges);
    let mut lines = Vec::new();
    for border in borders {
        let (column, row) = (border.column, border.row);
        let (from, (right, up)) = if border.is_upright {
            ((xs[column + 1], ys[row]), (border.toward, 0.0))
        } else {
            ((xs[column], ys[row + 1]), (0.0, border.toward))
        };
        let (from, to) = (
            frame.place(from),
            frame.place((xs[column + 1], ys[row + 1])),
        );
        let (x, y) = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
        let tick = vec![(x, y), (x + right * EDGE_TICK, y - up * EDGE_TICK)];
        for points in [vec![from, to], tick] {
            lines.push(Shape::Line {
                points,
                stroke: contour(),
            });
        }
    }
    lines
}

fn dot(centre: Point, fill: Colour) -> Shape {
    Shape::Dot {
        centre,
        radius: DOT,
        fill,
        stroke: style::line(fill, 0.1),
    }
}

/// The columns of times of what every top may do sooner or later, so that none says "not yet". What a fixed peg never does is
/// not among them.
const AWAITED: [&str; 3] = ["rise_time", "weak_time", "loop_time"];

/// An outcome, for people, where a run has no value in a column.
fn outcome_words(outcome: &str, column: &str) -> String {
    match outcome {
        "duration" if AWAITED.contains(&column) => "not by the end of the run".to_owned(),
        "duration" => "none in the whole run".to_owned(),
        other => other.replace('_', " "),
    }
}

/// The label of an axis.
fn label(axis: &MapAxis, exponent: i32) -> Text {
    let name = Text::plain(&axis.name);
    let factor = match exponent {
        0 => String::new(),
        _ => format!("×1e{exponent}").replace('-', "−"),
    };
    match format!("{factor} {}", axis.unit).trim() {
        "" => name,
        unit => name.followed_by(&format!(" ({unit})")),
    }
}

/// A range with some air at its ends.
fn aired((low, high): (f64, f64)) -> (f64, f64) {
    let air = 0.04 * (high - low);
    (low - air, high + air)
}

/// The colour of a value in a range.
fn shade(value: f64, (low, high): (f64, f64)) -> Colour {
    let part = if high > low {
        ((value - low) / (high - low)).clamp(0.0, 1.0)
    } else {
        0.5
    };
    let place = part * (RAMP.len() - 1) as f64;
    let index = (place as usize).min(RAMP.len() - 2);
    let (Colour(r0, g0, b0), Colour(r1, g1, b1)) = (RAMP[index], RAMP[index + 1]);
    let share = place - index as f64;
    let mix = |one: u8, other: u8| {
        (f64::from(one) + share * (f64::from(other) - f64::from(one))).round() as u8
    };
    Colour(mix(r0, r1), mix(g0, g1), mix(b0, b1))
}

fn draw_cells(
    drawing: &mut Drawing,
    frame: &Frame,
    axes: [&Along; 2],
    cells: &[Option<usize>],
    colour: &dyn Fn(usize) -> Colour,
) {
    let [xs, ys] = axes.map(Along::edges);
    let columns = axes[0].levels.len();
    let mut shapes = Vec::new();
    for row in 0..axes[1].levels.len() {
        // Neighbours of one colour are one area: smaller files.
        let mut start = 0;
        while start < columns {
            let fill = |column: usize| cells[row * columns + column].map(colour);
            let Some(own) = fill(start) else {
                start += 1;
                continue;
            };
            let mut end = start + 1;
            while end < columns && fill(end) == Some(own) {
                end += 1;
            }
            let (left, bottom) = frame.place((xs[start], ys[row]));
            let (right, top) = frame.place((xs[end], ys[row + 1]));
            let right = (right + OVERLAP).min(frame.bounds.right);
            let top = (top - OVERLAP).max(frame.bounds.top);
            shapes.push(Shape::Area {
                points: Bounds {
                    left,
                    top,
                    right,
                    bottom,
                }
                .corners(),
                fill: own,
            });
            start = end;
        }
    }
    drawing.group("runs", shapes);
}

#[cfg(test)]
mod tests {
    use super::*;
    const NAN: f64 = f64::NAN;

    #[test]
    fn widely_spread_values_are_drawn_over_their_logarithms() {
        let is_log =
            |values: &[f64]| [Along::new(values), Along::of_colours(values)].map(|a| a.is_log);
        // From thirtyfold on along axes, from tenfold on in colours, and never with zeros or negative numbers.
        for (values, expected) in [
            (vec![1.0, 4.0, 9.0], [false, false]),
            (vec![1.0, 4.0, f64::NAN, 10.0], [false, true]),
            (vec![1.0, 4.0, 30.0], [true, true]),
            (vec![0.0, 4.0, 100.0], [false, false]),
            (vec![-1.0, 4.0, 100.0], [false, false]),
            // A grid says how it is spaced.
            (vec![1.0, 2.0, 4.0], [true, false]),
            (vec![1.0, 20.5, 40.0], [false, true]),
            (vec![f64::NAN], [false, false]),
        ] {
            assert_eq!(is_log(&values), expected, "{values:?}");
        }
    }

    fn axis(name: &str, values: &[f64]) -> MapAxis {
        MapAxis {
            name: name.to_owned(),
            unit: String::new(),
            values: values.to_vec(),
        }
    }

    /// Runs of several scenarios over two frictions, of which the second has no value.
    fn curves(scenarios: usize, column: &str) -> Map {
        let runs = 2 * scenarios;
        let of = |values: [f64; 2]| -> Vec<f64> { values.into_iter().cycle().take(runs).collect() };
        Map {
            x: axis("friction_k", &of([0.01, 0.02])),
            y: None,
            color: axis(column, &of([3.0, f64::NAN])),
            stops: vec![Some("duration".to_owned()); runs],
            loops: vec![Some(false); runs],
            scenarios: (0..runs).map(|run| format!("s{}", run / 2)).collect(),
        }
    }

    fn texts(drawing: &Drawing) -> Vec<&str> {
        let labels = drawing.labels.iter();
        labels.map(|label| label.text.spoken.as_str()).collect()
    }

    #[test]
    fn what_a_column_can_never_have_is_not_called_late() {
        let told = |column| curves(1, column).draw(85.0).unwrap();
        assert!(texts(&told("rise_time")).contains(&"not by the end of the run"));
        assert!(texts(&told("hops")).contains(&"none in the whole run"));
    }

    #[test]
    fn labels_have_power_and_unit_where_there_are_any() {
        let label = |unit: &str, exponent| {
            let axis = MapAxis {
                unit: unit.to_owned(),
                ..axis("k", &[])
            };
            super::label(&axis, exponent).spoken
        };
        assert_eq!(label("", 0), "k");
        assert_eq!(label("s", 0), "k (s)");
        assert_eq!(label("", -3), "k (×1e−3)");
        assert_eq!(label("s", 3), "k (×1e3 s)");
    }

    #[test]
    fn a_single_value_is_in_the_middle_of_an_axis_of_its_size() {
        assert_eq!(Along::new(&[0.5]).edges(), [0.45, 0.55]);
        assert_eq!(Along::new(&[-20.0]).edges(), [-22.0, -18.0]);
        assert_eq!(Along::new(&[0.0]).edges(), [-1.0, 1.0]);
        assert_eq!(Along::new(&[1.0, 2.0]).edges(), [0.5, 1.5, 2.5]);
    }

    #[test]
    fn many_curves_differ_and_leave_room_for_marks() {
        let drawing = curves(35, "rise_time").draw(150.0).unwrap();
        let shapes = |suffix: &str| {
            let groups = drawing.groups.iter();
            let groups = groups.filter(|group| group.meaning.ends_with(suffix));
            groups.flat_map(|group| &group.shapes).collect::<Vec<_>>()
        };
        let heights = |shapes: &[&Shape]| {
            let ends = shapes.iter().map(|shape| match shape {
                Shape::Area { points, .. } => extremes(points.iter().map(|point| point.1)),
                Shape::Dot { centre, .. } => (centre.1, centre.1),
                Shape::Line { points, .. } => extremes(points.iter().map(|point| point.1)),
            });
            ends.fold(NONE, union)
        };
        let mut dots = shapes("");
        dots.retain(|shape| matches!(shape, Shape::Dot { .. }));
        assert_eq!(dots.len(), 35);
        let (marks, frame) = (heights(&shapes("no value")), heights(&shapes("frame")));
        assert!(
            marks.1 <= frame.1 && marks.0 > heights(&dots).1,
            "{marks:?}"
        );
        let keys = drawing.groups.iter();
        let keys = keys.filter(|group| group.meaning.starts_with("key: s"));
        let strokes = keys.filter_map(|group| match group.shapes.first() {
            Some(Shape::Line { stroke, .. }) => Some(format!("{stroke:?}")),
            _ => None,
        });
        let strokes: std::collections::BTreeSet<_> = strokes.collect();
        assert_eq!(strokes.len(), 35);

        let told = curves(36, "rise_time").draw(150.0).unwrap_err();
        assert!(told.contains("36 scenarios"), "{told}");
    }

    /// A grid of two by two, over x = 1, 2 and y = 1, 2.
    fn grid(shown: [f64; 4], stops: [Option<&str>; 4], loops: [Option<bool>; 4]) -> Map {
        Map {
            x: axis("friction_k", &[1.0, 2.0, 1.0, 2.0]),
            y: Some(axis("initial_theta", &[1.0, 1.0, 2.0, 2.0])),
            color: axis("rise_time", &shown),
            stops: stops.map(|stop| stop.map(str::to_owned)).to_vec(),
            loops: loops.to_vec(),
            scenarios: vec!["paper".to_owned(); 4],
        }
    }

    const EDGE: &str = "edge of the runs that loop; ticks point to them";

    #[test]
    fn runs_without_an_outcome_have_no_edge_of_looping() {
        let (yes, no) = (Some(true), Some(false));
        let (risen, shown) = (
            [Some("risen"), None, Some("risen"), None],
            [1.0, NAN, 2.0, NAN],
        );
        let lines = |loops| {
            let drawing = grid(shown, risen, loops).draw(85.0).unwrap();
            let edge = drawing.groups.iter();
            let mut edge = edge.filter(|group| group.meaning == "where looping begins");
            let lines = edge.next().map_or(0, |group| group.shapes.len());
            assert_eq!(texts(&drawing).contains(&EDGE), lines > 0);
            lines
        };
        // Each border has a tick.
        assert_eq!(lines([yes, None, no, None]), 2);
        assert_eq!(lines([yes, None, yes, None]), 0);
        assert_eq!(lines([yes, None, None, no]), 0);
        assert_eq!(lines([yes, no, no, no]), 4);
    }

    #[test]
    fn a_reason_to_stop_has_one_colour_in_all_figures() {
        let colours = |stops: [Option<&str>; 4]| -> Vec<Colour> {
            let map = grid([NAN; 4], stops, [None; 4]);
            let colours = map.outcome_colours().into_iter();
            colours.map(|(_, colour)| colour).collect()
        };
        let slip = Some("slip_stopped");
        let alone = colours([slip; 4]);
        let among = colours([Some("risen"), Some("rest"), slip, None]);
        assert_eq!(among.len(), 4);
        assert_eq!(among.last(), alone.first());
        let all = StopReason::ALL.into_iter().map(stop_colour);
        let mut all: Vec<_> = all.map(|colour| format!("{colour:?}")).collect();
        all.sort();
        all.dedup();
        // Those that leave no outcome share a colour.
        assert_eq!(all.len(), StopReason::ALL.len() - 1);
    }

    #[test]
    fn what_is_not_drawn_is_neither_in_the_legend_nor_in_the_range() {
        let mut map = grid(
            [1.0, NAN, 2.0, NAN],
            [Some("risen"), Some("fallen"), Some("risen"), Some("rest")],
            [None; 4],
        );
        map.x.values = map.color.values.clone();
        map.y = Some(axis("theta", &[0.01, 3.0, 0.02, 2.0]));
        let drawing = map.draw(85.0).unwrap();
        for absent in ["fallen", "rest", "2", "3"] {
            let up = texts(&drawing);
            let is_there = up.iter().filter(|text| **text == absent).count();
            // The times 1 and 2 are at the x axis and the bar.
            assert!(
                is_there <= if absent == "2" { 2 } else { 0 },
                "{absent}: {up:?}"
            );
        }
        map.y = Some(axis("theta", &[NAN, 1.0, NAN, 1.0]));
        let told = map.draw(85.0).unwrap_err();
        assert_eq!(told, "no run has a value of friction_k and one of theta");
    }

    #[test]
    fn values_that_hardly_differ_are_different_places() {
        let near = [1e15, 1.0000000000000002e15, 1.0000000000000004e15];
        assert!(!Along::new(&near).is_log);
        let wide = Along::new(&[near[0], near[1], 1e20]);
        assert!(wide.is_log);
        assert_eq!(wide.level(near[1]), Some(1));
        let runs = |y: [f64; 3]| {
            let all = near.into_iter().cycle().take(9).collect::<Vec<_>>();
            let up: Vec<f64> = y.into_iter().flat_map(|value| [value; 3]).collect();
            Map {
                x: axis("initial_phi", &all),
                y: Some(axis("initial_theta", &up)),
                color: axis("rise_time", &[1.0; 9]),
                stops: vec![None; 9],
                loops: vec![None; 9],
                scenarios: vec![String::new(); 9],
            }
        };
        assert!(runs([0.1, 0.2, 0.3]).draw(85.0).is_ok());
        let told = runs([5e-324, 5e-324, 0.3]).draw(85.0).unwrap_err();
        assert!(told.contains("initial_theta = 5e-324:"), "{told}");
    }
}
