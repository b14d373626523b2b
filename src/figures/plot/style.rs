//! The style of drawings: colours that the colour-blind can distinguish (Okabe and Ito), dashes that need no
//! colour, and sizes for print.

use super::shape::{Colour, Stroke};

pub(crate) const BLACK: Colour = Colour(0, 0, 0);
pub(crate) const GREY: Colour = Colour(0x99, 0x99, 0x99);
pub(crate) const WHITE: Colour = Colour(255, 255, 255);
pub(crate) const SKY: Colour = Colour(0x56, 0xb4, 0xe9);
pub(crate) const BLUE: Colour = Colour(0x00, 0x72, 0xb2);
pub(crate) const VERMILION: Colour = Colour(0xd5, 0x5e, 0x00);
pub(crate) const GREEN: Colour = Colour(0x00, 0x9e, 0x73);
const PURPLE: Colour = Colour(0xcc, 0x79, 0xa7);
const ORANGE: Colour = Colour(0xe6, 0x9f, 0x00);

/// The colours of curves, in order of use. The eighth colour of Okabe and Ito, yellow, is too pale for lines on white
/// paper.
pub(crate) const COLOURS: &[Colour] = &[BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK];

const SOLID: &[f64] = &[];
pub(crate) const DASHED: &[f64] = &[1.5, 0.8];

/// The dash patterns of curves, in order of use: alternating lengths of dashes and gaps, mm. Each fits more than once into
/// the 6.5 mm of a line in a legend.
pub(crate) const DASHES: &[&[f64]] = &[
    SOLID,
    DASHED,
    &[2.4, 0.6, 0.5, 0.6],
    &[0.5, 0.6],
    &[3.0, 1.2],
];

/// A typographic point, mm.
pub(crate) const POINT: f64 = 25.4 / 72.0;

/// The size of all letters, mm: readable in a column 85 mm wide.
pub(crate) const FONT_SIZE: f64 = 8.0 * POINT;

/// The distance between the baselines of two lines of text, mm.
pub(crate) const LINE_HEIGHT: f64 = 1.35 * FONT_SIZE;

/// The margin around a drawing, mm.
pub(crate) const MARGIN: f64 = 0.8;

/// The minimum width of a drawing with two columns of plots, mm: a column is then at least 62 mm wide.
pub(crate) const TWO_COLUMNS: f64 = 130.0;

/// The width of frames, ticks and guide lines, mm.
pub(crate) const HAIRLINE: f64 = 0.5 * POINT;

/// The widths of curves, mm.
pub(crate) const THIN: f64 = 0.7 * POINT;
pub(crate) const MEDIUM: f64 = 0.9 * POINT;

/// A solid line.
pub(crate) fn line(colour: Colour, width: f64) -> Stroke {
    Stroke {
        colour,
        width,
        dash: SOLID,
        opacity: 1.0,
    }
}

/// Pixels of a PNG in a millimetre: 300 per inch. Curves are thinned to this resolution in all formats.
pub(crate) const RESOLUTION: f64 = 300.0 / 25.4;

/// The line around a plot.
pub(crate) fn frame() -> Stroke {
    line(BLACK, HAIRLINE)
}
