//! Progress of a fit.

use std::cell::Cell;

/// Progress of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// End of the window, s.
    pub window: f64,
    /// End of the data, s.
    pub until: f64,
    /// Number of spins at the start that were tried to find other minima; 0 before that.
    pub spins: u32,
    /// χ² in it, with priors.
    pub chi2: f64,
    /// Number of simulations so far.
    pub evaluations: u64,
}

/// Counts the simulations of a fit and reports its progress.
pub(in crate::fit) struct Monitor<'a> {
    report: &'a dyn Fn(Progress),
    // Cells, because the optimiser borrows the monitor together with the problem.
    evaluations: Cell<u64>,
    window: Cell<f64>,
    until: Cell<f64>,
    spins: Cell<u32>,
}

impl<'a> Monitor<'a> {
    pub(in crate::fit) fn new(report: &'a dyn Fn(Progress)) -> Self {
        Self {
            report,
            evaluations: Cell::new(0),
            window: Cell::new(0.0),
            until: Cell::new(0.0),
            spins: Cell::new(0),
        }
    }

    /// Number of simulations so far.
    pub(in crate::fit) fn evaluations(&self) -> u64 {
        self.evaluations.get()
    }

    /// Adds simulations that were counted elsewhere.
    pub(in crate::fit) fn add(&self, evaluations: u64) {
        self.evaluations.set(self.evaluations.get() + evaluations);
    }

    /// Sets the end of the window that is fitted now, s, and that of the data.
    pub(in crate::fit) fn set_window(&self, end: f64, until: f64) {
        self.window.set(end);
        self.until.set(until);
    }

    /// Sets the number of spins at the start that were tried to find other minima.
    pub(in crate::fit) fn set_spins(&self, spins: usize) {
        self.spins.set(spins as u32);
    }

    /// Counts simulations and reports the χ² that they found; NaN if they were for derivatives.
    pub(in crate::fit) fn count(&self, simulations: u64, chi2: f64) {
        self.evaluations.set(self.evaluations.get() + simulations);
        (self.report)(Progress {
            window: self.window.get(),
            until: self.until.get(),
            spins: self.spins.get(),
            chi2,
            evaluations: self.evaluations.get(),
        });
    }
}
