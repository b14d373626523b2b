//! The integrator and the location of zeros, against exact solutions, problems of the literature and an
//! independent implementation.

#![allow(
    clippy::float_cmp,
    clippy::similar_names,
    reason = "bits are meant to be equal; dpsi is to psi as dtheta to theta"
)]

use crate::support::{FAST_PRECESSION, scenario};
use proptest::prelude::*;
use std::cell::Cell;
use std::f64::consts::{PI, TAU};
use toprise::physics::dynamics::{BodyRotation, EulerAngles, Phase};
use toprise::physics::integrate::{
    Crossing, Dense, Dop853, IntegrateError, KNOTS, SignTracker, Slope, System, Tolerances,
};
use toprise::run::scenario::Scenario;

const EPSILON: f64 = f64::EPSILON;

/// A system given by a function, all of whose components are controlled.
struct Equation<F>(F);

impl<F: Fn(f64, &[f64; N]) -> [f64; N], const N: usize> System<N> for Equation<F> {
    fn derivative(&self, t: f64, y: &[f64; N]) -> [f64; N] {
        self.0(t, y)
    }
}

fn equation<const N: usize>(f: impl Fn(f64, &[f64; N]) -> [f64; N]) -> impl System<N> {
    Equation(f)
}

fn start<S: System<N>, const N: usize>(
    system: S,
    t0: f64,
    y0: [f64; N],
    tolerance: f64,
) -> Dop853<S, N> {
    Dop853::new(system, t0, y0, tolerances(tolerance)).unwrap()
}

fn tolerances(tolerance: f64) -> Tolerances {
    Tolerances {
        relative: tolerance,
        absolute: tolerance,
    }
}

