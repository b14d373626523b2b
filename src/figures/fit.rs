//! Figures of a fit: data and model, residuals, profile likelihoods, and correlations of the estimates.

mod correlations;

use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::frame::{Band, Quantity};
use crate::figures::plot::legend::LegendEntry;
use crate::figures::plot::page::{Page, Panel};
use crate::figures::plot::shape::Point;
use crate::figures::plot::style::{BLACK, DASHED, HAIRLINE, MEDIUM, SKY, THIN, VERMILION, line};
use crate::figures::style::SHADE;
use crate::fit::report::Profile;
use crate::fit::{Fit, Residual};
use crate::run::simulation::{SimulationError, sample_at};
use crate::telemetry::fields::{NumberField, pose, state};
use std::borrow::Cow;

/// Number of samples of the model's curve: several for each pixel of a column.
const SAMPLES: u32 = 8000;

/// Height of a panel of residuals relative to one of data.
const RESIDUALS: f64 = 0.6;

/// The axis ends at this many standard deviations of the residuals.
const FARTHEST: f64 = 6.0;

/// Half width of the band in which 95 % of the residuals are expected, σ.
const BAND: f64 = 2.0;

/// Names of figures.
const DATA: &str = "data";
const CORRELATIONS: &str = "correlations";

/// The name of the figure of a profile.
pub fn profile_name(parameter: &str) -> String {
    format!("profile-{parameter}")
}

/// The names of the figures that a fit of these free parameters, with these profiles, will have. `initial` stands for
/// several parameters, and each file after the first has another one.
pub fn names(free: &[String], profiles: &[String], files: usize) -> Vec<String> {
    // Known before the fit, so that a file in the way is found before minutes are spent.
    let mut names = vec![DATA.to_owned()];
    names.extend(profiles.iter().map(|parameter| profile_name(parameter)));
    if free.len() > 1 || files > 1 || free.iter().any(|key| key == "initial") {
        names.push(CORRELATIONS.to_owned());
    }
    names
}

/// The figures of a fit, with the names of their files: `data`, `profile-KEY` for each profile, and `correlations` if
/// there is more than one parameter.
///
/// # Errors
/// [`SimulationError`] if the best fit can't be simulated.
pub fn draw(fit: &Fit, width: f64) -> Result<Vec<(String, Drawing)>, SimulationError> {
    let name = &fit.report.scenario;
    let mut figures = vec![(DATA.to_owned(), data(fit, width)?)];
    figures[0].1.title = format!("Measured values, best fit and residuals — {name}");
    for profile in &fit.report.profiles {
        let mut drawing = draw_profile(fit, profile, width);
        drawing.title = format!("Profile likelihood of {} — {name}", profile.parameter);
        figures.push((profile_name(&profile.parameter), drawing));
    }
    if fit.report.parameters.len() > 1 {
        let mut drawing = correlations::draw(fit, width);
        drawing.title = format!("Correlations of the estimates — {name}");
        figures.push((CORRELATIONS.to_owned(), drawing));
    }
    Ok(figures)
}

/// Each signal with its model, and its residuals below.
fn data(fit: &Fit, width: f64) -> Result<Drawing, SimulationError> {
    let curves = curves(fit)?;
    let mut panels = Vec::new();
    for (index, field) in fit.fields.iter().enumerate() {
        let of_signal: Vec<&Residual> = fit
            .residuals
            .iter()
            .filter(|value| value.signal == index)
            .collect();
        let mut values = Panel::new("", "");
        values.quantity = quantity(*field);
        values.curve("best fit", curves[index].clone(), line(BLACK, THIN));
        let points = of_signal.iter().map(|value| (value.time, value.value));
        values.dots("measured", points.collect(), line(SKY, THIN));
        panels.push(values);
        panels.push(residuals(fit, &of_signal));
    }
    let mut legend = vec![
        LegendEntry::line(line(SKY, MEDIUM), "measured"),
        LegendEntry::line(line(BLACK, THIN), "best fit"),
    ];
    if fit.residuals.iter().any(|value| value.is_held_out) {
        legend.push(LegendEntry::line(line(VERMILION, MEDIUM), "held out"));
    }
    legend.push(LegendEntry::area(SHADE, "±2 *σ*"));
    let page = Page {
        x: Quantity::new("*t*", "s"),
        legend,
        panels,
        shares_x: true,
    };
    Ok(page.draw(width))
}

