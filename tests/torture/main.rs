//! The torture bench: what happens to runs and recordings where nothing goes as it should.
//!
//! Each campaign tries something many times, with random numbers that follow from a seed, and says how many trials
//! were tried and held. The bench fails if a single one didn't hold. `cargo test` skips it; a sample of two minutes is
//!
//! ```sh
//! cargo test --test torture -- --sample
//! ```
//!
//! and all of it, with campaigns and counts that can be chosen (an hour or two on two cores),
//!
//! ```sh
//! TMPDIR=/dev/shm nice cargo test --test torture -- --full
//! TMPDIR=/dev/shm nice cargo test --test torture -- --full --seed 7 flips=200000 kills=1000
//! ```
//!
//! What fails names its case; `--seed S --case N flips` tries that one alone. The emulated CPUs need `qemu-x86_64`
//! (Debian's `qemu-user`) and are skipped without it.

#![allow(clippy::unnecessary_wraps, reason = "campaigns have one type")]
#![allow(
    clippy::case_sensitive_file_extension_comparisons,
    reason = "the program wrote the names"
)]

#[cfg(unix)]
mod bench;
#[cfg(unix)]
mod bombs;
#[cfg(unix)]
mod damage;
#[cfg(unix)]
mod environments;
#[cfg(unix)]
mod interruptions;
#[cfg(unix)]
mod material;
#[cfg(unix)]
mod overlaps;
#[cfg(unix)]
mod program;
#[cfg(unix)]
mod scenarios;

#[cfg(unix)]
use bench::{Arguments, CAMPAIGNS};
use std::process::ExitCode;

fn main() -> ExitCode {
    let is_asked = std::env::args().any(|word| word == "--sample" || word == "--full");
    if !is_asked || cfg!(not(unix)) {
        println!("torture bench: skipped; start it with `cargo test --test torture -- --sample`");
        return ExitCode::SUCCESS;
    }
    #[cfg(unix)]
    let held = bench::run(&<Arguments as clap::Parser>::parse(), CAMPAIGNS);
    #[cfg(not(unix))]
    let held = true;
    if held {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
