//! How figures look: colours that the colour-blind tell apart (Okabe and Ito), dashes that do without
//! colour, and sizes for print.

use super::drawing::{Colour, Stroke};

pub(super) const BLACK: Colour = Colour(0, 0, 0);
pub(super) const GREY: Colour = Colour(0x99, 0x99, 0x99);
pub(super) const WHITE: Colour = Colour(255, 255, 255);
pub(super) const SKY: Colour = Colour(0x56, 0xb4, 0xe9);
pub(super) const BLUE: Colour = Colour(0x00, 0x72, 0xb2);
const VERMILLION: Colour = Colour(0xd5, 0x5e, 0x00);
const GREEN: Colour = Colour(0x00, 0x9e, 0x73);
const PURPLE: Colour = Colour(0xcc, 0x79, 0xa7);
const ORANGE: Colour = Colour(0xe6, 0x9f, 0x00);

/// Shaded regions.
pub(super) const SHADE: Colour = Colour(0xf4, 0xee, 0xd6);

/// What stands in legends for the motions of several runs.
pub(super) const PALE: Colour = Colour(0xc8, 0xc8, 0xc8);

/// The unit sphere.
pub(super) const SURFACE: Colour = Colour(0xf6, 0xf6, 0xf6);

/// In the order in which runs and terms take them.
const COLOURS: &[Colour] = &[BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, BLACK];

const SOLID: &[f64] = &[];
const DASHED: &[f64] = &[1.5, 0.8];
const DASHES: &[&[f64]] = &[
    SOLID,
    DASHED,
    &[2.4, 0.6, 0.5, 0.6],
    &[0.5, 0.6],
    &[3.0, 1.2],
];

/// Millimetres in a point.
const POINT: f64 = 25.4 / 72.0;

/// Size of all letters: readable in a column 85 mm wide.
pub(super) const FONT: f64 = 8.0 * POINT;

/// A line of text with the room between lines, mm.
pub(super) const LINE: f64 = 1.35 * FONT;

/// Around the whole figure, mm.
pub(super) const MARGIN: f64 = 0.8;

/// From this width on there are two columns of plots, mm.
pub(super) const TWO_COLUMNS: f64 = 130.0;

/// Width of frames and ticks, and of thin lines that only guide the eye.
pub(super) const HAIRLINE: f64 = 0.5 * POINT;
const THIN: f64 = 0.7 * POINT;
const MEDIUM: f64 = 0.9 * POINT;

/// A solid line.
pub(super) fn line(colour: Colour, width: f64) -> Stroke {
    Stroke {
        colour,
        width,
        dash: SOLID,
        opacity: 1.0,
    }
}

/// The frame of a plot.
pub(super) fn frame() -> Stroke {
    line(BLACK, HAIRLINE)
}

/// How the runs of a figure are told apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Looks {
    /// How many runs there are.
    pub(super) runs: usize,
}

impl Looks {
    /// The colour of a run.
    fn colour(self, run: usize) -> Colour {
        COLOURS[run % COLOURS.len()]
    }

    /// What was simulated, over which averages are drawn.
    pub(super) fn motion(self, run: usize) -> Stroke {
        if self.runs == 1 {
            return line(SKY, THIN);
        }
        Stroke {
            opacity: 0.45,
            ..line(self.colour(run), THIN)
        }
    }

    /// Averages. Those of several runs often lie on one another: dashes let each be seen.
    pub(super) fn average(self, run: usize) -> Stroke {
        let (colour, dash) = if self.runs == 1 {
            (BLACK, DASHED)
        } else {
            (self.colour(run), DASHES[run % DASHES.len()])
        };
        Stroke {
            dash,
            ..line(colour, MEDIUM)
        }
    }

    /// The locus of the axis.
    pub(super) fn locus(self, run: usize) -> Stroke {
        line(self.colour(run), HAIRLINE)
    }

    /// One of several quantities in a plot. Where those of several runs lie on one another, the broader line
    /// of the earlier run shows.
    pub(super) fn term(self, run: usize, term: usize) -> Stroke {
        let colour = if self.runs == 1 { term } else { run };
        let broader = (self.runs - 1).saturating_sub(run).min(2) as f64 * 0.5 * POINT;
        Stroke {
            dash: DASHES[term % DASHES.len()],
            ..line(COLOURS[colour % COLOURS.len()], MEDIUM + broader)
        }
    }

    /// The same in a legend, where terms stand for all runs.
    pub(super) fn term_in_key(self, term: usize) -> Stroke {
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

    /// Rates of regular precession, under averages.
    pub(super) fn root(self, run: usize) -> Stroke {
        let colour = if self.runs == 1 {
            VERMILLION
        } else {
            self.colour(run)
        };
        line(colour, THIN)
    }

    /// The same in a legend.
    pub(super) fn root_in_key(self) -> Stroke {
        let colour = if self.runs == 1 { VERMILLION } else { BLACK };
        line(colour, THIN)
    }

    /// A run in a legend.
    pub(super) fn run_in_key(self, run: usize) -> Stroke {
        line(self.colour(run), MEDIUM)
    }
}
