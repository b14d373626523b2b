//! A scan of the offset of a clock: the points of its file, compared with one motion for all offsets.

use crate::fit::error::{FitError, bare_time, time};
use crate::fit::problem::model::{Point, Problem};
use crate::words::{Piece, sentence};
use std::f64::consts::TAU;

/// Samples of the model per cycle of its nutation.
const SAMPLES_PER_CYCLE: f64 = 40.0;

/// Maximum number of samples of the model, and of points that are compared with it at once.
const MAX_SAMPLES: f64 = 200_000.0;
const MAX_POINTS: usize = 2000;

/// An offset must bring at least this part of as many points into the motion as any offset can.
const MIN_OVERLAP: f64 = 0.5;

/// Points that must be within the motion at once: with fewer, every offset describes them.
const FEWEST: usize = 10;

/// Result of a scan.
pub(in crate::fit) struct Scanned<'a> {
    /// Offsets that describe the points better than their neighbours do: those that noise can't tell from the best with
    /// the most points first, then the others by their loss.
    pub minima: Vec<Cost>,
    /// Distance between samples of the model, and between offsets, s.
    pub step: f64,
    problem: &'a Problem,
    motion: SampledMotion,
    /// The points that were compared, in order of their times: each `stride`th of all.
    compared: Vec<Point>,
    stride: usize,
}

impl Scanned<'_> {
    /// The lowest mean loss.
    pub(in crate::fit) fn lowest(&self) -> f64 {
        let losses = self.minima.iter().map(|cost| cost.loss);
        losses.fold(f64::INFINITY, f64::min)
    }

    /// The loss with an offset above that with another one, `known`, for the points that both bring into the motion.
    pub(in crate::fit) fn excess(&self, offset: f64, known: f64) -> f64 {
        let mut excess = 0.0;
        let earliest = offset.min(known);
        let first = self
            .compared
            .partition_point(|point| point.time + earliest < 0.0);
        for point in &self.compared[first..] {
            let (Some(here), Some(there)) = (
                self.motion.loss(self.problem, point, offset),
                self.motion.loss(self.problem, point, known),
            ) else {
                break;
            };
            excess += here - there;
        }
        // Each compared point stands for those that were left out.
        excess * self.stride as f64
    }

    /// Whether a point of the file is within the motion, which ends at `end`, s, with room for a small change of the
    /// offset.
    pub(in crate::fit) fn is_within(&self, point: &Point, offset: f64, end: f64) -> bool {
        is_within(point.time + offset, self.step, end)
    }
}

/// Whether a time is within the motion, which ends at `end`, with this much room, s.
pub(in crate::fit) fn is_within(time: f64, room: f64, end: f64) -> bool {
    (room..=end - room).contains(&time)
}

/// Distance between samples of a motion that ends at `end`, s.
pub(in crate::fit) fn step(problem: &Problem, end: f64) -> f64 {
    let spin = problem.scenario.rates.psi.abs().max(1.0);
    let cycle = TAU / problem.scenario.model.top.nutation_frequency(spin);
    (cycle / SAMPLES_PER_CYCLE).max(end / MAX_SAMPLES)
}

/// The mean loss of a file's points with an offset.
#[derive(Clone, Copy)]
pub(in crate::fit) struct Cost {
    /// The offset, s.
    pub offset: f64,
    /// Mean loss of the points within the motion.
    pub loss: f64,
    /// Number of these points.
    pub within: usize,
}

impl Cost {
    /// The highest mean loss that noise, of which the squares of normal values have the variance 2, can't tell from this
    /// one.
    fn highest_equal(&self) -> f64 {
        highest_equal(self.loss, self.within)
    }
}

/// The highest mean of squares that noise can't tell from this mean of so many.
pub(in crate::fit) fn highest_equal(mean: f64, count: usize) -> f64 {
    const SIGMAS: f64 = 3.0;
    mean * (1.0 + SIGMAS * (2.0 / count as f64).sqrt())
}

/// Compares the points of a file with the motion of `values` for all offsets of its clock, the parameter with the index
/// `at`, that keep enough of them within the motion.
pub(in crate::fit) fn scan<'a>(
    problem: &'a Problem,
    values: &[f64],
    points: &[Point],
    at: usize,
    end: f64,
) -> Result<Scanned<'a>, FitError> {
    let parameter = &problem.parameters[at];
    let mut compared = points.to_vec();
    compared.sort_by(|a, b| a.time.total_cmp(&b.time));
    let most = most_at_once(&compared, end);
    if most < FEWEST.min(compared.len()) {
        return Err(parameter.error(sentence!(
            "at most {} of the {} of its file are within the motion (0 to {}) at once; are the times of both files in the unit that is stated, or else in s?",
            most.to_string(),
            Piece::count(compared.len() as u64, "sample"),
            time(end)
        )));
    }
    let stride = most.div_ceil(MAX_POINTS).max(1);
    let compared: Vec<Point> = compared.into_iter().step_by(stride).collect();
    let needed = MIN_OVERLAP * most_at_once(&compared, end) as f64;
    let motion = SampledMotion::new(problem, values, &compared, at, end)?;
    let [low, high] = parameter.bounds;
    let from = compared.last().map_or(0.0, |point| -point.time).max(low);
    let to = compared
        .first()
        .map_or(0.0, |point| end - point.time)
        .min(high);
    let mut costs: Vec<Cost> = Vec::new();
    for index in 0..=((to - from) / motion.step).max(0.0) as usize {
        let offset = from + index as f64 * motion.step;
        let (mut sum, mut within) = (0.0, 0_usize);
        let first = compared.partition_point(|point| point.time + offset < 0.0);
        for point in &compared[first..] {
            let Some(loss) = motion.loss(problem, point, offset) else {
                break;
            };
            sum += loss;
            within += 1;
        }
        // A mean over few points may be low by chance.
        if within as f64 >= needed {
            costs.push(Cost {
                offset,
                loss: sum / within as f64,
                within,
            });
        }
    }
    let mut minima = local_minima(&costs);
    minima.sort_by(|a, b| a.loss.total_cmp(&b.loss));
    // A mean over few points is low by chance more often than one over many.
    let highest = minima.first().map_or(0.0, Cost::highest_equal);
    let equal = minima.partition_point(|cost| cost.loss <= highest);
    minima[..equal].sort_by_key(|cost| std::cmp::Reverse(cost.within));
    if minima.is_empty() {
        let [first, last] = reach(&compared, end, needed);
        return Err(parameter.error(sentence!(
            "no offset from {} to {} brings its file into the motion (0 to {}), but those from {} to {} do: change its bounds",
            bare_time(low + parameter.shift),
            time(high + parameter.shift),
            time(end),
            bare_time(first + parameter.shift),
            time(last + parameter.shift)
        )));
    }
    Ok(Scanned {
        minima,
        step: motion.step,
        problem,
        motion,
        compared,
        stride,
    })
}

