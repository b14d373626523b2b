//! Line styles of runs and quantities, and the legends that explain them.

use super::data::RunData;
use crate::figures::plot::legend::LegendEntry;
use crate::figures::plot::shape::{Colour, Stroke};
use crate::figures::plot::style::{
    BLACK, COLOURS, DASHED, DASHES, HAIRLINE, MEDIUM, POINT, SKY, THIN, VERMILION, line,
};
use crate::figures::plot::text::Text;

/// The colour of shaded regions.
pub(super) const SHADE: Colour = Colour(0xf4, 0xee, 0xd6);

/// The legend colour for the motions of several runs.
pub(super) const PALE: Colour = Colour(0xc8, 0xc8, 0xc8);

/// The colour of the unit sphere.
pub(super) const SURFACE: Colour = Colour(0xf6, 0xf6, 0xf6);

/// The strokes of the runs of a figure, which depend on their number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Style {
    runs: usize,
}

impl Style {
    /// The style of a figure with this number of runs.
    pub(super) fn new(runs: usize) -> Self {
        Self { runs }
    }

    /// The colour of a run.
    fn colour(run: usize) -> Colour {
        COLOURS[run % COLOURS.len()]
    }

    /// The stroke of a motion over which averages are drawn.
    pub(super) fn motion(self, run: usize) -> Stroke {
        // A single motion needs no transparency: nothing but its averages crosses it.
        if self.runs == 1 {
            return line(SKY, THIN);
        }
        Stroke {
            opacity: 0.45,
            ..line(Self::colour(run), THIN)
        }
    }

    /// The colour of the region in which a motion nutates: its stroke on white.
    pub(super) fn envelope(self, run: usize) -> Colour {
        // Areas are opaque, so their colour has to contain the opacity.
        let stroke = self.motion(run);
        on_white(stroke.colour, stroke.opacity)
    }

    /// The stroke of averages. Dashed if there are several runs, because they often coincide.
    pub(super) fn average(self, run: usize) -> Stroke {
        let (colour, dash) = if self.runs == 1 {
            (BLACK, DASHED)
        } else {
            (Self::colour(run), DASHES[run % DASHES.len()])
        };
        Stroke {
            dash,
            ..line(colour, MEDIUM)
        }
    }

    /// The stroke of the locus of the axis, in the order in which the loci of all runs are drawn.
    pub(super) fn locus(self, run: usize, order: usize) -> Stroke {
        line(Self::colour(run), HAIRLINE + self.extra_width(order))
    }

    /// Extra line width relative to the last run, mm, so that coinciding lines stay visible.
    pub(super) fn extra_width(self, run: usize) -> f64 {
        (self.runs - 1).saturating_sub(run).min(2) as f64 * 0.5 * POINT
    }

    /// The stroke of one of several quantities in a plot.
    pub(super) fn term(self, run: usize, term: usize) -> Stroke {
        // Colours distinguish the runs if there are several; dashes always distinguish the quantities.
        let colour = if self.runs == 1 { term } else { run };
        Stroke {
            dash: DASHES[term % DASHES.len()],
            ..line(
                COLOURS[colour % COLOURS.len()],
                MEDIUM + self.extra_width(run),
            )
        }
    }

    /// The stroke of a rapidly oscillating quantity; its average uses [`Self::term`].
    pub(super) fn ripple(self, run: usize, term: usize) -> Stroke {
        Stroke {
            opacity: 0.3,
            ..line(self.term(run, term).colour, THIN)
        }
    }

    /// The stroke of a quantity in a legend, where it represents all runs.
    pub(super) fn term_in_legend(self, term: usize) -> Stroke {
        let stroke = self.term(0, term);
        if self.runs == 1 {
            return stroke;
        }
        Stroke {
            colour: BLACK,
            width: MEDIUM,
            ..stroke
        }
    }

    /// The stroke of the rates of regular precession of a run.
    pub(super) fn root(self, run: usize) -> Stroke {
        let colour = if self.runs == 1 {
            VERMILION
        } else {
            Self::colour(run)
        };
        line(colour, THIN)
    }

    /// The stroke of the rates of regular precession in a legend, where it represents all runs.
    pub(super) fn root_in_legend(self) -> Stroke {
        let colour = if self.runs == 1 { VERMILION } else { BLACK };
        line(colour, THIN)
    }

    /// The stroke of a run in a legend.
    pub(super) fn run_in_legend(run: usize) -> Stroke {
        line(Self::colour(run), MEDIUM)
    }
}

/// A translucent colour on white.
pub(super) fn on_white(Colour(red, green, blue): Colour, opacity: f64) -> Colour {
    let [red, green, blue] = [red, green, blue]
        .map(|component| (255.0 - opacity * f64::from(255 - component)).round() as u8);
    Colour(red, green, blue)
}

/// Note of a figure whose samples are too few for the nutation of a run.
pub(super) fn sampling_note(runs: &[&RunData]) -> Option<LegendEntry> {
    let fewest = runs
        .iter()
        .filter_map(|run| run.coarse_samples_per_nutation())
        .reduce(f64::min)?;
    let note = format!("only {fewest:.1} samples per nutation: nutation is not resolved");
    Some(LegendEntry::note(&note))
}

/// The legend of several runs; a single run needs none.
pub(super) fn run_legend(runs: &[&RunData], stroke: impl Fn(usize) -> Stroke) -> Vec<LegendEntry> {
    if runs.len() == 1 {
        return Vec::new();
    }
    runs.iter()
        .enumerate()
        .map(|(index, run)| LegendEntry::from_text(stroke(index), Text::name(&run.name)))
        .collect()
}
