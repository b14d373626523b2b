//! Progress of a request, shown while it is answered.

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Shows a text: its address and its length.
    #[link_name = "show_progress"]
    fn show(text: *const u8, length: usize);
}

/// Shows how far a request is.
pub fn show_progress(text: &str) {
    // SAFETY: the page reads the text before it returns, and keeps nothing of it.
    unsafe { show(text.as_ptr(), text.len()) }
}