/// The state at `t`, which is not before the end of the last step.
fn state_at<S: System<N>, const N: usize>(integrator: &mut Dop853<S, N>, t: f64) -> [f64; N] {
    while integrator.t() < t {
        integrator.step().unwrap();
    }
    let step = integrator.dense();
    step.at((t - step.t0) / step.h)
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

/// Steps until a step fails.
fn first_error<S: System<N>, const N: usize>(integrator: &mut Dop853<S, N>) -> IntegrateError {
    loop {
        if let Err(error) = integrator.step() {
            return error;
        }
        assert!(integrator.statistics().accepted < 10_000);
    }
}

/// y′ = y cos t, whose solution is e^(sin t): it notices wrong nodes, which autonomous systems don't.
fn non_autonomous() -> impl System<1> {
    equation(|t, y: &[f64; 1]| [y[0] * libm::cos(t)])
}

fn non_autonomous_solution(t: f64) -> f64 {
    libm::exp(libm::sin(t))
}

fn oscillator() -> impl System<2> {
    equation(|_, y: &[f64; 2]| [y[1], -y[0]])
}

// --- The method -------------------------------------------------------------------------------------

/// The method integrates polynomials of degree 7 exactly. The weighted sum of stages has terms up to
/// Σ|b| ≈ 17 times its own magnitude for a constant and a few times more for t⁷, each with a rounding or
/// two: 100 ε.
#[test]
fn every_step_of_a_degree_eight_solution_is_exact() {
    let eighth_power = |t: f64| {
        let square = t * t;
        (square * square) * (square * square)
    };
    let system = equation(|t, _: &[f64; 1]| [8.0 * (t * t * t) * (t * t) * (t * t)]);
    let mut integrator = start(system, 0.0, [0.0], 1e-9);
    while integrator.t() < 2.0 {
        integrator.step().unwrap();
        let exact = eighth_power(integrator.t());
        let error = (integrator.y()[0] - exact).abs();
        assert!(error <= 100.0 * EPSILON * exact, "{error:e} of {exact:e}");
    }
    let steps = integrator.statistics().accepted;
    assert!(steps < 60, "steps of a useful length: {steps}");
}

/// Length and error of a single step, and its dense output's largest error.
fn single_step(tolerance: f64) -> (f64, f64, f64) {
    let system = equation(|t, y: &[f64; 1]| [3.0 * y[0] * libm::cos(3.0 * t)]);
    let y0 = [non_autonomous_solution(0.3)];
    let mut integrator = start(system, 0.1, y0, tolerance);
    integrator.step().unwrap();
    let step = integrator.dense();
    let exact = |s: f64| non_autonomous_solution(3.0 * (step.t0 + s * step.h));
    let error = |s: f64| (step.component(0, s) - exact(s)).abs();
    let inside = (1..40).map(|i| error(f64::from(i) / 40.0));
    (step.h, error(1.0), inside.fold(0.0, f64::max))
}

/// The exponents of h in the error of one step and of its dense output, between steps whose lengths differ
/// by about 2 (the first step goes with the eighth root of the tolerance).
fn local_orders(tolerance: f64) -> (f64, f64) {
    let (long, error, inside) = single_step(tolerance);
    let (short, error_short, inside_short) = single_step(tolerance / 256.0);
    let halvings = libm::log2(long / short);
    assert!((halvings - 1.0).abs() < 0.2, "{halvings}");
    (
        libm::log2(error / error_short) / halvings,
        libm::log2(inside / inside_short) / halvings,
    )
}

/// A method of order 8 has a local error of h⁹ (1 + O(h)), dense output of order 7 one of h⁸ (1 + O(h));
/// h is about 0.1, so that the exponents come out right to some tenths.
#[test]
fn single_steps_have_order_eight_and_dense_output_order_seven() {
    for tolerance in [1e-4, 1e-5, 1e-6] {
        let (order, order_inside) = local_orders(tolerance);
        assert!((8.2..9.2).contains(&order), "{order}");
        assert!((7.7..8.3).contains(&order_inside), "{order_inside}");
    }
}

/// The bounds are some hundred tolerances, because steps are chosen for the error at their ends: inside
/// them it is larger by an order of h.
#[test]
fn time_dependent_equations_are_integrated() {
    for (tolerance, bound) in [(1e-6, 1e-4), (1e-9, 1e-6), (1e-12, 1e-9), (1e-14, 1e-11)] {
        let mut integrator = start(non_autonomous(), 0.0, [1.0], tolerance);
        let mut worst = 0.0_f64;
        for i in 0..200 {
            let t = f64::from(i) * 0.05;
            let [y] = state_at(&mut integrator, t);
            worst = worst.max((y - non_autonomous_solution(t)).abs());
        }
        assert!(worst < bound, "{tolerance:e}: {worst:e}");
    }
}

/// The bits of a result: a change of a coefficient, of the order of an addition or of the step control
/// shows here, and so does a machine that calculates differently.
#[test]
fn regress_bits_are_platform_independent() {
    let mut integrator = start(oscillator(), 0.0, [1.0, 0.0], 1e-12);
    for _ in 0..100 {
        integrator.step().unwrap();
    }
    let [x, v] = *integrator.y();
    let [inside, _] = integrator.dense().at(0.3);
    let bits = [integrator.t(), x, v, inside].map(f64::to_bits);
    assert_eq!(
        bits,
        [
            0x4033_c55e_4157_5dca,
            0x3fe3_59a9_2e60_5950,
            0xbfe9_7c93_c56b_f85c,
            0x3fe6_b7ca_f262_b2e6,
        ]
    );
}

// --- Dense output -----------------------------------------------------------------------------------

/// Its error is rounding: the coefficients d sum to 1500 in magnitude, s and 1 − s reduce that to a
/// few; |t| < 2.5 makes derivatives up to 7 · 2.5⁶ ≈ 1700.
#[test]
fn dense_output_is_exact_up_to_degree_seven() {
    let system = equation(|t, _: &[f64; 8]| {
        let mut power = 1.0;
        let mut dy = [0.0; 8];
        for (degree, dy) in (1..).zip(&mut dy[1..]) {
            *dy = f64::from(degree) * power;
            power *= t;
        }
        dy
    });
    let exact = |t: f64| {
        let mut power = 1.0;
        [0; 8].map(|_| {
            let this = power;
            power *= t;
            this
        })
    };
    let mut integrator = start(system, -1.0, exact(-1.0), 1e-6);
    while integrator.t() < 2.0 {
        integrator.step().unwrap();
        let step = integrator.dense();
        for i in 0..=20 {
            let s = f64::from(i) / 20.0;
            let exact = exact(step.t0 + s * step.h);
            for (value, exact) in step.at(s).iter().zip(exact) {
                let error = (value - exact).abs();
                assert!(error <= 1e-13 * (1.0 + exact.abs()), "{error:e} of {exact}");
            }
        }
    }
}

/// dy/dt of a polynomial of degree 7 at the start (`s` = 0) or the end (`s` = 1) of its step: the difference formula
/// with eight points, which is exact for it.
fn slope_at<const N: usize>(step: &Dense<N>, i: usize, s: f64) -> f64 {
    const WEIGHTS: [f64; 8] = [
        -363.0 / 140.0,
        7.0,
        -21.0 / 2.0,
        35.0 / 3.0,
        -35.0 / 4.0,
        21.0 / 5.0,
        -7.0 / 6.0,
        1.0 / 7.0,
    ];
    let mut sum = 0.0;
    for (j, weight) in (0_u8..).zip(WEIGHTS) {
        let at = f64::from(j) / 7.0;
        sum += if s == 0.0 {
            weight * step.component(i, at)
        } else {
            -weight * step.component(i, 1.0 - at)
        };
    }
    7.0 * sum / step.h
}

#[test]
fn neighbouring_steps_join_in_value_and_slope() {
    let force = |t, x: f64| libm::sin(3.0 * t) - 4.0 * x * x * x;
    let system = equation(move |t, y: &[f64; 2]| [y[1], force(t, y[0])]);
    let mut integrator = start(system, 0.0, [1.0, 0.0], 1e-9);
    for _ in 0..50 {
        let (y0, dy0) = (*integrator.y(), *integrator.dy());
        integrator.step().unwrap();
        let (y1, dy1) = (*integrator.y(), *integrator.dy());
        let step = integrator.dense();
        assert_eq!(step.at(0.0), y0);
        assert_eq!((step.t0 + step.h).to_bits(), integrator.t().to_bits());
        for i in 0..2 {
            // y₀ + (y₁ − y₀) rounds twice.
            let gap = (step.component(i, 1.0) - y1[i]).abs();
            assert!(gap <= EPSILON * (y0[i].abs() + y1[i].abs()), "{gap:e}");
            // The weights sum to 45 in magnitude, times 7, each value with an ulp or two.
            let rounding = 1000.0 * EPSILON * (y0[i].abs() + y1[i].abs()) / step.h;
            for (s, dy) in [(0.0, dy0[i]), (1.0, dy1[i])] {
                let slope = slope_at(&step, i, s);
                assert!((slope - dy).abs() <= rounding, "at {s}: {slope} {dy}");
            }
        }
    }
}

#[test]
fn components_are_those_of_the_whole_state() {
    let mut integrator = start(oscillator(), 0.0, [1.0, 0.5], 1e-9);
    integrator.step().unwrap();
    let step = integrator.dense();
    for s in [0.0, 0.1, 0.77, 1.0] {
        assert_eq!(step.at(s), [step.component(0, s), step.component(1, s)]);
    }
}

#[test]
fn dense_output_before_first_step_is_the_start() {
    let mut integrator = start(oscillator(), 3.0, [1.0, 0.5], 1e-9);
    let step = integrator.dense();
    assert_eq!((step.t0, step.h), (3.0, 0.0));
    assert_eq!(step.at(0.4), [1.0, 0.5]);
}

// --- Problems with known solutions -------------------------------------------------------------------

/// The local errors of at most `tolerance` add up over a hundred radians.
#[test]
fn harmonic_oscillator() {
    let mut integrator = start(oscillator(), 0.0, [1.0, 0.0], 1e-12);
    for i in 1..=1000 {
        let t = 0.1 * f64::from(i);
        let [x, v] = state_at(&mut integrator, t);
        let error = (x - libm::cos(t)).abs().max((v + libm::sin(t)).abs());
        assert!(error < 1e-10, "{error:e} at {t}");
    }
}

/// The restricted problem of two bodies with eccentricity 0.5, from the pericentre through one period 2π.
#[test]
fn kepler_orbit_closes() {
    let y0 = [0.5, 0.0, 0.0, 3.0_f64.sqrt()];
    let system = equation(|_, &[x, y, vx, vy]: &[f64; 4]| {
        let r = (x * x + y * y).sqrt();
        let cube = r * r * r;
        [vx, vy, -x / cube, -y / cube]
    });
    let mut integrator = start(system, 0.0, y0, 1e-13);
    let half = state_at(&mut integrator, PI);
    let apocentre = [-1.5, 0.0, 0.0, -1.0 / 3.0_f64.sqrt()];
    let end = state_at(&mut integrator, TAU);
    assert!(largest_difference(&half, &apocentre) < 1e-10);
    assert!(largest_difference(&end, &y0) < 1e-10);
}

/// Arenstorf's orbit of a satellite between Earth and Moon (Hairer, Nørsett, Wanner I, equations II.0.1
/// and II.0.2): start and period are those for which it closes. The passages close to the Moon magnify errors
/// some thousand times.
#[test]
fn arenstorf_orbit_closes() {
    const MOON: f64 = 0.012_277_471;
    const EARTH: f64 = 1.0 - MOON;
    let y0 = [0.994, 0.0, 0.0, -2.001_585_106_379_082_5];
    let period = 17.065_216_560_157_963;
    let closing_error = |tolerance| {
        let system = equation(|_, &[x, y, vx, vy]: &[f64; 4]| {
            let cube = |dx: f64| {
                let square = dx * dx + y * y;
                square * square.sqrt()
            };
            let (earth, moon) = (EARTH / cube(x + MOON), MOON / cube(x - EARTH));
            [
                vx,
                vy,
                x + 2.0 * vy - earth * (x + MOON) - moon * (x - EARTH),
                y - 2.0 * vx - earth * y - moon * y,
            ]
        });
        let mut integrator = start(system, 0.0, y0, tolerance);
        let end = state_at(&mut integrator, period);
        largest_difference(&end[..2], &y0[..2])
    };
    assert!(closing_error(1e-8) < 1e-5);
    assert!(closing_error(1e-11) < 1e-9);
    assert!(closing_error(1e-13) < 1e-10);
}

/// Seven stars in a plane (Hairer, Nørsett, Wanner I, equation II.10.3).
fn pleiades(y: &[f64; 28]) -> [f64; 28] {
    let mut dy = [0.0; 28];
    dy[..14].copy_from_slice(&y[14..]);
    for i in 0..7 {
        for (j, mass) in (0..7).zip([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]) {
            if i != j {
                let (dx, dz) = (y[j] - y[i], y[7 + j] - y[7 + i]);
                let square = dx * dx + dz * dz;
                let pull = mass / (square * square.sqrt());
                dy[14 + i] += pull * dx;
                dy[21 + i] += pull * dz;
            }
        }
    }
    dy
}

/// The end is the one of the Test Set for IVP Solvers (F. Mazzia, C. Magherini, problem PLEI), which
/// agrees with the figures of the book. Close encounters magnify errors some thousand times.
#[test]
fn pleiades_end_at_published_positions() {
    let mut y0 = [0.0; 28];
    y0[..14].copy_from_slice(&[
        3.0, 3.0, -1.0, -3.0, 2.0, -2.0, 2.0, 3.0, -3.0, 2.0, 0.0, 0.0, -4.0, 4.0,
    ]);
    (y0[19], y0[20], y0[24], y0[25]) = (1.75, -1.5, -1.25, 1.0);
    let end = [
        0.370_613_914_397_050_2,
        3.237_284_092_057_233,
        -3.222_559_032_418_324,
        0.659_709_145_577_531,
        0.342_558_170_715_658_4,
        1.562_172_101_400_631,
        -0.700_309_292_221_249_5,
        -3.943_437_585_517_392,
        -3.271_380_973_972_55,
        5.225_081_843_456_543,
        -2.590_612_434_977_47,
        1.198_213_693_392_275,
        -0.242_968_234_493_582_4,
        1.091_449_240_428_98,
    ];
    let mut integrator = start(equation(|_, y| pleiades(y)), 0.0, y0, 1e-13);
    let y = state_at(&mut integrator, 3.0);
    let error = largest_difference(&y[..14], &end);
    assert!(error < 1e-10, "{error:e}");
}

// --- The top, and an independent implementation ------------------------------------------------------

/// The paper's equations (7) with its numbers; the state is φ, θ, ψ and their rates.
fn top(&[_, theta, _, dphi, dtheta, dpsi]: &[f64; 6]) -> [f64; 6] {
    const IX: f64 = 8.52e-5;
    const IZ: f64 = 7.25e-5;
    const WEIGHT: f64 = 0.110 * 9.81;
    let (s, c) = libm::sincos(theta);
    let slip = (dtheta * dtheta + dpsi * dpsi * s * s).sqrt();
    let torque = 0.03 * WEIGHT * 0.007 * dpsi / slip;
    let spin = dpsi + dphi * c;
    [
        dphi,
        dtheta,
        dpsi,
        (IZ * dtheta / (IX * s)) * spin - 2.0 * dtheta * dphi * c / s + torque * c / IX,
        -(IZ * dphi * s / IX) * spin + dphi * dphi * s * c + (WEIGHT * 0.020 / IX) * s,
        -(IZ * dtheta * c / (IX * s)) * spin + 2.0 * dtheta * dphi * c * c / s + dtheta * dphi * s
            - torque * (c * c / IX + s * s / IZ),
    ]
}

const TOP_START: [f64; 6] = [0.0, 0.5, 0.0, 1.75, 0.0, 170.0];

struct TopForIvp;

impl ivp::prelude::FirstOrderSystem for TopForIvp {
    fn derivative(&self, _: f64, y: &[f64], dy: &mut [f64]) {
        dy.copy_from_slice(&top(y.try_into().unwrap()));
    }
}

/// The crate `ivp` chooses other steps, so that the two differ by their errors. Those of the spin angle
/// ψ (170 rad/s) and of ψ̇ are the largest: a relative error of 1e-12 per step of 2.4 ms.
#[test]
fn top_moves_as_with_crate_ivp() {
    use ivp::prelude::{Ivp, Method};
    let times: Vec<f64> = (0..=200).map(|i| f64::from(i) * 0.01).collect();
    let solution = Ivp::first_order(&TopForIvp, 0.0, 2.0, &TOP_START)
        .method(Method::DOP853)
        .rtol(1e-12)
        .atol(1e-12)
        .t_eval(times.clone())
        .solve()
        .unwrap();
    assert_eq!(solution.y.len(), times.len());
    let mut integrator = start(equation(|_, y| top(y)), 0.0, TOP_START, 1e-12);
    let mut worst = [0.0_f64; 6];
    for (t, theirs) in times.into_iter().zip(&solution.y) {
        let ours = state_at(&mut integrator, t);
        for i in 0..6 {
            worst[i] = worst[i].max((ours[i] - theirs[i]).abs());
        }
    }
    let bounds = [1e-11, 1e-11, 1e-10, 1e-9, 1e-9, 1e-9];
    for (worst, bound) in worst.into_iter().zip(bounds) {
        assert!(worst < bound, "{worst:e}");
    }
}

/// The reference was calculated with 140 bits by extrapolation (Gragg, Bulirsch, Stoer) of orders 20 and
/// 24, which agree to 22 digits. ψ = 3163 has an ulp of 4.5e-13, of which 15 000 steps add up some tens.
#[test]
fn the_top_after_twenty_seconds() {
    let reference = [
        37.772_835_177_782_88,
        0.120_360_007_237_563_61,
        3_162.882_909_284_896_6,
        1.749_926_908_218_632_2,
        -0.009_853_269_743_023_418,
        150.342_808_810_415_82,
    ];
    for (tolerance, bounds) in [
        (1e-12, [4e-10, 1e-11, 4e-10, 1e-8, 5e-9, 1e-8]),
        (1e-14, [1e-11, 2e-13, 1e-10, 2e-10, 5e-11, 1e-10]),
    ] {
        let mut integrator = start(equation(|_, y| top(y)), 0.0, TOP_START, tolerance);
        let end = state_at(&mut integrator, 20.0);
        for i in 0..6 {
            let error = (end[i] - reference[i]).abs();
            let what = format!("component {i} at {tolerance:e}");
            assert!(error < bounds[i], "{what}: {error:e}");
        }
    }
}

// --- Steps ------------------------------------------------------------------------------------------

/// The oscillator with quadratures that would upset any step control.
struct WithQuadratures;

impl System<5> for WithQuadratures {
    const CONTROLLED: usize = 2;
    fn derivative(&self, t: f64, y: &[f64; 5]) -> [f64; 5] {
        let is_high = libm::sin(1e3 * t) > 0.0;
        let jumping = if is_high { 1e200 } else { -1.0 };
        [y[1], -y[0], y[1] * y[1], jumping, 1e3 * y[4]]
    }
}

#[test]
fn quadratures_do_not_influence_the_motion() {
    let mut with = start(WithQuadratures, 0.0, [1.0, 0.0, 0.0, 0.0, 1e-300], 1e-10);
    let mut without = start(oscillator(), 0.0, [1.0, 0.0], 1e-10);
    while with.t() < 1.0 {
        with.step().unwrap();
        without.step().unwrap();
        assert_eq!(with.t().to_bits(), without.t().to_bits());
        assert_eq!(with.y()[..2], without.y()[..]);
        assert_eq!(with.dense().at(0.3)[..2], without.dense().at(0.3)[..]);
    }
    assert_eq!(with.statistics(), without.statistics());
    // ∫ sin² t dt, without error control of its own.
    let [_, _, integral, ..] = *with.y();
    let t = with.t();
    assert!((integral - (0.5 * t - 0.25 * libm::sin(2.0 * t))).abs() < 1e-8);
}

#[test]
fn short_run_is_prefix_of_long_run_at_any_sampling() {
    let mut sampled = start(non_autonomous(), 0.0, [1.0], 1e-10);
    let mut plain = start(non_autonomous(), 0.0, [1.0], 1e-10);
    for i in 0..100 {
        sampled.step().unwrap();
        plain.step().unwrap();
        if i % 3 == 0 {
            assert_eq!(sampled.dense(), sampled.dense());
        }
        assert_eq!(sampled.t().to_bits(), plain.t().to_bits());
        assert_eq!(sampled.y(), plain.y());
        assert_eq!(sampled.dy(), plain.dy());
    }
}

/// Errors of the dense output in a run, in tolerances and in the norm of the step control.
struct DenseErrors {
    largest: f64,
    /// Least and largest ratio of the defect at 0.8 to the error, where there is an error to speak of.
    defect_per_error: (f64, f64),
}

/// A step whose length is chosen for the dense output too.
fn checked<S: System<N>, const N: usize>(integrator: &mut Dop853<S, N>) -> Dense<N> {
    integrator.step_densely().unwrap();
    integrator.dense()
}

/// A step whose length is chosen for the error at its end.
fn unchecked<S: System<N>, const N: usize>(integrator: &mut Dop853<S, N>) -> Dense<N> {
    integrator.step().unwrap();
    integrator.dense()
}

/// Compares the dense output of each step with an integration from the step's start that is a thousand times finer.
fn dense_errors<S: System<N> + Clone, const N: usize>(
    system: &S,
    y0: [f64; N],
    tolerance: f64,
    end: f64,
    step: impl Fn(&mut Dop853<S, N>) -> Dense<N>,
) -> DenseErrors {
    let mut integrator = start(system.clone(), 0.0, y0, tolerance);
    let mut errors = DenseErrors {
        largest: 0.0,
        defect_per_error: (f64::INFINITY, 0.0),
    };
    while integrator.t() < end {
        let before = *integrator.y();
        let dense = step(&mut integrator);
        let after = integrator.y();
        let norm = |v: &[f64; N]| {
            let squares = (0..S::CONTROLLED).map(|i| {
                let size = before[i].abs().max(after[i].abs());
                let error = v[i] / (tolerance + tolerance * size);
                error * error
            });
            (squares.sum::<f64>() / S::CONTROLLED as f64).sqrt()
        };
        let mut fine = start(system.clone(), dense.t0, before, tolerance / 1000.0);
        let mut error = 0.0_f64;
        for i in 1..16 {
            let s = f64::from(i) / 16.0;
            let exact = state_at(&mut fine, dense.t0 + s * dense.h);
            let state = dense.at(s);
            error = error.max(norm(&std::array::from_fn(|i| state[i] - exact[i])));
        }
        errors.largest = errors.largest.max(error);
        if error > 0.5 {
            let slope = dense.slope(0.8);
            let dy = system.derivative(dense.t0 + 0.8 * dense.h, &dense.at(0.8));
            let defect = norm(&std::array::from_fn(|i| slope[i] - dense.h * dy[i]));
            let (least, most) = errors.defect_per_error;
            errors.defect_per_error = (least.min(defect / error), most.max(defect / error));
        }
    }
    errors
}

/// A top that exchanges little energy in a fast precession: its steps are chosen too long for the dense output.
fn fast_precession() -> (BodyRotation, [f64; BodyRotation::STATE_LENGTH]) {
    let scenario = scenario("rise-by-loss-of-spin", &FAST_PRECESSION);
    let state = BodyRotation::state(scenario.angles, scenario.rates, &scenario.model);
    let (model, phase) = (scenario.model, Phase::Sliding);
    (BodyRotation::new(model, phase), state)
}

/// The paper's top, with a friction that sets in over `speed` m/s of slip: soft or stiff.
fn sliding_top(speed: &str) -> (EulerAngles, [f64; EulerAngles::STATE_LENGTH]) {
    let changes = [
        ("friction.law", "coulomb-tanh"),
        ("friction.smoothing_speed", speed),
        ("initial.theta", "0.05"),
    ];
    in_euler_angles(&scenario("full-coulomb", &changes))
}

fn in_euler_angles(scenario: &Scenario) -> (EulerAngles, [f64; EulerAngles::STATE_LENGTH]) {
    let state = EulerAngles::state(scenario.angles, scenario.rates, &scenario.model);
    let (model, phase) = (scenario.model.clone(), Phase::Sliding);
    (EulerAngles { model, phase }, state)
}

/// The documented bound is ten tolerances; in these cases, the estimate is at most 2.64 times smaller than the error.
const DENSE_BOUND: f64 = 10.0 * 2.64;

#[test]
fn val_dense_output_keeps_to_the_tolerances_over_stiff_and_soft_tops() {
    let (top, state) = fast_precession();
    let found = dense_errors(&top, state, 1e-9, 0.3, checked);
    assert!(found.largest < DENSE_BOUND, "{}", found.largest);
    // Where only the error at the ends counts, the dense output exceeds the bound.
    let without = dense_errors(&top, state, 1e-9, 0.3, unchecked);
    assert!(without.largest > DENSE_BOUND, "{}", without.largest);
    for speed in ["0.1", "1e-3", "1e-6"] {
        let (top, state) = sliding_top(speed);
        for tolerance in [1e-7, 1e-10] {
            let found = dense_errors(&top, state, tolerance, 0.3, checked);
            assert!(found.largest < DENSE_BOUND, "{speed} {}", found.largest);
        }
    }
}

#[test]
fn val_dense_output_keeps_to_the_tolerances_over_the_papers_top() {
    let (top, state) = in_euler_angles(&scenario("paper", &[]));
    let found = dense_errors(&top, state, 1e-10, 2.0, checked);
    assert!(found.largest < 10.0, "{}", found.largest);
}

/// Two oscillators in one are what the equations of a top come to.
#[test]
fn val_dense_output_defect_estimates_error() {
    let (top, state) = fast_precession();
    let (least, most) = dense_errors(&top, state, 1e-9, 0.3, unchecked).defect_per_error;
    assert!(least > 2.3 && most < 3.8, "{least} {most}");
    let (top, state) = sliding_top("1e-3");
    let (least, most) = dense_errors(&top, state, 1e-9, 0.3, unchecked).defect_per_error;
    assert!(least > 0.7 && most < 9.4, "{least} {most}");
}

#[test]
fn the_slope_of_the_dense_output_is_its_derivative() {
    let mut integrator = start(oscillator(), 0.0, [1.0, 0.0], 1e-9);
    integrator.step_densely().unwrap();
    let dense = integrator.dense();
    for i in 0..=10 {
        let s = f64::from(i) / 10.0;
        let step = 1e-4;
        let (after, before) = (dense.at(s + step), dense.at(s - step));
        for (component, slope) in dense.slope(s).into_iter().enumerate() {
            let difference = (after[component] - before[component]) / (2.0 * step);
            // The difference errs by step² times the third derivative, and by the rounding of states near 1.
            assert!((slope - difference).abs() < 1e-8, "{slope} {difference}");
        }
    }
}

/// A system that counts how often it is asked.
struct Counting(Cell<u64>);

impl System<1> for Counting {
    fn derivative(&self, t: f64, y: &[f64; 1]) -> [f64; 1] {
        self.0.set(self.0.get() + 1);
        // The jump makes rejections.
        [if t < 1.0 { y[0] } else { -20.0 * y[0] }]
    }
}

#[test]
fn statistics_count_steps_and_rejections() {
    let mut integrator = start(Counting(Cell::new(0)), 0.0, [1.0], 1e-10);
    assert_eq!(integrator.statistics().evaluations, 2);
    let (mut shortest, mut longest) = (f64::INFINITY, 0.0);
    let (mut length_after_rejection, mut steps) = (None, 0);
    while integrator.t() < 2.0 {
        let rejected_before = integrator.statistics().rejected;
        let t = integrator.t();
        integrator.step().unwrap();
        steps += 1;
        let length = integrator.t() - t;
        if let Some(limit) = length_after_rejection {
            // t + h is rounded.
            assert!(length <= limit + 2.0 * EPSILON, "{length} {limit}");
        }
        let rejected = integrator.statistics().rejected > rejected_before;
        length_after_rejection = rejected.then_some(length);
        (shortest, longest) = (length.min(shortest), length.max(longest));
    }
    let _ = integrator.dense();
    let statistics = *integrator.statistics();
    assert!(statistics.rejected > 0);
    assert_eq!(statistics.accepted, steps);
    let evaluations = 2 + 12 * steps + 11 * statistics.rejected + 3;
    assert_eq!(statistics.evaluations, evaluations);
    assert_eq!(statistics.evaluations, integrator.system().0.get());
    assert_eq!(statistics.smallest_step, shortest);
    assert_eq!(statistics.largest_step, longest);
}

/// y = 1 / (1 − t) reaches infinity at t = 1; errors of 1e-10 shift that by about as much.
#[test]
fn a_singularity_ends_the_integration() {
    let mut integrator = start(equation(|_, y: &[f64; 1]| [y[0] * y[0]]), 0.0, [1.0], 1e-10);
    let error = first_error(&mut integrator);
    let IntegrateError::StepSizeUnderflow { t, step } = error else {
        panic!("{error}");
    };
    assert!((t - 1.0).abs() < 1e-8, "{t}");
    assert!(step.abs() <= 10.0 * EPSILON);
    assert_eq!(integrator.t().to_bits(), t.to_bits());
}

#[test]
fn the_edge_of_a_domain_is_approached_and_not_crossed() {
    // NaN beyond t = 1.
    let system = equation(|t, _: &[f64; 1]| [(1.0 - t).sqrt()]);
    let mut integrator = start(system, 0.0, [0.0], 1e-10);
    let error = first_error(&mut integrator);
    let is_underflow = matches!(error, IntegrateError::StepSizeUnderflow { .. });
    assert!(is_underflow, "{error}");
    let (t, y) = (integrator.t(), *integrator.y());
    assert!(t <= 1.0 && 1.0 - t < 1e-12, "{t}");
    assert!((y[0] - 2.0 / 3.0).abs() < 1e-9, "{y:?}");
    // The failure has left the last good step intact, and happens again.
    let step = integrator.dense();
    assert!((step.component(0, 1.0) - y[0]).abs() <= EPSILON);
    assert!(step.at(0.5)[0].is_finite());
    assert!(integrator.step().is_err());
    assert_eq!((integrator.t(), *integrator.y()), (t, y));
}

struct DivergingQuadrature;

impl System<2> for DivergingQuadrature {
    const CONTROLLED: usize = 1;
    fn derivative(&self, t: f64, y: &[f64; 2]) -> [f64; 2] {
        [y[0], if t < 1.0 { 1.0 } else { f64::NAN }]
    }
}

#[test]
fn rejects_non_finite_values() {
    let mut integrator = start(DivergingQuadrature, 0.0, [1.0, 0.0], 1e-10);
    let error = first_error(&mut integrator);
    let is_behind = matches!(error, IntegrateError::NonFiniteState { t } if t >= 1.0);
    assert!(is_behind, "{error}");
    assert!(integrator.t() < 1.0 && integrator.y()[1].is_finite());
    assert_eq!(integrator.step(), Err(error));

    for (t0, y0) in [
        (0.0, f64::NAN),
        (0.0, f64::INFINITY),
        (f64::NAN, 0.0),
        (2.0, 0.0),
    ] {
        let system = equation(|t: f64, _: &[f64; 1]| [(1.0 - t).sqrt()]);
        let error = Dop853::new(system, t0, [y0], tolerances(1e-9)).err();
        assert!(matches!(error, Some(IntegrateError::NonFiniteState { .. })));
    }
}

/// Steps grow sixfold until t overflows.
#[test]
fn system_at_rest_fails_at_maximum_time() {
    let mut integrator = start(equation(|_, _: &[f64; 1]| [0.0]), 0.0, [1.0], 1e-9);
    let error = (0..1000).find_map(|_| integrator.step().err());
    let t = f64::INFINITY;
    assert_eq!(error, Some(IntegrateError::NonFiniteState { t }));
}

/// The probe of the first step leaves the domain of the equation.
#[test]
fn a_start_at_the_edge_of_the_domain_succeeds() {
    for beyond in [f64::NAN, f64::INFINITY] {
        let system = equation(|t: f64, y: &[f64; 1]| [if t < 1e-5 { -y[0] } else { beyond }]);
        let mut integrator = start(system, 0.0, [1.0], 1e-9);
        integrator.step().unwrap();
        assert!(integrator.t() > 0.0);
    }
}

// --- Zeros ------------------------------------------------------------------------------------------

/// The crossings of `g` on one step and the number of evaluations besides those at the knots.
fn scan(tracker: &mut SignTracker, mut g: impl FnMut(f64) -> f64) -> (Vec<Crossing>, usize) {
    let values = KNOTS.map(&mut g);
    let (mut found, mut evaluations) = (Vec::new(), 0);
    let counted = |s: f64| {
        evaluations += 1;
        assert!((0.0..=1.0).contains(&s), "{s} is outside the step");
        g(s)
    };
    tracker.scan(&values, counted, &mut found);
    (found, evaluations)
}

fn zeros(g: impl FnMut(f64) -> f64) -> Vec<Crossing> {
    scan(&mut SignTracker::default(), g).0
}

/// Two zeros as far from `middle`, between which the function is negative.
fn pair(middle: f64, half: f64) -> [(f64, Slope); 2] {
    [
        (middle - half, Slope::Falling),
        (middle + half, Slope::Rising),
    ]
}

fn assert_crossings(found: &[Crossing], expected: &[(f64, Slope)], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    for (found, (s, slope)) in found.iter().zip(expected) {
        assert_eq!(found.slope, *slope);
        assert!((found.s - s).abs() <= tolerance, "{} {s}", found.s);
    }
}

#[test]
fn a_single_zero_is_located_to_an_ulp_with_few_evaluations() {
    for i in 1..1000 {
        let zero = f64::from(i) / 1000.0;
        let (found, evaluations) = scan(&mut SignTracker::default(), |s| s - zero);
        assert_crossings(&found, &[(zero, Slope::Rising)], EPSILON);
        assert!(evaluations <= 60, "{evaluations}");
        let cubic = |s: f64| (zero - s) * (1.0 + 3.0 * s * s);
        let (found, evaluations) = scan(&mut SignTracker::default(), cubic);
        assert_crossings(&found, &[(zero, Slope::Falling)], EPSILON);
        assert!(evaluations <= 15, "{evaluations}");
    }
}

/// A function whose zero bisection finds in 52 evaluations and the secant in thousands.
#[test]
fn flat_and_steep_functions_need_few_evaluations() {
    let functions: [fn(f64) -> f64; 4] = [
        |s| {
            let x = s - 0.3;
            let cube = x * x * x;
            cube * cube * cube
        },
        |s| if s < 0.1234 { -1e-300 } else { 1e300 },
        |s| if s < 0.9 { -1e300 } else { 1e-300 },
        |s| (s - 0.6) / (1e-9 + (s - 0.6).abs()),
    ];
    for g in functions {
        let (found, evaluations) = scan(&mut SignTracker::default(), g);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].slope, Slope::Rising);
        assert!(evaluations <= 300, "{evaluations}");
    }
}

