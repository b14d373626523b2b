//! Drawings as PNG.

use super::drawing::{Drawing, Label};
use super::shape::{Colour, Point, Shape, Stroke};
use super::style::{BLACK, FONT_SIZE, RESOLUTION};
use super::text::{self, UNITS_PER_EM};
use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, PixelDimensions, Unit};
use tiny_skia::{FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};

/// A drawing that can't become a PNG file.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// A side is 0 pixels long, or the pixels don't fit into memory.
    #[error("the figure has no size or is too large")]
    Size {
        /// The width, pixels.
        width: u32,
        /// The height, pixels.
        height: u32,
    },
    /// The encoder rejects the pixels.
    #[error(transparent)]
    Encoding(#[from] EncodingError),
}

impl Drawing {
    /// The drawing as a PNG file with 300 pixels per inch.
    ///
    /// # Errors
    /// If the drawing has no size, or more pixels than a PNG file can have.
    pub fn png(&self) -> Result<Vec<u8>, PngError> {
        let width = (self.width * RESOLUTION).round() as u32;
        let height = (self.height * RESOLUTION).round() as u32;
        let mut pixels = Pixmap::new(width, height).ok_or(PngError::Size { width, height })?;
        pixels.fill(tiny_skia::Color::WHITE);
        for shape in self.groups.iter().flat_map(|group| &group.shapes) {
            draw_shape(&mut pixels, shape);
        }
        for label in &self.labels {
            draw_label(&mut pixels, label);
        }
        Ok(encode(&pixels)?)
    }
}

/// A PNG file of opaque pixels.
fn encode(pixels: &Pixmap) -> Result<Vec<u8>, EncodingError> {
    // The background is opaque, so alpha would only make the file larger.
    let rgb: Vec<u8> = pixels
        .pixels()
        .iter()
        .flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()])
        .collect();
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, pixels.width(), pixels.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::High);
    let per_metre = (RESOLUTION * 1e3).round() as u32;
    encoder.set_pixel_dims(Some(PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    writer.finish()?;
    Ok(bytes)
}

/// The transform from millimetres to pixels.
fn to_pixels() -> Transform {
    Transform::from_scale(RESOLUTION as f32, RESOLUTION as f32)
}

fn paint(Colour(red, green, blue): Colour, opacity: f64) -> Paint<'static> {
    let mut paint = Paint::default();
    let alpha = (opacity * 255.0).round() as u8;
    paint.set_color_rgba8(red, green, blue, alpha);
    paint.anti_alias = true;
    paint
}

fn path(points: &[Point], is_closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (index, (x, y)) in points.iter().enumerate() {
        if index == 0 {
            builder.move_to(*x as f32, *y as f32);
        } else {
            builder.line_to(*x as f32, *y as f32);
        }
    }
    if is_closed {
        builder.close();
    }
    builder.finish()
}

/// Fills a path; lines of no extent have none.
fn fill(pixels: &mut Pixmap, path: Option<Path>, colour: Colour, transform: Transform) {
    if let Some(path) = path {
        let paint = paint(colour, 1.0);
        pixels.fill_path(&path, &paint, FillRule::Winding, transform, None);
    }
}

/// Draws the line of a path.
fn outline(pixels: &mut Pixmap, path: Option<Path>, stroke: &Stroke) {
    let Some(path) = path else {
        return;
    };
    let dash = stroke.dash.iter().map(|length| *length as f32).collect();
    let pen = tiny_skia::Stroke {
        width: stroke.width as f32,
        // A mitre would extend beyond the sharp peaks of a curve.
        line_join: LineJoin::Round,
        dash: StrokeDash::new(dash, 0.0),
        ..tiny_skia::Stroke::default()
    };
    let paint = paint(stroke.colour, stroke.opacity);
    pixels.stroke_path(&path, &paint, &pen, to_pixels(), None);
}

fn draw_shape(pixels: &mut Pixmap, shape: &Shape) {
    match shape {
        Shape::Line { points, stroke } => outline(pixels, path(points, false), stroke),
        Shape::Area {
            points,
            fill: colour,
        } => fill(pixels, path(points, true), *colour, to_pixels()),
        Shape::Dot {
            centre,
            radius,
            fill: colour,
            stroke,
        } => {
            let (x, y) = (centre.0 as f32, centre.1 as f32);
            let circle = PathBuilder::from_circle(x, y, *radius as f32);
            fill(pixels, circle.clone(), *colour, to_pixels());
            outline(pixels, circle, stroke);
        }
    }
}

fn draw_label(pixels: &mut Pixmap, label: &Label) {
    let degrees = if label.is_upward { -90.0 } else { 0.0 };
    let em = FONT_SIZE as f32;
    // Heights of glyphs are upwards, those of pixels downwards.
    let label_to_pixels = to_pixels()
        .pre_translate(label.origin.0 as f32, label.origin.1 as f32)
        .pre_rotate(degrees)
        .pre_scale(em, -em);
    for glyph in &label.text.glyphs {
        let size = (glyph.scale / UNITS_PER_EM) as f32;
        let glyph_to_pixels = label_to_pixels
            .pre_translate(glyph.x as f32, glyph.y as f32)
            .pre_scale(size, size);
        let outline = text::outline(glyph.style, glyph.id);
        fill(pixels, outline, BLACK, glyph_to_pixels);
    }
}
