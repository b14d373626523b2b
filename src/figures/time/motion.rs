//! The paper's figures 2 and 4.

use super::curves::{add_averages, add_motion, add_motions, motion_legend, page};
use crate::figures::data::RunData;
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::legend::LegendEntry;
use crate::figures::plot::page::{Page, Panel};
use crate::figures::plot::text::Text;
use crate::figures::style::{Style, sampling_note};
use crate::telemetry::fields::{NumberField, nutation, state};

/// The quantities of figure 2: symbol, field and recorded mean over each nutation.
const QUANTITIES: [(&str, NumberField, NumberField); 4] = [
    ("*θ*", state::THETA, nutation::THETA_MEAN),
    ("*θ\u{307}*", state::THETA_DOT, nutation::THETA_DOT_MEAN),
    ("*φ\u{307}*", state::PHI_DOT, nutation::PHI_DOT_MEAN),
    ("*ψ\u{307}*", state::PSI_DOT, nutation::PSI_DOT_MEAN),
];

/// The paper's figure 2: the inclination and the rates with their averages over nutations.
pub(crate) fn motion(runs: &[&RunData], width: f64) -> Drawing {
    let mut legend = motion_legend(runs);
    legend.extend(note(runs, &QUANTITIES.map(|(_, field, _)| field)));
    let mut panels = Vec::new();
    for (symbol, field, mean) in QUANTITIES {
        let mut panel = Panel::new(symbol, field.unit());
        // Near the vertical, φ̇ and ψ̇ diverge.
        panel.is_singular = [state::PHI_DOT, state::PSI_DOT].contains(&field);
        add_motions(&mut panel, runs, field);
        add_averages(&mut panel, runs, field, mean);
        panels.push(panel);
    }
    page(legend, panels).draw(width)
}

/// The note of runs whose samples are too few, and which don't record the region in which some fields nutate either.
fn note(runs: &[&RunData], fields: &[NumberField]) -> Option<LegendEntry> {
    let mut without = runs.to_vec();
    without.retain(|run| fields.iter().any(|field| run.envelope(*field).is_none()));
    sampling_note(&without)
}

/// The paper's figure 4: θ of each further run with the averages of the first.
pub(crate) fn compared(runs: &[&RunData], width: f64) -> Drawing {
    let Some((reference, others)) = runs.split_first() else {
        return Drawing::new(width);
    };
    let style = Style::new(runs.len());
    let reference_name = Text::name(&reference.name).followed_by(", average over each nutation");
    let mut legend = vec![LegendEntry::from_text(style.average(0), reference_name)];
    legend.extend(note(others, &[state::THETA]));
    let mut panels = Vec::new();
    for (index, run) in others.iter().enumerate() {
        // Each run has the colour that it has in the other figures.
        let index = index + 1;
        let mut panel = Panel::new("*θ*", "rad");
        add_motion(&mut panel, run, state::THETA, style, index);
        let meaning = format!("{}: average of {}", reference.name, state::THETA.path());
        let averages = reference.averages(nutation::THETA_MEAN);
        panel.curve(meaning, averages, style.average(0));
        let name = Text::name(&run.name);
        panel
            .legend
            .push(LegendEntry::from_text(style.motion(index), name));
        panels.push(panel);
    }
    let page = Page {
        shares_x: false,
        ..page(legend, panels)
    };
    page.draw(width)
}
