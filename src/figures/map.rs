//! The map of a sweep: outcomes of its runs over one or two of the keys that varied.

mod axis_values;
mod bar;
mod chart;
mod curves;
mod grid;
mod plane;
mod runs;

pub use self::runs::{Map, MapAxis, MapRun};

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

    #[test]
    fn distinguishes_at_most_35_curves_below_their_marks() {
        let drawing = curves(35).draw(150.0).unwrap();
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
            ends.fold(EMPTY, union)
        };
        let mut dots = shapes("");
        dots.retain(|shape| matches!(shape, Shape::Dot { .. }));
        assert_eq!(dots.len(), 35);
        let (marks, frame) = (heights(&shapes("no value")), heights(&shapes("frame")));
        assert!(marks.1 < frame.0, "{marks:?} {frame:?}");
        let keys = drawing.groups.iter();
        let keys = keys.filter(|group| group.meaning.starts_with("key: s"));
        let strokes = keys.filter_map(|group| match group.shapes.first() {
            Some(Shape::Line { stroke, .. }) => Some(format!("{stroke:?}")),
            _ => None,
        });
        let strokes: std::collections::BTreeSet<_> = strokes.collect();
        assert_eq!(strokes.len(), 35);

        let message = curves(36).draw(150.0).unwrap_err().to_string();
        assert!(message.contains("36 scenarios"), "{message}");
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

    #[test]
    fn borders_only_known_looping() {
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
            assert_eq!(texts(&drawing).contains(&BOUNDARY), lines > 0);
            lines
        };
        // Each border has a tick.
        assert_eq!(lines([yes, None, no, None]), 2);
        assert_eq!(lines([yes, None, yes, None]), 0);
        assert_eq!(lines([yes, None, None, no]), 0);
        assert_eq!(lines([yes, no, no, no]), 4);
    }

    #[test]
    fn legend_and_range_skip_undrawn_runs() {
        let mut map = grid(
            [1.0, NAN, 2.0, NAN],
            [Some("risen"), Some("fallen"), Some("risen"), Some("rest")],
            [None; 4],
        );
        let theta = |map: &mut Map, theta: [f64; 4]| {
            for (run, theta) in map.runs.iter_mut().zip(theta) {
                (run.x, run.y) = (run.color, theta);
            }
        };
        theta(&mut map, [0.01, 3.0, 0.02, 2.0]);
        let drawing = map.clone().draw(85.0).unwrap();
        for absent in ["fallen", "rest", "2", "3"] {
            let up = texts(&drawing);
            let is_there = up.iter().filter(|text| **text == absent).count();
            // The times 1 and 2 are at the x axis and the bar.
            assert!(
                is_there <= if absent == "2" { 2 } else { 0 },
                "{absent}: {up:?}"
            );
        }
        theta(&mut map, [NAN, 1.0, NAN, 1.0]);
        let message = map.draw(85.0).unwrap_err().to_string();
        assert_eq!(
            message,
            "no run has a value for friction_k and one of initial_theta"
        );
    }

    #[test]
    fn rejects_runs_at_the_same_place() {
        let runs = |y: [f64; 3]| {
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
        };
        assert!(runs([0.1, 0.2, 0.3]).draw(85.0).is_ok());
        let message = runs([5e-324, 5e-324, 0.3])
            .draw(85.0)
            .unwrap_err()
            .to_string();
        assert!(message.contains("initial_theta = 5e-324:"), "{message}");
    }
}
