//! Tests that nothing in a figure overlaps or sticks out, whatever it shows.

use super::*;
use crate::analysis::plot::drawing::{Drawing, Label};
use crate::analysis::plot::shape::{Bounds, Shape};
use crate::analysis::plot::style::FONT;
use crate::run::scenario::{Preset, Scenario};

/// A run that is drawn quickly, and differs from others.
fn run(preset: &str, name: &str, duration: &str) -> Run {
    let mut values = Preset::find(preset).unwrap().values().unwrap();
    values.set("stop.duration", duration).unwrap();
    let figures: Vec<_> = FIGURES.iter().collect();
    let mut run = Run::read(&Scenario::new(values).unwrap(), preset, &figures, &|_| {});
    run.name = name.to_owned();
    run
}

fn runs() -> Vec<Run> {
    vec![
        run("paper", "paper", "30"),
        run("paper-spin-term-only", &"a-very-long-name-".repeat(5), "40"),
        run("full-coulomb", "directory/full_{coulomb}*.mcap", "2"),
        run("frictionless", "frictionless", "2"),
    ]
}

/// The space that a label takes.
fn space(label: &Label) -> Bounds {
    let ((x, y), text) = (label.origin, &label.text);
    let [width, above, below] = [text.width, text.above, text.below].map(|em| em * FONT);
    if label.is_upward {
        Bounds::between((x - above, y - width), (x + below, y))
    } else {
        Bounds::between((x, y - above), (x + width, y + below))
    }
}

fn overlap(a: &Bounds, b: &Bounds) -> bool {
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom
}

fn check(drawing: &Drawing, what: &str) {
    let (width, height) = drawing.size();
    for (index, label) in drawing.labels.iter().enumerate() {
        let bounds = space(label);
        let said = &label.text.spoken;
        let is_within = bounds.left >= 0.0
            && bounds.top >= 0.0
            && bounds.right <= width
            && bounds.bottom <= height;
        assert!(is_within, "{what}: {said} sticks out: {bounds:?}");
        for other in &drawing.labels[index + 1..] {
            let other_said = &other.text.spoken;
            let is_apart = !overlap(&bounds, &space(other));
            assert!(is_apart, "{what}: {said} lies on {other_said}");
        }
    }
    for frame in frames(drawing) {
        let inside = |label: &&Label| overlap(&space(label), &frame);
        let label = drawing.labels.iter().find(inside);
        assert!(
            label.is_none(),
            "{what}: {:?} in a frame",
            label.map(|l| &l.text.spoken)
        );
    }
}

/// The frames of all plots.
fn frames(drawing: &Drawing) -> Vec<Bounds> {
    let groups = drawing
        .groups
        .iter()
        .filter(|group| group.meaning == "frame");
    groups
        .filter_map(|group| match group.shapes.first() {
            Some(Shape::Line { points, .. }) => Some(Bounds {
                left: points[0].0,
                top: points[0].1,
                right: points[2].0,
                bottom: points[2].1,
            }),
            _ => None,
        })
        .collect()
}

#[test]
fn labels_lie_within_figures_and_apart() {
    let runs = runs();
    let alone = |run| vec![run];
    let mut sets: Vec<Vec<&Run>> = runs.iter().map(alone).collect();
    sets.push(runs.iter().collect());
    for figure in FIGURES {
        for runs in sets.iter().filter(|runs| runs.len() >= figure.least_runs) {
            for width in [80.0, 85.0, 129.0, 130.0, 170.0, 400.0] {
                let what = format!("{} of {} runs, {width} mm", figure.name, runs.len());
                check(&figure.draw(runs, width), &what);
            }
        }
    }
}

#[test]
fn lines_lie_within_figures() {
    let runs = runs();
    let runs: Vec<_> = runs.iter().collect();
    for figure in FIGURES {
        let drawing = figure.draw(&runs, 85.0);
        for shape in drawing.groups.iter().flat_map(|group| &group.shapes) {
            let (Shape::Line { points, .. } | Shape::Area { points, .. }) = shape else {
                continue;
            };
            for (x, y) in points {
                let is_within =
                    (0.0..=drawing.width).contains(x) && (0.0..=drawing.height).contains(y);
                assert!(is_within, "{}: ({x}, {y})", figure.name);
            }
        }
    }
}
