//! Progress on standard error: on a terminal only, and not with `--quiet`.

use super::output;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A line that shows the progress of a command.
pub(super) struct Progress(ProgressBar);

impl Progress {
    /// Starts a bar that fills up to `total` bytes.
    pub(super) fn for_bytes(action: &'static str, total: u64) -> Self {
        let progress = Self::new(Some(total), "{msg}  {bar:40} {percent:>3} %  [{elapsed}]");
        progress.0.set_message(action);
        progress
    }

    /// Starts a progress line without a total.
    pub(super) fn for_state() -> Self {
        Self::new(None, "{spinner} {msg}  [{elapsed}]")
    }

    /// Starts a bar, or a line if there is no total, with a template of `indicatif`.
    pub(super) fn new(total: Option<u64>, template: &str) -> Self {
        let target = if output::is_quiet() {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(total, target);
        // A template that can't be parsed leaves the default style.
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self(bar)
    }

    /// Advances the bar.
    pub(super) fn add(&self, more: u64) {
        // Even nothing would lock the bar and draw it.
        if more > 0 {
            self.0.inc(more);
        }
    }

    /// Shows another state.
    pub(super) fn set_text(&self, state: String) {
        self.0.set_message(state);
        self.0.tick();
    }

    /// Removes the line.
    pub(super) fn finish(&self) {
        self.0.finish_and_clear();
    }
}
