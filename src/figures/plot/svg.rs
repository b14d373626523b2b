//! Drawings as SVG.
//!
//! All coordinates are whole hundredths of a millimetre: short, and the same on every machine. Glyphs are defined once and
//! used by all labels.

use super::drawing::{Drawing, Label};
use super::shape::{Colour, Point, Shape, Stroke};
use super::style::{BLACK, FONT};
use super::text::{self, Style, UNITS};
use std::collections::BTreeSet;
use tiny_skia::{Path, PathSegment};

/// Units of the drawing in a millimetre.
const SCALE: f64 = 100.0;

impl Drawing {
    /// The drawing as an SVG document.
    pub fn svg(&self) -> String {
        let [width, height] = [self.width, self.height].map(unit);
        let mut svg = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        svg.push_str(&format!("<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             width=\"{}mm\" height=\"{}mm\" viewBox=\"0 0 {width} {height}\" role=\"img\">\n<title>{}</title>\n",
            decimal(width as f64 / SCALE),
            decimal(height as f64 / SCALE),
            escaped(&self.title)));
        svg.push_str(&self.glyphs());
        svg.push_str("<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
        for group in &self.groups {
            svg.push_str(&format!("<g aria-label=\"{}\">\n", escaped(&group.meaning)));
            for part in &group.shapes {
                svg.push_str(&shape(part));
            }
            svg.push_str("</g>\n");
        }
        for text in &self.labels {
            svg.push_str(&label(text));
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// The definitions of all glyphs that are used.
    fn glyphs(&self) -> String {
        let texts = self.labels.iter().map(|label| &label.text);
        let used: BTreeSet<_> = texts
            .flat_map(|text| text.glyphs.iter().map(|glyph| (glyph.style, glyph.id)))
            .collect();
        let mut svg = String::from("<defs>\n");
        for (style, id) in used {
            let (name, path) = (name(style, id), outline(style, id));
            svg.push_str(&format!("<path id=\"{name}\" d=\"{path}\"/>\n"));
        }
        svg.push_str("</defs>\n");
        svg
    }
}

fn unit(length: f64) -> i64 {
    (length * SCALE).round() as i64
}

/// A number with at most four digits after the point.
fn decimal(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0" } else { text }.to_owned()
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('"', "&quot;");
    let text = text.replace('<', "&lt;").replace('>', "&gt;");
    // XML can't represent these characters.
    text.replace(char::is_control, "\u{fffd}")
}

fn name(style: Style, id: u16) -> String {
    let letter = match style {
        Style::Upright => 'u',
        Style::Italic => 'i',
    };
    format!("{letter}{id}")
}

fn hex(Colour(red, green, blue): Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn stroke(stroke: &Stroke) -> String {
    let mut svg = format!(
        "stroke=\"{}\" stroke-width=\"{}\"",
        hex(stroke.colour),
        unit(stroke.width)
    );
    if !stroke.dash.is_empty() {
        let lengths: Vec<_> = stroke.dash.iter().map(|l| unit(*l).to_string()).collect();
        svg.push_str(&format!(" stroke-dasharray=\"{}\"", lengths.join(" ")));
    }
    if stroke.opacity < 1.0 {
        svg.push_str(&format!(" stroke-opacity=\"{}\"", decimal(stroke.opacity)));
    }
    svg
}

/// The data of a path from point to point, in relative steps and without steps of no length.
fn path(points: &[Point]) -> String {
    let mut places: Vec<_> = points.iter().map(|(x, y)| (unit(*x), unit(*y))).collect();
    places.dedup();
    let mut svg = String::new();
    let mut last = (0, 0);
    for (index, place) in places.into_iter().enumerate() {
        let (dx, dy) = (place.0 - last.0, place.1 - last.1);
        // A minus sign separates as well as a space does.
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

fn shape(shape: &Shape) -> String {
    match shape {
        Shape::Line {
            points,
            stroke: line,
        } => format!(
            "<path d=\"{}\" fill=\"none\" stroke-linejoin=\"round\" {}/>\n",
            path(points),
            stroke(line)
        ),
        Shape::Area { points, fill } => {
            format!("<path d=\"{}z\" fill=\"{}\"/>\n", path(points), hex(*fill))
        }
        Shape::Dot {
            centre,
            radius,
            fill,
            stroke: line,
        } => format!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" {}/>\n",
            unit(centre.0),
            unit(centre.1),
            unit(*radius),
            hex(*fill),
            stroke(line)
        ),
    }
}

fn label(label: &Label) -> String {
    let scale = FONT * SCALE / UNITS;
    let turn = if label.is_upward { " rotate(-90)" } else { "" };
    let mut svg = format!(
        "<g aria-label=\"{}\" fill=\"{}\" transform=\"translate({} {}){turn} scale({} {})\">",
        escaped(&label.text.spoken),
        hex(BLACK),
        unit(label.origin.0),
        unit(label.origin.1),
        decimal(scale),
        decimal(-scale)
    );
    for glyph in &label.text.glyphs {
        let (x, y) = (glyph.x * UNITS, glyph.y * UNITS);
        let place = if glyph.scale == 1.0 {
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
            "<use xlink:href=\"#{}\" {place}/>",
            name(glyph.style, glyph.id)
        ));
    }
    svg.push_str("</g>\n");
    svg
}

/// The data of the path of a glyph.
fn outline(style: Style, id: u16) -> String {
    let path = text::outline(style, id);
    let segments = path.iter().flat_map(Path::segments);
    segments.map(segment).collect()
}

fn segment(segment: PathSegment) -> String {
    let (command, points) = match segment {
        PathSegment::MoveTo(to) => ('M', vec![to]),
        PathSegment::LineTo(to) => ('L', vec![to]),
        PathSegment::QuadTo(by, to) => ('Q', vec![by, to]),
        PathSegment::CubicTo(from, by, to) => ('C', vec![from, by, to]),
        PathSegment::Close => ('Z', Vec::new()),
    };
    let numbers = points.iter().flat_map(|point| [point.x, point.y]);
    let numbers: Vec<_> = numbers.map(|number| decimal(number.into())).collect();
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
        fn paths_lead_from_place_to_place(
            points in prop::collection::vec((-1.0..1.0, -0.1..0.1), 1..30),
        ) {
            let path = path(&points);
            let mut expected: Vec<_> = points.iter().map(|(x, y)| (unit(*x), unit(*y))).collect();
            expected.dedup();
            prop_assert_eq!(path.contains('l'), expected.len() > 1);
            prop_assert_eq!(places(&path), expected);
        }
    }

    #[test]
    fn paths_are_steps() {
        let points = [(1.0, 1.0), (1.0, 1.001), (1.5, 0.5), (1.25, 0.75)];
        assert_eq!(path(&points), "M100 100l50-50-25 25");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(decimal(85.0), "85");
        assert_eq!(decimal(-0.000_01), "0");
        assert_eq!(decimal(0.28222), "0.2822");
    }
}
