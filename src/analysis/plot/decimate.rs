//! Leaves out points of lines that can't be distinguished in print.

use super::shape::Point;

/// Keeps the first, the lowest, the highest and the last point of each column of this width, so that the envelope of what
/// oscillates within a column stays.
///
/// The points must be in the order of their columns. A point that is not finite divides the line.
pub(crate) fn by_column(points: impl IntoIterator<Item = Point>, width: f64) -> Vec<Vec<Point>> {
    let mut lines = vec![Vec::new()];
    let mut column: Option<Column> = None;
    for point in points {
        if !(point.0.is_finite() && point.1.is_finite()) {
            finish(&mut column, &mut lines);
            lines.push(Vec::new());
            continue;
        }
        let number = (point.0 / width).floor() as i64;
        match &mut column {
            Some(open) if open.number == number => open.add(point),
            _ => {
                finish(&mut column, &mut lines);
                column = Some(Column::new(number, point));
            }
        }
    }
    finish(&mut column, &mut lines);
    lines.retain(|line| !line.is_empty());
    lines
}

fn finish(column: &mut Option<Column>, lines: &mut [Vec<Point>]) {
    if let (Some(column), Some(line)) = (column.take(), lines.last_mut()) {
        column.put_into(line);
    }
}

/// The points that are kept of a column.
struct Column {
    number: i64,
    count: usize,
    /// The first, lowest, highest and last point, each with its place among the points of the column.
    kept: [(usize, Point); 4],
}

impl Column {
    fn new(number: i64, point: Point) -> Self {
        Self {
            number,
            count: 1,
            kept: [(0, point); 4],
        }
    }

    fn add(&mut self, point: Point) {
        let found = (self.count, point);
        let [_, lowest, highest, last] = &mut self.kept;
        if point.1 < lowest.1.1 {
            *lowest = found;
        }
        if point.1 > highest.1.1 {
            *highest = found;
        }
        *last = found;
        self.count += 1;
    }

    fn put_into(mut self, line: &mut Vec<Point>) {
        self.kept.sort_by_key(|(place, _)| *place);
        let mut before = None;
        for (place, point) in self.kept {
            if before != Some(place) {
                line.push(point);
            }
            before = Some(place);
        }
    }
}

/// Leaves out points that lie nearer than `distance` to the last one that is kept; the last of all stays.
pub(crate) fn by_distance(points: &[Point], distance: f64) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for (index, point) in points.iter().enumerate() {
        let is_far = kept.last().is_none_or(|last| {
            let (dx, dy) = (point.0 - last.0, point.1 - last.1);
            dx * dx + dy * dy >= distance * distance
        });
        if is_far || index + 1 == points.len() {
            kept.push(*point);
        }
    }
    kept
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
    fn gaps_divide_the_line() {
        let points = [(0.0, 1.0), (1.0, f64::NAN), (2.0, 1.0), (3.0, 2.0)];
        let lines = by_column(points, 0.5);
        assert_eq!(lines, [vec![(0.0, 1.0)], vec![(2.0, 1.0), (3.0, 2.0)]]);
    }

    #[test]
    fn the_ends_of_a_path_stay() {
        let points = [(0.0, 0.0), (0.1, 0.0), (1.0, 0.0), (1.1, 0.0)];
        assert_eq!(
            by_distance(&points, 0.5),
            [(0.0, 0.0), (1.0, 0.0), (1.1, 0.0)]
        );
    }
}
