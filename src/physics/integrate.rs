//! Numerical integration of ordinary differential equations.
//!
//! [`Dop853`] is the explicit Runge–Kutta method of order 8 by Dormand and Prince with step control and
//! dense output of order 7; [`SignTracker`] locates zeros of functions on that output.
//!
//! Uses only `+ − × ÷` and `sqrt`, which IEEE 754 rounds exactly, in a fixed order: the results are bit-identical on
//! every machine.
//!
//! # Sources
//! * E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I. Nonstiff Problems*,
//!   2nd ed., Springer 1993: II.4 (first step), II.5 (the method), II.6 (dense output), II.10 (error
//!   estimate);
//! * E. Hairer, G. Wanner, `dop853.f`, <https://www.unige.ch/~hairer/software.html>: coefficients and the
//!   constants of the step control. Its licence is the BSD 2-clause one, "Copyright (c) 2004, Ernst
//!   Hairer" (<https://www.unige.ch/~hairer/prog/licence.txt>).

mod coefficients;
mod crossing;
mod dense;
mod dop853;
mod interpolant;
mod problem;
mod search;

pub use crossing::{Crossing, SignTracker, Slope};
pub use dense::Dense;
pub use dop853::Dop853;
pub use interpolant::KNOTS;
pub use problem::{IntegrateError, Statistics, System, Tolerances};
pub use search::zero;
