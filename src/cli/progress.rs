//! Progress on standard error, on a terminal only.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// How far something has come, in bytes.
pub(super) struct Progress(ProgressBar);

impl Progress {
    /// Starts at nothing.
    pub(super) fn of_bytes(action: &'static str, total: u64) -> Self {
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
        let template = "{msg}  {bar:40} {percent:>3} %  [{elapsed}]";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message(action);
        Self(bar)
    }

    /// Some more has been done.
    pub(super) fn add(&self, bytes: u64) {
        if bytes > 0 {
            self.0.inc(bytes);
        }
    }

    /// Removes it.
    pub(super) fn finish(&self) {
        self.0.finish_and_clear();
    }
}