/// The differences s − m are exact near the zeros m ± δ, so that only those are rounded.
#[test]
fn two_zeros_between_knots_are_found() {
    for middle in [0.013, 0.1, 0.24, 0.26, 0.45, 0.5003, 0.6, 0.77, 0.9, 0.987] {
        for half in [0.008, 1e-3, 1e-4, 1e-5, 1e-6] {
            let parabola = |s: f64| (s - middle) * (s - middle) - half * half;
            let [falling, rising] = pair(middle, half);
            let expected = [falling, rising];
            assert_crossings(&zeros(parabola), &expected, 2.0 * EPSILON);
            let expected = [(falling.0, Slope::Rising), (rising.0, Slope::Falling)];
            assert_crossings(&zeros(|s| -parabola(s)), &expected, 2.0 * EPSILON);
        }
    }
}

/// The same with the turning point next to the ends of the step, or one of its knots.
#[test]
fn two_zeros_next_to_a_knot_are_found() {
    for half in [1e-3, 1e-4, 1e-5, 1e-6] {
        let middles = KNOTS.map(|knot| [knot - 1.5 * half, knot + 1.5 * half]);
        for middle in middles.concat() {
            if (0.0..1.0).contains(&middle) {
                let found = zeros(|s| (s - middle) * (s - middle) - half * half);
                assert_crossings(&found, &pair(middle, half), 2.0 * EPSILON);
            }
        }
    }
}