/// The motion in the signals of a file, on a grid of times.
struct SampledMotion {
    /// Distance of the times, s.
    step: f64,
    /// Number of times.
    count: usize,
    /// The signals, ascending.
    signals: Vec<usize>,
    /// The values of one signal after the other.
    values: Vec<f64>,
}

impl SampledMotion {
    fn new(
        problem: &Problem,
        values: &[f64],
        points: &[Point],
        at: usize,
        end: f64,
    ) -> Result<Self, FitError> {
        let step = step(problem, end);
        let count = (end / step) as usize + 1;
        let mut signals: Vec<usize> = points.iter().map(|point| point.signal).collect();
        signals.sort_unstable();
        signals.dedup();
        let mut grid: Vec<Point> = Vec::new();
        for signal in &signals {
            for index in 0..count {
                grid.push(Point {
                    signal: *signal,
                    // On the clock of the file; its offset is added in the model.
                    time: index as f64 * step - values[at],
                    value: 0.0,
                    sigma: 1.0,
                });
            }
        }
        Ok(Self {
            step,
            count,
            signals,
            values: problem.predict(values, &grid)?,
        })
    }

    /// The loss of a point, which is not before the start; `None` after the end.
    fn loss(&self, problem: &Problem, point: &Point, offset: f64) -> Option<f64> {
        let residual = problem.residual_to_nearest_turn(self.value(point, offset)?, point);
        let deviate = problem.loss.transformed(residual);
        Some(deviate * deviate)
    }

    /// The value at the time of a point, which is not before the start; `None` after the end.
    fn value(&self, point: &Point, offset: f64) -> Option<f64> {
        let place = (point.time + offset) / self.step;
        if place >= (self.count - 1) as f64 {
            return None;
        }
        let row = self.signals.iter().position(|s| *s == point.signal)?;
        let at = row * self.count + place as usize;
        // Between samples of the motion, which are dense enough for a straight line.
        Some(self.values[at] + place.fract() * (self.values[at + 1] - self.values[at]))
    }
}

/// The minima: offsets whose neighbours don't have a lower loss, moved to where a parabola through the three is lowest.
fn local_minima(costs: &[Cost]) -> Vec<Cost> {
    let mut minima = Vec::new();
    for (at, cost) in costs.iter().enumerate() {
        let before = at.checked_sub(1).map(|at| costs[at]);
        let after = costs.get(at + 1).copied();
        // At the ends, one neighbour is enough.
        let is_minimum = [before, after]
            .into_iter()
            .flatten()
            .all(|other| cost.loss <= other.loss);
        if is_minimum {
            minima.push(match (before, after) {
                (Some(before), Some(after)) => vertex(before, *cost, after),
                (None, _) | (_, None) => *cost,
            });
        }
    }
    minima
}

/// The lowest point of the parabola through a minimum of the grid and its neighbours.
fn vertex(before: Cost, lowest: Cost, after: Cost) -> Cost {
    let bend = before.loss - 2.0 * lowest.loss + after.loss;
    // Offsets between them may bring too few points into the motion.
    let is_even = (after.offset - lowest.offset) < 1.5 * (lowest.offset - before.offset);
    if bend <= 0.0 || !is_even {
        return lowest;
    }
    let slope = 0.5 * (after.loss - before.loss);
    let part = -slope / bend;
    Cost {
        offset: lowest.offset + part * (after.offset - lowest.offset),
        loss: (lowest.loss + 0.5 * part * slope).max(0.0),
        within: lowest.within,
    }
}

/// The largest number of points within a time of this length, s. Points are in order of their times.
fn most_at_once(points: &[Point], length: f64) -> usize {
    let mut most = 0;
    let mut first = 0;
    for (at, point) in points.iter().enumerate() {
        while point.time - points[first].time > length {
            first += 1;
        }
        most = most.max(at + 1 - first);
    }
    most
}

/// The lowest and the highest offset that bring at least so many points into the motion, s.
fn reach(points: &[Point], end: f64, needed: f64) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (at, point) in points.iter().enumerate() {
        let after = points.partition_point(|other| other.time <= point.time + end);
        if (after - at) as f64 >= needed {
            low = low.min(-point.time);
        }
        let before = points.partition_point(|other| other.time < point.time - end);
        if (at + 1 - before) as f64 >= needed {
            high = high.max(end - point.time);
        }
    }
    [low, high]
}
