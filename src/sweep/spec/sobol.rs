//! Sobol sequence.
//!
//! Own implementation, because available crates are limited to 65,536 points or unmaintained.

/// Number of dimensions that the table has.
pub(super) const DIMENSIONS: usize = DIRECTIONS.len() + 1;

/// Number of bits of a coordinate.
const BITS: u32 = 52;

/// For each dimension but the first a primitive polynomial, its coefficients as binary digits, and the initial direction
/// numbers: S. Joe and F. Y. Kuo, Constructing Sobol sequences with better two-dimensional projections, SIAM J. Sci.
/// Comput. 30 (2008) 2635, table `new-joe-kuo-6.21201`.
#[rustfmt::skip]
const DIRECTIONS: &[(u32, &[u64])] = &[
    (3, &[1]),
    (7, &[1, 3]),
    (11, &[1, 3, 1]),
    (13, &[1, 1, 1]),
    (19, &[1, 1, 3, 3]),
    (25, &[1, 3, 5, 13]),
    (37, &[1, 1, 5, 5, 17]),
    (41, &[1, 1, 5, 5, 5]),
    (47, &[1, 1, 7, 11, 19]),
    (55, &[1, 1, 5, 1, 1]),
    (59, &[1, 1, 1, 3, 11]),
    (61, &[1, 3, 5, 5, 31]),
    (67, &[1, 3, 3, 9, 7, 49]),
    (91, &[1, 1, 1, 15, 21, 21]),
    (97, &[1, 3, 1, 13, 27, 49]),
    (103, &[1, 1, 1, 15, 7, 5]),
    (109, &[1, 3, 1, 15, 13, 25]),
    (115, &[1, 1, 5, 5, 19, 61]),
    (131, &[1, 3, 7, 11, 23, 15, 103]),
    (137, &[1, 3, 7, 13, 13, 15, 69]),
    (143, &[1, 1, 3, 13, 7, 35, 63]),
    (145, &[1, 3, 5, 9, 1, 25, 53]),
    (157, &[1, 3, 1, 13, 9, 35, 107]),
    (167, &[1, 3, 1, 5, 27, 61, 31]),
    (171, &[1, 1, 5, 11, 19, 41, 61]),
    (185, &[1, 3, 5, 3, 3, 13, 69]),
    (191, &[1, 1, 7, 13, 1, 19, 1]),
    (193, &[1, 3, 7, 5, 13, 19, 59]),
    (203, &[1, 1, 3, 9, 25, 29, 41]),
    (211, &[1, 3, 5, 13, 23, 1, 55]),
    (213, &[1, 3, 7, 3, 13, 59, 17]),
    (229, &[1, 3, 1, 3, 5, 53, 69]),
    (239, &[1, 1, 5, 5, 23, 33, 13]),
    (241, &[1, 1, 7, 7, 1, 61, 123]),
    (247, &[1, 1, 7, 9, 13, 61, 49]),
    (253, &[1, 3, 3, 5, 3, 55, 33]),
    (285, &[1, 3, 1, 15, 31, 13, 49, 245]),
    (299, &[1, 3, 5, 15, 31, 59, 63, 97]),
    (301, &[1, 3, 1, 11, 11, 11, 77, 249]),
    (333, &[1, 3, 1, 11, 27, 43, 71, 9]),
    (351, &[1, 1, 7, 15, 21, 11, 81, 45]),
    (355, &[1, 3, 7, 3, 25, 31, 65, 79]),
    (357, &[1, 3, 1, 1, 19, 11, 3, 205]),
    (361, &[1, 1, 5, 9, 19, 21, 29, 157]),
    (369, &[1, 3, 7, 11, 1, 33, 89, 185]),
    (391, &[1, 3, 3, 3, 15, 9, 79, 71]),
    (397, &[1, 3, 7, 11, 15, 39, 119, 27]),
    (425, &[1, 1, 3, 1, 11, 31, 97, 225]),
    (451, &[1, 1, 1, 3, 23, 43, 57, 177]),
    (463, &[1, 3, 7, 7, 17, 17, 37, 71]),
    (487, &[1, 3, 1, 5, 27, 63, 123, 213]),
    (501, &[1, 1, 3, 5, 11, 43, 53, 133]),
    (529, &[1, 3, 5, 5, 29, 17, 47, 173, 479]),
    (539, &[1, 3, 3, 11, 3, 1, 109, 9, 69]),
    (545, &[1, 1, 1, 5, 17, 39, 23, 5, 343]),
    (557, &[1, 3, 1, 5, 25, 15, 31, 103, 499]),
    (563, &[1, 1, 1, 11, 11, 17, 63, 105, 183]),
    (601, &[1, 1, 5, 11, 9, 29, 97, 231, 363]),
    (607, &[1, 1, 5, 15, 19, 45, 41, 7, 383]),
    (617, &[1, 3, 7, 7, 31, 19, 83, 137, 221]),
    (623, &[1, 1, 1, 3, 23, 15, 111, 223, 83]),
    (631, &[1, 1, 5, 13, 31, 15, 55, 25, 161]),
    (637, &[1, 1, 3, 13, 25, 47, 39, 87, 257]),
];

