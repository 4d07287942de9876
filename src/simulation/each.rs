//! Realizations that have nothing to do with each other, as many side by side as there are threads.

use super::Finish;
use super::watch::Watch;
use crate::error::RunError;
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// What a realization came to: whether it was finished and kept, or stopped before.
pub(super) type Found = Result<bool, RunError>;

/// Plays `realizations`, `part` at a time on a thread, in order as threads become free; those that finish are kept
/// whatever befalls others. Where one fails for what is not its own numbers (a full disk), no more are begun.
pub(super) fn each(
    realizations: &[u32],
    part: usize,
    watch: &Watch,
    play: impl Fn(&[u32]) -> Vec<(u32, Found)> + Sync,
) -> Finish {
    let finish = Mutex::new((Finish::default(), u32::MAX, false));
    realizations.chunks(part.max(1)).par_bridge().for_each(|numbers| {
        let over = finish.lock().unwrap_or_else(PoisonError::into_inner).2;
        let found = match over || watch.stopped() {
            true => Vec::new(),
            false => play(numbers),
        };
        let mut finish = finish.lock().unwrap_or_else(PoisonError::into_inner);
        finish.0.interrupted |= found.len() < numbers.len() && !over;
        for (number, result) in found {
            match result {
                Ok(true) => watch.advance(1),
                Ok(false) => finish.0.interrupted = true,
                Err(error) => {
                    finish.2 |= matches!(error, RunError::File { .. });
                    // The first failure by number is told, whichever thread came to one first.
                    if number < finish.1 {
                        (finish.0.error, finish.1) = (Some(error.of(number)), number);
                    }
                }
            }
        }
    });
    finish.into_inner().unwrap_or_else(PoisonError::into_inner).0
}
