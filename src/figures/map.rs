//! The map of a sweep: outcomes of its runs over one or two of the keys that varied.

mod axis_values;
mod bar;
mod chart;
mod curves;
mod grid;
mod plane;
mod runs;
#[cfg(feature = "sweep")]
mod table;

pub use self::runs::{Map, MapAxis, MapRun};
#[cfg(feature = "sweep")]
pub use self::table::CONTEXT_COLUMNS;

use super::error::FigureError;
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::ticks::MAX_MAGNITUDE;

impl Map {
    /// Draws the map with a width in mm. Runs without a value along an axis are left out.
    ///
    /// # Errors
    /// There are no runs, several at one place, too many scenarios, or values that no axis can show.
    pub fn draw(mut self, width: f64) -> Result<Drawing, FigureError> {
        let has_y = self.y.is_some();
        self.runs
            .retain(|run| run.x.is_finite() && (!has_y || run.y.is_finite()));
        if self.runs.is_empty() {
            return Err(FigureError::NoValues {
                x: self.x.name,
                y: self.y.map(|y| y.name),
            });
        }
        self.check_magnitudes()?;
        let mut drawing = match &self.y {
            Some(y) => plane::draw(&self, y, width)?,
            None => curves::draw(&self, width)?,
        };
        drawing.title = self.title();
        Ok(drawing)
    }

    fn title(&self) -> String {
        let (color, x) = (&self.color.name, &self.x.name);
        match &self.y {
            Some(y) => format!("{color} over {x} and {}", y.name),
            None => format!("{color} over {x}"),
        }
    }

    /// Rejects numbers that no axis can show.
    fn check_magnitudes(&self) -> Result<(), FigureError> {
        for run in &self.runs {
            check_magnitude(&self.x, run.x)?;
            check_magnitude(&self.color, run.color)?;
            if let Some(y) = &self.y {
                check_magnitude(y, run.y)?;
            }
        }
        Ok(())
    }
}

