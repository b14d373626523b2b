//! toprise as WebAssembly, for the page and for tests in Node.
//!
//! Questions and answers are JSON, see [`answer::Question`]; columns of numbers and files are read from memory. A question is
//! written where [`input`] says; [`ask`] puts its answer where [`output`] says.

#![allow(unsafe_code, reason = "exported names are not mangled")]

mod answer;
mod run;
mod tables;

use answer::Page;
use std::cell::RefCell;

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

/// The address for a question of this length, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    PAGE.with_borrow_mut(|page| {
        page.question = vec![0; length];
        page.question.as_mut_ptr()
    })
}

/// Answers the question; returns the length of the answer, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn ask() -> usize {
    PAGE.with_borrow_mut(Page::answer)
}

/// The address of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    PAGE.with_borrow(|page| page.output.as_ptr())
}

/// The address of a column of the run, as doubles.
#[unsafe(no_mangle)]
pub extern "C" fn column(index: usize) -> *const f64 {
    PAGE.with_borrow(|page| page.column(index).as_ptr())
}

/// The address of the file that was recorded last.
#[unsafe(no_mangle)]
pub extern "C" fn file() -> *const u8 {
    PAGE.with_borrow(|page| page.file.as_ptr())
}
