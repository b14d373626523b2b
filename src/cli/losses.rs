//! Unreadable parts of a file as lines of text.

use crate::archive::recording::Loss;
use crate::words::grouped;

/// Maximum number of losses that are shown; the JSON output lists more.
const MAX_SHOWN: usize = 10;

/// A line with its label for each of the first losses, and one with the number of the others. `unlisted` is the number of
/// those that are not in the list.
pub(super) fn loss_lines(losses: &[Loss], unlisted: Option<u64>) -> Vec<(&'static str, String)> {
    let mut lines: Vec<_> = losses
        .iter()
        .take(MAX_SHOWN)
        .map(|loss| (label(loss), loss.to_string()))
        .collect();
    let more = (losses.len() - lines.len()) as u64 + unlisted.unwrap_or(0);
    if more > 0 {
        lines.push(("lost", format!("and {} more", grouped(more))));
    }
    lines
}

fn label(loss: &Loss) -> &'static str {
    if loss.is_suspect { "damage" } else { "lost" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shows_ten_losses_and_the_number_of_others() {
        let losses = vec![Loss::default(); 12];
        for (listed, unlisted, last) in [
            (10, None, None),
            (11, None, Some("and 1 more")),
            (12, Some(2000), Some("and 2,002 more")),
        ] {
            let lines = loss_lines(&losses[..listed], unlisted);
            assert_eq!(lines.get(10).map(|(_, line)| line.as_str()), last);
            assert!(lines.len() <= 11);
        }
    }
}