/// A function that no polynomial equals; the step is a sixth of its period, more than the integrator
/// ever takes. Near the zeros its slope is 2 sin 2δ ≈ 4 δ and its rounding 1 ulp.
#[test]
fn two_zeros_of_a_sinusoid_are_found() {
    for i in 1..200 {
        let middle = f64::from(i) / 200.0;
        for half in [4e-3, 1e-3, 1e-4, 1e-5] {
            if middle < half || middle > 1.0 - half {
                continue;
            }
            let found = zeros(|s| libm::cos(2.0 * half) - libm::cos(2.0 * (s - middle)));
            assert_crossings(&found, &pair(middle, half), EPSILON / half);
        }
    }
}

#[test]
fn finds_many_zeros_in_one_interval() {
    let found = zeros(|s| (s - 0.26) * (s - 0.36) * (s - 0.49));
    let expected = [
        (0.26, Slope::Rising),
        (0.36, Slope::Falling),
        (0.49, Slope::Rising),
    ];
    assert_crossings(&found, &expected, 2.0 * EPSILON);
}

#[test]
fn touching_zero_is_not_a_crossing() {
    for middle in [0.0, 0.25, 0.4, 0.5, 0.9, 1.0] {
        assert_eq!(zeros(|s| (s - middle) * (s - middle)), []);
        assert_eq!(zeros(|s| -(s - middle) * (s - middle) - 1e-18), []);
    }
}

