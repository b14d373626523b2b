//! Bodies of the scene: surfaces of revolution.
//!
//! Lengths in metres. The body frame has its origin at the centre of the spherical peg and its z
//! axis along the symmetry axis; the world frame has the table at z = 0.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use rerun::{Color, LineStrips3D, Mesh3D, Radius};

use crate::physics::math;
use crate::telemetry::proportions::Proportions;

/// Steps around the axis; a multiple of the number of sectors.
const STEPS: usize = 96;
/// Sectors of alternating colour, so that the spin is visible.
const SECTORS: usize = 6;

/// A point of a profile, and the surface's normal there, each as distance from the axis and height.
type ProfilePoint = [[f64; 2]; 2];

/// The surface of the top in body axes.
pub(in crate::rerun) fn top(proportions: &Proportions) -> Mesh3D {
    let mut surface = Surface::default();
    for (part, palette) in parts(proportions) {
        surface.turn(&part, palette);
    }
    surface.mesh()
}

type Palette = [u32; SECTORS];

const WOOD: u32 = 0xC9A2_6BFF;
const CREAM: u32 = 0xF2E8_D5FF;
const INK: u32 = 0x4A5F_8AFF;
const MARK: u32 = 0xC855_3DFF;
const STEEL: u32 = 0xB9C0_C8FF;

const DISC: Palette = [CREAM, INK, CREAM, INK, MARK, INK];
const CONE: Palette = [WOOD; SECTORS];
const METAL: Palette = [STEEL; SECTORS];

/// Profiles of the top's parts, from the bottom to the tip. Each is smooth; edges lie between them.
fn parts(p: &Proportions) -> Vec<(Vec<ProfilePoint>, Palette)> {
    if p.is_ball {
        return ball(p);
    }
    let half = 0.5 * p.thickness();
    let (low, high) = (p.disc_height - half, p.disc_height + half);
    let neck = p.neck();
    let shoulder = p.shoulder();
    let seam = math::atan2((p.peg * p.peg - neck * neck).sqrt(), neck);
    let rim = p.disc_radius - half;
    let collar = [p.stem_radius, high + 0.4 * shoulder];
    let knob = 1.5 * p.stem_radius;
    let end = p.tip - knob;
    let outwards = [-FRAC_PI_2, FRAC_PI_2];
    vec![
        (arc([0.0, 0.0], p.peg, [-FRAC_PI_2, seam]), METAL),
        (line([neck, p.peg * math::sin(seam)], [shoulder, low]), CONE),
        (line([shoulder, low], [rim, low]), DISC),
        (arc([rim, p.disc_height], half, outwards), DISC),
        (line([rim, high], [shoulder, high]), DISC),
        (line([shoulder, high], collar), CONE),
        (line(collar, [p.stem_radius, end]), METAL),
        (arc([0.0, end], knob, outwards), METAL),
    ]
}

/// Profiles of a tippe top, from the bottom of the ball to the tip of the stem.
fn ball(p: &Proportions) -> Vec<(Vec<ProfilePoint>, Palette)> {
    let cut = p.cut();
    let rim = (p.peg * p.peg - cut * cut).sqrt();
    let seam = math::atan2(cut, rim);
    let (stem, knob) = (p.stem_radius, p.stem_radius);
    let end = p.tip - knob;
    vec![
        (arc([0.0, 0.0], p.peg, [-FRAC_PI_2, seam]), DISC),
        (line([rim, cut], [stem, cut]), CONE),
        (line([stem, cut], [stem, end]), METAL),
        (arc([0.0, end], knob, [0.0, FRAC_PI_2]), METAL),
    ]
}

/// An arc of a profile, between two angles from the horizontal in rad.
fn arc(center: [f64; 2], radius: f64, [from, to]: [f64; 2]) -> Vec<ProfilePoint> {
    const PIECES: u32 = 16;
    (0..=PIECES)
        .map(|piece| {
            let angle = from + (to - from) * f64::from(piece) / f64::from(PIECES);
            let (sin, cos) = math::sin_cos(angle);
            // At the poles the cosine is not exactly 0.
            let distance = (center[0] + radius * cos).max(0.0);
            [[distance, center[1] + radius * sin], [cos, sin]]
        })
        .collect()
}