fn check_magnitude(axis: &MapAxis, value: f64) -> Result<(), FigureError> {
    if value.is_finite() && value.abs() >= MAX_MAGNITUDE {
        return Err(FigureError::TooLarge {
            column: axis.name.clone(),
            value,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::plot::range::{EMPTY, extremes, union};
    use crate::figures::plot::shape::Shape;
    use std::collections::BTreeSet;

    const NAN: f64 = f64::NAN;

    fn axis(name: &str) -> MapAxis {
        MapAxis {
            name: name.to_owned(),
            unit: String::new(),
        }
    }

    /// Runs of several scenarios over two frictions; the second has no value.
    fn curves(scenarios: usize) -> Map {
        let runs = (0..2 * scenarios).map(|run| MapRun {
            x: [0.01, 0.02][run % 2],
            color: [3.0, NAN][run % 2],
            stop: Some("duration".to_owned()),
            loops: Some(false),
            scenario: format!("s{}", run / 2),
            ..MapRun::default()
        });
        Map {
            x: axis("friction_k"),
            y: None,
            color: axis("rise_time"),
            runs: runs.collect(),
        }
    }

    fn texts(drawing: &Drawing) -> Vec<&str> {
        let labels = drawing.labels.iter();
        labels.map(|label| label.text.spoken.as_str()).collect()
    }

    /// The shapes of the groups whose meaning ends with this.
    fn shapes<'a>(drawing: &'a Drawing, suffix: &str) -> Vec<&'a Shape> {
        drawing
            .groups
            .iter()
            .filter(|group| group.meaning.ends_with(suffix))
            .flat_map(|group| &group.shapes)
            .collect()
    }

    /// The range of heights of some shapes, mm from the top.
    fn heights(shapes: &[&Shape]) -> (f64, f64) {
        shapes
            .iter()
            .map(|shape| match shape {
                Shape::Area { points, .. } | Shape::Line { points, .. } => {
                    extremes(points.iter().map(|point| point.1))
                }
                Shape::Dot { centre, .. } => (centre.1, centre.1),
            })
            .fold(EMPTY, union)
    }

    #[test]
    fn distinguishes_at_most_35_curves_below_their_marks() {
        let drawing = curves(35).draw(150.0).unwrap();
        let mut dots = shapes(&drawing, "");
        dots.retain(|shape| matches!(shape, Shape::Dot { .. }));
        assert_eq!(dots.len(), 35);
        let marks = heights(&shapes(&drawing, "no value"));
        let frame = heights(&shapes(&drawing, "frame"));
        assert!(marks.1 < frame.0, "{marks:?} {frame:?}");
        let mut strokes = BTreeSet::new();
        for group in &drawing.groups {
            if let Some(Shape::Line { stroke, .. }) = group.shapes.first()
                && group.meaning.starts_with("key: s")
            {
                strokes.insert(format!("{stroke:?}"));
            }
        }
        assert_eq!(strokes.len(), 35);
    }

    #[test]
    fn rejects_36_curves() {
        let error = curves(36).draw(150.0).unwrap_err();
        let expected = FigureError::TooManyCurves {
            scenarios: 36,
            max: 35,
        };
        assert_eq!(error, expected);
    }

    /// A grid of two by two, over x = 1, 2 and y = 1, 2.
    fn grid(shown: [f64; 4], stops: [Option<&str>; 4], loops: [Option<bool>; 4]) -> Map {
        let runs = (0..4).map(|run| MapRun {
            x: [1.0, 2.0][run % 2],
            y: [1.0, 2.0][run / 2],
            color: shown[run],
            stop: stops[run].map(str::to_owned),
            loops: loops[run],
            scenario: "paper".to_owned(),
        });
        Map {
            x: axis("friction_k"),
            y: Some(axis("initial_theta")),
            color: axis("rise_time"),
            runs: runs.collect(),
        }
    }

    const BOUNDARY: &str = "boundary of looping runs (ticks point inside)";

    /// The number of lines on the boundary of looping runs, each of which has a tick.
    fn boundary_lines(loops: [Option<bool>; 4]) -> usize {
        let stops = [Some("risen"), None, Some("risen"), None];
        let map = grid([1.0, NAN, 2.0, NAN], stops, loops);
        let drawing = map.draw(85.0).unwrap();
        let lines = shapes(&drawing, "where looping begins").len();
        assert_eq!(texts(&drawing).contains(&BOUNDARY), lines > 0);
        lines
    }

    #[test]
    fn bounds_only_known_looping() {
        let (yes, no) = (Some(true), Some(false));
        assert_eq!(boundary_lines([yes, None, no, None]), 2);
        assert_eq!(boundary_lines([yes, None, yes, None]), 0);
        assert_eq!(boundary_lines([yes, None, None, no]), 0);
        assert_eq!(boundary_lines([yes, no, no, no]), 4);
    }

    /// A map of two runs with a value and two without, over that value and these inclinations.
    fn map_over_values(thetas: [f64; 4]) -> Map {
        let mut map = grid(
            [1.0, NAN, 2.0, NAN],
            [Some("risen"), Some("fallen"), Some("risen"), Some("rest")],
            [None; 4],
        );
        for (run, theta) in map.runs.iter_mut().zip(thetas) {
            (run.x, run.y) = (run.color, theta);
        }
        map
    }

    #[test]
    fn legend_and_range_skip_undrawn_runs() {
        let drawing = map_over_values([0.01, 3.0, 0.02, 2.0]).draw(85.0).unwrap();
        let texts = texts(&drawing);
        // The values 1 and 2 are at the x axis and the bar.
        for (text, max) in [("fallen", 0), ("rest", 0), ("2", 2), ("3", 0)] {
            let count = texts.iter().filter(|found| **found == text).count();
            assert!(count <= max, "{text}: {texts:?}");
        }
    }

    #[test]
    fn rejects_maps_without_values() {
        let error = map_over_values([NAN, 1.0, NAN, 1.0])
            .draw(85.0)
            .unwrap_err();
        assert_eq!(
            error.to_string(),
            "no run has a value for friction_k and one of initial_theta"
        );
    }

    /// Nine runs over adjacent numbers and these.
    fn adjacent(y: [f64; 3]) -> Map {
        let runs = (0..9_usize).map(|run| MapRun {
            x: [1e15, 1.0000000000000002e15, 1.0000000000000004e15][run % 3],
            y: y[run / 3],
            color: 1.0,
            ..MapRun::default()
        });
        Map {
            runs: runs.collect(),
            ..grid([NAN; 4], [None; 4], [None; 4])
        }
    }

    #[test]
    fn rejects_runs_at_the_same_place() {
        assert!(adjacent([0.1, 0.2, 0.3]).draw(85.0).is_ok());
        let error = adjacent([5e-324, 5e-324, 0.3]).draw(85.0).unwrap_err();
        let message = error.to_string();
        assert!(message.contains("initial_theta = 5e-324:"), "{message}");
    }

    #[test]
    fn rejects_values_beyond_all_axes() {
        let mut map = curves(1);
        map.runs[0].color = -1e100;
        let expected = FigureError::TooLarge {
            column: "rise_time".to_owned(),
            value: -1e100,
        };
        assert_eq!(map.draw(85.0).unwrap_err(), expected);
    }
}
