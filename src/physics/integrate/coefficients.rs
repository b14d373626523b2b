//! The coefficients of DOP853: nodes, stages, error estimates and dense output.
//!
//! Source: E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I. Nonstiff Problems*, 2nd ed.
//! (Springer, 1993), sections II.5 (the method of order 8 by Dormand and Prince) and II.6 (dense output), and the
//! authors' program `dop853.f`, from which `SciPy`'s `dop853_coefficients.py` (BSD 3-clause) was typed. The values
//! below are the nearest `f64` to its decimals.
//!
//! The licence of `dop853.f` (<https://www.unige.ch/~hairer/prog/licence.txt>) is the BSD 2-clause one,
//! "Copyright (c) 2004, Ernst Hairer"; only the numbers, none of its code, are used here.
//!
//! Stages count from 0, where the book counts from 1:
//!
//! * 0 is the derivative at the step's start, 1 to 11 advance the solution;
//! * 12 is the derivative at the step's end, which is stage 0 of the next step;
//! * 13 to 15 serve the dense output alone.

/// Nonzero coefficients of a linear combination of stages: (stage, coefficient).
pub(super) type StageWeights<const M: usize> = [(usize, f64); M];

/// Number of stages of a step whose derivatives enter its solution.
pub(super) const STAGES: usize = 12;

/// Number of stages with those of the dense output.
pub(super) const ALL_STAGES: usize = 16;

/// Nodes c: the fraction of the step at which each stage evaluates the derivative.
pub(super) const NODES: [f64; ALL_STAGES] = [
    0.0,
    0.05260015195876773,
    0.0789002279381516,
    0.1183503419072274,
    0.2816496580927726,
    0.3333333333333333,
    0.25,
    0.3076923076923077,
    0.6512820512820513,
    0.6,
    0.8571428571428571,
    1.0,
    1.0,
    0.1,
    0.2,
    0.7777777777777778,
];

/// Row 1 of the matrix a: the state at which stage 1 is evaluated.
pub(super) const STAGE_1: StageWeights<1> = [(0, 0.05260015195876773)];

/// Row 2 of the matrix a: the state at which stage 2 is evaluated.
pub(super) const STAGE_2: StageWeights<2> = [(0, 0.0197250569845379), (1, 0.0591751709536137)];

/// Row 3 of the matrix a: the state at which stage 3 is evaluated.
pub(super) const STAGE_3: StageWeights<2> = [(0, 0.02958758547680685), (2, 0.08876275643042054)];

/// Row 4 of the matrix a: the state at which stage 4 is evaluated.
pub(super) const STAGE_4: StageWeights<3> = [
    (0, 0.2413651341592667),
    (2, -0.8845494793282861),
    (3, 0.924834003261792),
];

/// Row 5 of the matrix a: the state at which stage 5 is evaluated.
pub(super) const STAGE_5: StageWeights<3> = [
    (0, 0.037037037037037035),
    (3, 0.17082860872947386),
    (4, 0.12546768756682242),
];

/// Row 6 of the matrix a: the state at which stage 6 is evaluated.
pub(super) const STAGE_6: StageWeights<4> = [
    (0, 0.037109375),
    (3, 0.17025221101954405),
    (4, 0.06021653898045596),
    (5, -0.017578125),
];

/// Row 7 of the matrix a: the state at which stage 7 is evaluated.
pub(super) const STAGE_7: StageWeights<5> = [
    (0, 0.03709200011850479),
    (3, 0.17038392571223998),
    (4, 0.10726203044637328),
    (5, -0.015319437748624402),
    (6, 0.008273789163814023),
];

/// Row 8 of the matrix a: the state at which stage 8 is evaluated.
pub(super) const STAGE_8: StageWeights<6> = [
    (0, 0.6241109587160757),
    (3, -3.3608926294469414),
    (4, -0.868219346841726),
    (5, 27.59209969944671),
    (6, 20.154067550477894),
    (7, -43.48988418106996),
];

/// Row 9 of the matrix a: the state at which stage 9 is evaluated.
pub(super) const STAGE_9: StageWeights<7> = [
    (0, 0.47766253643826434),
    (3, -2.4881146199716677),
    (4, -0.590290826836843),
    (5, 21.230051448181193),
    (6, 15.279233632882423),
    (7, -33.28821096898486),
    (8, -0.020331201708508627),
];

