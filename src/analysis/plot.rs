//! Drawings for print: axes, curves, legends and text, as SVG and PNG with the same bytes on every machine.
//!
//! A [`page::Page`] lays out panels of curves, with space measured from the labels; a [`frame::Frame`] is a plot with
//! its axes; a [`drawing::Drawing`] is shapes and labels in mm, which [`svg`] and [`png`] write. Independent of what
//! the curves represent.

pub(crate) mod decimate;
pub(crate) mod drawing;
pub(crate) mod frame;
pub(crate) mod legend;
pub(crate) mod page;
mod png;
pub(crate) mod range;
pub(crate) mod rows;
pub(crate) mod shape;
pub(crate) mod style;
mod svg;
pub(crate) mod text;
pub(crate) mod ticks;

/// The drawing of a top in the glossary.
#[cfg(test)]
mod glossary {
    use super::drawing::{Anchor, Drawing};
    use super::shape::{Bounds, Colour, Point, Shape, Stroke};
    use super::style::{BLACK, BLUE, COLOURS, DASHED, GREEN, GREY, HAIRLINE, SKY, VERMILION, line};
    use super::text::Text;
    use libm::{cos, hypot, sin};
    use std::f64::consts::{FRAC_PI_3, FRAC_PI_6, PI, TAU};
    use std::path::Path;

    /// Centre of the peg, mm.
    const PEG: Point = (42.0, 55.0);
    /// The lowest point of the peg, mm.
    const CONTACT: Point = (PEG.0, PEG.1 + 4.0);
    /// The centre of mass on the body, mm.
    const CENTRE_OF_MASS: Point = (0.0, 22.0);
    const INCLINATION: f64 = FRAC_PI_6;

    /// A point on the body: distances from the symmetry axis, and along it from the centre of the peg, mm.
    fn on_body((across, along): Point) -> Point {
        let (s, c) = (sin(INCLINATION), cos(INCLINATION));
        (
            PEG.0 + along * s + across * c,
            PEG.1 - along * c + across * s,
        )
    }

    /// A point in the plane of the drawing: distances from the vertical, and above the centre of the peg, mm.
    fn above((across, up): Point) -> Point {
        (PEG.0 + across, PEG.1 - up)
    }

    /// An arc of an ellipse, counterclockwise as seen along the second axis from its end.
    fn arc(
        (x, y): Point,
        radii: Point,
        from: f64,
        to: f64,
        place: fn(Point) -> Point,
    ) -> Vec<Point> {
        let at = |part: u32| {
            let angle = from + (to - from) * f64::from(part) / 48.0;
            place((x + radii.0 * cos(angle), y + radii.1 * sin(angle)))
        };
        (0..=48).map(at).collect()
    }

    fn solid(points: Vec<Point>, fill: Colour) -> Vec<Shape> {
        let mut outline = points.clone();
        outline.push(points[0]);
        let stroke = line(GREY, HAIRLINE);
        let outline = Shape::Line {
            points: outline,
            stroke,
        };
        vec![Shape::Area { points, fill }, outline]
    }

    fn arrow(points: Vec<Point>, colour: Colour, dash: &'static [f64]) -> Vec<Shape> {
        let [(x0, y0), (x, y)] = points[points.len() - 2..] else {
            return Vec::new();
        };
        let length = hypot(x - x0, y - y0);
        let (dx, dy) = ((x - x0) / length, (y - y0) / length);
        let corner = |side: f64| (x - 2.0 * dx + side * dy, y - 2.0 * dy - side * dx);
        let head = vec![corner(0.7), (x + 0.4 * dx, y + 0.4 * dy), corner(-0.7)];
        let stroke = Stroke {
            dash,
            ..line(colour, 0.4)
        };
        vec![
            Shape::Line { points, stroke },
            Shape::Area {
                points: head,
                fill: colour,
            },
        ]
    }

    fn dot(centre: Point) -> Shape {
        Shape::Dot {
            centre,
            radius: 0.6,
            fill: BLACK,
            stroke: line(BLACK, HAIRLINE),
        }
    }