/// A straight piece of a profile; the outside is to the right of its direction.
fn line(from: [f64; 2], to: [f64; 2]) -> Vec<ProfilePoint> {
    let direction = [to[0] - from[0], to[1] - from[1]];
    let length = math::hypot(direction[0], direction[1]).max(f64::MIN_POSITIVE);
    let normal = [direction[1] / length, -direction[0] / length];
    vec![[from, normal], [to, normal]]
}

/// A growing triangle mesh.
#[derive(Default)]
struct Surface {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    colors: Vec<Color>,
    triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// Turns a profile around the z axis. Each sector has its own vertices, so that colours
    /// change at once from one sector to the next.
    fn turn(&mut self, profile: &[ProfilePoint], palette: Palette) {
        let steps = STEPS / SECTORS;
        for (sector, color) in palette.into_iter().enumerate() {
            let first = self.positions.len();
            for step in 0..=steps {
                let turn = (sector * steps + step) as f64 / STEPS as f64;
                let direction = math::sin_cos(TAU * turn);
                for [place, normal] in profile {
                    self.positions.push(around(*place, direction));
                    self.normals.push(around(*normal, direction));
                    self.colors.push(Color::from_u32(color));
                }
            }
            self.stitch(first, profile.len(), steps);
        }
    }

    /// Joins neighbouring meridians, counter-clockwise as seen from outside.
    fn stitch(&mut self, first: usize, points: usize, steps: usize) {
        for step in 0..steps {
            for point in 0..points - 1 {
                let a = (first + step * points + point) as u32;
                let b = a + points as u32;
                self.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
            }
        }
    }

    fn mesh(self) -> Mesh3D {
        Mesh3D::new(self.positions)
            .with_vertex_normals(self.normals)
            .with_vertex_colors(self.colors)
            .with_triangle_indices(self.triangles)
    }
}

fn around([distance, height]: [f64; 2], (sin, cos): (f64, f64)) -> [f32; 3] {
    [
        (distance * cos) as f32,
        (distance * sin) as f32,
        height as f32,
    ]
}

/// A round table top of the given radius, just below z = 0.
pub(in crate::rerun) fn table(radius: f64) -> Mesh3D {
    let depth = 0.03 * radius;
    let mut surface = Surface::default();
    let color = [0x2B30_3AFF; SECTORS];
    // The surface is slightly below z = 0 to avoid z-fighting.
    let top = -2e-4;
    surface.turn(&line([radius, top], [0.0, top]), color);
    surface.turn(&line([radius, top - depth], [radius, top]), color);
    surface.mesh()
}

/// Circles, as many as `rings`, and rays on a table of the given radius.
pub(in crate::rerun) fn table_marks(radius: f64, rings: u32) -> LineStrips3D {
    let circles = (1..=rings).map(|ring| circle(radius * f64::from(ring) / f64::from(rings)));
    let rays = (0..6).map(|ray| {
        let direction = math::sin_cos(PI * f64::from(ray) / 6.0);
        [radius, -radius]
            .map(|end| around([end, 0.0], direction))
            .to_vec()
    });
    LineStrips3D::new(circles.chain(rays))
        .with_colors([Color::from_u32(0x4A52_60FF)])
        .with_radii([Radius::new_ui_points(0.5)])
}

fn circle(radius: f64) -> Vec<[f32; 3]> {
    let turns = (0..=STEPS).map(|step| step as f64 / STEPS as f64);
    turns
        .map(|turn| around([radius, 0.0], math::sin_cos(TAU * turn)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::scenario::Preset;

    fn difference(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
        [0, 1, 2].map(|i| a[i] - b[i])
    }

    #[test]
    fn triangles_face_outwards() {
        let presets = ["paper", "tippe-top"].map(|name| Preset::find(name).unwrap());
        let mut surface = Surface::default();
        for preset in presets {
            let top = preset.scenario().unwrap().model.top;
            for (part, palette) in parts(&Proportions::new(&top)) {
                surface.turn(&part, palette);
            }
        }
        for [a, b, c] in surface.triangles.iter().map(|t| t.map(|i| i as usize)) {
            let u = difference(surface.positions[b], surface.positions[a]);
            let v = difference(surface.positions[c], surface.positions[a]);
            let face = [
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            ];
            let normal = surface.normals[a];
            let outwards: f32 = (0..3).map(|i| face[i] * normal[i]).sum();
            assert!(outwards >= -1e-12, "{face:?} {normal:?}");
        }
    }
}