/// Row 10 of the matrix a: the state at which stage 10 is evaluated.
pub(super) const STAGE_10: StageWeights<8> = [
    (0, -0.9371424300859873),
    (3, 5.186372428844064),
    (4, 1.0914373489967295),
    (5, -8.149787010746927),
    (6, -18.52006565999696),
    (7, 22.739487099350505),
    (8, 2.4936055526796523),
    (9, -3.0467644718982196),
];

/// Row 11 of the matrix a: the state at which stage 11 is evaluated.
pub(super) const STAGE_11: StageWeights<9> = [
    (0, 2.273310147516538),
    (3, -10.53449546673725),
    (4, -2.0008720582248625),
    (5, -17.9589318631188),
    (6, 27.94888452941996),
    (7, -2.8589982771350235),
    (8, -8.87285693353063),
    (9, 12.360567175794303),
    (10, 0.6433927460157636),
];

/// Weights b: the solution of order 8 at the end of the step.
pub(super) const SOLUTION: StageWeights<8> = [
    (0, 0.054293734116568765),
    (5, 4.450312892752409),
    (6, 1.8915178993145003),
    (7, -5.801203960010585),
    (8, 0.3111643669578199),
    (9, -0.1521609496625161),
    (10, 0.20136540080403034),
    (11, 0.04471061572777259),
];

/// Row 13 of the matrix a, for the dense output.
pub(super) const STAGE_13: StageWeights<8> = [
    (0, 0.056167502283047954),
    (6, 0.25350021021662483),
    (7, -0.2462390374708025),
    (8, -0.12419142326381637),
    (9, 0.15329179827876568),
    (10, 0.00820105229563469),
    (11, 0.007567897660545699),
    (12, -0.008298),
];

/// Row 14 of the matrix a, for the dense output.
pub(super) const STAGE_14: StageWeights<8> = [
    (0, 0.03183464816350214),
    (5, 0.028300909672366776),
    (6, 0.053541988307438566),
    (7, -0.05492374857139099),
    (10, -0.00010834732869724932),
    (11, 0.0003825710908356584),
    (12, -0.00034046500868740456),
    (13, 0.1413124436746325),
];

/// Row 15 of the matrix a, for the dense output.
pub(super) const STAGE_15: StageWeights<8> = [
    (0, -0.42889630158379194),
    (5, -4.697621415361164),
    (6, 7.683421196062599),
    (7, 4.06898981839711),
    (8, 0.3567271874552811),
    (12, -0.0013990241651590145),
    (13, 2.9475147891527724),
    (14, -9.15095847217987),
];

/// Weights b minus those of the embedded solution of order 3.
pub(super) const ERROR_3: StageWeights<8> = [
    (0, -0.18980075407240762),
    (5, 4.450312892752409),
    (6, 1.8915178993145003),
    (7, -5.801203960010585),
    (8, -0.4226823213237919),
    (9, -0.1521609496625161),
    (10, 0.20136540080403034),
    (11, 0.02265179219836082),
];

/// Weights b minus those of the embedded solution of order 5.
pub(super) const ERROR_5: StageWeights<8> = [
    (0, 0.01312004499419488),
    (5, -1.2251564463762044),
    (6, -0.4957589496572502),
    (7, 1.6643771824549864),
    (8, -0.35032884874997366),
    (9, 0.3341791187130175),
    (10, 0.08192320648511571),
    (11, -0.022355307863886294),
];

