//! Arrows as a `MarkerArray`, which 3D views of Foxglove, Lichtblick and RViz draw. Each has a namespace with its name, which
//! these viewers show and hide.

use super::cdr::Cdr;
use crate::telemetry::arrows::{Arrow, SampleArrows};
use nalgebra::Vector3;

// Constants of `visualization_msgs/Marker`.
const ARROW: u32 = 0;
const TEXT: u32 = 9;
const ADD: u32 = 0;
const DELETE: u32 = 2;

/// The frame that arrows are in.
const FRAME: &str = "world";

/// Diameter of the shaft of an arrow of normal thickness, and height of a letter, in heights of the top.
const SHAFT: f64 = 0.028;
const LETTER: f64 = 0.1;

/// Ratio of the diameters of head and shaft.
const HEAD: f64 = 2.2;

/// Length below which an arrow is not drawn, in heights of the top: viewers find no direction for one of length zero.
const SHORTEST: f64 = 1e-6;

/// A marker.
struct Marker<'m> {
    name: &'m str,
    kind: u32,
    action: u32,
    position: Vector3<f64>,
    scale: [f64; 3],
    color: u32,
    /// The ends of an arrow.
    points: &'m [Vector3<f64>],
    text: &'m str,
}

/// Writes the arrows of a sample of a top with this height (m), and their symbols at the tips.
pub(super) fn write(
    cdr: &mut Cdr,
    time_ns: u64,
    arrows: &[Arrow],
    drawn: &SampleArrows<'_>,
    height: f64,
) {
    let labels = arrows
        .iter()
        .filter(|arrow| !arrow.style().symbol.is_empty());
    cdr.u32((arrows.len() + labels.count()) as u32);
    for arrow in arrows {
        let style = arrow.style();
        let visible = drawn
            .get(*arrow)
            .filter(|drawn| drawn.vector.norm() > SHORTEST * height);
        let ends = visible.map(|drawn| [drawn.start, drawn.start + drawn.vector]);
        let shaft = SHAFT * height * style.thickness;
        let marker = Marker {
            name: style.name,
            kind: ARROW,
            action: if ends.is_some() { ADD } else { DELETE },
            position: Vector3::zeros(),
            // Without a length, the head has its usual share of the arrow.
            scale: [shaft, HEAD * shaft, 0.0],
            color: style.color,
            points: ends.as_ref().map_or(&[], |ends| &ends[..]),
            text: "",
        };
        marker.write(cdr, time_ns);
        if !style.symbol.is_empty() {
            let label = Marker {
                kind: TEXT,
                position: ends.map_or(Vector3::zeros(), |[_, tip]| tip),
                scale: [0.0, 0.0, LETTER * height],
                points: &[],
                text: style.symbol,
                ..marker
            };
            label.write(cdr, time_ns);
        }
    }
}

impl Marker<'_> {
    fn write(&self, cdr: &mut Cdr, time_ns: u64) {
        let color = self.color.to_be_bytes().map(|part| f32::from(part) / 255.0);
        // Namespace and identifier together name a marker.
        cdr.header(time_ns, FRAME).string(self.name).u32(self.kind);
        cdr.u32(self.kind).u32(self.action);
        cdr.f64s(rounded(&self.position).as_slice())
            .f64s(&[0.0, 0.0, 0.0, 1.0]);
        cdr.f64s(&self.scale).f32s(&color);
        // It stays until the next one, and where it is in its frame.
        cdr.u32(0).u32(0).u8(0);
        cdr.u32(self.points.len() as u32);
        for point in self.points {
            cdr.f64s(rounded(point).as_slice());
        }
        // One colour for all points, and no texture, whose image has a header and a format.
        cdr.u32(0).string("").header(0, "").string("").u32(0).u32(0);
        // No mesh, by name or in a file.
        cdr.string(self.text).string("").string("").u32(0).u8(0);
    }
}

/// A point in single precision, as viewers draw it: the zeros that follow compress well.
fn rounded(point: &Vector3<f64>) -> Vector3<f64> {
    point.map(|part| f64::from(part as f32))
}
