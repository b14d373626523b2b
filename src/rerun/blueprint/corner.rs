//! The corner of a chart that its curves leave to the legend.

use rerun::blueprint::components::Corner2D;

use crate::rerun::plots::Plots;
use crate::rerun::plots::curves::Curves;
use crate::rerun::plots::outline::Outline;

/// Width of a legend, relative to a chart in a window of 1366 × 768 points. Larger charts leave more room.
const WIDTH: f64 = 0.38;
/// Height of the frame of a legend, and of each of its lines, relative to such a chart.
const FRAME: f64 = 0.06;
const LINE: f64 = 0.175;

/// The corners, the preferred one first, with their places: whether they are at the right, and whether at the top.
const CORNERS: [(Corner2D, bool, bool); 4] = [
    (Corner2D::RightTop, true, true),
    (Corner2D::LeftTop, false, true),
    (Corner2D::LeftBottom, false, false),
    (Corner2D::RightBottom, true, false),
];

/// A chart of runs that have ended.
pub(super) struct EndedChart<'c> {
    pub(super) curves: &'c [Curves],
    pub(super) runs: &'c [&'c Plots],
    /// The range of the value axis, if it is not that of the values.
    pub(super) range: Option<[f64; 2]>,
    /// Length of the time axis, s.
    pub(super) duration: f64,
}

/// The corner in which the legend of a chart covers least of the curves, as far as they are known.
pub(super) fn corner_for(ended: Option<&EndedChart<'_>>) -> Corner2D {
    let Some(chart) = ended else {
        return CORNERS[0].0;
    };
    let mut curves = Vec::new();
    let mut lines = 0;
    let mut values = [f64::INFINITY, f64::NEG_INFINITY];
    for run in chart.runs {
        for plot in chart.curves {
            curves.extend(run.outline(*plot));
            for (_, [low, high]) in run.ranges(*plot) {
                lines += 1;
                values = [values[0].min(low), values[1].max(high)];
            }
        }
    }
    free_corner(
        &curves,
        lines,
        chart.range.unwrap_or(values),
        1e9 * chart.duration,
    )
}

/// The corner in which a legend covers curves least.
///
/// The chart shows these values over the time up to `end_ns`. The legend has as many lines as there are curves.
fn free_corner(curves: &[&Outline], lines: usize, values: [f64; 2], end_ns: f64) -> Corner2D {
    let height = (FRAME + LINE * lines as f64) * (values[1] - values[0]);
    let [low, high] = [values[0] + height, values[1] - height];
    let mut best = (CORNERS[0].0, f64::INFINITY);
    for (corner, is_right, is_top) in CORNERS {
        let band = if is_top {
            [high, values[1]]
        } else {
            [values[0], low]
        };
        let mut covered = 0.0;
        for outline in curves {
            let (mut count, mut sum) = (0, 0.0);
            for (time_ns, range) in outline.ranges() {
                let distance = if is_right { end_ns - time_ns } else { time_ns };
                if distance < WIDTH * end_ns {
                    count += 1;
                    sum += hidden_part(range, band, values[1] - values[0]);
                }
            }
            covered += sum / f64::from(count.max(1));
        }
        if covered < best.1 {
            best = (corner, covered);
        }
    }
    best.0
}

/// The part of a curve with this range of values that a legend in a band of values hides: one for the curve, and up to one more
/// for the part of the chart's height that the curve fills behind the legend.
fn hidden_part(range: [f64; 2], band: [f64; 2], height: f64) -> f64 {
    let [low, high] = [range[0].max(band[0]), range[1].min(band[1])];
    if low <= high {
        1.0 + (high - low) / height
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Corner2D::{LeftBottom, LeftTop, RightBottom, RightTop};

    /// The corner for a curve over 10 s in a chart of values from 0 to 1.
    fn corner(curve: impl Fn(f64) -> f64) -> Corner2D {
        let mut outline = Outline::new();
        for step in 0..1000 {
            let time = f64::from(step) / 1000.0;
            outline.add((time * 1e10) as u64, curve(time));
        }
        free_corner(&[&outline], 2, [0.0, 1.0], 1e10)
    }

    #[test]
    fn legends_avoid_curves() {
        for (curve, expected) in [
            (rising as fn(f64) -> f64, LeftTop),
            (falling, RightTop),
            (low, RightTop),
            (high, LeftBottom),
        ] {
            assert_eq!(corner(curve), expected);
        }
    }

    fn rising(time: f64) -> f64 {
        time
    }

    fn falling(time: f64) -> f64 {
        1.0 - time
    }

    fn low(_time: f64) -> f64 {
        0.1
    }

    fn high(_time: f64) -> f64 {
        0.9
    }

    #[test]
    fn bursts_are_avoided() {
        let burst = |time: f64| if time > 0.9 { 1.0 } else { 0.0 };
        assert_eq!(corner(burst), LeftTop);
    }

    /// Where every corner hides a curve, one that fills the chart counts more than a line.
    #[test]
    fn legends_hide_lines_rather_than_bursts() {
        let mut outline = Outline::new();
        for step in 0..1000 {
            let time = f64::from(step) / 1000.0;
            let swing = if time < 0.3 { 0.5 } else { 0.0 };
            let sign = if step % 2 == 0 { 1.0 } else { -1.0 };
            outline.add((time * 1e10) as u64, 0.5 + sign * swing);
        }
        let corner = free_corner(&[&outline], 4, [0.0, 1.0], 1e10);
        assert!([RightTop, RightBottom].contains(&corner), "{corner:?}");
    }
}
