//! toprise as WebAssembly, for the page and for tests in Node.
//!
//! Requests and responses are JSON, see [`request::Request`]. Data columns and files are read directly from memory. Write
//! a request to the address returned by [`input`]; [`ask`] writes the response to [`output`].

#![allow(unsafe_code, reason = "exported names are not mangled")]

mod fit;
mod form;
mod progress;
mod request;
mod run;
mod scenario_request;
mod tables;
mod verify;

use request::Page;
use std::cell::RefCell;

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

/// Allocates the input buffer for a request of `length` bytes and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    PAGE.with_borrow_mut(|page| {
        page.input = vec![0; length];
        page.input.as_mut_ptr()
    })
}

/// Handles the request; returns the response length in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn ask() -> usize {
    PAGE.with_borrow_mut(Page::respond)
}

/// The address of the response.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    PAGE.with_borrow(|page| page.output.as_ptr())
}

/// The address of a column of the run, as doubles.
#[unsafe(no_mangle)]
pub extern "C" fn column(index: usize) -> *const f64 {
    PAGE.with_borrow(|page| page.column(index).as_ptr())
}

/// Allocates the buffer for a file of `length` bytes, which the next request reads, and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn file_input(length: usize) -> *mut u8 {
    PAGE.with_borrow_mut(|page| {
        page.given = vec![0; length];
        page.given.as_mut_ptr()
    })
}

/// The address of the last recorded file.
#[unsafe(no_mangle)]
pub extern "C" fn file() -> *const u8 {
    PAGE.with_borrow(|page| page.file.as_ptr())
}
