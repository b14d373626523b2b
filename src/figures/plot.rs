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
pub(crate) mod png;
pub(crate) mod range;
pub(crate) mod rows;
pub(crate) mod shape;
pub(crate) mod style;
mod svg;
pub(crate) mod text;
pub(crate) mod ticks;