/// One coordinate of Sobol's sequence.
#[derive(Clone, Debug)]
pub(super) struct Sobol([u64; BITS as usize]);

impl Sobol {
    /// The coordinate in a dimension below [`DIMENSIONS`].
    pub(super) fn new(dimension: usize) -> Self {
        let mut numbers = [1_u64; BITS as usize];
        if dimension > 0 {
            let (polynomial, initial) = DIRECTIONS[dimension - 1];
            let degree = initial.len();
            numbers[..degree].copy_from_slice(initial);
            for j in degree..numbers.len() {
                // m_j = 2 a_1 m_(j−1) ⊕ 4 a_2 m_(j−2) ⊕ … ⊕ 2^d m_(j−d) ⊕ m_(j−d), with the coefficients a of the
                // polynomial of degree d.
                let mut next = numbers[j - degree];
                for k in 1..=degree {
                    if polynomial >> (degree - k) & 1 == 1 {
                        next ^= numbers[j - k] << k;
                    }
                }
                numbers[j] = next;
            }
        }
        for (number, shift) in numbers.iter_mut().zip((0..BITS).rev()) {
            *number <<= shift;
        }
        Self(numbers)
    }

    /// The coordinate of a point of the sequence, in binary digits: a number below 2⁵². The sequence is in Gray code
    /// order, as usual.
    fn digits(&self, index: u64) -> u64 {
        let gray = index ^ (index >> 1);
        let used = self.0.iter().enumerate();
        used.filter(|(bit, _)| gray >> bit & 1 == 1)
            .fold(0, |digits, (_, number)| digits ^ number)
    }

    /// The coordinate, from 0 to below 1, of a point of the sequence, with a digital shift (XOR with `shift`), which
    /// preserves the low discrepancy.
    pub(super) fn at(&self, index: u64, shift: u64) -> f64 {
        let digits = self.digits(index) ^ (shift >> (64 - BITS));
        // Exact, because a double holds 53 bits.
        digits as f64 / (1_u64 << BITS) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each block of 2ⁿ points has one coordinate in each of 2ⁿ intervals, with a shift too.
    #[test]
    fn blocks_fill_all_intervals_once() {
        for dimension in [0, 1, 7, DIMENSIONS - 1] {
            let sobol = Sobol::new(dimension);
            for shift in [0, 0x0123_4567_89ab_cdef] {
                let mut places: Vec<u64> = (1024..2048)
                    .map(|index| (sobol.at(index, shift) * 1024.0) as u64)
                    .collect();
                places.sort_unstable();
                assert!(places.into_iter().eq(0..1024), "{dimension}");
            }
        }
    }
}
