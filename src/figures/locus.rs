//! Where the symmetry axis points: on the unit sphere, from above, and at its end.

use super::drawing::Drawing;
use super::run::Run;

pub(super) fn locus(_runs: &[&Run], width: f64) -> Drawing {
    Drawing {
        title: String::new(),
        width,
        height: 10.0,
        groups: Vec::new(),
        labels: Vec::<_>::new(),
    }
}
