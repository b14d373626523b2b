//! The rate of precession and the rates of regular precession.

use super::curves::{add_averages, add_motions, motion_legend, page};
use crate::figures::data::RunData;
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::frame::Band;
use crate::figures::plot::legend::LegendEntry;
use crate::figures::plot::page::Panel;
use crate::figures::plot::range::overlap;
use crate::figures::plot::shape::Point;
use crate::figures::style::{SHADE, Style, sampling_note};
use crate::telemetry::fields::{NumberField, nutation, precession as rates, state};

/// The height of the panel of the root that the motion doesn't follow, relative to a normal panel.
const FAR_HEIGHT: f64 = 0.45;

/// A rate beyond all axes, rad/s.
const BEYOND_AXES: f64 = 1e9;

/// φ̇ and the rates of regular precession, with the region between them in which θ̈ is negative.
pub(crate) fn precession(runs: &[&RunData], width: f64) -> Drawing {
    let style = Style::new(runs.len());
    let mut near = Panel::new("*φ\u{307}*", "rad/s");
    near.is_singular = true;
    let mut far = near.clone();
    add_motions(&mut near, runs, state::PHI_DOT);
    // A root that diverges must not flatten the motion.
    near.max_range = around(near.range());
    for (index, run) in runs.iter().enumerate() {
        let [near_root, far_root] = roots_by_distance(run);
        for (panel, field) in [(&mut near, near_root), (&mut far, far_root)] {
            let meaning = format!("{}: {}", run.name, field.path());
            panel.curve(meaning, run.series(field), style.root(index));
        }
    }
    add_averages(&mut near, runs, state::PHI_DOT, nutation::PHI_DOT_MEAN);
    let mut panels = arrange(near, far);
    let mut legend = motion_legend(runs);
    legend.push(LegendEntry::line(
        style.root_in_legend(),
        "regular precession, slow and fast",
    ));
    // The regions of several runs would hide each other.
    if let [run] = runs {
        let bands = upright_regions(run);
        if !bands.is_empty() {
            legend.push(LegendEntry::area(SHADE, "*θ\u{308}* < 0"));
        }
        for panel in &mut panels {
            panel.bands.clone_from(&bands);
        }
    }
    legend.extend(sampling_note(runs));
    page(legend, panels).draw(width)
}

/// The y range around the motion; roots outside it are clipped.
fn around((low, high): (f64, f64)) -> (f64, f64) {
    let room = 2.0 * (high - low).max(low.abs()).max(high.abs());
    (low - room, high + room)
}

/// The rates of regular precession: first the one that φ̇ follows.
fn roots_by_distance(run: &RunData) -> [NumberField; 2] {
    // Medians, because the roots diverge where they pass through infinity.
    let rate = median(run, state::PHI_DOT);
    let slow_distance = (rate - median(run, rates::SLOW_ROOT)).abs();
    let fast_distance = (rate - median(run, rates::FAST_ROOT)).abs();
    if fast_distance < slow_distance {
        [rates::FAST_ROOT, rates::SLOW_ROOT]
    } else {
        [rates::SLOW_ROOT, rates::FAST_ROOT]
    }
}

/// The median of a field over time; NaN if it has no values.
fn median(run: &RunData, field: NumberField) -> f64 {
    let mut values: Vec<f64> = run
        .series(field)
        .into_iter()
        .map(|point| point.1)
        .filter(|value| value.is_finite())
        .collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Panels of the motion with the root it follows and of the other root, with a broken common axis if they are
/// separated.
fn arrange(near: Panel, far: Panel) -> Vec<Panel> {
    if far.is_empty() {
        return vec![near];
    }
    let (near_range, far_range) = (near.range(), far.range());
    let far = Panel {
        height: FAR_HEIGHT,
        ..far
    };
    if overlap(near_range, far_range) {
        return vec![near, far];
    }
    let (mut upper, lower) = if far_range.0 > near_range.1 {
        (far, near)
    } else {
        (near, far)
    };
    upper.is_broken = true;
    vec![upper, lower]
}

/// The rates of regular precession at a time.
struct Roots {
    time: f64,
    slow: f64,
    fast: f64,
}

impl Roots {
    /// Whether both rates have the same sign; `None` if a rate is missing.
    fn have_same_sign(&self) -> Option<bool> {
        let product = self.slow * self.fast;
        product.is_finite().then_some(product > 0.0)
    }
}

/// The regions where θ̈ is negative: θ̈ is positive at φ̇ = 0 and changes its sign at the roots.
///
/// While both roots have the same sign it is negative between them. If one root passes through infinity and changes
/// sign, θ̈ is negative outside them.
fn upright_regions(run: &RunData) -> Vec<Band> {
    let slow = run.series(rates::SLOW_ROOT);
    let fast = run.series(rates::FAST_ROOT);
    let roots: Vec<Roots> = slow
        .into_iter()
        .zip(fast)
        .map(|((time, slow), (_, fast))| Roots { time, slow, fast })
        .collect();
    let mut regions = Vec::new();
    for part in roots.chunk_by(|a, b| a.have_same_sign() == b.have_same_sign()) {
        let low = edge(part, |roots| roots.slow.min(roots.fast));
        let high = edge(part, |roots| roots.slow.max(roots.fast));
        match part[0].have_same_sign() {
            Some(true) => regions.push(upright_region(low, high)),
            Some(false) => {
                let bottom = edge(part, |_| -BEYOND_AXES);
                let top = edge(part, |_| BEYOND_AXES);
                regions.push(upright_region(bottom, low));
                regions.push(upright_region(high, top));
            }
            None => {}
        }
    }
    regions
}

fn edge(part: &[Roots], rate: impl Fn(&Roots) -> f64) -> Vec<Point> {
    part.iter().map(|roots| (roots.time, rate(roots))).collect()
}

fn upright_region(lower: Vec<Point>, upper: Vec<Point>) -> Band {
    Band {
        meaning: "driven upright".to_owned(),
        lower,
        upper,
        fill: SHADE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A panel whose only curve goes through this range.
    fn panel((low, high): (f64, f64)) -> Panel {
        let mut panel = Panel::new("*φ\u{307}*", "rad/s");
        let points = vec![(0.0, low), (1.0, high)];
        panel.curve("φ\u{307}", points, Style::new(1).motion(0));
        panel
    }

    #[test]
    fn breaks_the_axis_between_separate_ranges() {
        for (far, expected) in [
            ((900.0, 950.0), [(900.0, true), (1.0, false)]),
            ((-950.0, -900.0), [(1.0, true), (-950.0, false)]),
            ((-50.0, 50.0), [(1.0, false), (-50.0, false)]),
        ] {
            let panels = arrange(panel((1.0, 2.0)), panel(far));
            let found: Vec<_> = panels
                .iter()
                .map(|panel| (panel.range().0, panel.is_broken))
                .collect();
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn axis_ignores_far_precession_roots() {
        assert_eq!(around((1.0, 2.0)), (-3.0, 6.0));
        assert_eq!(around((499.0, 500.0)), (-501.0, 1500.0));
    }
}
