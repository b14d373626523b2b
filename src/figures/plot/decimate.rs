//! Removes points of lines that can't be distinguished in print.

use super::shape::Point;
use std::ops::Range;

/// Keeps the first, the lowest, the highest and the last point of each column of this width, so that the envelope of an
/// oscillation within a column is kept.
///
/// The points must be in the order of their columns. A point that is not finite divides the line.
pub(crate) fn by_column(points: impl IntoIterator<Item = Point>, width: f64) -> Vec<Vec<Point>> {
    let points: Vec<Point> = points.into_iter().collect();
    // A pixel column can't show more of a line than where it enters, its extremes, and where it leaves.
    points
        .split(|(x, y)| !(x.is_finite() && y.is_finite()))
        .filter(|line| !line.is_empty())
        .map(|line| thin_line(line, width))
        .collect()
}

fn thin_line(line: &[Point], width: f64) -> Vec<Point> {
    let mut kept = Vec::new();
    for column in line.chunk_by(|a, b| (a.0 / width).floor() == (b.0 / width).floor()) {
        let rows = envelope(0..column.len(), [|row: usize| column[row].1]);
        kept.extend(rows.into_iter().map(|row| column[row]));
    }
    kept
}

/// The first and the last of some rows, and those with the least and the greatest number of each column, in order.
pub(crate) fn envelope<C>(rows: Range<usize>, columns: impl IntoIterator<Item = C>) -> Vec<usize>
where
    C: Fn(usize) -> f64,
{
    let mut kept = vec![rows.start, rows.end - 1];
    for value in columns {
        let finite = rows.clone().filter(|row| value(*row).is_finite());
        // Reversed, because `max_by` takes the last of equal values; both ends of the envelope take the first.
        let greatest = finite
            .clone()
            .min_by(|a, b| value(*b).total_cmp(&value(*a)));
        kept.extend(finite.min_by(|a, b| value(*a).total_cmp(&value(*b))));
        kept.extend(greatest);
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// Omits points closer than `distance` to the last kept point; the final point is kept.
pub(crate) fn by_distance(points: &[Point], distance: f64) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for (index, point) in points.iter().enumerate() {
        let is_last = index + 1 == points.len();
        if is_last
            || kept
                .last()
                .is_none_or(|last| is_far(*last, *point, distance))
        {
            kept.push(*point);
        }
    }
    kept
}

/// Whether two points are at least this distance apart.
fn is_far(one: Point, other: Point, distance: f64) -> bool {
    let (dx, dy) = (other.0 - one.0, other.1 - one.1);
    dx * dx + dy * dy >= distance * distance
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    fn extremes(points: &[Point], width: f64) -> BTreeMap<i64, (f64, f64)> {
        let mut columns = BTreeMap::new();
        for (x, y) in points {
            let column = (x / width).floor() as i64;
            let (low, high) = columns.entry(column).or_insert((*y, *y));
            *low = f64::min(*low, *y);
            *high = f64::max(*high, *y);
        }
        columns
    }

    proptest! {
        #[test]
        fn each_column_keeps_its_extremes_and_at_most_four_points(
            values in prop::collection::vec(-1e3..1e3, 1..500),
            step in 0.001..2.0,
        ) {
            let points: Vec<_> = values.iter().enumerate().map(|(i, y)| (i as f64 * step, *y)).collect();
            let lines = by_column(points.clone(), 1.0);
            prop_assert_eq!(lines.len(), 1);
            let columns = extremes(&points, 1.0);
            prop_assert_eq!(extremes(&lines[0], 1.0), columns.clone());
            prop_assert!(lines[0].len() <= 4 * columns.len());
            prop_assert_eq!(lines[0].first(), points.first());
            prop_assert_eq!(lines[0].last(), points.last());
            prop_assert!(lines[0].is_sorted_by(|a, b| a.0 < b.0));
        }
    }

    #[test]
    fn gaps_divide_lines() {
        let points = [(0.0, 1.0), (1.0, f64::NAN), (2.0, 1.0), (3.0, 2.0)];
        let lines = by_column(points, 0.5);
        assert_eq!(lines, [vec![(0.0, 1.0)], vec![(2.0, 1.0), (3.0, 2.0)]]);
    }

    #[test]
    fn keeps_both_ends_of_a_path() {
        let points = [(0.0, 0.0), (0.1, 0.0), (1.0, 0.0), (1.1, 0.0)];
        assert_eq!(
            by_distance(&points, 0.5),
            [(0.0, 0.0), (1.0, 0.0), (1.1, 0.0)]
        );
    }
}