    fn top() -> Drawing {
        const WOOD: Colour = Colour(0xe9, 0xd9, 0xbd);
        const LIGHT: Colour = Colour(0xfb, 0xf7, 0xee);
        const STEEL: Colour = Colour(0xd4, 0xd8, 0xde);
        let mut drawing = Drawing::new(96.0);
        drawing.height = 69.0;
        drawing.title = "A top whose axis is inclined to the vertical".to_owned();
        let table = Bounds::between((2.0, CONTACT.1), (94.0, CONTACT.1 + 2.5));
        drawing.group("table", vec![table.area(Colour(0xe8, 0xe8, 0xe8))]);
        let rim = |along| arc((0.0, along), (19.0, 4.8), 0.0, TAU, on_body);
        let peg = arc((0.0, 0.0), (4.0, 4.0), 0.0, TAU, on_body);
        let cone = [(-3.2, 2.4), (-18.7, 26.5), (18.7, 26.5), (3.2, 2.4)];
        let stem = [(1.1, 29.5), (0.8, 46.0), (-0.8, 46.0), (-1.1, 29.5)];
        let body = [
            solid(peg, STEEL),
            solid(cone.map(on_body).to_vec(), WOOD),
            solid(rim(27.3), WOOD),
            solid(rim(29.2), LIGHT),
            solid(stem.map(on_body).to_vec(), STEEL),
        ];
        drawing.group("body of the top", body.concat());
        draw_arrows(&mut drawing);
        draw_labels(&mut drawing);
        drawing
    }

    fn draw_arrows(drawing: &mut Drawing) {
        let centre = on_body(CENTRE_OF_MASS);
        let axis = vec![on_body((0.0, 46.0)), on_body((0.0, 53.0))];
        let lever = Shape::Line {
            points: vec![PEG, centre],
            stroke: Stroke {
                dash: DASHED,
                ..line(BLACK, HAIRLINE)
            },
        };
        drawing.group(
            "from the centre of the peg to the centre of mass",
            vec![lever, dot(PEG), dot(centre)],
        );
        let (from, to) = (PI, TAU + FRAC_PI_3);
        // The vertical and n are in the plane of the drawing; farther away is to the upper right.
        let arrows = [
            ("vertical", vec![CONTACT, above((0.0, 52.5))], BLACK, DASHED),
            ("symmetry axis", axis, BLUE, &[]),
            (
                "spin",
                arc((0.0, 49.0), (5.6, 1.6), from, to, on_body),
                BLUE,
                &[],
            ),
            (
                "precession",
                arc((0.0, 48.0), (5.6, 1.6), from, to, above),
                VERMILION,
                &[],
            ),
            (
                "inclination",
                arc((0.0, 0.0), (36.0, 36.0), 1.5 * FRAC_PI_3, FRAC_PI_3, above),
                GREEN,
                &[],
            ),
            (
                "weight",
                vec![centre, (centre.0, centre.1 + 15.0)],
                BLACK,
                &[],
            ),
            (
                "slip velocity",
                vec![CONTACT, (CONTACT.0 + 20.0, CONTACT.1 - 4.6)],
                SKY,
                &[],
            ),
            (
                "friction force",
                vec![CONTACT, (CONTACT.0 - 14.0, CONTACT.1 + 3.2)],
                COLOURS[4],
                &[],
            ),
        ];
        for (meaning, points, colour, dash) in arrows {
            drawing.group(meaning, arrow(points, colour, dash));
        }
        drawing.group("point of contact", vec![dot(CONTACT)]);
    }

    fn draw_labels(drawing: &mut Drawing) {
        let centre = on_body(CENTRE_OF_MASS);
        let labels = [
            ("*z*′", above((1.5, 51.0)), Anchor::Start),
            ("*φ*: precession", above((-7.0, 47.0)), Anchor::End),
            ("*θ*: inclination", above((3.0, 37.5)), Anchor::Start),
            ("*n*", on_body((1.2, 52.5)), Anchor::Start),
            ("*ψ*: spin", on_body((7.5, 47.5)), Anchor::Start),
            ("*M g*", (centre.0 + 1.2, centre.1 + 9.0), Anchor::Start),
            ("*l*", on_body((2.0, 13.0)), Anchor::Middle),
            ("*R*", (PEG.0 - 5.0, PEG.1 - 2.0), Anchor::End),
            (
                "*v*: slip velocity",
                (CONTACT.0 + 21.5, CONTACT.1 - 4.0),
                Anchor::Start,
            ),
            (
                "*f*: friction force",
                (CONTACT.0 - 14.0, CONTACT.1 + 7.2),
                Anchor::Middle,
            ),
            ("table", (93.0, CONTACT.1 + 6.5), Anchor::End),
        ];
        for (text, place, anchor) in labels {
            drawing.label(Text::markup(text), place, anchor);
        }
    }

    /// `TOPRISE_WRITE=1 cargo test --lib glossary` redraws it.
    #[test]
    fn regress_the_glossary_has_the_drawing_of_a_top() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/top.svg");
        let drawn = top().svg();
        if std::env::var_os("TOPRISE_WRITE").is_some() {
            std::fs::write(&path, &drawn).unwrap();
        }
        assert!(
            std::fs::read_to_string(path).unwrap() == drawn,
            "TOPRISE_WRITE=1 cargo test --lib glossary draws it anew"
        );
    }
}