/// Runs of watched values that stay far from zero or constant cost nothing.
#[test]
fn functions_clear_of_zero_are_not_evaluated() {
    for g in [
        (|s| 3.0 + s) as fn(f64) -> f64,
        |s| -1.5 - (s - 0.4) * (s - 0.4),
        |_| 1.0,
    ] {
        assert_eq!(scan(&mut SignTracker::default(), g), (vec![], 0));
    }
}

#[test]
fn a_zero_at_a_knot_is_found_once_and_exactly() {
    for knot in &KNOTS[1..4] {
        assert_crossings(&zeros(|s| s - knot), &[(*knot, Slope::Rising)], 0.0);
    }
}

#[test]
fn a_zero_between_steps_is_found_once() {
    let mut tracker = SignTracker::default();
    assert_eq!(scan(&mut tracker, |s| 1.0 - s).0, []);
    let (found, _) = scan(&mut tracker, |s| -s);
    assert_crossings(&found, &[(0.0, Slope::Falling)], 0.0);
    // Back again: touched, not crossed.
    assert_eq!(scan(&mut tracker, |s| s - 1.0).0, []);
    assert_eq!(scan(&mut tracker, |s| -s).0, []);
}

/// The value at the end of a step and that at the start of the next may differ by rounding.
#[test]
fn finds_sign_change_within_rounding_between_steps() {
    let mut tracker = SignTracker::default();
    assert_eq!(scan(&mut tracker, |s| 1e-17 + 1.0 - s).0.len(), 0);
    let (found, _) = scan(&mut tracker, |s| -1e-17 - s);
    assert_crossings(&found, &[(0.0, Slope::Falling)], 0.0);
}

