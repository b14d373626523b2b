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

/// The corners with their places: whether they are at the right, and whether at the top.
const CORNERS: [(Corner2D, bool, bool); 4] = [
    (Corner2D::LeftTop, false, true),
    (Corner2D::RightTop, true, true),
    (Corner2D::LeftBottom, false, false),
    (Corner2D::RightBottom, true, false),
];

/// The corner in which the legend of a chart of these plots covers least of the curves of runs that have ended.
///
/// The value axis has this range, or that of the values; the time axis has this duration in s.
pub(super) fn corner_for(
    preferred: Corner2D,
    shown: &[Curves],
    runs: &[&Plots],
    range: Option<[f64; 2]>,
    duration: f64,
) -> Corner2D {
    let mut curves = Vec::new();
    let mut lines = 0;
    let mut values = [f64::INFINITY, f64::NEG_INFINITY];
    for run in runs {
        for plot in shown {
            curves.extend(run.outline(*plot));
            for (_, [low, high]) in run.ranges(*plot) {
                lines += 1;
                values = [values[0].min(low), values[1].max(high)];
            }
        }
    }
    free_corner(
        preferred,
        &curves,
        lines,
        range.unwrap_or(values),
        1e9 * duration,
    )
}

/// The corner in which a legend covers curves least; the preferred one, if no other is better.
///
/// The chart shows these values over the time up to `end_ns`. The legend has as many lines as there are curves.
fn free_corner(
    preferred: Corner2D,
    curves: &[&Outline],
    lines: usize,
    values: [f64; 2],
    end_ns: f64,
) -> Corner2D {
    let height = (FRAME + LINE * lines as f64) * (values[1] - values[0]);
    let [low, high] = [values[0] + height, values[1] - height];
    let mut best = (preferred, f64::INFINITY);
    for (corner, is_right, is_top) in CORNERS {
        let mut covered = 0.0;
        for outline in curves {
            let near = outline.ranges().filter(|(time, _)| {
                let time = time / end_ns;
                if is_right {
                    time > 1.0 - WIDTH
                } else {
                    time < WIDTH
                }
            });
            let (mut count, mut sum) = (0, 0.0);
            for (_, range) in near {
                count += 1;
                let band = if is_top {
                    [high, values[1]]
                } else {
                    [values[0], low]
                };
                sum += hidden_part(range, band, values[1] - values[0]);
            }
            covered += sum / f64::from(count.max(1));
        }
        if covered < best.1 || (covered <= best.1 && corner == preferred) {
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
    fn corner(curve: impl Fn(f64) -> f64, preferred: Corner2D) -> Corner2D {
        let mut outline = Outline::new();
        for step in 0..1000 {
            let time = f64::from(step) / 1000.0;
            outline.add((time * 1e10) as u64, curve(time));
        }
        free_corner(preferred, &[&outline], 2, [0.0, 1.0], 1e10)
    }

    #[test]
    fn legends_avoid_curves() {
        for (curve, expected) in [
            (rising as fn(f64) -> f64, [LeftTop, RightBottom]),
            (falling, [RightTop, LeftBottom]),
            (low, [LeftTop, RightTop]),
            (high, [LeftBottom, RightBottom]),
        ] {
            for preferred in [LeftTop, RightTop, LeftBottom, RightBottom] {
                let found = corner(curve, preferred);
                assert!(expected.contains(&found), "{found:?}, not {expected:?}");
                if expected.contains(&preferred) {
                    assert_eq!(found, preferred);
                }
            }
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
        assert_eq!(corner(burst, RightTop), LeftTop);
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
        let corner = free_corner(LeftTop, &[&outline], 4, [0.0, 1.0], 1e10);
        assert!([RightTop, RightBottom].contains(&corner), "{corner:?}");
    }
}
