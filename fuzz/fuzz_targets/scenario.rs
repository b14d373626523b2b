//! Any text as a scenario.

#![no_main]

use libfuzzer_sys::fuzz_target;

#[allow(dead_code)] // each target takes one of the steps
mod steps;

fuzz_target!(|data: &[u8]| steps::scenario(data));