/// Weights d: the coefficients 4 to 7 of the dense output.
pub(super) const DENSE: [StageWeights<12>; 4] = [
    [
        (0, -8.428938276109013),
        (5, 0.5667149535193777),
        (6, -3.0689499459498917),
        (7, 2.38466765651207),
        (8, 2.117034582445028),
        (9, -0.871391583777973),
        (10, 2.2404374302607883),
        (11, 0.6315787787694688),
        (12, -0.08899033645133331),
        (13, 18.148505520854727),
        (14, -9.194632392478356),
        (15, -4.436036387594894),
    ],
    [
        (0, 10.427508642579134),
        (5, 242.28349177525817),
        (6, 165.20045171727028),
        (7, -374.5467547226902),
        (8, -22.113666853125306),
        (9, 7.733432668472264),
        (10, -30.674084731089398),
        (11, -9.332130526430229),
        (12, 15.697238121770845),
        (13, -31.139403219565178),
        (14, -9.35292435884448),
        (15, 35.81684148639408),
    ],
    [
        (0, 19.985053242002433),
        (5, -387.0373087493518),
        (6, -189.17813819516758),
        (7, 527.8081592054236),
        (8, -11.57390253995963),
        (9, 6.8812326946963),
        (10, -1.0006050966910838),
        (11, 0.7777137798053443),
        (12, -2.778205752353508),
        (13, -60.19669523126412),
        (14, 84.32040550667716),
        (15, 11.99229113618279),
    ],
    [
        (0, -25.69393346270375),
        (5, -154.18974869023643),
        (6, -231.5293791760455),
        (7, 357.6391179106141),
        (8, 93.40532418362432),
        (9, -37.45832313645163),
        (10, 104.0996495089623),
        (11, 29.8402934266605),
        (12, -43.53345659001114),
        (13, 96.32455395918828),
        (14, -39.17726167561544),
        (15, -149.72683625798564),
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// The sums below have up to 15 terms of magnitude up to 80, whose decimals were rounded to `f64`: each
    /// contributes half an ulp, and so does each addition.
    fn rounding(row: &[(usize, f64)]) -> f64 {
        let magnitude: f64 = row.iter().map(|(_, a)| a.abs()).sum();
        1e-15_f64.max(f64::EPSILON * magnitude)
    }

    fn sum(row: &[(usize, f64)]) -> f64 {
        row.iter().map(|(_, a)| a).sum()
    }

    /// Condition of order 1 for every stage; for autonomous systems, only this condition detects wrong nodes.
    #[test]
    fn every_row_sums_to_its_node() {
        let rows: [(usize, &[(usize, f64)]); 15] = [
            (1, &STAGE_1),
            (2, &STAGE_2),
            (3, &STAGE_3),
            (4, &STAGE_4),
            (5, &STAGE_5),
            (6, &STAGE_6),
            (7, &STAGE_7),
            (8, &STAGE_8),
            (9, &STAGE_9),
            (10, &STAGE_10),
            (11, &STAGE_11),
            (12, &SOLUTION),
            (13, &STAGE_13),
            (14, &STAGE_14),
            (15, &STAGE_15),
        ];
        for (stage, row) in rows {
            let defect = (sum(row) - NODES[stage]).abs();
            assert!(defect <= rounding(row), "stage {stage}: {defect:e}");
        }
    }

    #[test]
    fn stages_use_only_earlier_stages() {
        let rows: [&[(usize, f64)]; 4] = [&STAGE_11, &STAGE_13, &STAGE_14, &STAGE_15];
        for (row, stage) in rows.into_iter().zip([11, 13, 14, 15]) {
            assert!(row.iter().all(|&(earlier, _)| earlier < stage));
        }
    }

    /// The quadrature conditions of order 8: Σ bᵢ cᵢ^q = 1/(q+1) for q = 0 … 7.
    #[test]
    fn the_weights_integrate_polynomials_of_degree_seven() {
        let mut powers = NODES.map(|_| 1.0);
        for q in 0..8_u8 {
            let integral: f64 = SOLUTION.iter().map(|&(i, b)| b * powers[i]).sum();
            let defect = (integral - 1.0 / f64::from(q + 1)).abs();
            assert!(defect <= rounding(&SOLUTION), "degree {q}: {defect:e}");
            for (power, node) in powers.iter_mut().zip(NODES) {
                *power *= node;
            }
        }
    }

    /// An error estimate must be zero for functions that both of its solutions integrate exactly.
    #[test]
    fn error_estimates_vanish_up_to_their_order() {
        for (row, order) in [(&ERROR_3, 3), (&ERROR_5, 5)] {
            let mut powers = NODES.map(|_| 1.0);
            for q in 0..order {
                let estimate: f64 = row.iter().map(|&(i, e)| e * powers[i]).sum();
                assert!(estimate.abs() <= rounding(row), "order {order}, degree {q}");
                for (power, node) in powers.iter_mut().zip(NODES) {
                    *power *= node;
                }
            }
        }
    }
}
