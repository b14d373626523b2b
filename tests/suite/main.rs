//! All integration tests in one binary, because each would link the Rerun SDK once more.
//!
//! `val_*` compare with an independent truth, `regress_*` pin what there was, the rest are laws and
//! behaviour.

#![allow(clippy::too_many_lines, reason = "tables of cases")]
#![allow(
    clippy::case_sensitive_file_extension_comparisons,
    reason = "the program wrote the names"
)]

mod agreement;
mod answers;
mod architecture;
mod archive;
mod built_files;
mod command_line;
mod compatible;
mod conformance;
#[cfg(unix)]
mod crash;
mod crates;
mod cycles;
mod damage;
mod diff;
mod documents;
mod effort;
mod explain;
mod faults;
mod figures;
mod file_graph;
#[cfg(feature = "fit")]
mod fit;
#[cfg(feature = "fit")]
mod fit_cases;
#[cfg(feature = "fit")]
mod fit_clocks;
#[cfg(feature = "fit")]
mod fit_laws;
mod foreign;
mod forgeries;
mod formula;
mod free_peg;
mod frozen;
mod fuzz_corpus;
mod generated;
mod golden;
mod integrate;
mod laws;
mod laws_of_motion;
mod loops;
mod outcome;
mod package;
mod packing;
mod physics;
mod properties;
mod publish;
mod random_scenarios;
mod raw;
mod readers;
mod recordings;
mod reference;
mod relogged;
mod report_strings;
#[cfg(feature = "rerun")]
mod rerun;
#[cfg(feature = "rerun")]
mod rerun_pair;
mod rest;
mod scenarios;
mod similarity;
mod slip;
mod supplements;
mod support;
#[cfg(feature = "sweep")]
mod sweep;
mod telemetry;
mod vertical;
