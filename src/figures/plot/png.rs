//! Drawings as PNG.

use super::drawing::{Drawing, Label};
use super::shape::{Colour, Point, Shape, Stroke};
use super::style::{BLACK, FONT, RESOLUTION};
use super::text::{self, UNITS};
use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, PixelDimensions, Unit};
use tiny_skia::{FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};

impl Drawing {
    /// The drawing as a PNG file with 300 pixels per inch.
    ///
    /// # Errors
    /// If the drawing has no size, or more pixels than a PNG file can have.
    pub fn png(&self) -> Result<Vec<u8>, EncodingError> {
        let [width, height] =
            [self.width, self.height].map(|length| (length * RESOLUTION).round() as u32);
        let Some(mut pixels) = Pixmap::new(width, height) else {
            let error = std::io::Error::other("the figure has no size or is too large");
            return Err(error.into());
        };
        pixels.fill(tiny_skia::Color::WHITE);
        for shape in self.groups.iter().flat_map(|group| &group.shapes) {
            draw(&mut pixels, shape);
        }
        for label in &self.labels {
            write(&mut pixels, label);
        }
        encode(&pixels)
    }
}

/// A PNG file of opaque pixels.
fn encode(pixels: &Pixmap) -> Result<Vec<u8>, EncodingError> {
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

/// The scale from millimetres to pixels.
fn scale() -> Transform {
    Transform::from_scale(RESOLUTION as f32, RESOLUTION as f32)
}

fn paint(Colour(red, green, blue): Colour, opacity: f64) -> Paint<'static> {
    let mut paint = Paint::default();
    let alpha = (opacity * 255.0).round() as u8;
    paint.set_color_rgba8(red, green, blue, alpha);
    paint.anti_alias = true;
    paint
}

fn outline(points: &[Point], is_closed: bool) -> Option<Path> {
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

fn fill(pixels: &mut Pixmap, path: Option<Path>, colour: Colour, transform: Transform) {
    if let Some(path) = path {
        let paint = paint(colour, 1.0);
        pixels.fill_path(&path, &paint, FillRule::Winding, transform, None);
    }
}

fn trace(pixels: &mut Pixmap, path: Option<Path>, stroke: &Stroke) {
    let Some(path) = path else {
        return;
    };
    let dash = stroke.dash.iter().map(|length| *length as f32).collect();
    let pen = tiny_skia::Stroke {
        width: stroke.width as f32,
        line_join: LineJoin::Round,
        dash: StrokeDash::new(dash, 0.0),
        ..tiny_skia::Stroke::default()
    };
    let paint = paint(stroke.colour, stroke.opacity);
    pixels.stroke_path(&path, &paint, &pen, scale(), None);
}

fn draw(pixels: &mut Pixmap, shape: &Shape) {
    match shape {
        Shape::Line { points, stroke } => trace(pixels, outline(points, false), stroke),
        Shape::Area { points, fill: with } => fill(pixels, outline(points, true), *with, scale()),
        Shape::Dot {
            centre,
            radius,
            fill: with,
            stroke,
        } => {
            let (x, y) = (centre.0 as f32, centre.1 as f32);
            let circle = PathBuilder::from_circle(x, y, *radius as f32);
            fill(pixels, circle.clone(), *with, scale());
            trace(pixels, circle, stroke);
        }
    }
}

fn write(pixels: &mut Pixmap, label: &Label) {
    let turn = if label.is_upward { -90.0 } else { 0.0 };
    let em = FONT as f32;
    let place = scale()
        .pre_translate(label.origin.0 as f32, label.origin.1 as f32)
        .pre_rotate(turn)
        .pre_scale(em, -em);
    for glyph in &label.text.glyphs {
        let size = (glyph.scale / UNITS) as f32;
        let place = place
            .pre_translate(glyph.x as f32, glyph.y as f32)
            .pre_scale(size, size);
        fill(pixels, text::outline(glyph.style, glyph.id), BLACK, place);
    }
}
