//! The colours of plots and scene, as 0xRRGGBBAA: those of the arrows, and further ones of Okabe and Ito's.

pub(super) use crate::telemetry::arrows::palette::{
    GREEN, GREY, ORANGE, SKY, VERMILION, WHITE, YELLOW, name,
};

/// The colour of fast ripple; translucent, so that other curves stay visible.
pub(super) const PALE: u32 = 0x56B4_E990;
pub(super) const BLUE: u32 = 0x4C8F_D6FF;
pub(super) const PURPLE: u32 = 0xCC79_A7FF;