#[test]
fn first_sign_after_zero_is_not_a_crossing() {
    assert_eq!(zeros(|s| s), []);
    assert_eq!(zeros(|s| -s), []);
    let mut tracker = SignTracker::default();
    assert_eq!(scan(&mut tracker, |_| 0.0).0, []);
    assert_eq!(scan(&mut tracker, |s| s * (s - 0.6)).0.len(), 1);
}

#[test]
fn the_first_zero_of_many_is_the_crossing() {
    let plateau = |s: f64| {
        if s < 0.25 {
            1.0
        } else if s <= 0.75 {
            0.0
        } else {
            -1.0
        }
    };
    assert_crossings(&zeros(plateau), &[(0.25, Slope::Falling)], 0.0);
}

#[test]
fn ignores_noise_around_zero() {
    let noise = |s: f64| {
        let is_up = libm::sin(1e6 * s) > 0.0;
        if is_up { 1e-9 } else { -1e-9 }
    };
    let mut tracker = SignTracker::with_noise_level(1e-8);
    let found = scan(&mut tracker, |s| s - 0.5 + noise(s)).0;
    assert_crossings(&found, &[(0.5, Slope::Rising)], 1e-8);
    assert_eq!(scan(&mut tracker, noise).0, []);
    assert_eq!(scan(&mut tracker, |s| s + noise(s)).0, []);
    // The sign changed in the noise: the crossing is noticed when the function leaves it.
    assert_eq!(scan(&mut tracker, |s| -1e-9 * s).0, []);
    let found = scan(&mut tracker, |s| -1e-9 - s).0;
    assert_crossings(&found, &[(0.0, Slope::Falling)], 0.0);
}

