//! Text set in the embedded font.
//!
//! Glyphs are drawn as outlines, so a figure looks the same wherever it is shown, and the space that a
//! label takes is known when figures are laid out.

use super::shape::Bounds;
use std::sync::OnceLock;
use tiny_skia::{Path, PathBuilder};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// STIX Two Text 2.13, the Latin and Greek part: see `font/OFL.txt`.
const UPRIGHT: &[u8] = include_bytes!("font/STIXTwoText-Regular.ttf");
const ITALIC: &[u8] = include_bytes!("font/STIXTwoText-Italic.ttf");

/// Font units per em.
pub(crate) const UNITS_PER_EM: f64 = 1000.0;

/// The size and upward shift of normal letters, em.
const NORMAL: Script = Script {
    scale: 1.0,
    shift: 0.0,
};
/// The size and upward shift of subscripts, em.
const SUBSCRIPT: Script = Script {
    scale: 0.7,
    shift: -0.18,
};
/// The size and upward shift of superscripts, em.
const SUPERSCRIPT: Script = Script {
    scale: 0.7,
    shift: 0.34,
};

/// The room between a letter and the dots over it, em.
const ACCENT_GAP: f64 = 0.07;

/// The distance between two dots over a letter, em.
const ACCENT_STEP: f64 = 0.2;

/// The maximum width of names, em; longer ones are truncated.
const MAX_NAME_WIDTH: f64 = 14.0;

/// Slant of italic letters, relative to their height.
const SLANT: f64 = 0.21;

/// The style of a glyph: upright for units and words, italic for symbols.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum FontStyle {
    Upright,
    Italic,
}

/// The size of letters and their shift above the baseline, em.
#[derive(Clone, Copy)]
struct Script {
    scale: f64,
    shift: f64,
}

