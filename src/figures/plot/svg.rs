//! Drawings as SVG.
//!
//! All coordinates are whole hundredths of a millimetre: short, and the same on every machine. Glyphs are defined once and
//! used by all labels.

use super::drawing::{Drawing, Label};
use super::shape::{Colour, Point, Shape, Stroke};
use super::style::{BLACK, FONT_SIZE};
use super::text::{self, FontStyle, UNITS_PER_EM};
use std::collections::BTreeSet;
use tiny_skia::{Path, PathSegment};

/// Units of the drawing in a millimetre.
const UNITS_PER_MM: f64 = 100.0;

impl Drawing {
    /// The drawing as an SVG document.
    pub fn svg(&self) -> String {
        let [width, height] = [self.width, self.height].map(units);
        // `xlink:href` below is SVG 1.1: many programs don't read the plain `href` of SVG 2.
        let mut svg = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        svg.push_str(&format!("<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             width=\"{}mm\" height=\"{}mm\" viewBox=\"0 0 {width} {height}\" role=\"img\">\n<title>{}</title>\n",
            decimal(width as f64 / UNITS_PER_MM),
            decimal(height as f64 / UNITS_PER_MM),
            escape(&self.title)));
        svg.push_str(&self.glyph_definitions());
        svg.push_str("<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
        for group in &self.groups {
            svg.push_str(&format!("<g aria-label=\"{}\">\n", escape(&group.meaning)));
            for part in &group.shapes {
                svg.push_str(&shape_element(part));
            }
            svg.push_str("</g>\n");
        }
        for label in &self.labels {
            svg.push_str(&label_element(label));
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// The definitions of all glyphs that are used.
    fn glyph_definitions(&self) -> String {
        // Sorted, so that the bytes don't depend on a hash order.
        let mut used = BTreeSet::new();
        for label in &self.labels {
            used.extend(
                label
                    .text
                    .glyphs
                    .iter()
                    .map(|glyph| (glyph.style, glyph.id)),
            );
        }
        let mut svg = String::from("<defs>\n");
        for (style, id) in used {
            let (id, path) = (glyph_id(style, id), glyph_path(style, id));
            svg.push_str(&format!("<path id=\"{id}\" d=\"{path}\"/>\n"));
        }
        svg.push_str("</defs>\n");
        svg
    }
}

/// A length in mm as units of the drawing.
fn units(length: f64) -> i64 {
    (length * UNITS_PER_MM).round() as i64
}

/// A number with at most four digits after the point.
fn decimal(value: f64) -> String {
    match format!("{value:.4}")
        .trim_end_matches('0')
        .trim_end_matches('.')
    {
        "-0" => "0".to_owned(),
        text => text.to_owned(),
    }
}

/// Text for an XML document.
fn escape(text: &str) -> String {
    // The ampersand first, because the others add some.
    text.replace('&', "&amp;")
        .replace('"', "&quot;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        // XML can't represent control characters.
        .replace(char::is_control, "\u{fffd}")
}

/// The XML identifier of a glyph.
fn glyph_id(style: FontStyle, id: u16) -> String {
    let letter = match style {
        FontStyle::Upright => 'u',
        FontStyle::Italic => 'i',
    };
    format!("{letter}{id}")
}

fn hex(Colour(red, green, blue): Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The attributes of a line.
fn stroke_attributes(stroke: &Stroke) -> String {
    let mut svg = format!(
        "stroke=\"{}\" stroke-width=\"{}\"",
        hex(stroke.colour),
        units(stroke.width)
    );
    if !stroke.dash.is_empty() {
        let lengths: Vec<_> = stroke
            .dash
            .iter()
            .map(|length| units(*length).to_string())
            .collect();
        svg.push_str(&format!(" stroke-dasharray=\"{}\"", lengths.join(" ")));
    }
    if stroke.opacity < 1.0 {
        svg.push_str(&format!(" stroke-opacity=\"{}\"", decimal(stroke.opacity)));
    }
    svg
}

/// The data of a path from point to point, in relative steps and without steps of no length.
fn path_data(points: &[Point]) -> String {
    let mut places: Vec<_> = points.iter().map(|(x, y)| (units(*x), units(*y))).collect();
    places.dedup();
    let mut svg = String::new();
    let mut last = (0, 0);
    for (index, place) in places.into_iter().enumerate() {
        let (dx, dy) = (place.0 - last.0, place.1 - last.1);
        // A minus sign separates numbers as a space does, and curves are most of a file.
        let before = match index {
            0 => "M",
            1 => "l",
            _ if dx < 0 => "",
            _ => " ",
        };
        let between = if dy < 0 { "" } else { " " };
        svg.push_str(&format!("{before}{dx}{between}{dy}"));
        last = place;
    }
    svg
}

fn shape_element(shape: &Shape) -> String {
    match shape {
        Shape::Line { points, stroke } => format!(
            "<path d=\"{}\" fill=\"none\" stroke-linejoin=\"round\" {}/>\n",
            path_data(points),
            stroke_attributes(stroke)
        ),
        Shape::Area { points, fill } => {
            format!(
                "<path d=\"{}z\" fill=\"{}\"/>\n",
                path_data(points),
                hex(*fill)
            )
        }
        Shape::Dot {
            centre,
            radius,
            fill,
            stroke,
        } => format!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" {}/>\n",
            units(centre.0),
            units(centre.1),
            units(*radius),
            hex(*fill),
            stroke_attributes(stroke)
        ),
    }
}

fn label_element(label: &Label) -> String {
    let scale = FONT_SIZE * UNITS_PER_MM / UNITS_PER_EM;
    // Heights of glyphs are upwards, those of SVG downwards: hence the negative scale.
    let rotation = if label.is_upward { " rotate(-90)" } else { "" };
    let mut svg = format!(
        "<g aria-label=\"{}\" fill=\"{}\" transform=\"translate({} {}){rotation} scale({} {})\">",
        escape(&label.text.spoken),
        hex(BLACK),
        units(label.origin.0),
        units(label.origin.1),
        decimal(scale),
        decimal(-scale)
    );
    for glyph in &label.text.glyphs {
        let (x, y) = (glyph.x * UNITS_PER_EM, glyph.y * UNITS_PER_EM);
        // Most glyphs are not in a script, and need no transform of their own.
        let position = if glyph.scale == 1.0 {
            format!("x=\"{}\" y=\"{}\"", decimal(x), decimal(y))
        } else {
            format!(
                "transform=\"translate({} {}) scale({})\"",
                decimal(x),
                decimal(y),
                decimal(glyph.scale)
            )
        };
        svg.push_str(&format!(
            "<use xlink:href=\"#{}\" {position}/>",
            glyph_id(glyph.style, glyph.id)
        ));
    }
    svg.push_str("</g>\n");
    svg
}

/// The data of the path of a glyph.
fn glyph_path(style: FontStyle, id: u16) -> String {
    text::outline(style, id)
        .iter()
        .flat_map(Path::segments)
        .map(path_command)
        .collect()
}

fn path_command(segment: PathSegment) -> String {
    let (command, points) = match segment {
        PathSegment::MoveTo(end) => ('M', vec![end]),
        PathSegment::LineTo(end) => ('L', vec![end]),
        PathSegment::QuadTo(control, end) => ('Q', vec![control, end]),
        PathSegment::CubicTo(first, second, end) => ('C', vec![first, second, end]),
        PathSegment::Close => ('Z', Vec::new()),
    };
    let numbers: Vec<_> = points
        .iter()
        .flat_map(|point| [point.x, point.y])
        .map(|number| decimal(number.into()))
        .collect();
    format!("{command}{}", numbers.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The points of an SVG path: an absolute point, then relative steps.
    fn places(path: &str) -> Vec<(i64, i64)> {
        let spaced = path.replace('-', " -").replace('l', " ");
        let numbers: Vec<i64> = spaced[1..]
            .split_whitespace()
            .map(|number| number.parse().unwrap())
            .collect();
        let mut place = (0, 0);
        let mut step = |step: &[i64]| {
            place = (place.0 + step[0], place.1 + step[1]);
            place
        };
        numbers.chunks(2).map(&mut step).collect()
    }

    proptest! {
        #[test]
        fn paths_visit_all_points(
            points in prop::collection::vec((-1.0..1.0, -0.1..0.1), 1..30),
        ) {
            let path = path_data(&points);
            let mut expected: Vec<_> = points.iter().map(|(x, y)| (units(*x), units(*y))).collect();
            expected.dedup();
            prop_assert_eq!(path.contains('l'), expected.len() > 1);
            prop_assert_eq!(places(&path), expected);
        }
    }

    #[test]
    fn paths_are_relative_steps() {
        let points = [(1.0, 1.0), (1.0, 1.001), (1.5, 0.5), (1.25, 0.75)];
        assert_eq!(path_data(&points), "M100 100l50-50-25 25");
    }

    #[test]
    fn decimals_are_short() {
        assert_eq!(decimal(85.0), "85");
        assert_eq!(decimal(-0.000_01), "0");
        assert_eq!(decimal(0.28222), "0.2822");
    }
}