#[test]
fn zero_is_located_where_the_noise_spans_the_end_of_a_step() {
    let mut tracker = SignTracker::looking_ahead();
    tracker.set_noise_level(1e-3);
    let found = scan(&mut tracker, |s| 0.9995 - s).0;
    assert_crossings(&found, &[(0.9995, Slope::Falling)], 1e-15);
    // It has crossed already, and turns back without leaving the noise.
    assert_eq!(scan(&mut tracker, |s| -0.0005 - s).0, []);
    assert_eq!(scan(&mut tracker, |s| 0.0005 * s - 1.0005).0, []);
    let mut tracker = SignTracker::looking_ahead();
    tracker.set_noise_level(1e-3);
    let turns = |s: f64| 0.5 * (s - 1.01) * (s - 1.01) - 1e-4;
    assert_eq!(scan(&mut tracker, turns).0, []);
    assert_eq!(scan(&mut tracker, |s| turns(s + 1.0)).0, []);
}

/// NaN between `from` and `to`, zero outside.
fn nan_between(from: f64, to: f64, s: f64) -> f64 {
    if s > from && s < to { f64::NAN } else { 0.0 }
}

#[test]
fn nan_input_terminates() {
    type Function = fn(f64) -> f64;
    let bad: [(Function, usize); 6] = [
        (|_| f64::NAN, 0),
        (|s| if s < 0.5 { f64::NAN } else { s }, 0),
        (|s| nan_between(0.3, 0.7, s) + s - 0.5, 1),
        (|s| nan_between(0.26, 0.49, s) + s - 0.4, 1),
        (|s| 1.0 / (s - 0.6), 1),
        (|s| f64::copysign(f64::INFINITY, s - 0.9), 1),
    ];
    for (g, crossings) in bad {
        let (found, evaluations) = scan(&mut SignTracker::default(), g);
        assert_eq!(found.len(), crossings);
        assert!(evaluations < 300, "{evaluations}");
    }
}

