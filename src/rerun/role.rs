//! Entity names and styles.
//!
//! In a recording of one run, colours distinguish quantities. Where two runs are compared, colours distinguish the runs:
//! each has one in the scene, the plots and the log of events, and their difference has a third.

use super::entity::{FOCUS, STAGE};
use crate::rerun::palette;
use crate::telemetry::side::Side;

/// Opacity (0 to 255) of a second top, so that the first one stays visible behind it.
pub(super) const GHOST: u32 = 0x88;

/// White, with the opacity of a top that arrows are seen through.
const TRANSLUCENT: u32 = 0xFFFF_FFA8;

/// Owner of an entity; determines its name and style.
#[derive(Clone, Debug)]
pub(super) enum Role {
    /// The only run of a recording.
    Alone,
    /// One of two runs.
    Compared(Side),
    /// The difference of two runs.
    Difference,
    /// The decimal logarithm of the magnitude of that difference.
    Magnitude,
}

impl Role {
    /// Whether there is no other run in the recording.
    pub(super) fn is_alone(&self) -> bool {
        matches!(self, Self::Alone)
    }

    /// The path in the recording of an entity of a run.
    pub(super) fn entity(&self, path: &str) -> String {
        let path = path.trim_start_matches('/');
        match self {
            Self::Alone => format!("/{path}"),
            Self::Compared(side) => format!("/{}/{path}", side.letter()),
            Self::Difference => format!("/diff/{path}"),
            Self::Magnitude => format!("/diff_log10/{path}"),
        }
    }

    /// The entity that the camera of a run's scene is at rest with: that of a free peg travels with it.
    pub(super) fn scene_origin(&self, is_free: bool) -> String {
        if is_free {
            self.entity(FOCUS)
        } else {
            STAGE.to_owned()
        }
    }

    /// The name of a quantity in a legend. Letters stand for the runs, whose names would make the legend so wide that it
    /// hides the curves; titles and the summary have the names.
    pub(super) fn name(&self, own: &str) -> String {
        match self {
            Self::Alone => own.to_owned(),
            Self::Compared(side) => format!("{} {own}", side.name()),
            Self::Difference => format!("Δ {own}"),
            Self::Magnitude => format!("log₁₀ |Δ {own}|"),
        }
    }

    /// The colour of the number with index `place` in a plot, or of an arrow, whose colour in a recording of one run is
    /// `own`.
    pub(super) fn color(&self, own: u32, place: usize) -> u32 {
        let color = match self {
            Self::Alone => return own,
            Self::Compared(Side::A) => palette::SKY,
            Self::Compared(Side::B) => palette::ORANGE,
            Self::Difference | Self::Magnitude => palette::PURPLE,
        };
        // The colour of the run, with the opacity of the quantity in the lowest byte.
        shade(color, place) & !0xFF | own & 0xFF
    }

    /// The width of a line that is `own` points wide in a recording of one run. Lines of run B lie on those of run A
    /// and leave them visible on both sides.
    pub(super) fn width(&self, own: f32) -> f32 {
        match self {
            // Translucent bands and dots keep their width.
            Self::Compared(Side::A) if own > 1.0 => 3.5,
            Self::Alone | Self::Compared(Side::A) => own,
            Self::Compared(Side::B) | Self::Difference | Self::Magnitude => own.min(1.2),
        }
    }

    fn is_of_b(&self) -> bool {
        matches!(self, Self::Compared(Side::B))
    }

    /// The factor by which arrows are thicker than in a recording of one run.
    pub(super) fn thickness(&self) -> f64 {
        if self.is_of_b() { 0.7 } else { 1.0 }
    }

    /// Scale factor of the drawn top; B is slightly larger, so that it is visible around A.
    pub(super) fn size(&self) -> f64 {
        if self.is_of_b() { 1.015 } else { 1.0 }
    }

    /// The colour that the top's colours are multiplied by; the arrows in its body are visible.
    pub(super) fn albedo(&self) -> u32 {
        if self.is_of_b() {
            palette::ORANGE & !0xFF | GHOST
        } else {
            TRANSLUCENT
        }
    }
}

/// A shade of a colour, for the components of a vector: itself, a lighter or a darker one.
fn shade(color: u32, place: usize) -> u32 {
    color.to_be_bytes().into_iter().fold(0, |shaded, value| {
        let value = match place % 3 {
            0 => value,
            1 => value + (0xFF - value) / 5 * 3,
            _ => value / 5 * 3,
        };
        shaded << 8 | u32::from(value)
    })
}
