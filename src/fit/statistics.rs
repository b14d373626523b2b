//! Statistics of residuals.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use special::Gamma;

/// Probability that χ² with these degrees of freedom is at least as large.
pub(super) fn chi2_p_value(chi2: f64, freedom: f64) -> f64 {
    // The incomplete gamma function is not defined at infinity.
    if !chi2.is_finite() {
        return 0.0;
    }
    (1.0 - (0.5 * chi2).inc_gamma(0.5 * freedom)).clamp(0.0, 1.0)
}

/// An eigenvalue of a [`ScaledGram`] below this is zero within the error of the derivatives: they are right to 1e-5 or
/// better, and the square root of this is 3e-6.
pub(super) const NULL_EIGENVALUE: f64 = 1e-11;

/// Maximum lag of the test for whiteness.
const MAX_LAG: usize = 10;

/// p-value of the Ljung–Box test: small if the residuals (in time order) are correlated with earlier ones. `None` if
/// there are too few.
pub(super) fn whiteness(residuals: &[f64]) -> Option<f64> {
    let count = residuals.len();
    // A correlation at a lag needs several independent pairs.
    let lags = MAX_LAG.min(count / 5);
    if lags == 0 {
        return None;
    }
    let mean = residuals.iter().sum::<f64>() / count as f64;
    // n times the variance, as the covariances below: the factor cancels.
    let variance: f64 = residuals.iter().map(|r| (r - mean) * (r - mean)).sum();
    if variance == 0.0 {
        return None;
    }
    let mut sum = 0.0;
    for lag in 1..=lags {
        let pairs = residuals.iter().zip(&residuals[lag..]);
        let covariance: f64 = pairs.map(|(a, b)| (a - mean) * (b - mean)).sum();
        let correlation = covariance / variance;
        sum += correlation * correlation / (count - lag) as f64;
    }
    let statistic = (count * (count + 2)) as f64 * sum;
    Some(chi2_p_value(statistic, lags as f64))
}

/// p-value of the mean of residuals: small if they have a constant error, which correlations about the mean don't show.
/// `None` for fewer than two.
pub(super) fn mean_p_value(residuals: &[f64]) -> Option<f64> {
    let sum: f64 = residuals.iter().sum();
    let squares: f64 = residuals.iter().map(|r| r * r).sum();
    if residuals.len() < 2 || squares == 0.0 {
        return None;
    }
    // The mean in units of its standard deviation, squared. Squares about 0 keep it finite if all are equal.
    Some(chi2_p_value(sum * sum / squares, 1.0))
}

/// Root mean square; 0 for no values.
pub(super) fn rms(values: &[f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let sum: f64 = values.iter().map(|value| value * value).sum();
    (sum / values.len() as f64).sqrt()
}

/// A symmetric matrix scaled to unit diagonal: its eigenvalues and eigenvectors. Columns of zeros stay zero.
pub(super) struct ScaledGram {
    /// Square roots of the diagonal.
    pub norms: Vec<f64>,
    eigen: SymmetricEigen<f64, nalgebra::Dyn>,
}

impl ScaledGram {
    pub(super) fn new(gram: &DMatrix<f64>) -> Self {
        // Rounding may make a variance slightly negative.
        let norms: Vec<f64> = gram.diagonal().iter().map(|d| d.max(0.0).sqrt()).collect();
        let scaled = DMatrix::from_fn(gram.nrows(), gram.ncols(), |i, j| {
            let norm = norms[i] * norms[j];
            if norm > 0.0 { gram[(i, j)] / norm } else { 0.0 }
        });
        // The decomposition is not defined for a model without parameters.
        let eigen = if norms.is_empty() {
            SymmetricEigen {
                eigenvectors: DMatrix::zeros(0, 0),
                eigenvalues: DVector::zeros(0),
            }
        } else {
            scaled.symmetric_eigen()
        };
        Self { norms, eigen }
    }

    /// The directions along which nothing changes, in units of 1/norm: eigenvectors whose eigenvalue is below a limit.
    pub(super) fn null_directions(&self, limit: f64) -> Vec<Vec<f64>> {
        let mut directions = Vec::new();
        for (at, value) in self.eigen.eigenvalues.iter().enumerate() {
            if *value < limit {
                let direction = self.eigen.eigenvectors.column(at);
                directions.push(direction.iter().copied().collect());
            }
        }
        directions
    }

    /// The inverse of the matrix. A direction without information has a huge variance, a column of zeros has none.
    pub(super) fn inverse(&self) -> DMatrix<f64> {
        /// Below this, an eigenvalue of a matrix with unit diagonal is rounding.
        const ROUNDING: f64 = 1e-15;
        self.unscaled(|value| 1.0 / value.max(ROUNDING))
    }

    /// The inverse in the directions with information, whose eigenvalues are above a limit; zero in the others.
    pub(super) fn pseudo_inverse(&self, limit: f64) -> DMatrix<f64> {
        self.unscaled(|value| if value > limit { 1.0 / value } else { 0.0 })
    }

    /// The matrix with other eigenvalues, scaled back.
    fn unscaled(&self, eigenvalue: impl Fn(f64) -> f64) -> DMatrix<f64> {
        let size = self.norms.len();
        let mut matrix = DMatrix::zeros(size, size);
        for (at, value) in self.eigen.eigenvalues.iter().enumerate() {
            let vector = self.eigen.eigenvectors.column(at);
            matrix += vector * vector.transpose() * eigenvalue(*value);
        }
        DMatrix::from_fn(size, size, |i, j| {
            let norm = self.norms[i] * self.norms[j];
            if norm > 0.0 {
                matrix[(i, j)] / norm
            } else {
                0.0
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_chi2_p_values_equal_tables() {
        for (chi2, freedom, p) in [
            (3.841458820694124, 1.0, 0.05),
            (18.307038053275146, 10.0, 0.05),
            (124.3421134040116, 100.0, 0.05),
            (29.58829844507442, 10.0, 0.001),
        ] {
            let found = chi2_p_value(chi2, freedom);
            assert!((found - p).abs() < 1e-9, "{found} {p}");
        }
        assert_eq!(chi2_p_value(f64::INFINITY, 3.0), 0.0);
    }

    #[test]
    fn a_constant_error_is_not_white() {
        assert!(mean_p_value(&[0.3; 100]).unwrap() < 1e-6);
        let alternating: Vec<f64> = (0..100).map(|i| f64::from(i % 2) - 0.5).collect();
        assert_eq!(mean_p_value(&alternating), Some(1.0));
        assert_eq!(mean_p_value(&[0.0; 5]), None);
    }

    #[test]
    fn matrices_without_columns_have_empty_inverses() {
        let gram = ScaledGram::new(&DMatrix::zeros(0, 0));
        assert!(gram.inverse().is_empty());
        assert!(gram.pseudo_inverse(1e-11).is_empty());
        assert!(gram.null_directions(1e-11).is_empty());
    }

    #[test]
    fn whiteness_finds_a_slow_drift() {
        let drift: Vec<f64> = (0..100).map(|i| f64::from(i) / 100.0).collect();
        assert!(whiteness(&drift).unwrap() < 1e-6);
        // A fixed sequence of a linear congruential generator.
        let mut state = 1_u64;
        let mut noise = Vec::new();
        for _ in 0..200 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            noise.push((state >> 40) as f64);
        }
        assert!(whiteness(&noise).unwrap() > 0.01);
        assert_eq!(whiteness(&[1.0; 3]), None);
    }
}
