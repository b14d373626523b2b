//! Native module of the Python package `toprise` (see `toprise/__init__.py`).

#![allow(
    clippy::needless_pass_by_value,
    reason = "arguments from Python are owned"
)]

mod compare;
mod errors;
mod figures;
mod fit;
mod guard;
mod outcome;
mod run;
mod scenario;
mod stream;
mod sweep;
mod table;
mod view;

/// The native module.
#[pyo3::pymodule]
mod _toprise {
    #[pymodule_export]
    use crate::compare::{diff, explain, presets, verify};
    #[pymodule_export]
    use crate::figures::{Figure, figures, map};
    #[pymodule_export]
    use crate::fit::fit;
    #[pymodule_export]
    use crate::outcome::outcome;
    #[pymodule_export]
    use crate::run::{Run, read, run};
    #[pymodule_export]
    use crate::scenario::Scenario;
    #[pymodule_export]
    use crate::sweep::{design, outcome_columns, outcomes, rows, sweep};
    #[pymodule_export]
    use crate::table::{Table, table};

    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