/// A pseudo-random sign at every point: hostile, but bounded.
#[test]
fn evaluations_are_bounded() {
    for seed in 0..50_u64 {
        let g = |s: f64| {
            let mixed = (s.to_bits() ^ seed).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            f64::from((mixed >> 40) as u32) - 8_388_608.0
        };
        let (found, evaluations) = scan(&mut SignTracker::default(), g);
        // At most 16 turning points and 20 roots.
        assert!(evaluations <= 36 * 100, "{evaluations}");
        assert!(found.is_sorted_by(|a, b| a.s <= b.s && a.slope != b.slope));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// All zeros of a cubic over three steps, in product form so that its sign is exact: two may be as close
    /// as 1e-5, not all three.
    #[test]
    fn finds_all_zeros_of_random_cubics(
        first in -0.5..2.5_f64,
        narrow in 1e-5..0.3_f64,
        wide in 0.2..1.5_f64,
        mirrored: bool,
        factor in prop_oneof![-1e3..-1e-3_f64, 1e-3..1e3_f64],
    ) {
        let side = if mirrored { -1.0 } else { 1.0 };
        let mut roots = [first, first + side * narrow, first + side * (narrow + wide)];
        roots.sort_by(f64::total_cmp);
        let cubic = |t: f64| factor * (t - roots[0]) * (t - roots[1]) * (t - roots[2]);
        let mut tracker = SignTracker::default();
        let mut found = Vec::new();
        for start in [0.0, 1.0, 2.0] {
            let (crossings, _) = scan(&mut tracker, |s| cubic(start + s));
            found.extend(crossings.into_iter().map(|c| (start + c.s, c.slope)));
        }
        let inside: Vec<f64> = roots.into_iter().filter(|r| (0.0..3.0).contains(r)).collect();
        prop_assert_eq!(found.len(), inside.len(), "{:?} {:?}", found, inside);
        for ((t, slope), root) in found.into_iter().zip(inside) {
            // s is resolved to ε, start + s to the ulp of 3.
            prop_assert!((t - root).abs() <= 4.0 * EPSILON, "{} {}", t, root);
            let after = cubic(root + 1e-7);
            prop_assert_eq!(slope, if after > 0.0 { Slope::Rising } else { Slope::Falling });
        }
    }
}