/// The font of a style; `None` if the embedded file can't be read, which a test rules out.
fn face(style: FontStyle) -> Option<&'static Face<'static>> {
    static FACES: OnceLock<[Option<Face<'static>>; 2]> = OnceLock::new();
    let [upright, italic] =
        FACES.get_or_init(|| [UPRIGHT, ITALIC].map(|font| Face::parse(font, 0).ok()));
    match style {
        FontStyle::Upright => upright.as_ref(),
        FontStyle::Italic => italic.as_ref(),
    }
}

/// The outline of a glyph, in font units; empty for a space.
pub(crate) fn outline(style: FontStyle, id: u16) -> Option<Path> {
    let mut outline = GlyphPath(PathBuilder::new());
    face(style)?.outline_glyph(GlyphId(id), &mut outline);
    outline.0.finish()
}

/// Builds the path of a glyph.
struct GlyphPath(PathBuilder);

impl OutlineBuilder for GlyphPath {
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
    pub(crate) style: FontStyle,
    pub(crate) id: u16,
    pub(crate) x: f64,
    /// The height above the baseline.
    pub(crate) y: f64,
    pub(crate) scale: f64,
}

impl Glyph {
    /// The extent of the ink, em, with heights above the baseline.
    fn ink(&self) -> Option<Bounds> {
        let bounds = face(self.style)?.glyph_bounding_box(GlyphId(self.id))?;
        Some(Bounds {
            left: self.x + self.em(bounds.x_min),
            right: self.x + self.em(bounds.x_max),
            bottom: self.y + self.em(bounds.y_min),
            top: self.y + self.em(bounds.y_max),
        })
    }

    /// A length of the glyph in font units, as em.
    fn em(&self, units: i16) -> f64 {
        f64::from(units) / UNITS_PER_EM * self.scale
    }
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

    /// Typesets a name. A long name is truncated at its start, because file names usually differ at their ends.
    pub(crate) fn name(source: &str) -> Self {
        Self::default().followed_by_name(source)
    }

    /// Appends a name to the text.
    pub(crate) fn followed_by_name(self, source: &str) -> Self {
        let mut name = source.to_owned();
        let mut rest = source.chars();
        // Letter by letter: letters have different widths.
        while Self::plain(&name).width > MAX_NAME_WIDTH && rest.next().is_some() {
            name = format!("…{}", rest.as_str());
        }
        self.followed_by(&name)
    }

    /// Typesets a text in which `*` begins and ends symbols, `_{…}` and `^{…}` are scripts, and combining dots
    /// stand over the letter before them.
    pub(crate) fn markup(source: &str) -> Self {
        Self::default().followed_by_markup(source)
    }

    /// Appends text with markup.
    pub(crate) fn followed_by_markup(self, source: &str) -> Self {
        let mut text = self;
        let mut style = FontStyle::Upright;
        let mut script = NORMAL;
        let mut letters = source.chars().peekable();
        while let Some(letter) = letters.next() {
            match letter {
                '*' if style == FontStyle::Upright => style = FontStyle::Italic,
                '*' => style = FontStyle::Upright,
                '_' | '^' if letters.next_if_eq(&'{').is_some() => {
                    text.spoken.push(letter);
                    script = if letter == '_' {
                        SUBSCRIPT
                    } else {
                        SUPERSCRIPT
                    };
                }
                // Scripts don't nest in labels.
                '}' => script = NORMAL,
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
            self.push(letter, FontStyle::Upright, NORMAL);
        }
        self
    }

    /// Appends a letter.
    fn push(&mut self, letter: char, style: FontStyle, script: Script) {
        self.spoken.push(letter);
        let Some(face) = face(style) else {
            return;
        };
        // Glyph 0 is a box for missing letters, as in names of files.
        let id = face.glyph_index(letter).unwrap_or(GlyphId(0));
        let advance = f64::from(face.glyph_hor_advance(id).unwrap_or(0)) / UNITS_PER_EM;
        self.add(Glyph {
            style,
            id: id.0,
            x: self.width,
            y: script.shift,
            scale: script.scale,
        });
        self.width += advance * script.scale;
    }

    /// Adds a glyph in place, without advancing.
    fn add(&mut self, glyph: Glyph) {
        if let Some(ink) = glyph.ink() {
            self.above = self.above.max(ink.top);
            self.below = self.below.max(-ink.bottom);
        }
        self.glyphs.push(glyph);
    }

    /// Puts dots over the last letter.
    fn accent(&mut self, dots: u8, mark: char) {
        self.spoken.push(mark);
        let style = FontStyle::Upright;
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
        let (Some(letter_ink), Some(dot_ink)) = (letter.ink(), dot.ink()) else {
            return;
        };
        let lean = match letter.style {
            FontStyle::Upright => 0.0,
            // The slant shifts the middle of the ink by half its height, and the dots by more than the full height.
            FontStyle::Italic => SLANT * (letter_ink.top - letter_ink.bottom + ACCENT_GAP) / 2.0,
        };
        let middle = f64::midpoint(letter_ink.left, letter_ink.right) + lean;
        let step = ACCENT_STEP * letter.scale;
        for index in 0..dots {
            let offset = step * (f64::from(index) - f64::from(dots - 1) / 2.0);
            self.add(Glyph {
                x: middle + offset - f64::midpoint(dot_ink.left, dot_ink.right),
                y: letter_ink.top + ACCENT_GAP * letter.scale - dot_ink.bottom,
                ..dot
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fonts_contain_all_letters_of_labels() {
        for style in [FontStyle::Upright, FontStyle::Italic] {
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
    fn accents_add_height_but_no_width() {
        let bare = Text::markup("*θ*");
        let dotted = Text::markup("*θ\u{308}*");
        assert_eq!(dotted.glyphs.len(), 3);
        assert!(dotted.above > bare.above);
        assert!((dotted.width - bare.width).abs() < 1e-12);
        assert_eq!(dotted.spoken, "θ\u{308}");
    }

    #[test]
    fn truncates_long_names_at_the_start() {
        let text = Text::name(&"a/long/directory/".repeat(9));
        assert!(text.width <= MAX_NAME_WIDTH && text.width > MAX_NAME_WIDTH - 1.0);
        assert!(text.spoken.starts_with('…') && text.spoken.ends_with("directory/"));
    }

    #[test]
    fn plain_text_has_no_markup() {
        assert_eq!(Text::plain("a*b_{c}").spoken, "a*b_{c}");
        assert_eq!(Text::markup("*E*_{kin} (J)").spoken, "E_kin (J)");
    }
}
