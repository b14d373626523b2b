//! Text set in the embedded font.
//!
//! Glyphs are drawn as outlines, so a figure looks the same wherever it is shown, and the space that a
//! label takes is known when figures are laid out.

use super::shape::Bounds;
use std::sync::OnceLock;
use tiny_skia::{Path, PathBuilder};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// The style of a glyph: upright for units and words, italic for symbols.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Style {
    Upright,
    Italic,
}

/// STIX Two Text 2.13, the Latin and Greek part: see `font/OFL.txt`.
const UPRIGHT: &[u8] = include_bytes!("font/STIXTwoText-Regular.ttf");
const ITALIC: &[u8] = include_bytes!("font/STIXTwoText-Italic.ttf");

/// Font units per em.
pub(crate) const UNITS: f64 = 1000.0;

/// The sizes and upward shifts of letters, subscripts and superscripts, em.
const LETTER: (f64, f64) = (1.0, 0.0);
const SUBSCRIPT: (f64, f64) = (0.7, -0.18);
const SUPERSCRIPT: (f64, f64) = (0.7, 0.34);

/// The room between a letter and the dots over it, and between two dots, em.
const ACCENT_GAP: f64 = 0.07;
const ACCENT_STEP: f64 = 0.2;

/// The maximum width of names, em; longer ones are truncated.
const LONGEST_NAME: f64 = 14.0;

/// Slant of italic letters, relative to their height.
const SLANT: f64 = 0.21;

fn face(style: Style) -> Option<&'static Face<'static>> {
    static FACES: OnceLock<[Option<Face<'static>>; 2]> = OnceLock::new();
    let faces = FACES.get_or_init(|| [UPRIGHT, ITALIC].map(|font| Face::parse(font, 0).ok()));
    faces[style as usize].as_ref()
}

/// The outline of a glyph, in font units; empty for a space.
pub(crate) fn outline(style: Style, id: u16) -> Option<Path> {
    let mut outline = Outline(PathBuilder::new());
    face(style)?.outline_glyph(GlyphId(id), &mut outline);
    outline.0.finish()
}

/// Builds the path of a glyph.
struct Outline(PathBuilder);

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}

/// A glyph. Lengths are in em.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Glyph {
    pub(crate) style: Style,
    pub(crate) id: u16,
    pub(crate) x: f64,
    /// The height above the baseline.
    pub(crate) y: f64,
    pub(crate) scale: f64,
}

/// Typeset text. Lengths are in em.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Text {
    pub(crate) glyphs: Vec<Glyph>,
    pub(crate) width: f64,
    /// Extent of the ink above the baseline, and below.
    pub(crate) above: f64,
    pub(crate) below: f64,
    /// The text without markup, for screen readers.
    pub(crate) spoken: String,
}

impl Text {
    /// Typesets text without markup.
    pub(crate) fn plain(source: &str) -> Self {
        Self::default().followed_by(source)
    }

    /// Sets a name. A long name is truncated at its start, because file names usually differ at their ends.
    pub(crate) fn name(source: &str) -> Self {
        let mut text = Self::plain(source);
        let mut rest = source.chars();
        while text.width > LONGEST_NAME && rest.next().is_some() {
            text = Self::plain(&format!("…{}", rest.as_str()));
        }
        text
    }

    /// Sets a text in which `*` begins and ends symbols, `_{…}` and `^{…}` are scripts, and combining dots
    /// stand over the letter before them.
    pub(crate) fn markup(source: &str) -> Self {
        let mut text = Self::default();
        let mut style = Style::Upright;
        let mut script = LETTER;
        let mut letters = source.chars().peekable();
        while let Some(letter) = letters.next() {
            match letter {
                '*' if style == Style::Upright => style = Style::Italic,
                '*' => style = Style::Upright,
                '_' | '^' if letters.next_if_eq(&'{').is_some() => {
                    text.spoken.push(letter);
                    script = if letter == '_' {
                        SUBSCRIPT
                    } else {
                        SUPERSCRIPT
                    };
                }
                '}' => script = LETTER,
                '\u{307}' => text.accent(1, letter),
                '\u{308}' => text.accent(2, letter),
                _ => text.push(letter, style, script),
            }
        }
        text
    }

