//! The story of a run, told from its numbers: what friction did to the precession, why the axis rose or fell,
//! and where the energy went.
//!
//! The argument is the paper's (V. Tanrıverdi, arXiv:2204.14060, sections 2 and 3): between the two rates of
//! regular precession θ̈ is negative, friction hurries the precession beyond the slow one, and so the top
//! rises.
//!
//! ```
//! use toprise::analysis::explain::explain;
//! use toprise::run::scenario::{Preset, Scenario};
//!
//! let mut values = Preset::find("paper")?.values()?;
//! values.set("stop.duration", "2.0")?;
//! let scenario = Scenario::new(values)?;
//! let story = explain(&scenario)?;
//! assert!(story.chapters.iter().any(|chapter| chapter.heading == "Why the axis moves"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod facts;
mod peg;
mod pieces;
mod stages;
mod story;
mod tell;
mod totals;
mod why;

pub use self::facts::ExplainError;
pub use self::story::{Chapter, Story};

use crate::analysis::subject::Subject;

/// Tells the story of a run.
///
/// # Errors
/// [`ExplainError`] if it lacks what is needed.
pub fn explain<'a>(subject: impl Into<Subject<'a>>) -> Result<Story, ExplainError> {
    explain_while(subject, &|| true)
}

/// Tells the story of a run, unless `carry_on` says no while it is read or simulated.
///
/// # Errors
/// As [`explain`], and [`ExplainError::Interrupted`].
pub fn explain_while<'a>(
    subject: impl Into<Subject<'a>>,
    carry_on: &dyn Fn() -> bool,
) -> Result<Story, ExplainError> {
    Ok(tell::tell(&facts::gather(subject.into(), carry_on)?))
}