/// The residuals of a signal in σ.
fn residuals(fit: &Fit, values: &[&Residual]) -> Panel {
    let mut panel = Panel::new("residual", "*σ*");
    panel.height = RESIDUALS;
    // Outliers must not hide all other residuals.
    let limit = FARTHEST * spread(values).max(1.0);
    panel.max_range = (-limit, limit);
    let end = fit
        .residuals
        .iter()
        .map(|value| value.time)
        .fold(0.0, f64::max);
    panel.bands.push(Band {
        meaning: "±2 σ".to_owned(),
        lower: vec![(0.0, -BAND), (end, -BAND)],
        upper: vec![(0.0, BAND), (end, BAND)],
        fill: SHADE,
    });
    panel.curve("zero", vec![(0.0, 0.0), (end, 0.0)], line(BLACK, HAIRLINE));
    for (is_held_out, colour, meaning) in [(false, SKY, "fitted"), (true, VERMILION, "held out")] {
        let part = values
            .iter()
            .filter(|value| value.is_held_out == is_held_out);
        let points: Vec<Point> = part.map(|value| (value.time, value.residual)).collect();
        if !points.is_empty() {
            panel.dots(meaning, points, line(colour, THIN));
        }
    }
    panel
}

/// The standard deviation of most residuals, σ: from their median, which outliers don't change.
fn spread(values: &[&Residual]) -> f64 {
    /// Median of the size of a normal number with standard deviation 1.
    const MEDIAN: f64 = 0.6745;
    let mut sizes: Vec<f64> = values.iter().map(|value| value.residual.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.get(sizes.len() / 2).map_or(0.0, |size| size / MEDIAN)
}

/// The motion of the best fit in each signal.
fn curves(fit: &Fit) -> Result<Vec<Vec<Point>>, SimulationError> {
    let end = fit
        .residuals
        .iter()
        .map(|value| value.time)
        .fold(0.0, f64::max);
    let step = end / f64::from(SAMPLES);
    let times: Vec<f64> = (0..=SAMPLES).map(|i| step * f64::from(i)).collect();
    let mut curves = vec![Vec::new(); fit.fields.len()];
    sample_at(&fit.scenario, &times, &mut |index, sample| {
        for (curve, field) in curves.iter_mut().zip(&fit.fields) {
            curve.push((times[index], field.of_sample(sample)));
        }
    })?;
    Ok(curves)
}

/// The symbols of fields that have one.
const SYMBOLS: [(NumberField, &str); 7] = [
    (state::THETA, "*θ*"),
    (state::PHI, "*φ*"),
    (state::PSI, "*ψ*"),
    (state::THETA_DOT, "*θ̇*"),
    (state::PHI_DOT, "*φ̇*"),
    (state::PSI_DOT, "*ψ̇*"),
    (pose::OMEGA_BODY.z(), "*ω*_{*n*}"),
];

/// The quantity of a field: its symbol, or its path.
fn quantity(field: NumberField) -> Quantity {
    let symbol = match SYMBOLS.iter().find(|(known, _)| *known == field) {
        Some((_, symbol)) => Cow::Borrowed(*symbol),
        None => Cow::Owned(field.path().to_owned()),
    };
    Quantity {
        symbol,
        unit: Cow::Borrowed(field.unit()),
    }
}

/// Δχ² over a parameter, with the parabola of its standard deviation.
fn draw_profile(fit: &Fit, profile: &Profile, width: f64) -> Drawing {
    let mut panel = Panel::new("Δ*χ*^{2}", "");
    let points: Vec<Point> = profile
        .values
        .iter()
        .copied()
        .zip(profile.delta_chi2.iter().copied())
        .collect();
    let estimate = fit
        .report
        .parameters
        .iter()
        .find(|estimate| estimate.name == profile.parameter);
    let mut legend = vec![LegendEntry::line(line(BLACK, MEDIUM), "profile likelihood")];
    if let (Some(estimate), Some((first, last))) = (estimate, points.first().zip(points.last()))
        && let Some(sd) = estimate.sd
    {
        // Where both agree, the standard deviation describes the uncertainty; a skewed profile shows that it doesn't.
        let mut parabola = Vec::new();
        let step = (last.0 - first.0) / 200.0;
        for i in 0..=200 {
            let value = first.0 + step * f64::from(i);
            let distance = (value - estimate.value) / sd;
            parabola.push((value, distance * distance));
        }
        let mut stroke = line(VERMILION, THIN);
        stroke.dash = DASHED;
        panel.curve("from the standard deviation", parabola, stroke);
        legend.push(LegendEntry::line(stroke, "from the standard deviation"));
    }
    panel.curve("profile likelihood", points.clone(), line(BLACK, MEDIUM));
    // The line between the computed values is no result.
    panel.dots("computed", points, line(BLACK, THIN));
    let unit = estimate.map_or(String::new(), |estimate| estimate.unit.clone());
    let page = Page {
        x: Quantity {
            symbol: Cow::Owned(profile.parameter.clone()),
            unit: Cow::Owned(unit),
        },
        legend,
        panels: vec![panel],
        shares_x: true,
    };
    page.draw(width)
}