    /// Appends words to the text.
    pub(crate) fn followed_by(mut self, words: &str) -> Self {
        for letter in words.chars() {
            self.push(letter, Style::Upright, LETTER);
        }
        self
    }

    fn push(&mut self, letter: char, style: Style, (scale, y): (f64, f64)) {
        self.spoken.push(letter);
        let Some(face) = face(style) else {
            return;
        };
        // The font shows a box for missing letters.
        let id = face.glyph_index(letter).unwrap_or(GlyphId(0));
        let advance = f64::from(face.glyph_hor_advance(id).unwrap_or(0)) / UNITS;
        self.add(Glyph {
            style,
            id: id.0,
            x: self.width,
            y,
            scale,
        });
        self.width += advance * scale;
    }

    fn add(&mut self, glyph: Glyph) {
        if let Some(ink) = ink(&glyph) {
            self.above = self.above.max(ink.top);
            self.below = self.below.max(-ink.bottom);
        }
        self.glyphs.push(glyph);
    }

    /// Puts dots over the last letter.
    fn accent(&mut self, dots: u8, mark: char) {
        self.spoken.push(mark);
        let style = Style::Upright;
        let (Some(letter), Some(face)) = (self.glyphs.last().copied(), face(style)) else {
            return;
        };
        let dot = Glyph {
            style,
            id: face.glyph_index('.').unwrap_or(GlyphId(0)).0,
            x: 0.0,
            y: 0.0,
            scale: letter.scale,
        };
        let (Some(under), Some(over)) = (ink(&letter), ink(&dot)) else {
            return;
        };
        let lean = match letter.style {
            Style::Upright => 0.0,
            // The slant shifts the middle of the ink by half its height, and the dots by more than the full height.
            Style::Italic => SLANT * (under.top - under.bottom + ACCENT_GAP) / 2.0,
        };
        let middle = f64::midpoint(under.left, under.right) + lean;
        let step = ACCENT_STEP * letter.scale;
        for count in 0..dots {
            let offset = step * (f64::from(count) - f64::from(dots - 1) / 2.0);
            self.add(Glyph {
                x: middle + offset - f64::midpoint(over.left, over.right),
                y: under.top + ACCENT_GAP * letter.scale - over.bottom,
                ..dot
            });
        }
    }
}

/// The extent of the ink of a glyph, em, with heights above the baseline.
fn ink(glyph: &Glyph) -> Option<Bounds> {
    let bounds = face(glyph.style)?.glyph_bounding_box(GlyphId(glyph.id))?;
    let em = |units: i16| f64::from(units) / UNITS * glyph.scale;
    Some(Bounds {
        left: glyph.x + em(bounds.x_min),
        right: glyph.x + em(bounds.x_max),
        bottom: glyph.y + em(bounds.y_min),
        top: glyph.y + em(bounds.y_max),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fonts_have_all_letters_of_labels() {
        for style in [Style::Upright, Style::Italic] {
            let face = face(style).unwrap();
            for letter in "θφψωτkR0123456789−.·²³()|/ ".chars() {
                assert!(
                    face.glyph_index(letter).is_some(),
                    "{letter:?} in {style:?}"
                );
            }
        }
    }

    #[test]
    fn dots_stand_over_their_letter_and_take_no_width() {
        let bare = Text::markup("*θ*");
        let dotted = Text::markup("*θ\u{308}*");
        assert_eq!(dotted.glyphs.len(), 3);
        assert!(dotted.above > bare.above);
        assert!((dotted.width - bare.width).abs() < 1e-12);
        assert_eq!(dotted.spoken, "θ\u{308}");
    }

    #[test]
    fn long_names_keep_their_end() {
        let text = Text::name(&"a/long/directory/".repeat(9));
        assert!(text.width <= LONGEST_NAME && text.width > LONGEST_NAME - 1.0);
        assert!(text.spoken.starts_with('…') && text.spoken.ends_with("directory/"));
    }

    #[test]
    fn names_are_set_as_they_are() {
        assert_eq!(Text::plain("a*b_{c}").spoken, "a*b_{c}");
        assert_eq!(Text::markup("*E*_{kin} (J)").spoken, "E_kin (J)");
    }
}
